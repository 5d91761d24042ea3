"""The lowest eigenvalues and modes of the Laplacian."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, Optional, Union

import numpy as np
import numpy.typing as npt

from . import _arrays, _core
from ._arrays import Floats
from ._errors import InvalidOption
from ._foreign import as_mesh
from ._operators import Progress, _arguments, _known_options, _whole


@dataclass(frozen=True)
class Eigenmodes:
    """Eigenvalues and modes; unpacks as ``values, vectors``."""

    values: Floats  #: (k,) ascending [1/length^2]
    vectors: Floats  #: (n_vertices, k), M-orthonormal
    residuals: Floats  #: (k,) ``|S u - lambda M u| / (lambda |M u|)``
    zero_modes: int  #: how often lambda = 0 is an eigenvalue of the mesh
    solver: dict[str, Any] = field(repr=False)  #: what was chosen, and why

    def __iter__(self) -> Iterator[Floats]:
        return iter((self.values, self.vectors))

    def __repr__(self) -> str:
        n, k = self.vectors.shape
        lowest, highest = (self.values[0], self.values[-1]) if k else (np.nan, np.nan)
        return (
            f"<carat.Eigenmodes: {k} on {n} vertices, lambda {lowest:.6g} to {highest:.6g},"
            f" residuals <= {self.residuals.max(initial=0):.1e}>"
        )


def eigenmodes(
    mesh: Any,
    faces: Optional[Any] = None,
    *,
    k: int = 10,
    dirichlet: Union[bool, npt.ArrayLike] = False,
    operator: Optional[str] = None,
    solver: str = "auto",
    progress: Optional[Progress] = None,
    threads: int = 0,
    **options: Any,
) -> Eigenmodes:
    """The lowest eigenvalues and modes of the Laplacian: S u = lambda M u.

    Parameters
    ----------
    mesh : PolygonMesh, PolyhedralMesh, (n, 3) array_like, or a mesh of another package
        The mesh, or with `faces` the points of a surface.
    faces : array_like or list, optional
        Faces of a surface.
    k : int
        How many.
    dirichlet : bool or array_like of int
        True: modes vanish on the boundary; vertices: they vanish there; False: du/dn = 0.
    operator : str, optional
        Default: the most accurate for the purpose, ``"stabilized_diamond"``.
    solver : {"auto", "cholesky", "iterative"}
        Of the linear systems inside; ``"auto"`` takes conjugate gradients in large volumes.
    progress : callable, optional
        Called with the number of pairs that have converged.
    threads : int
        0: all the machine has.
    **options
        Of the operator, as for :func:`discretize`.

    Returns
    -------
    Eigenmodes
        Unpacks as ``values, vectors``: ``vectors.T @ M @ vectors`` is the identity; all members of
        clusters are there; the sign is fixed, results are the same in every run.

    Raises
    ------
    InvalidMesh, InvalidOption, SolverFailure

    Examples
    --------
    >>> import carat
    >>> lam, U = carat.eigenmodes(carat.generate("sphere-quads", level=3), k=4)
    >>> [round(value) for value in lam]  # l (l + 1)
    [0, 2, 2, 2]
    """
    mesh = as_mesh(mesh, faces)
    if isinstance(dirichlet, (bool, np.bool_)):
        fixed = np.empty(0, dtype=np.int32)
        if dirichlet:
            fixed = mesh.boundary_vertices
            if len(fixed) == 0:
                raise InvalidOption("dirichlet=True: the mesh is closed, it has no boundary")
    else:
        fixed = _arrays.ids(dirichlet, "dirichlet")
    count = _whole(k, "k", 1)
    arguments = _arguments(
        mesh, "eigenmodes", operator=operator, threads=threads, **_known_options(options)
    )
    values, vectors, residuals, zero_modes, report = _core.eigenmodes(
        mesh._core, arguments, count, fixed, str(solver), progress
    )
    return Eigenmodes(values, vectors, residuals, zero_modes, report)
