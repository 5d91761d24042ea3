#!/usr/bin/env python3
"""Checks docs/equations.md against the code, both ways.

Usage: check_equations.py [ROOT]

Every tag [BBA21 (n)] (or "(n), (m)") under src/carat must have a row with that equation and that
file; every row's file must exist and hold the function, and every test named must exist.
"""
import re
import sys
from pathlib import Path

TAG = re.compile(r"\[BBA21 ((?:\(\d+\)(?:,\s*|-)?)+)\]")
ROW = re.compile(r"^\|\s*\((\d+)\)\s*\|([^|]*)\|([^|]*)\|([^|]*)\|([^|]*)\|\s*$", re.M)
TEST = re.compile(r"^TEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)\s*\)", re.M)


def tags(root):
    """(equation, file) of every tag in the sources."""
    found = set()
    for path in sorted((root / "src" / "carat").rglob("*")):
        if path.suffix not in (".h", ".cpp"):
            continue
        for match in TAG.finditer(path.read_text(encoding="utf-8")):
            name = path.relative_to(root / "src" / "carat").as_posix()
            for first, last in re.findall(r"\((\d+)\)(?:-\((\d+)\))?", match.group(1)):
                for number in range(int(first), int(last or first) + 1):
                    found.add((number, name))
    return found


def code_words(cell):
    return re.findall(r"`([^`]+)`", cell)


def main():
    root = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent.parent).resolve()
    rows = ROW.findall((root / "docs" / "equations.md").read_text(encoding="utf-8"))
    tests = set()
    for path in (root / "tests").rglob("*.cpp"):
        tests.update(".".join(t) for t in TEST.findall(path.read_text(encoding="utf-8")))
    errors, mapped = [], set()
    tagged = tags(root)
    for number, _, functions, files, named_tests in rows:
        where = f"docs/equations.md: equation ({number})"
        names = code_words(files)
        if not names or not code_words(functions) or not code_words(named_tests):
            errors.append(f"{where}: function, file and test must each be named in backticks")
        texts = []
        for name in names:
            path = root / "src" / "carat" / name
            mapped.add((int(number), name))
            if not path.exists():
                errors.append(f"{where}: there is no file src/carat/{name}")
                continue
            texts.append(path.read_text(encoding="utf-8"))
        for function in code_words(functions):
            if not any(re.search(rf"\b{re.escape(function)}\b", text) for text in texts):
                errors.append(f"{where}: no '{function}' in {', '.join(names)}")
        for test in code_words(named_tests):
            if test not in tests:
                errors.append(f"{where}: there is no test {test}")
    for number, name in sorted(tagged - mapped):
        errors.append(f"src/carat/{name}: [BBA21 ({number})] has no row in docs/equations.md")
    missing = set(range(6, 34)) - {int(row[0]) for row in rows}
    for number in sorted(missing):
        errors.append(f"docs/equations.md: equation ({number}) is missing")
    for error in errors:
        print(error)
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
