#!/usr/bin/env python3
"""Checks that the sources keep to the layers of ARCHITECTURE.md and that registries are complete.

Usage: check_layers.py [ROOT]

The layer table is the first fenced block under the heading "Layers": lines `folder/  Ln  ...`,
folders relative to src/carat unless they start with a top folder such as cli/. A file may include
headers of its own folder and of folders with a smaller number.
"""
import re
import sys
from pathlib import Path

# Narrower than the layers: folder (relative to src/carat) -> folders it must not see.
FORBIDDEN = {
    "kernels": ["mesh"],
    "assembly": ["mesh"],
    "solve": ["mesh"],
    "apps": ["operators/surface", "operators/volume"],
}
# Registry file, the macro's name in it, the argument that names a file, where the files are.
REGISTRIES = [
    ("operators/operators.def", "CARAT_SURFACE_OPERATOR", "operators/surface"),
    ("operators/operators.def", "CARAT_VOLUME_OPERATOR", "operators/volume"),
    ("generators/families.def", "CARAT_FAMILY", "generators"),
    ("generators/volume_families.def", "CARAT_VOLUME_FAMILY", "generators"),
    ("io/formats.def", "CARAT_FORMAT", "io"),
]
TOP_FOLDERS = ("cli", "python")
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"](carat/[^>"]+|[^>"/]+/[^>"]+)[>"]', re.M)


def read_layers(architecture):
    """Folder -> layer number."""
    text = architecture.read_text(encoding="utf-8")
    section = re.search(r"^#+ [^\n]*Layers[^\n]*\n(.*?)(?=^#+ |\Z)", text, re.M | re.S | re.I)
    if not section:
        raise SystemExit(f"{architecture}: no heading 'Layers'")
    block = re.search(r"```[^\n]*\n(.*?)```", section.group(1), re.S)
    if not block:
        raise SystemExit(f"{architecture}: no fenced block under 'Layers'")
    layers = {}
    for line in block.group(1).splitlines():
        folders = re.match(r"\s*((?:[\w/]+/\s+)+)L(\d+)\b", line)
        if folders:
            for folder in folders.group(1).split():
                layers[folder.strip("/").removeprefix("src/carat/")] = int(folders.group(2))
    if not layers:
        raise SystemExit(f"{architecture}: the layer table has no line 'folder/  Ln'")
    return layers


def sources(folder):
    return sorted(p for p in folder.rglob("*") if p.suffix in (".h", ".cpp", ".def", ".inc"))


def check_includes(root, layers):
    errors = []
    carat = root / "src" / "carat"
    folders = {p.name: p for p in carat.iterdir() if p.is_dir()}
    folders.update({name: root / name for name in TOP_FOLDERS if (root / name).is_dir()})
    for name, path in sorted(folders.items()):
        files = sources(path)
        if not files:
            continue
        if name not in layers:
            errors.append(f"{path.relative_to(root)}: not in the layer table of ARCHITECTURE.md")
            continue
        for file in files:
            for match in INCLUDE.finditer(file.read_text(encoding="utf-8")):
                errors += check_include(root, layers, name, file, match.group(1))
    return errors


def check_include(root, layers, folder, file, include):
    if not include.startswith("carat/"):
        return []
    where = f"{file.relative_to(root)}: includes {include}"
    inner = include.removeprefix("carat/")
    target = inner.split("/")[0] if "/" in inner else None
    if target is None or target == folder:
        return []
    if target not in layers:
        return [f"{where}: '{target}' is not in the layer table"]
    if layers[target] >= layers[folder]:
        return [f"{where}: layer {layers[folder]} must not see {target}, layer {layers[target]}"]
    return [
        f"{where}: {folder} must not see {hidden}"
        for hidden in FORBIDDEN.get(folder, [])
        if inner.startswith(hidden + "/")
    ]


def check_registry(root, definition, macro, folder):
    """Every line names a source that defines it, and every source that defines one has a line."""
    path = root / "src" / "carat" / definition
    if not path.exists():
        return [f"{definition}: missing"]
    names = re.findall(rf"^\s*{macro}\((\w+)", path.read_text(encoding="utf-8"), re.M)
    errors = [f"{definition}: {name} is there twice" for name in set(names) if names.count(name) > 1]
    directory = root / "src" / "carat" / folder
    texts = {p.stem: p.read_text(encoding="utf-8") for p in directory.glob("*.cpp")}
    kind = re.fullmatch(r"CARAT_(SURFACE|VOLUME)_OPERATOR", macro)
    if kind:
        defined = set(texts)
        expected_text = "{}_" + kind.group(1).lower() + "_operator"
    else:
        pattern = {
            "CARAT_FAMILY": r"^PolygonMesh generate_(\w+)\(const FamilyOptions",
            "CARAT_VOLUME_FAMILY": r"^PolyhedralMesh generate_(\w+)\(const VolumeDomain",
            "CARAT_FORMAT": r"^FormatEntry (\w+)_format\(",
        }[macro]
        defined = {stem for stem, text in texts.items()
                   for name in re.findall(pattern, text, re.M) if name in (stem, *names)}
        expected_text = None
    for name in names:
        if name not in texts:
            errors.append(f"{definition}: {name} has no file {folder}/{name}.cpp")
        elif expected_text and expected_text.format(name) not in texts[name]:
            errors.append(f"{folder}/{name}.cpp does not define {expected_text.format(name)}")
    for name in sorted(defined - set(names)):
        errors.append(f"{folder}/{name}.cpp has no line in {definition}")
    return errors


def main():
    root = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent.parent).resolve()
    errors = check_includes(root, read_layers(root / "ARCHITECTURE.md"))
    for registry in REGISTRIES:
        errors += check_registry(root, *registry)
    for error in errors:
        print(error)
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
