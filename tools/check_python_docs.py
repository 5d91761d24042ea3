#!/usr/bin/env python3
"""Runs the Python of the documentation: every block marked `python`, page by page.

Usage: check_python_docs.py PAGE.md ...

The blocks of a page share their variables and run in an empty folder. Blocks with prompts (>>>)
have to answer what the page says, the others have to run. A block that imports a package which is not
installed is passed over if that is one of OTHERS.
"""
import doctest
import importlib.util
import os
import re
import sys
import tempfile
from pathlib import Path

BLOCK = re.compile(r"^```python\n(.*?)^```", re.M | re.S)
OTHERS = ("meshio", "pyvista", "trimesh", "vtk")


def lacking(block):
    """The first package that a block imports and that is not there."""
    for name in re.findall(r"^(?:>>> )?(?:import|from) (\w+)", block, re.M):
        if name in OTHERS and importlib.util.find_spec(name) is None:
            return name
    return None


def run(page, counts):
    """What is wrong on a page."""
    text = page.read_text(encoding="utf-8")
    variables, wrong = {"__name__": "page"}, []
    for match in BLOCK.finditer(text):
        block = match.group(1)
        line = text.count("\n", 0, match.start()) + 2
        if name := lacking(block):
            print(f"{page}:{line}: passed over, {name} is not installed")
            continue
        counts.append(line)
        if ">>>" in block:
            test = doctest.DocTestParser().get_doctest(block, {}, str(page), str(page), line - 1)
            test.globs = variables
            runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS)
            if runner.run(test, clear_globs=False).failed:
                wrong.append(f"{page}:{line}: does not answer what it says")
        else:
            try:
                exec(compile("\n" * (line - 1) + block, str(page), "exec"), variables)
            except Exception as error:  # noqa: BLE001  whatever it is, the page is wrong
                wrong.append(f"{page}:{line}: {type(error).__name__}: {error}")
    return wrong


def main():
    pages = [Path(page).resolve() for page in sys.argv[1:]]
    wrong, counts = [], []
    for page in pages:
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            wrong += run(page, counts)
            os.chdir("/")
    if not counts:
        wrong.append("no blocks of Python")
    return "\n".join(wrong) or 0


if __name__ == "__main__":
    sys.exit(main())
