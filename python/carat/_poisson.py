"""Poisson's equation with mixed boundary conditions."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Optional, Union

import numpy as np
import numpy.typing as npt

from . import _arrays, _core
from ._arrays import Floats, Ints
from ._errors import InvalidOption, InvalidType
from ._foreign import as_mesh
from ._mesh import Mesh, PolyhedralMesh
from ._operators import Finding, _arguments, _findings, _known_options, _whole

Values = Union[float, npt.ArrayLike, Callable[[Floats], Any]]


@dataclass(frozen=True)
class SolveReport:
    """How a system was solved."""

    method: str  #: e.g. "conjugate gradients, multigrid"
    reason: str  #: why it was chosen; empty where the caller chose
    iterations: int  #: 0: by a factorisation
    residual: float  #: of S u = b, relative to the terms, largest over the rows
    floating_components: int  #: components without Dirichlet or Robin data: mean zero there
    imbalance: float  #: of their data, relative; subtracted as a constant


class Poisson:
    """Solves -div(K grad u) = f with Dirichlet, Neumann and Robin data.

    Where no condition is given the natural one K du/dn = 0 holds; components without Dirichlet or
    Robin data get the solution of mean zero. The operators are assembled once. What solves the
    system is kept as long as Dirichlet vertices, Robin sides and alpha stay the same: other values
    and right-hand sides cost one solve.

    Parameters
    ----------
    mesh : PolygonMesh, PolyhedralMesh, (n, 3) array_like, or a mesh of another package
        The mesh, or with `faces` the points of a surface.
    faces : array_like or list, optional
        Faces of a surface.
    operator : str, optional
        Default: the most accurate for the purpose, ``"stabilized_diamond"`` on surfaces and
        ``"diamond"`` in volumes.
    solver : {"auto", "cholesky", "multigrid", "incomplete-cholesky", "sparser-cholesky"}
        ``"auto"`` chooses by size and dimension; see ``report.reason``.
    expected_solves : int
        How many right-hand sides will be solved for; many pay for a factorisation.
    threads : int
        0: all the machine has.
    **options
        Of the operator, as for :func:`discretize`, e.g. `coefficient`.

    Raises
    ------
    InvalidMesh, InvalidOption, SolverFailure

    Notes
    -----
    Bunge, Botsch, Alexa 2021, section 8.2.

    Examples
    --------
    >>> import carat
    >>> mesh = carat.generate("plane-quads", level=3)
    >>> u = carat.Poisson(mesh).solve(1.0, dirichlet=0.0)
    >>> bool(0.0730 < u.max() < 0.0745)
    True
    """

    def __init__(
        self,
        mesh: Any,
        faces: Optional[Any] = None,
        *,
        operator: Optional[str] = None,
        solver: str = "auto",
        expected_solves: int = 1,
        threads: int = 0,
        **options: Any,
    ) -> None:
        #: The mesh.
        self.mesh: Mesh = as_mesh(mesh, faces)
        self._solver = str(solver)
        self._expected = _whole(expected_solves, "expected_solves", 1)
        self._core = _core.discretize_for_poisson(
            self.mesh._core,
            _arguments(
                self.mesh,
                "poisson",
                operator=operator,
                threads=threads,
                **_known_options(options),
            ),
            self._solver,
        )
        self._system: Any = None
        self._system_key: Optional[tuple[bytes, ...]] = None
        self._report: Optional[SolveReport] = None

    @property
    def operator(self) -> str:
        """Name of the operator."""
        return str(self._core.name)

    @property
    def n_unknowns(self) -> int:
        """The vertices, and unknowns beyond them for some operators."""
        return int(self._core.n_unknowns)

    @property
    def report(self) -> SolveReport:
        """How the last system was solved.

        Raises
        ------
        InvalidOption
            Nothing was solved yet.
        """
        if self._report is None:
            raise InvalidOption("nothing was solved yet; call solve() first")
        return self._report

    @property
    def diagnostics(self) -> dict[str, Finding]:
        """What the operators met on the way; by name."""
        return _findings(self._core.diagnostics())

    def solve(
        self,
        f: Values = 0.0,
        *,
        dirichlet: Optional[Any] = None,
        neumann: Optional[Any] = None,
        robin: Optional[Any] = None,
        integrated: bool = False,
    ) -> Floats:
        """The solution at the vertices (and the unknowns beyond them, if there are any).

        Parameters
        ----------
        f : float, (N,) array_like or callable
            Right-hand side: one number, one an unknown, or a function of (N, 3) points.
        dirichlet : float, callable, dict or (ids, values), optional
            Values of u: a number or a function of (m, 3) points for all of the boundary;
            ``{vertex: value}`` or ``{"patch": value}``; or vertices with values, one number or one
            a vertex or a function.
        neumann : dict or (sides, flux), optional
            K du/dn, n the outward normal: ``{side: flux}``, ``{"patch": flux}`` or lists. Sides are
            edges of surfaces and faces of volumes: see ``mesh.boundary_sides``.
        robin : (sides, alpha, g), optional
            K du/dn + alpha u = g over these sides, alpha >= 0.
        integrated : bool
            f is a load already: M f, not f.

        Returns
        -------
        (N,) ndarray

        Raises
        ------
        InvalidOption
            Vertices or sides that do not exist, values that do not fit.
        SolverFailure
            The data of a floating component do not balance, or the system is singular.
        """
        conditions = self._conditions(dirichlet, neumann, robin)
        load = self._right_hand_side(f)
        key = tuple(
            conditions[name].tobytes()
            for name in ("dirichlet_vertices", "robin_sides", "robin_alpha")
        )
        if self._system is not None and key == self._system_key:
            problem = self._system.with_data(conditions)
        else:
            self._system = None  # before memory is needed for the next
            problem = self._system = _core.poisson(
                self.mesh._core, self._core, conditions, self._solver, self._expected
            )
            self._system_key = key
        values: Floats
        values, report = problem.solve(load, bool(integrated))
        self._report = SolveReport(
            **{name: report[name] for name in SolveReport.__dataclass_fields__}
        )
        return values

    def _right_hand_side(self, f: Any) -> Floats:
        n = self.n_unknowns
        if callable(f):
            at = np.concatenate((self.mesh.points, self._core.unknown_positions))
            return _arrays.values_at(f(at), n, "f (values of the function)", "unknowns")
        return _arrays.values_at(f, n, "f", "unknowns")

    def _conditions(self, dirichlet: Any, neumann: Any, robin: Any) -> dict[str, Any]:
        vertices, values, function = self._dirichlet(dirichlet)
        sides, flux = self._neumann(neumann)
        robin_sides, alpha, g = self._robin(robin)
        return {
            "dirichlet_vertices": vertices,
            "dirichlet_values": values,
            "dirichlet_function": function,
            "neumann_sides": sides,
            "neumann_flux": flux,
            "robin_sides": robin_sides,
            "robin_alpha": alpha,
            "robin_g": g,
        }

    def _dirichlet(self, given: Any) -> tuple[Ints, Floats, Any]:
        none = np.empty(0, dtype=np.int32)
        if given is None:
            return none, np.empty(0), None
        if isinstance(given, Mapping):
            return (*self._by_key(given, "dirichlet", self._vertices_of_patch), None)
        if isinstance(given, tuple) and len(given) == 2:
            vertices = self._some(given[0], "dirichlet (vertices)", self.mesh.n_vertices, "vertex")
            function = given[1] if callable(given[1]) else None
            return vertices, self._at(given[1], vertices, "dirichlet (values)"), function
        if callable(given) or np.ndim(given) == 0:
            vertices = self.mesh.boundary_vertices
            if len(vertices) == 0:
                raise InvalidOption(
                    "dirichlet: the mesh has no boundary; give (vertices, values) instead"
                )
            function = given if callable(given) else None
            return vertices, self._at(given, vertices, "dirichlet"), function
        raise InvalidType(
            f"dirichlet: {type(given).__name__}; expected a number, a function of (m, 3) points,"
            " {vertex: value}, or a tuple (vertices, values)"
        )

    def _at(self, values: Any, vertices: Ints, what: str) -> Floats:
        if callable(values):
            values = values(self.mesh.points[vertices])
            what += " of the function"
        return _arrays.values_at(values, len(vertices), what, "vertices")

    def _some(self, values: Any, what: str, n: int, noun: str) -> Ints:
        numbers = _arrays.ids(values, what)
        wrong = numbers[(numbers < 0) | (numbers >= n)]
        if wrong.size:
            raise InvalidOption(
                f"{what}: {noun} {wrong[0]} does not exist; the mesh has 0 to {n - 1}", wrong[:100]
            )
        return numbers

    def _by_key(
        self, given: Mapping[Any, Any], what: str, of_patch: Callable[[str], Ints]
    ) -> tuple[Ints, Floats]:
        numbers: list[Ints] = [np.empty(0, dtype=np.int32)]
        values: list[Floats] = [np.empty(0)]
        for key, value in given.items():
            some = of_patch(key) if isinstance(key, str) else _arrays.ids(key, what)
            numbers.append(some)
            values.append(_arrays.values_at(value, len(some), f"{what}[{key!r}]", "entries"))
        return np.concatenate(numbers), np.concatenate(values)

    def _patch(self, name: str) -> Ints:
        patches = self.mesh.patches if isinstance(self.mesh, PolyhedralMesh) else {}
        if name not in patches:
            known = ", ".join(sorted(patches)) or "none"
            raise InvalidOption(f"there is no patch {name!r}; the mesh has: {known}")
        return patches[name]

    def _vertices_of_patch(self, name: str) -> Ints:
        starts, indices = self.mesh.face_offsets, self.mesh.face_indices
        pieces = [indices[starts[f] : starts[f + 1]] for f in self._patch(name)]
        vertices: Ints = np.unique(np.concatenate([np.empty(0, dtype=np.int32), *pieces]))
        return vertices

    def _neumann(self, given: Any) -> tuple[Ints, Floats]:
        if given is None:
            return np.empty(0, dtype=np.int32), np.empty(0)
        if isinstance(given, Mapping):
            return self._by_key(given, "neumann", self._patch)
        if isinstance(given, tuple) and len(given) == 2:
            sides = _arrays.ids(given[0], "neumann (sides)")
            return sides, _arrays.values_at(given[1], len(sides), "neumann (flux)", "sides")
        raise InvalidType(
            f"neumann: {type(given).__name__}; expected {{side: flux}} or a tuple (sides, flux)"
        )

    def _robin(self, given: Any) -> tuple[Ints, Floats, Floats]:
        if given is None:
            return np.empty(0, dtype=np.int32), np.empty(0), np.empty(0)
        if isinstance(given, tuple) and len(given) == 3:
            sides = (
                self._patch(given[0])
                if isinstance(given[0], str)
                else _arrays.ids(given[0], "robin (sides)")
            )
            n = len(sides)
            return (
                sides,
                _arrays.values_at(given[1], n, "robin (alpha)", "sides"),
                _arrays.values_at(given[2], n, "robin (g)", "sides"),
            )
        raise InvalidType(
            f"robin: {type(given).__name__}; expected a tuple (sides, alpha, g)"
        )

    def __reduce__(self) -> Any:
        raise TypeError(
            "Poisson holds a factorisation, which cannot be pickled; pickle the mesh and make it"
            " again"
        )

    def __repr__(self) -> str:
        return f"<carat.Poisson: {self.operator}, {self.n_unknowns} unknowns>"
