"""Checks that docs/operators.md and its pictures are what the program's registry says, or writes
them so.

Usage: make_operator_docs.py CARAT [--write]
"""
import csv
import json
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
INTRODUCTION = """\
# Operators

Made from the program's registry by `tools/make_operator_docs.py build/release/carat --write`; the
test `docs.operators` keeps it so. `carat claims` measures every promise on every family of meshes.

S is the stiffness (positive semidefinite, integrated), M the mass, G the gradient, D the
divergence; the laplacian is L = -S. See [conventions.md](conventions.md).
"""
# What a card says of a claim that is denied.
DENIALS = {
    "semidefinite": "has negative eigenvalues on meshes far from Delaunay",
    "kernel_is_constants": "its kernel holds more than the constants on some meshes",
    "linear_precision": "no linear precision",
    "gradient": "defines no gradient",
    "divergence_of_gradient": "L is not D G alone: a stabilising term is added",
    "total_mass": "where faces are not planar its mass sums to the measure of its own faces and points, not to that of the virtual vertices",
    "positive_mass": "its mass can have negative entries",
    "second_order": "no second order",
    "symmetric": "not symmetric",
}
PROMISES = {
    "symmetric": "symmetric",
    "semidefinite": "semidefinite",
    "kernel_is_constants": "annihilates the constants only",
    "linear_precision": "exact on linear functions",
    "divergence_of_gradient": "L = D G",
    "total_mass": "mass sums to the measure",
    "positive_mass": "positive mass",
    "maximum_principle": "maximum principle on Delaunay meshes",
    "second_order": "second order for Poisson's equation",
    "equals_cotan_on_simplices": "linear elements on triangles or tetrahedra",
}
COLOURS = {True: "#b5482a", False: "#2a6fb5"}  # the sign of an entry


def run(*command):
    return subprocess.run(list(map(str, command)), check=True, capture_output=True, text=True).stdout


def entries(path):
    """Of a Matrix Market file, both triangles of a symmetric one."""
    lines = [line for line in path.read_text().splitlines() if not line.startswith("%")]
    found = {}
    for line in lines[1:]:
        row, column, value = line.split()
        found[int(row) - 1, int(column) - 1] = float(value)
        found[int(column) - 1, int(row) - 1] = float(value)
    return found


def read_obj(path):
    points, faces = [], []
    for line in path.read_text().splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            points.append([float(x) for x in words[1:4]])
        elif words[:1] == ["f"]:
            faces.append([int(word.split("/")[0]) - 1 for word in words[1:]])
    return points, faces


def read_ovm(path):
    """Vertices and edges of an OpenVolumeMesh file."""
    words = iter(path.read_text().split())
    points, edges = [], []
    for word in words:
        if word == "Vertices":
            points = [[float(next(words)) for _ in range(3)] for _ in range(int(next(words)))]
        elif word == "Edges":
            edges = [(int(next(words)), int(next(words))) for _ in range(int(next(words)))]
    return points, edges


def stencil(carat, entry, folder):
    """An SVG of the row of the vertex nearest to the middle: discs as large as the entries."""
    volume = entry["kind"] == "volume"
    simplices = entry["claims"]["simplices_only"]
    family = (("cube-tets" if simplices else "cube-hexahedra") if volume else
              ("plane-triangles" if simplices else "plane-voronoi"))
    mesh = folder / ("mesh.ovm" if volume else "mesh.obj")
    run(carat, "generate", family, "--level", 0 if volume else 1, *([] if volume else ["--jitter", 0.2]),
        "-o", mesh)
    run(carat, "operators", mesh, "--operator", entry["name"], "-o", folder / "matrices")
    if volume:
        points, edges = read_ovm(mesh)
    else:
        points, faces = read_obj(mesh)
        edges = sorted({(min(a, b), max(a, b)) for face in faces
                        for a, b in zip(face, face[1:] + face[:1])})
    unknowns = folder / "matrices/unknowns.csv"
    n_vertices = len(points)
    if unknowns.exists():
        with open(unknowns) as lines:
            points += [[float(row[x]) for x in "xyz"] for row in csv.DictReader(lines)]
    middle = min(range(n_vertices), key=lambda v: round(sum(
        (x - 0.5) ** 2 for x in points[v][:3 if volume else 2]), 9))
    matrix = entries(folder / "matrices/stiffness.mtx")
    row = {column: value for (r, column), value in matrix.items() if r == middle}
    largest = max(abs(value) for column, value in row.items() if column != middle)
    row = {column: value for column, value in row.items() if abs(value) > 1e-9 * largest}

    def place(p):
        x, y, z = p
        if volume:  # seen from a little above
            x, y = x - 0.5 + 0.42 * (y - 0.5), z - 0.5 + 0.30 * (y - 0.5)
            return 150 + 190 * x, 150 - 190 * y
        return 10 + 280 * x, 290 - 280 * y

    lines = ['<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 300 300" width="300" '
             'height="300">', '<rect width="300" height="300" fill="#ffffff"/>']
    for a, b in edges:
        (x1, y1), (x2, y2) = place(points[a]), place(points[b])
        lines.append(f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" '
                     'stroke="#c8c8c8" stroke-width="0.8"/>')
    for column, value in sorted(row.items(), key=lambda item: (-abs(item[1]), item[0])):
        x, y = place(points[column])
        radius = 9.0 if column == middle else 2.0 + 6.0 * (abs(value) / largest) ** 0.5
        outline = "#333333" if column < n_vertices else "none"
        lines.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius:.1f}" '
                     f'fill="{COLOURS[value > 0]}" fill-opacity="0.75" stroke="{outline}" '
                     'stroke-width="0.8"/>')
    return "\n".join(lines + ["</svg>", ""]), len(row), family


