"""Implicit smoothing of a polygon mesh in ten lines: one linear system, from our matrices.

(M + t S) x = M x0 takes one implicit step of mean curvature flow. On the unit sphere the positions
are eigenfunctions with the eigenvalue 2, so the step shrinks it to the radius 1 / (1 + 2 t).
"""

# %% [script]
import argparse

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("mesh", nargs="?", help="a surface to smooth instead of the noisy sphere")
parser.add_argument("--plot", metavar="PAGE.html", help="write a page that shows the result")
arguments = parser.parse_args()

# %% [markdown]
# A sphere of hexagons with noise along its normals, half as long as an edge.

# %%
import numpy as np
from scipy.sparse.linalg import splu

import carat

sphere = carat.generate("sphere-hexagons", level=3)
noise = 0.02 * np.random.default_rng(1).standard_normal((sphere.n_vertices, 1))
mesh: carat.Mesh = sphere.with_points(sphere.points * (1 + noise))

# %% [script]
if arguments.mesh:
    mesh = carat.read(arguments.mesh)

# %% [markdown]
# Stiffness and mass are SciPy matrices. A time is an area: features smaller than its root go.

# %%
S, M = carat.stiffness(mesh)
time = 4e-3 * M.sum() / (4 * np.pi)
smooth = mesh.with_points(splu((M + time * S).tocsc()).solve(M @ mesh.points))


# %%
def radius(mesh: carat.Mesh) -> tuple[float, float]:
    """Mean distance of the vertices from their middle, and its deviation."""
    lengths = np.linalg.norm(mesh.points - mesh.points.mean(axis=0), axis=1)
    return float(lengths.mean()), float(lengths.std())


for name, shape in {"before": mesh, "after": smooth}.items():
    mean, deviation = radius(shape)
    print(f"{name}: radius {mean:.4f} +- {deviation:.4f}")
print(f"a sphere without noise: {1 / (1 + 2 * time):.4f}")

# %% [notebook]
# carat.show(smooth, vertex={"moved": np.linalg.norm(smooth.points - mesh.points, axis=1)})

# %% [script]
if arguments.plot:
    moved = np.linalg.norm(smooth.points - mesh.points, axis=1)
    carat.show(smooth, vertex={"moved": moved}, path=arguments.plot)
