"""A descriptor of shapes in twenty lines: the heat kernel signature, from eigenmodes.

The signature of a vertex says how much of a unit of heat is still there after a time t. It does not
change when the shape is moved, bent without stretching, or meshed in another way.
"""

# %% [script]
import argparse

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("mesh", nargs="?", help="a surface to compare with the generated ones")
parser.add_argument("--plot", metavar="PAGE.html", help="write a page that shows a signature")
arguments = parser.parse_args()

# %% [markdown]
# With eigenvalues λ and modes φ, the signature is h(x, t) = Σ exp(-λ t) φ(x)². Times are in units
# of the area, so that size does not count.

# %%
import numpy as np
import numpy.typing as npt

import carat

Floats = npt.NDArray[np.float64]
TIMES = np.geomspace(0.01, 0.1, 8)


def signatures(mesh: carat.Mesh, k: int = 60) -> Floats:
    """(n_vertices, times) heat kernel signatures of a surface, scaled to an area of 1."""
    values, modes = carat.eigenmodes(mesh, k=k)
    area = float(carat.discretize(mesh).mass.sum())
    signature: Floats = area * modes**2 @ np.exp(-np.outer(values, TIMES) * area)
    return signature


def descriptor(mesh: carat.Mesh) -> Floats:
    """Mean and deviation of the signatures over the surface: a short vector for a shape."""
    found, areas = signatures(mesh), carat.discretize(mesh).lumped_mass
    mean = np.average(found, axis=0, weights=areas)
    deviation = np.sqrt(np.average((found - mean) ** 2, axis=0, weights=areas))
    return np.concatenate((mean, deviation))


# %% [markdown]
# On the unit sphere λ = l (l + 1) occurs 2 l + 1 times, so the mean of the signature is known.

# %%
sphere = carat.generate("sphere-hexagons", level=3)
degree = np.arange(60)
exact = (2 * degree + 1) @ np.exp(-np.outer(degree * (degree + 1), TIMES) * 4 * np.pi)
shape = descriptor(sphere)
print(f"sphere: signature at the first time {shape[0]:.4f}, exactly {exact[0]:.4f}")

# %% [markdown]
# The same shape from other faces has nearly the same descriptor; another shape has not.

# %%
others = {name: carat.generate(name, level=3) for name in ("sphere-quads", "torus-triangles")}

# %% [script]
if arguments.mesh:
    others[arguments.mesh] = carat.read(arguments.mesh)

# %%
for name, other in others.items():
    difference = float(np.linalg.norm(descriptor(other) - shape))
    print(f"{name}: {difference:.4f} from the sphere of hexagons")

# %% [notebook]
# torus = others["torus-triangles"]
# carat.show(torus, vertex={"signature": signatures(torus)[:, 0]}, title="Heat kernel signature")

# %% [script]
if arguments.plot:
    last = list(others.values())[-1]
    carat.show(last, vertex={"signature": signatures(last)[:, 0]}, path=arguments.plot)
