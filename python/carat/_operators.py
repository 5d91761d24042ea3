"""Discrete operators as SciPy matrices."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Optional, Union

import numpy as np
import numpy.typing as npt
import scipy.sparse

from . import _arrays, _core
from ._arrays import Floats, Ints
from ._errors import InvalidOption, InvalidType
from ._foreign import as_mesh
from ._mesh import Mesh, PolyhedralMesh

#: Called with a number that grows while work goes on.
Progress = Callable[[int], object]
#: K in div(K grad u): one number, one a cell, a symmetric tensor a cell, or a function of points.
Coefficient = Union[float, npt.ArrayLike, Callable[[Floats], Any]]


def _csr(parts: tuple[Floats, Ints, Ints, tuple[int, int]]) -> scipy.sparse.csr_matrix:
    """A SciPy matrix over arrays that are not copied; they are sorted and without duplicates."""
    data, indices, indptr, shape = parts
    matrix = scipy.sparse.csr_matrix((data, indices, indptr), shape=shape, copy=False)
    matrix.has_sorted_indices = True
    matrix.has_canonical_format = True
    return matrix


@dataclass(frozen=True)
class Finding:
    """Something that a computation met and its user should know.

    Attributes
    ----------
    meaning : str
        What it is and what was done about it.
    elements : ndarray of int
        Numbers of the elements concerned, ascending; often none.
    """

    meaning: str
    elements: Ints

    def __len__(self) -> int:
        return len(self.elements)


def _findings(raw: Mapping[str, tuple[str, Ints]]) -> dict[str, Finding]:
    return {name: Finding(meaning, elements) for name, (meaning, elements) in raw.items()}


def _text(value: Any, what: str) -> str:
    if value is None:
        return ""
    if not isinstance(value, str):
        raise InvalidType(f"{what}: {value!r}; expected a string")
    return value


def _number(value: Any, what: str) -> Optional[float]:
    if value is None:
        return None
    if isinstance(value, (str, bytes)):
        raise InvalidType(f"{what}: {value!r}; expected a number")
    try:
        return float(value)
    except (TypeError, ValueError):
        raise InvalidType(f"{what}: {value!r}; expected a number") from None


def _whole(value: Any, what: str, least: int, most: int = np.iinfo(np.int32).max) -> int:
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, np.integer)):
        raise InvalidType(f"{what}: {value!r}; expected a whole number")
    if value < least:
        raise InvalidOption(f"{what}: {value}; expected a whole number of at least {least}")
    if value > most:
        raise InvalidOption(f"{what}: {value}; expected a whole number of at most {most}")
    return int(value)


def _arguments(
    mesh: Mesh,
    application: str = "",
    *,
    operator: Optional[str] = None,
    virtual_point: Optional[str] = None,
    weights: Optional[str] = None,
    mass: Optional[str] = None,
    lumped: bool = False,
    lam: Optional[float] = None,
    theta: Optional[float] = None,
    tau: Optional[float] = None,
    boundary_unknowns: Optional[bool] = None,
    keep_flipped: bool = False,
    strict: bool = False,
    coefficient: Optional[Coefficient] = None,
    threads: int = 0,
) -> dict[str, Any]:
    """The options of an operator as the compiled part takes them."""
    if lumped:
        if mass not in (None, "lumped"):
            raise InvalidOption(f'lumped=True and mass="{mass}" contradict each other')
        mass = "lumped"
    function, cells = None, None
    if callable(coefficient):
        function = coefficient
    elif coefficient is not None:
        cells = _cell_coefficient(mesh, coefficient)
        if cells is None:
            value = float(np.asarray(coefficient))
            function = lambda x: np.full(len(x), value)  # noqa: E731
    return {
        "application": application,
        "operator": _text(operator, "operator"),
        "virtual_point": _text(virtual_point, "virtual_point"),
        "weights": _text(weights, "weights"),
        "mass": _text(mass, "mass"),
        "lambda": _number(lam, "lam"),
        "theta": _number(theta, "theta"),
        "tau": _number(tau, "tau"),
        "boundary_unknowns": None if boundary_unknowns is None else bool(boundary_unknowns),
        "keep_flipped": bool(keep_flipped),
        "strict": bool(strict),
        "coefficient": function,
        "cell_coefficient": cells,
        "threads": _whole(threads, "threads", 0, 1024),
    }


def _cell_coefficient(mesh: Mesh, coefficient: Any) -> Optional[Floats]:
    """(n_cells, 1) or (n_cells, 6), or None for one number."""
    array = _arrays.floats(coefficient, "coefficient")
    if array.ndim == 0:
        return None
    n = mesh.n_elements
    if not isinstance(mesh, PolyhedralMesh):
        raise InvalidOption(
            "coefficient: one a cell is for volumes; on a surface give a number, or a function of"
            " (n, 3) points"
        )
    if array.shape == (n,):
        return array.reshape(n, 1)
    if array.shape in ((n, 1), (n, 6)):
        return array
    if array.shape == (n, 3, 3):
        if not np.array_equal(array, array.transpose(0, 2, 1)):
            raise InvalidOption("coefficient: tensors have to be symmetric")
        return np.ascontiguousarray(
            array[:, [0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2]]  # xx, yy, zz, xy, yz, xz
        )
    raise InvalidOption(
        f"coefficient: shape {_arrays.shape_of(array)}; expected ({n},), ({n}, 3, 3) or ({n}, 6)"
        " with xx, yy, zz, xy, yz, xz, or a function of (n, 3) points"
    )


class Discretization:
    """The discrete operators of one mesh, consistent with each other; made by :func:`discretize`.

    With the vertices' values u, the stiffness S and the mass M:

    - ``u @ S @ u`` is the Dirichlet energy of u; S is symmetric positive semidefinite;
    - ``laplacian`` is ``-S``, the integrated Laplacian; its pointwise values are ``M^-1 L u``;
    - ``M`` integrates: ``ones @ M @ ones`` is the area or volume;
    - ``gradient @ u`` has `gradient_dimension` components for every sample, one after the other;
    - ``divergence`` is ``-gradient.T @ M_s`` with the samples' measures M_s; ``laplacian`` is
      ``divergence @ gradient`` for operators without a stabilising term.

    Matrices are CSR with ascending columns. Stiffness, mass and gradient are arrays over the
    memory of this object: copy them before you change them.
    """

    def __init__(
        self, core: _core.Discretization, mesh: Mesh, options: Mapping[str, Any]
    ) -> None:
        self._core = core
        self._options = dict(options)
        self._made: dict[str, Any] = {}
        #: The mesh that the operators belong to.
        self.mesh = mesh

    @property
    def operator(self) -> str:
        """Name of the operator."""
        return str(self._core.name)

    @property
    def mass_kind(self) -> str:
        """Which mass matrix: full, lumped, moment-exact, voronoi."""
        return str(self._core.mass_kind())

    @property
    def n_unknowns(self) -> int:
        """Rows of the stiffness: the vertices, and unknowns beyond them for some operators."""
        return int(self._core.n_unknowns)

    @property
    def n_samples(self) -> int:
        """Number of places where the gradient is."""
        return int(self._core.n_samples)

    @property
    def gradient_dimension(self) -> int:
        """Components of a sample's gradient; 1: differences along the sides; 0: no gradient."""
        return int(self._core.gradient_dimension)

    def _once(self, name: str, parts: Callable[[], Any]) -> scipy.sparse.csr_matrix:
        if name not in self._made:
            self._made[name] = _csr(parts())
        return self._made[name]

    @property
    def stiffness(self) -> scipy.sparse.csr_matrix:
        """S, (N, N), symmetric positive semidefinite [1 on surfaces, length in volumes]."""
        return self._once("stiffness", self._core.stiffness)

    @property
    def laplacian(self) -> scipy.sparse.csr_matrix:
        """L = -S, (N, N), integrated and negative semidefinite."""
        return self._once("laplacian", self._core.laplacian)

    @property
    def mass(self) -> scipy.sparse.csr_matrix:
        """M, (N, N), symmetric; its entries sum to the area or volume [length^2, length^3]."""
        return self._once("mass", self._core.mass)

    @property
    def lumped_mass(self) -> Floats:
        """(N,) row sums of the mass: the area or volume that belongs to each unknown."""
        sums: Floats = self._core.lumped_mass()
        return sums

    @property
    def gradient(self) -> scipy.sparse.csr_matrix:
        """G, (gradient_dimension * n_samples, N) [1/length]; component k of sample s in row
        ``gradient_dimension * s + k``. On surfaces in the sample's own axes: see
        :meth:`element_vectors` for vectors in space.

        Raises
        ------
        InvalidOption
            The operator defines none.
        """
        self._need_gradient()
        return self._once("gradient", self._core.gradient)

    @property
    def divergence(self) -> scipy.sparse.csr_matrix:
        """D = -G^T M_s, (N, rows of the gradient): integrated divergence of sample vectors.

        Raises
        ------
        InvalidOption
            The operator defines none.
        """
        self._need_gradient()
        return self._once("divergence", self._core.divergence)

    def _need_gradient(self) -> None:
        if self.gradient_dimension == 0:
            raise InvalidOption(f"the operator {self.operator} defines no gradient")

    @property
    def sample_measure(self) -> Floats:
        """(n_samples,) area or volume of every sample, 0 where degenerate; a read-only view."""
        measure: Floats = self._core.sample_measure
        return measure

    @property
    def unknown_positions(self) -> Floats:
        """(N, 3) where the unknowns are: the vertices, then those beyond them [length]."""
        return np.concatenate((self.mesh.points, self._core.unknown_positions))

    @property
    def diagnostics(self) -> dict[str, Finding]:
        """What was met on the way, e.g. degenerate elements that were left out; by name."""
        return _findings(self._core.diagnostics())

    def element_vectors(self, values: npt.ArrayLike) -> Floats:
        """Sample vectors as vectors in space, averaged over every face or cell.

        Parameters
        ----------
        values : (rows of the gradient,) array_like
            E.g. ``ops.gradient @ u``.

        Returns
        -------
        (n_elements, 3) ndarray
        """
        self._need_gradient()
        vectors: Floats = self._core.element_vectors(
            _arrays.floats(values, "values").reshape(-1), self.mesh.n_elements
        )
        return vectors

    def vertex_vectors(self, values: npt.ArrayLike) -> Floats:
        """The same averaged around every vertex: (n_vertices, 3)."""
        self._need_gradient()
        vectors: Floats = self._core.vertex_vectors(_arrays.floats(values, "values").reshape(-1))
        return vectors

    def __reduce__(self) -> Any:
        return _rebuild, (self.mesh, self._options)

    def __repr__(self) -> str:
        return (
            f"<carat.Discretization: {self.operator}, mass {self.mass_kind}, {self.n_unknowns}"
            f" unknowns, {self.n_samples} samples>"
        )