def options_of(entry):
    options = entry["options"]
    masses = options["mass"]
    lines = [f"`--mass {'|'.join(masses)}` (default {masses[0]})" if len(masses) > 1
             else f"one mass: {masses[0]}"]
    if options["virtual_vertex"]:
        lines.append("`--virtual-point`, `--weights`, `--keep-flipped`")
    if "lambda" in options:
        lines.append(f"`--lambda` (default {options['lambda']:g})")
    for name in ("theta", "tau"):
        if name in options:
            lines.append(f"`--{name}` (default {options[name]:.3g})")
    if "boundary_unknowns" in options:
        default = "keep" if options["boundary_unknowns"] else "eliminate"
        lines.append(f"`--boundary-unknowns keep|eliminate` (default {default})")
    return "; ".join(lines)


def card(entry, picture, n_entries, family):
    claims, text = entry["claims"], entry["card"]
    kept = [words for claim, words in PROMISES.items() if claims[claim]]
    denied = [words for claim, words in DENIALS.items() if not claims[claim]]
    uses = []
    for use in entry["default_of"]:
        more = [f"--{name} {use[name]}" for name in ["mass", "theta"] if name in use]
        uses.append(f"`carat {use['command']}`" + (f" (with `{' '.join(more)}`)" if more else ""))
    default = f" The default of {', '.join(uses)}." if uses else ""
    lines = [f"### {entry['name']}", "", f"{entry['title']}.{default}", "",
             f"![Row of one vertex: {entry['name']}]({picture})", "",
             f"- **Definition.** {text['definition']}",
             f"- **Meshes.** {'triangles or tetrahedra only' if claims['simplices_only'] else 'any'}",
             f"- **Unknowns.** {text['unknowns']}",
             f"- **Sparsity.** {text['sparsity']}; {n_entries} entries in the row shown ({family})",
             f"- **Options.** {options_of(entry)}",
             f"- **Promises.** {'; '.join(kept)}"]
    if denied:
        lines.append(f"- **Denied by the literature.** {'; '.join(denied)}")
    lines += [f"- **When.** {text['when']}", f"- **References.** {text['references']}", ""]
    return "\n".join(lines)


def pages(carat):
    """File -> content."""
    files, parts = {}, [INTRODUCTION]
    listed = json.loads(run(carat, "list", "operators", "--json"))["operators"]
    for kind, heading in [("surface", "Surfaces"), ("volume", "Volumes")]:
        parts.append(f"## {heading}\n\nPictures: the row of S of one vertex; blue entries are "
                     "negative (coupled), red ones positive; areas grow with the magnitude" +
                     ("; discs without outline are unknowns beyond the vertices.\n"
                      if kind == "volume" else ".\n"))
        for entry in listed:
            if entry["kind"] != kind:
                continue
            with tempfile.TemporaryDirectory() as folder:
                svg, n_entries, family = stencil(carat, entry, pathlib.Path(folder))
            picture = f"images/stencil-{kind}-{entry['name']}.svg"
            files[ROOT / "docs" / picture] = svg
            parts.append(card(entry, picture, n_entries, family))
    files[ROOT / "docs/operators.md"] = "\n".join(parts)
    return files


def main():
    for path, content in pages(sys.argv[1]).items():
        if "--write" in sys.argv:
            path.write_text(content)
        elif not path.exists() or (path.suffix == ".md" and path.read_text() != content):
            return f"{path}: not what the program says; run {__file__} {sys.argv[1]} --write"
    return 0


if __name__ == "__main__":
    sys.exit(main())
