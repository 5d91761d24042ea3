"""Geodesic distances by the heat method."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Optional

import numpy as np

from . import _arrays, _core
from ._arrays import Floats
from ._errors import InvalidOption, InvalidType
from ._foreign import as_mesh
from ._mesh import Mesh
from ._operators import (
    Finding,
    Progress,
    _arguments,
    _findings,
    _known_options,
    _number,
    _whole,
)


def _choice(value: Any, what: str, choices: Sequence[str]) -> str:
    if value not in choices:
        raise InvalidOption(f"{what}={value!r}: choose one of {', '.join(choices)}")
    return str(value)


class HeatGeodesics:
    """Geodesic distances by the heat method, on surfaces and through volumes.

    What solves its two linear systems is set up once and serves any number of distances.

    Parameters
    ----------
    mesh : PolygonMesh, PolyhedralMesh, (n, 3) array_like, or a mesh of another package
        The mesh, or with `faces` the points of a surface.
    faces : array_like or list, optional
        Faces of a surface.
    operator : str, optional
        Default: the most accurate for the purpose, ``"stabilized_diamond"`` on surfaces and
        ``"diamond"`` in volumes.
    t_coef : float
        Time step ``t = t_coef * h^2``; smaller is sharper, larger smoother.
    edge_length : {"max", "mean"}
        Which edge length h is.
    directions : {"samples", "elements"}
        Where the heat's gradient is brought to unit length: in every sample, or its mean in every
        face or cell.
    solver : {"auto", "cholesky", "multigrid", "incomplete-cholesky", "sparser-cholesky"}
        Of the distance's Poisson equation.
    expected_sources : int
        How many distances will be asked for; many pay for a factorisation.
    threads : int
        0: all the machine has.
    **options
        Of the operator, as for :func:`discretize`.

    Raises
    ------
    InvalidMesh, InvalidOption, SolverFailure

    Notes
    -----
    (M + t S) u = sources; X = -grad u / ``|grad u|``; S phi = -div X. Crane, Weischedel, Wardetzky:
    Geodesics in Heat, 2013. Distances have the unit of the points.

    Examples
    --------
    >>> import carat
    >>> heat = carat.HeatGeodesics(carat.generate("sphere-quads", level=3))
    >>> d = heat.distance(0)
    >>> bool(abs(d.max() - 3.14159) < 0.05)
    True
    """

    def __init__(
        self,
        mesh: Any,
        faces: Optional[Any] = None,
        *,
        operator: Optional[str] = None,
        t_coef: float = 1.0,
        edge_length: str = "max",
        directions: str = "samples",
        solver: str = "auto",
        expected_sources: int = 1,
        threads: int = 0,
        **options: Any,
    ) -> None:
        #: The mesh.
        self.mesh: Mesh = as_mesh(mesh, faces)
        arguments = _arguments(
            self.mesh,
            "geodesics",
            operator=operator,
            threads=threads,
            **_known_options(options),
        )
        if arguments["coefficient"] is not None or arguments["cell_coefficient"] is not None:
            raise InvalidOption("geodesics have no coefficient: distances are those of the mesh")
        step = _number(t_coef, "t_coef")
        self._core = _core.heat_geodesics(
            self.mesh._core,
            arguments,
            1.0 if step is None else step,
            _choice(edge_length, "edge_length", ("max", "mean")) == "mean",
            _choice(directions, "directions", ("samples", "elements")) == "elements",
            str(solver),
            _whole(expected_sources, "expected_sources", 1),
        )
        #: Gradient samples of the last call where the heat vanished in double precision, so that
        #: distances behind them are too small; a larger `t_coef` helps.
        self.unresolved_samples = 0

    @property
    def operator(self) -> str:
        """Name of the operator."""
        return str(self._core.operator)

    @property
    def time_step(self) -> float:
        """t [length^2]."""
        return float(self._core.time_step)

    @property
    def diagnostics(self) -> dict[str, Finding]:
        """What the operators met on the way; by name."""
        return _findings(self._core.diagnostics())

    @property
    def solver(self) -> dict[str, Any]:
        """How the distance's Poisson equation is solved, and why."""
        info: dict[str, Any] = self._core.poisson_info()
        return info

    def distance(self, sources: Any, weights: Optional[Any] = None) -> Floats:
        """Distance from the nearest of several vertices.

        Parameters
        ----------
        sources : int or (k,) array_like of int
            Vertices to measure from.
        weights : (k,) array_like, optional
            Weight of each one's heat, > 0.

        Returns
        -------
        (n_vertices,) ndarray
            Distances [length], +inf where no source reaches.

        Raises
        ------
        InvalidOption
            No source, a vertex that does not exist or has no face, a weight that is not positive.
        """
        vertices = _arrays.ids(sources, "sources")
        given = np.empty(0) if weights is None else _arrays.values_at(
            weights, len(vertices), "weights", "sources"
        )
        values: Floats
        values, self.unresolved_samples = self._core.distance(vertices, given)
        return values

    def distance_many(
        self, sources: Sequence[Any], *, progress: Optional[Progress] = None
    ) -> Floats:
        """The distances from each of many source sets by itself, solved for several at a time.

        Parameters
        ----------
        sources : sequence of int or of lists of int
            One entry a distance: a vertex, or vertices whose nearest counts.
        progress : callable, optional
            Called with the number of distances that are done.

        Returns
        -------
        (len(sources), n_vertices) ndarray
            Distances [length], +inf where no source reaches.

        Raises
        ------
        InvalidOption
            As :meth:`distance`, before any work; names the set.
        """
        if isinstance(sources, (int, np.integer, str)) or not hasattr(sources, "__iter__"):
            raise InvalidType(
                f"sources: {sources!r}; expected one entry a distance, e.g. [[0], [1]]"
            )
        sets = [_arrays.ids(entry, f"source set {i}") for i, entry in enumerate(sources)]
        values: Floats
        values, self.unresolved_samples = self._core.distances(sets, progress)
        return values

    def __reduce__(self) -> Any:
        raise TypeError(
            "HeatGeodesics holds factorisations, which cannot be pickled; pickle the mesh and make"
            " it again"
        )

    def __repr__(self) -> str:
        return (
            f"<carat.HeatGeodesics: {self.operator}, {self._core.n_vertices} vertices,"
            f" time step {self.time_step:.3g}>"
        )
