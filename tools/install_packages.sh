#!/usr/bin/env bash
# Installs what is missing of the packages in the named groups: build, python, test, docs,
# distributed.
# CARAT_SKIP_PACKAGES=1 leaves the system as it is, for machines that have everything by other means.
set -euo pipefail

# Libraries are looked for as Debian packages, tools (tool:package) on the PATH.
build=(libeigen3-dev libsuitesparse-dev libopenblas-dev libmetis-dev libvtk9-dev
       libmuparser-dev libcli11-dev nlohmann-json3-dev libcairo2-dev zlib1g-dev glmark2-data
       ca-certificates pkg-config:pkg-config cmake:cmake ninja:ninja-build g++:g++ node:nodejs npm:npm python3:python3)
python=(pybind11-dev python3-pybind11 python3-dev python3-numpy python3-scipy)
test=(python3-pytest mypy python3-pip python3-setuptools python3-wheel python3-meshio python3-vtk9
      python3-nbclient python3-nbformat python3-ipykernel
      libgtest-dev libbenchmark-dev libspectra-dev fonts-dejavu-core chromium:chromium clang-format-14:clang-format-14)
distributed=(libscotch-dev petsc-dev slepc-dev libopenmpi-dev mpirun:openmpi-bin)
docs=(python3-sphinx furo python3-myst-parser python3-sphinx-copybutton python3-breathe
      python3-numpydoc python3-meshio python3-vtk9 doxygen:doxygen)

wanted=()
for group in "$@"; do
  case $group in
    build) wanted+=("${build[@]}") ;;
    python) wanted+=("${python[@]}") ;;
    test) wanted+=("${test[@]}") ;;
    distributed) wanted+=("${distributed[@]}") ;;
    docs) wanted+=("${docs[@]}") ;;
    *) echo "install_packages.sh: error: no group '$group'; there are build, python, test, docs and distributed" >&2; exit 2 ;;
  esac
done
[[ ${CARAT_SKIP_PACKAGES:-} == 1 ]] && exit 0

libraries=() missing=()
for entry in "${wanted[@]}"; do
  if [[ $entry != *:* ]]; then
    libraries+=("$entry")
  elif ! command -v "${entry%%:*}" >/dev/null; then
    missing+=("${entry#*:}")
  fi
done
installed=$(dpkg-query --show --showformat '${Package} ${db:Status-Status}\n' "${libraries[@]}" \
              2>/dev/null || true)
for library in "${libraries[@]}"; do
  grep -qx "$library installed" <<<"$installed" || missing+=("$library")
done
((${#missing[@]} == 0)) && exit 0

refuse() {
  {
    echo "Some packages are missing, and $1."
    echo "Install these (names as in Debian 12), then start again:"
    echo "  ${missing[*]}"
    echo "If you have them by other means, set CARAT_SKIP_PACKAGES=1."
  } >&2
  exit 1
}
command -v apt-get >/dev/null || refuse "there is no apt here"
as_root=()
if ((EUID != 0)); then
  command -v sudo >/dev/null || refuse "installing them takes root or sudo"
  as_root=(sudo)
fi

echo "Installing ${missing[*]}" >&2
apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get --quiet --yes)
{
  "${apt[@]}" update
  "${apt[@]}" install --no-install-recommends "${missing[@]}"
} >&2 </dev/null || refuse "apt could not install them (see above)"