def _rebuild(mesh: Mesh, options: Mapping[str, Any]) -> Discretization:
    """Assembles again, which gives the same bits."""
    return discretize(mesh, **options)


def discretize(
    mesh: Any,
    faces: Optional[Any] = None,
    *,
    operator: str = "diamond",
    virtual_point: Optional[str] = None,
    weights: Optional[str] = None,
    mass: Optional[str] = None,
    lumped: bool = False,
    lam: Optional[float] = None,
    theta: Optional[float] = None,
    tau: Optional[float] = None,
    boundary_unknowns: Optional[bool] = None,
    keep_flipped: bool = False,
    strict: bool = False,
    coefficient: Optional[Coefficient] = None,
    threads: int = 0,
) -> Discretization:
    """Gradient, divergence, Laplacian, stiffness and mass of a mesh.

    Parameters
    ----------
    mesh : PolygonMesh, PolyhedralMesh, (n, 3) array_like, or a mesh of another package
        The mesh, or with `faces` the points of a surface; see :func:`as_mesh`.
    faces : array_like or list, optional
        Faces of a surface, as :class:`PolygonMesh` takes them.
    operator : str
        E.g. ``"diamond"``, ``"stabilized_diamond"``, ``"bunge"``, ``"cotan"``; see
        :func:`operators`.
    virtual_point : {"area", "centroid", "trace"}, optional
        Where a face's virtual vertex lies: least squared area of the virtual triangles (default),
        mean of the vertices, or least trace of the stiffness.
    weights : {"in-plane", "minimum-norm"}, optional
        Which affine weights give that point on faces that are not planar.
    mass : {"full", "lumped", "moment-exact", "voronoi"}, optional
        Which mass matrix; default: the operator's own.
    lumped : bool
        Short for ``mass="lumped"``.
    lam : float, optional
        Weight of the stabilising term of operators that have one.
    theta : float, optional
        Stabilised diamonds: share of the diamond's stiffness, 0 to 1.
    tau : float, optional
        Moment-exact mass: 0 splits a diamond at its base, 1 about its axis.
    boundary_unknowns : bool, optional
        Operators with unknowns at faces or edges: keep those on the boundary.
    keep_flipped : bool
        Leave virtual vertices where they are if they flip a virtual triangle.
    strict : bool
        Degenerate elements are errors instead of being left out and reported.
    coefficient : float, array_like or callable, optional
        K in div(K grad u): a number > 0; in volumes one a cell, (n_cells,), or a symmetric
        positive definite tensor a cell, (n_cells, 3, 3) or (n_cells, 6) with xx, yy, zz, xy, yz,
        xz; or a function that is given (m, 3) points and returns (m,) values. It enters stiffness
        and laplacian.
    threads : int
        0: all the machine has. Results do not depend on it.

    Returns
    -------
    Discretization

    Raises
    ------
    InvalidMesh, InvalidOption, DegenerateElement

    Notes
    -----
    Bunge, Botsch, Alexa: The Diamond Laplace for Polygonal and Polyhedral Meshes, 2021; the
    sources of the other operators are in ``carat.operators()``. The mesh is not copied; points and
    faces are.

    Examples
    --------
    >>> import carat
    >>> mesh = carat.generate("plane-quads", level=2)
    >>> ops = carat.discretize(mesh)
    >>> ops.gradient_dimension
    2
    >>> abs(ops.stiffness @ mesh.points[:, 0]).max() > 0  # not zero at the boundary
    True
    """
    mesh = as_mesh(mesh, faces)
    options: dict[str, Any] = {
        "operator": operator,
        "virtual_point": virtual_point,
        "weights": weights,
        "mass": mass,
        "lumped": lumped,
        "lam": lam,
        "theta": theta,
        "tau": tau,
        "boundary_unknowns": boundary_unknowns,
        "keep_flipped": keep_flipped,
        "strict": strict,
        "coefficient": coefficient,
        "threads": threads,
    }
    core = _core.discretize(mesh._core, _arguments(mesh, **options), "frames")
    return Discretization(core, mesh, options)


