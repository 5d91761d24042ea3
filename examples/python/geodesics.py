"""Geodesic distance by the heat method, on a surface and through a volume.

Both meshes are generated, so the exact distances are known: great circles on the unit sphere,
straight lines in the unit ball.
"""

# %% [script]
import argparse

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--plot", metavar="PAGE.html", help="write a page that shows the surface")
arguments = parser.parse_args()

# %% [markdown]
# A sphere of pentagons and hexagons. `HeatGeodesics` sets up its two linear systems once; every
# further source costs two solves.

# %%
import numpy as np

import carat

sphere = carat.generate("sphere-hexagons", level=4)
heat = carat.HeatGeodesics(sphere)
distance = heat.distance(0)
exact = np.arccos(np.clip(sphere.points @ sphere.points[0], -1, 1))
print(f"surface: {sphere.n_vertices} vertices, farthest {distance.max():.4f} (pi = 3.1416)")
print(f"         mean error {abs(distance - exact).mean():.4f}")

# %% [markdown]
# Isolines are drawn for fields that are called *distance*.

# %% [notebook]
# carat.show(sphere, vertex={"distance": distance}, title="Distance on a sphere")

# %% [markdown]
# Several sources at once, of which the nearest counts, or many distances in one call, which are
# solved for several at a time on all processors.

# %%
nearest = heat.distance([0, int(distance.argmax())])
each = heat.distance_many(range(100))
print(f"         two poles: farthest {nearest.max():.4f} (pi / 2 = 1.5708)")
print(f"         a hundred sources: {each.shape}")

# %% [markdown]
# Volumes take the same call. These cells are general polyhedra, and the distance goes straight
# through them.

# %%
ball = carat.generate("ball-voronoi", level=1)
middle = int(np.linalg.norm(ball.points, axis=1).argmin())
through = carat.HeatGeodesics(ball, edge_length="mean").distance(middle)
straight = np.linalg.norm(ball.points - ball.points[middle], axis=1)
print(f"volume:  {ball.n_vertices} vertices, mean error {abs(through - straight).mean():.4f}")

# %% [notebook]
# carat.show(ball, vertex={"distance": through}, title="Distance in a ball")

# %% [script]
if arguments.plot:
    carat.show(sphere, vertex={"distance": distance}, path=arguments.plot)
