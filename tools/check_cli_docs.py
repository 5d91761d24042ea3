"""Checks that docs/cli.md is what the program's own help says, or writes it so.

Usage: check_cli_docs.py CARAT [--write]
"""
import pathlib
import subprocess
import sys

INTRODUCTION = """\
# Command line

Made from the program's own help by `tools/check_cli_docs.py build/release/carat --write`; the test
`docs.cli` keeps it so. What the results mean: [conventions.md](conventions.md); files:
[files.md](files.md).
"""


def help_of(carat, *command):
    text = subprocess.run([carat, *command, "--help"], check=True, capture_output=True,
                          text=True).stdout
    return "\n".join(line.rstrip() for line in text.strip().splitlines())


def page(carat):
    overview = help_of(carat)
    lines = overview.split("Commands:\n", 1)[1].split("\n\n", 1)[0].splitlines()
    parts = [INTRODUCTION, f"```text\n{overview}\n```\n"]
    for command in (line.split()[0] for line in lines):
        parts.append(f"## {command}\n\n```text\n{help_of(carat, command)}\n```\n")
    return "\n".join(parts)


def main():
    document = pathlib.Path(__file__).resolve().parent.parent / "docs/cli.md"
    expected = page(sys.argv[1])
    if "--write" in sys.argv:
        document.write_text(expected)
    elif not document.exists() or document.read_text() != expected:
        return f"{document}: not what the program says; run {__file__} {sys.argv[1]} --write"
    return 0


if __name__ == "__main__":
    sys.exit(main())