def stiffness(
    mesh: Any,
    faces: Optional[Any] = None,
    *,
    operator: str = "diamond",
    threads: int = 0,
    **options: Any,
) -> tuple[scipy.sparse.csr_matrix, scipy.sparse.csr_matrix]:
    """Stiffness and mass of a mesh: all that most programs need.

    Parameters
    ----------
    mesh, faces, operator, threads, **options
        As for :func:`discretize`.

    Returns
    -------
    S : (N, N) csr_matrix
        Stiffness, symmetric positive semidefinite; the integrated Laplacian is -S [1 on surfaces,
        length in volumes].
    M : (N, N) csr_matrix
        Mass, symmetric [length^2, length^3]. Not diagonal unless ``lumped=True``.

    Both are handed over, not copied.

    Examples
    --------
    >>> import carat
    >>> V = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    >>> S, M = carat.stiffness(V, [[0, 1, 2, 3]])
    >>> round(M.sum(), 12)
    1.0
    """
    mesh = as_mesh(mesh, faces)
    known = _arguments(mesh, operator=operator, threads=threads, **_known_options(options))
    core = _core.discretize(mesh._core, known, "matrices")
    return _csr(core.stiffness()), _csr(core.mass())


_OPTIONS = (
    "virtual_point",
    "weights",
    "mass",
    "lumped",
    "lam",
    "theta",
    "tau",
    "boundary_unknowns",
    "keep_flipped",
    "strict",
    "coefficient",
)


