"""Poisson's equation on a mesh of OpenFOAM, with boundary conditions by the names of patches.

Without a case a small one is written: the unit cube of Voronoi cells, with the patches `inlet`,
`outlet` and `walls`. Between u = 1 at the inlet and 0 at the outlet u is 1 - x, which general
polyhedra represent exactly, and the flux through the cube is 1.
"""

# %% [script]
import argparse

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("case", nargs="?", help="folder of a case with patches inlet and outlet")
parser.add_argument("--plot", metavar="PAGE.html", help="write a page that shows the solution")
arguments = parser.parse_args()

# %% [markdown]
# OpenFOAM's `polyMesh` is five text files: points, faces, the cells on both sides of every face,
# and the patches as ranges of faces. Inner faces come first.

# %%
import tempfile
from pathlib import Path

import numpy as np

import carat


def write_case(folder: Path) -> None:
    """A case of the unit cube, with its boundary in three patches."""
    cube = carat.generate("cube-voronoi", level=1)
    assert isinstance(cube, carat.PolyhedralMesh)
    faces, cells = cube.faces, cube.face_cells
    middle_x = np.array([cube.points[face, 0].mean() for face in faces])
    inner = cells.min(axis=1) >= 0
    walls = ~inner & (middle_x > 1e-9) & (middle_x < 1 - 1e-9)
    parts = {"": inner, "inlet": ~inner & (middle_x <= 1e-9),
             "outlet": ~inner & (middle_x >= 1 - 1e-9), "walls": walls}
    order = np.concatenate([np.flatnonzero(part) for part in parts.values()])
    files = {
        "points": ["(" + " ".join(map(repr, point)) + ")" for point in cube.points.tolist()],
        "faces": [f"{len(faces[f])}(" + " ".join(map(str, faces[f])) + ")" for f in order],
        "owner": cells.max(axis=1)[order],
        "neighbour": cells.min(axis=1)[order][: inner.sum()],
    }
    start, patches = int(inner.sum()), []
    for name in ("inlet", "outlet", "walls"):
        size = int(parts[name].sum())
        patches.append(f"{name} {{ type patch; nFaces {size}; startFace {start}; }}")
        start += size
    kinds = {"points": "vectorField", "faces": "faceList", "boundary": "polyBoundaryMesh"}
    (folder / "constant/polyMesh").mkdir(parents=True)
    for name, entries in {**files, "boundary": patches}.items():
        kind, text = kinds.get(name, "labelList"), "\n".join(map(str, entries))
        header = f"FoamFile {{ format ascii; class {kind}; object {name}; }}"
        path = folder / "constant/polyMesh" / name
        path.write_text(f"{header}\n{len(entries)}\n(\n{text}\n)\n")


# %% [markdown]
# A case is read by the name of its folder.

# %%
with tempfile.TemporaryDirectory() as folder:
    write_case(Path(folder))
    mesh = carat.read(folder)

# %% [script]
if arguments.case:
    mesh = carat.read(arguments.case)

# %%
assert isinstance(mesh, carat.PolyhedralMesh)
print(mesh)
print({name: len(faces) for name, faces in mesh.patches.items()})

# %% [markdown]
# Patches without a condition let nothing through. `report` says how the system was solved.

# %%
poisson = carat.Poisson(mesh)
u = poisson.solve(0.0, dirichlet={"inlet": 1.0, "outlet": 0.0})
S, _ = carat.stiffness(mesh, operator=poisson.operator)
print(f"u from {u.min():.4f} to {u.max():.4f}, flux {u @ S @ u:.6f}; {poisson.report.method}")

# %% [script]
if not arguments.case:
    print(f"largest difference to 1 - x: {abs(u - (1 - mesh.points[:, 0])).max():.1e}")

# %% [notebook]
# carat.show(mesh, u, title="Between inlet and outlet")

# %% [script]
if arguments.plot:
    carat.show(mesh, u, path=arguments.plot)
