"""Checks that the README shows the part of examples/laplacian.cpp that lies between its markers.

Usage: check_readme.py SOURCE
"""
import pathlib
import re
import sys


def main():
    source = pathlib.Path(sys.argv[1])
    example = re.search(r"^// \[readme\]\n(.*?)^// \[readme end\]$",
                        (source / "examples/laplacian.cpp").read_text(), re.M | re.S)
    if not example:
        return "examples/laplacian.cpp: no part between // [readme] and // [readme end]"
    readme = source / "README.md"
    if not readme.exists():
        return "README.md: missing"
    shown = re.search(r"^<!-- examples/laplacian\.cpp -->\n\s*```cpp\n(.*?)^```$",
                      readme.read_text(), re.M | re.S)
    if not shown:
        return "README.md: no ```cpp block behind the comment <!-- examples/laplacian.cpp -->"
    if shown.group(1).strip() != example.group(1).strip():
        return ("README.md: the C++ example differs from examples/laplacian.cpp; the block should "
                "be\n" + example.group(1))
    return 0


if __name__ == "__main__":
    sys.exit(main())