def _known_options(options: Mapping[str, Any]) -> dict[str, Any]:
    """Refuses misspelt ones as Python does."""
    for name in options:
        if name not in _OPTIONS:
            raise InvalidType(
                f"there is no option {name!r}; choose one of {', '.join(sorted(_OPTIONS))}"
            )
    return dict(options)


@dataclass(frozen=True)
class OperatorInfo:
    """What there is to know of an operator before choosing it."""

    name: str
    kind: str  #: "surface" or "volume"
    title: str
    citation: str
    masses: tuple[str, ...]  #: the default first
    gradient: bool  #: whether it defines one
    simplices_only: bool  #: triangles or tetrahedra only
    vertex_unknowns: bool  #: no unknowns beyond the vertices
    definition: str
    when: str  #: when to use it, and when not


def operators(kind: Optional[str] = None) -> list[OperatorInfo]:
    """The operators that there are.

    Parameters
    ----------
    kind : {"surface", "volume"}, optional
        Only those of one kind of mesh.
    """
    if kind not in (None, "surface", "volume"):
        raise InvalidOption(f'kind={kind!r}: choose one of "surface", "volume"')
    everything = [OperatorInfo(**entry) for entry in _core.operators()]
    return [entry for entry in everything if kind in (None, entry.kind)]
