#!/usr/bin/env python3
"""Runs the notebooks of examples/python and fails if a cell does, or if one shows nothing.

Usage: run_notebooks.py [NOTEBOOK ...]

Takes nbclient and ipykernel; carat has to be importable (PYTHONPATH).
"""
import os
import sys
import tempfile
from pathlib import Path

import nbformat
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError

FOLDER = Path(__file__).resolve().parent.parent / "examples/python"


def run(path):
    """What is wrong, or nothing."""
    book = nbformat.read(path, as_version=4)
    nbformat.validate(book)
    with tempfile.TemporaryDirectory() as folder:
        client = NotebookClient(book, timeout=300, kernel_name="python3",
                                resources={"metadata": {"path": folder}})
        try:
            client.execute()
        except CellExecutionError as error:
            return str(error)
    outputs = [output for cell in book.cells for output in cell.get("outputs", [])]
    if not any("text/html" in output.get("data", {}) for output in outputs):
        return "no cell shows a view"
    return ""


def main():
    # The kernels run in folders of their own.
    folders = os.environ.get("PYTHONPATH", "").split(os.pathsep)
    os.environ["PYDEVD_DISABLE_FILE_VALIDATION"] = "1"  # a warning of no use here
    os.environ["PYTHONPATH"] = os.pathsep.join(os.path.abspath(f) for f in folders if f)
    paths = [Path(path) for path in sys.argv[1:]] or sorted(FOLDER.glob("*.ipynb"))
    failed = 0
    for path in paths:
        wrong = run(path)
        print(f"{path.name}: {wrong or 'ok'}", flush=True)
        failed += bool(wrong)
    return 1 if failed or not paths else 0


if __name__ == "__main__":
    sys.exit(main())
