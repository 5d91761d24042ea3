"""The calls of the package potpourri3d that concern meshes, their files and scalar problems."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Optional

import numpy as np
import scipy.sparse

from .. import _files, _geodesics, _mesh, _operators
from .._arrays import Floats, Ints
from .._errors import InvalidOption

__all__ = [
    "MeshHeatMethodDistanceSolver",
    "compute_distance",
    "compute_distance_multisource",
    "cotan_laplacian",
    "edges",
    "face_areas",
    "read_mesh",
    "read_polygon_mesh",
    "vertex_areas",
    "write_mesh",
]


class MeshHeatMethodDistanceSolver:
    """Distances by the heat method.

    Parameters
    ----------
    V : (n, 3) array_like
        Positions [length].
    F : array_like or list
        Faces of any valence.
    t_coef : float
        Factor of the time step.
    use_robust : bool
        Without effect: bad meshes are dealt with as they are.
    """

    def __init__(self, V: Any, F: Any, t_coef: float = 1.0, use_robust: bool = True) -> None:
        del use_robust
        self._heat = _geodesics.HeatGeodesics(V, F, t_coef=t_coef, edge_length="mean")

    def compute_distance(self, v_ind: int) -> Floats:
        """(n,) distance from one vertex."""
        return self._heat.distance(v_ind)

    def compute_distance_multisource(self, v_inds: Sequence[int]) -> Floats:
        """(n,) distance from the nearest of several vertices."""
        return self._heat.distance(v_inds)


def compute_distance(V: Any, F: Any, v_ind: int) -> Floats:
    """(n,) distance from one vertex; for several use :class:`MeshHeatMethodDistanceSolver`."""
    return MeshHeatMethodDistanceSolver(V, F).compute_distance(v_ind)


def compute_distance_multisource(V: Any, F: Any, v_inds: Sequence[int]) -> Floats:
    """(n,) distance from the nearest of several vertices."""
    return MeshHeatMethodDistanceSolver(V, F).compute_distance_multisource(v_inds)


def cotan_laplacian(V: Any, F: Any, denom_eps: float = 0.0) -> scipy.sparse.csr_matrix:
    """(n, n) cotan Laplacian of triangles, positive semidefinite; `denom_eps` has no effect."""
    del denom_eps
    return _operators.stiffness(V, F, operator="cotan")[0]


def face_areas(V: Any, F: Any) -> Floats:
    """(m,) areas [length^2]: of faces that are not planar those of their vector areas."""
    areas: Floats = np.linalg.norm(_mesh.PolygonMesh(V, F).face_area_vectors, axis=1)
    return areas


def vertex_areas(V: Any, F: Any) -> Floats:
    """(n,) a third of the areas of the triangles at every vertex [length^2]."""
    mesh = _mesh.PolygonMesh(V, F)
    if np.any(np.diff(mesh.face_offsets) != 3):
        raise InvalidOption("vertex_areas: of triangles only; see carat.discretize().lumped_mass")
    areas = np.linalg.norm(mesh.face_area_vectors, axis=1)
    shares = np.repeat(areas, 3) / 3
    return np.bincount(mesh.face_indices, weights=shares, minlength=mesh.n_vertices).astype(float)


def edges(V: Any, F: Any) -> Ints:
    """(k, 2) edges, each once."""
    return _mesh.PolygonMesh(V, F).edges


def read_polygon_mesh(filename: _files.PathLike) -> tuple[Floats, list[list[int]]]:
    """Points and faces of any valence."""
    mesh = _files.read(filename)
    if not isinstance(mesh, _mesh.PolygonMesh):
        raise InvalidOption(f"{filename} holds a volume; read it with carat.read()")
    return np.array(mesh.points), mesh.faces


def read_mesh(filename: _files.PathLike) -> tuple[Floats, Ints]:
    """Points and triangles; other faces are cut into triangles."""
    mesh = _files.read(filename)
    if not isinstance(mesh, _mesh.PolygonMesh):
        raise InvalidOption(f"{filename} holds a volume; read it with carat.read()")
    triangles, _ = mesh.triangulate()
    return np.array(mesh.points), np.array(triangles.face_indices).reshape(-1, 3)


def write_mesh(
    V: Any, F: Any, filename: _files.PathLike, UV_coords: Optional[Any] = None, UV_type: Any = None
) -> None:
    """Writes points and faces; coordinates of textures are refused."""
    if UV_coords is not None or UV_type is not None:
        raise NotImplementedError("carat writes no texture coordinates")
    _files.write(filename, _mesh.PolygonMesh(V, F))
