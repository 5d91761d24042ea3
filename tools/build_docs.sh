#!/usr/bin/env bash
# Builds the documentation as pages that need no network, warnings being errors.
set -euo pipefail

usage="Usage: ./tools/build_docs.sh [OUT]

Writes the site to OUT (default build/docs); open OUT/index.html. Takes the Python package: it is
taken from PYTHONPATH or built into build/release. Installs what is missing."
if [[ ${1:-} == -h || ${1:-} == --help ]]; then
  echo "$usage"
  exit 0
fi
out=$(realpath -m -- "${1:-$(dirname "${BASH_SOURCE[0]}")/../build/docs}")
cd "$(dirname "${BASH_SOURCE[0]}")/.."

./tools/install_packages.sh build python docs
python=${PYTHON:-/usr/bin/python3}
if ! "$python" -c 'import carat' 2>/dev/null; then
  export PYTHONPATH=$PWD/build/release/python${PYTHONPATH:+:$PYTHONPATH}
  if ! "$python" -c 'import carat' 2>/dev/null; then
    ./run --python
  fi
fi

"$python" tools/make_notebooks.py --check
"$python" tools/check_python_docs.py README.md docs/index.md docs/guide/*.md

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
{ cat docs/site/Doxyfile; echo "OUTPUT_DIRECTORY = $work"; } | doxygen -
export CARAT_DOXYGEN_XML=$work/xml
"$python" -m sphinx -b html -W --keep-going -E -q -d "$work/doctrees" -c docs/site docs "$out"
rm -f "$out/.buildinfo"

# Whatever a page loads by itself has to be here.
if grep -rlE '(<(script|img|iframe)[^>]* src|<link[^>]* href|url\(|@import|srcset)[= "(]*["'"'"']?(https?:)?//' \
     --include='*.html' --include='*.css' "$out"; then
  echo "build_docs.sh: error: these pages load something from the network" >&2
  exit 1
fi
echo "$out/index.html"
