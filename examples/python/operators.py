"""The operators side by side on one mesh: entries, and the error of Poisson's equation.

On the unit square u = sin(pi x) sin(pi y) solves -div grad u = 2 pi^2 u with u = 0 on the border.
"""

# %% [script]
import argparse

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("family", nargs="?", help="family of planar meshes instead of plane-voronoi")
parser.add_argument("--plot", metavar="PAGE.html", help="write a page that shows the errors")
arguments = parser.parse_args()

# %% [markdown]
# A square of Voronoi cells, whose vertices are displaced a little.

# %%
import numpy as np

import carat

family = "plane-voronoi"

# %% [script]
family = arguments.family or family

# %%
mesh = carat.generate(family, level=3, jitter=0.2)
x, y, _ = mesh.points.T
exact = np.sin(np.pi * x) * np.sin(np.pi * y)
print(f"{family}: {mesh.n_vertices} vertices, {mesh.n_faces} faces")

# %% [markdown]
# Operators for triangles alone are passed over where there are other faces.

# %%
errors = {}
triangles = bool(np.all(np.diff(mesh.face_offsets) == 3))
for entry in carat.operators("surface"):
    if triangles or not entry.simplices_only:
        S, _ = carat.stiffness(mesh, operator=entry.name)
        u = carat.Poisson(mesh, operator=entry.name).solve(2 * np.pi**2 * exact, dirichlet=0.0)
        errors[entry.name] = u - exact
        error = np.sqrt(np.mean((u - exact) ** 2))
        linear = abs((S @ x)[np.setdiff1d(range(len(x)), mesh.boundary_vertices)]).max()
        print(f"{entry.name:20} {S.nnz / len(x):5.1f} entries a row, error {error:.2e},"
              f" S x inside {linear:.0e}")

# %% [markdown]
# The last column is what is left of the Laplacian of a linear function, which should be nothing.

# %% [notebook]
# carat.show(mesh, vertex=errors, title="Errors")

# %% [script]
if arguments.plot:
    carat.show(mesh, vertex=errors, path=arguments.plot)
