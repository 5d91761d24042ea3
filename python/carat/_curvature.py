"""Mean curvature of surfaces."""

from __future__ import annotations

from typing import Any, Optional

from . import _core
from ._arrays import Floats
from ._errors import InvalidType
from ._foreign import as_mesh
from ._mesh import PolygonMesh
from ._operators import _arguments, _known_options


def mean_curvature(
    mesh: Any,
    faces: Optional[Any] = None,
    *,
    signed: bool = False,
    operator: Optional[str] = None,
    threads: int = 0,
    **options: Any,
) -> Floats:
    """Mean curvature at the vertices of a surface, ``|M^-1 L X| / 2``.

    Parameters
    ----------
    mesh : PolygonMesh, (n, 3) array_like, or a mesh of another package
        The surface, or with `faces` its points.
    faces : array_like or list, optional
        Its faces.
    signed : bool
        Positive where the surface bends away from its normals: +1/R on a sphere of radius R with
        outward normals.
    operator : str, optional
        Default: the most accurate for the purpose, ``"diamond"`` with lumped mass.
    threads : int
        0: all the machine has.
    **options
        Of the operator, as for :func:`discretize`.

    Returns
    -------
    (n_vertices,) ndarray
        H [1/length]; 0 on the boundary and at vertices without faces, where it is not defined.

    Raises
    ------
    InvalidMesh, InvalidOption, SolverFailure

    Notes
    -----
    Bunge, Botsch, Alexa 2021, section 8.1.

    Examples
    --------
    >>> import carat
    >>> H = carat.mean_curvature(carat.generate("sphere-quads", level=4), signed=True)
    >>> bool(abs(H - 1).max() < 0.02)
    True
    """
    mesh = as_mesh(mesh, faces)
    if not isinstance(mesh, PolygonMesh):
        raise InvalidType(
            "mean_curvature is of surfaces; take mesh.boundary_surface()[0] for that of a volume"
        )
    arguments = _arguments(
        mesh, "curvature", operator=operator, threads=threads, **_known_options(options)
    )
    values: Floats
    values, _ = _core.mean_curvature(mesh._core, arguments, bool(signed))
    return values
