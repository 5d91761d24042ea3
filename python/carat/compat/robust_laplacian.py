"""The calls of the package robust_laplacian.

L is the stiffness, positive semidefinite as there; M is diagonal. On triangles the operator is
cotan on the mesh as it is: neither are bad triangles mollified nor edges flipped to be intrinsic
Delaunay, so entries differ from those of the original; faces of other valences take the diamond
operator.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse

from .. import _mesh, _operators

__all__ = ["mesh_laplacian", "point_cloud_laplacian"]


def mesh_laplacian(
    verts: Any, faces: Any, mollify_factor: float = 1e-5
) -> tuple[scipy.sparse.csr_matrix, scipy.sparse.csr_matrix]:
    """Laplacian and diagonal mass matrix of a surface.

    Parameters
    ----------
    verts : (n, 3) array_like
        Positions [length].
    faces : array_like or list
        As :class:`carat.PolygonMesh` takes them.
    mollify_factor : float
        Without effect: degenerate triangles are left out instead.

    Returns
    -------
    L : (n, n) csr_matrix
        Positive semidefinite.
    M : (n, n) csr_matrix
        Diagonal [length^2].
    """
    del mollify_factor
    mesh = _mesh.PolygonMesh(verts, faces)
    triangles = bool(np.all(np.diff(mesh.face_offsets) == 3))
    return _operators.stiffness(mesh, operator="cotan" if triangles else "diamond", lumped=True)


def point_cloud_laplacian(
    points: Any, mollify_factor: float = 1e-5, n_neighbors: int = 30
) -> tuple[scipy.sparse.csr_matrix, scipy.sparse.csr_matrix]:
    """Not there: carat is about meshes.

    Raises
    ------
    NotImplementedError
        Always.
    """
    raise NotImplementedError("carat computes on meshes; it has no Laplacian of point clouds")
