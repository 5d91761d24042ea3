#!/usr/bin/env python3
"""Makes a notebook of every script in examples/python, so that the two say the same.

Usage: make_notebooks.py [--check]

A script begins with a docstring, whose first line is the title, and is cut into cells by lines
  # %%             code of both
  # %% [markdown]  text, commented out; in the script a comment
  # %% [notebook]  code of the notebook alone, commented out
  # %% [script]    code of the script alone, e.g. its options
Notebooks have no outputs. --check writes nothing and fails if a notebook is not what its script
says.
"""
import ast
import json
import re
import sys
from pathlib import Path

FOLDER = Path(__file__).resolve().parent.parent / "examples/python"
MARK = re.compile(r"^# %%(?: \[(\w+)\])?\n", re.M)
KINDS = ("code", "markdown", "notebook", "script")


def uncommented(text):
    return re.sub(r"^# ?", "", text, flags=re.M)


def cells(script):
    """(kind, text) of every cell of the notebook."""
    text = script.read_text(encoding="utf-8")
    title, _, rest = ast.get_docstring(ast.parse(text)).partition("\n")
    yield "markdown", f"# {title.rstrip('.')}\n\n{rest.strip()}".strip()
    pieces = MARK.split(text)
    for kind, content in zip(pieces[1::2], pieces[2::2]):
        kind = kind or "code"
        if kind not in KINDS:
            raise SystemExit(f"{script}: a cell of kind {kind!r}; expected one of {KINDS}")
        content = content.strip()
        if kind in ("markdown", "notebook"):
            content = uncommented(content)
        if content and kind != "script":
            yield ("markdown" if kind == "markdown" else "code"), content


def notebook(script):
    """The notebook's file, byte by byte."""
    made = []
    for number, (kind, text) in enumerate(cells(script)):
        cell = {"cell_type": kind, "id": f"{script.stem}-{number}", "metadata": {},
                "source": text.splitlines(keepends=True)}
        if kind == "code":
            cell |= {"execution_count": None, "outputs": []}
        made.append(cell)
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    book = {"cells": made, "metadata": {"kernelspec": kernel, "language_info": {"name": "python"}},
            "nbformat": 4, "nbformat_minor": 5}
    return json.dumps(book, indent=1, ensure_ascii=False, sort_keys=True) + "\n"


def main():
    wrong = []
    scripts = sorted(FOLDER.glob("*.py"))
    for script in scripts:
        path, content = script.with_suffix(".ipynb"), notebook(script)
        if "--check" not in sys.argv:
            path.write_text(content, encoding="utf-8")
        elif not path.exists() or path.read_text(encoding="utf-8") != content:
            wrong.append(f"{path}: not what {script.name} says; run {__file__}")
    wrong += [f"{path}: no script of this name" for path in sorted(FOLDER.glob("*.ipynb"))
              if not path.with_suffix(".py").exists()]
    if not scripts:
        wrong.append(f"{FOLDER}: no scripts")
    return "\n".join(wrong) or 0


if __name__ == "__main__":
    sys.exit(main())
