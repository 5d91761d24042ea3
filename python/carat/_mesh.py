"""Meshes: immutable values of points and connectivity, with named fields beside them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, Optional, Union

import numpy as np
import numpy.typing as npt

from . import _arrays, _core
from ._arrays import Floats, Ints
from ._errors import InvalidMesh, InvalidOption, InvalidType


def _rows_as_lists(parts: tuple[Ints, Ints]) -> list[list[int]]:
    indices, offsets = parts
    flat = indices.tolist()
    bounds = offsets.tolist()
    return [flat[begin:end] for begin, end in zip(bounds, bounds[1:])]


class _MeshBase:
    """What surfaces and volumes have in common."""

    _kind: str
    _core: Any
    #: Named values at the vertices, (n_vertices,) or (n_vertices, k); those of a file that was read.
    vertex_data: dict[str, Floats]

    @property
    def points(self) -> Floats:
        """(n_vertices, 3) positions [length]: a read-only view of the mesh's own memory."""
        points: Floats = self._core.points
        return points

    @property
    def n_vertices(self) -> int:
        """Number of vertices."""
        return int(self._core.n_vertices)

    @property
    def n_edges(self) -> int:
        """Number of edges."""
        return int(self._core.n_edges)

    @property
    def n_faces(self) -> int:
        """Number of faces; of a volume those inside and on the boundary."""
        return int(self._core.n_faces)

    @property
    def edges(self) -> Ints:
        """(n_edges, 2) end points, the lower number first, sorted; a read-only view."""
        edges: Ints = self._core.edges
        return edges

    @property
    def face_indices(self) -> Ints:
        """Vertex numbers of all faces one after the other; a read-only view."""
        indices: Ints = self._core.faces[0]
        return indices

    @property
    def face_offsets(self) -> Ints:
        """(n_faces + 1,): face f is ``face_indices[face_offsets[f]:face_offsets[f + 1]]``."""
        offsets: Ints = self._core.faces[1]
        return offsets

    @property
    def faces(self) -> list[list[int]]:
        """One list of vertex numbers a face; a copy. Large meshes: face_indices, face_offsets."""
        return _rows_as_lists(self._core.faces)

    @property
    def boundary_vertices(self) -> Ints:
        """Vertices on the boundary, ascending."""
        vertices: Ints = self._core.boundary_vertices()
        return vertices

    @property
    def boundary_sides(self) -> Ints:
        """Pieces of the boundary, ascending: edges of one face (surfaces), faces of one cell
        (volumes). Neumann and Robin data of :class:`Poisson` belong to these."""
        sides: Ints = self._core.boundary_sides()
        return sides

    def statistics(self) -> dict[str, Any]:
        """Counts, measures and defects, as ``carat info`` prints them."""
        statistics: dict[str, Any] = self._core.statistics()
        return statistics

    def __eq__(self, other: object) -> bool:
        """Same kind, points (bitwise) and connectivity; fields do not count."""
        if type(other) is not type(self) or not isinstance(other, _MeshBase):
            return NotImplemented
        if self._core is other._core:
            return True
        pairs = zip(self._arrays(), other._arrays())
        return all(bool(np.array_equal(a, b)) for a, b in pairs)

    __hash__ = None  # type: ignore[assignment]

    def _arrays(self) -> tuple[npt.NDArray[Any], ...]:
        raise NotImplementedError


def _fields(
    given: Optional[Mapping[str, Any]], n: int, what: str, of: str
) -> dict[str, Floats]:
    if given is None:
        return {}
    if not isinstance(given, Mapping):
        raise InvalidType(
            f"{what}: {type(given).__name__}; expected a dictionary of named arrays,"
            ' e.g. {"u": u}'
        )
    return {
        str(name): _arrays.field(values, n, f'{what} "{name}"', of)
        for name, values in given.items()
    }


class PolygonMesh(_MeshBase):
    """An immutable surface of polygons in space.

    Faces may have any number of vertices, be bent or not convex; boundaries, several components,
    edges of more than two faces and vertices without faces are ordinary input. Vertices and faces
    keep the numbers that they are given.

    Parameters
    ----------
    points : (n, 3) or (n, 2) array_like
        Positions [length]; (n, 2) lie in the plane z = 0. Copied.
    faces : array_like or list
        Vertices of every face, counted from 0, in order around it: an (m, k) integer array whose
        rows may be filled up with -1; a list of lists; or a tuple ``(indices, offsets)`` of two
        one-dimensional arrays. Any integer type and memory order. Copied.
    vertex_data, face_data : dict, optional
        Named values, one row a vertex or face.

    Raises
    ------
    InvalidMesh
        A position is not finite, a vertex number out of range, a face has fewer than three
        different vertices, or a shape is wrong.

    Examples
    --------
    >>> import carat
    >>> mesh = carat.PolygonMesh([[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1, 2, 3]])
    >>> mesh
    <carat.PolygonMesh: 4 vertices, 4 edges, 1 face>
    """

    _kind = "surface"

    def __init__(
        self,
        points: Any,
        faces: Any,
        *,
        vertex_data: Optional[Mapping[str, Any]] = None,
        face_data: Optional[Mapping[str, Any]] = None,
    ) -> None:
        positions = _arrays.points(points)
        parts = _arrays.rows(faces, "faces")
        if len(parts) == 1:
            core = _core.polygon_mesh_of_rows(positions, parts[0])
        else:
            core = _core.polygon_mesh(positions, parts[0], parts[1])
        self._set(core, vertex_data, face_data)

    def _set(
        self,
        core: _core.PolygonMesh,
        vertex_data: Optional[Mapping[str, Any]] = None,
        face_data: Optional[Mapping[str, Any]] = None,
    ) -> None:
        self._core = core
        self.vertex_data = _fields(vertex_data, core.n_vertices, "vertex_data", "vertices")
        #: Named values at the faces.
        self.face_data = _fields(face_data, core.n_faces, "face_data", "faces")

    @classmethod
    def _of(cls, core: _core.PolygonMesh, *fields: Any) -> PolygonMesh:
        mesh = cls.__new__(cls)
        mesh._set(core, *fields)
        return mesh

    @property
    def n_elements(self) -> int:
        """Number of faces."""
        return self.n_faces

    @property
    def vertex_normals(self) -> Floats:
        """(n_vertices, 3) unit normals, by the right-hand rule; zero where there is none."""
        normals: Floats = self._core.vertex_normals()
        return normals

    @property
    def face_area_vectors(self) -> Floats:
        """(n_faces, 3) vector areas [length^2]: normal times area where the face is planar."""
        vectors: Floats = self._core.face_area_vectors()
        return vectors

    @property
    def vertex_components(self) -> Ints:
        """Number of every vertex's connected component; -1 without a face."""
        components: Ints = self._core.vertex_components()
        return components

    def with_points(self, points: Any) -> PolygonMesh:
        """The same faces, sharing their memory, at other positions; without the fields.

        Parameters
        ----------
        points : (n_vertices, 3) array_like
            Positions [length].
        """
        return self._of(self._core.with_points(_arrays.points(points)))

    def dual(self) -> PolygonMesh:
        """The dual mesh: one vertex a face, one polygon a vertex.

        Raises
        ------
        InvalidMesh
            Edges of more than two faces, or neighbours that are turned against each other.
        """
        return self._of(self._core.dual())

    def triangulate(self) -> tuple[PolygonMesh, Ints]:
        """The faces cut into triangles, and the original face of every triangle."""
        core, faces = self._core.triangulate()
        return self._of(core), faces

    def _arrays(self) -> tuple[npt.NDArray[Any], ...]:
        return self.points, self.face_indices, self.face_offsets

    def __reduce__(self) -> Any:
        return _restore_surface, (*map(np.array, self._arrays()), self.vertex_data, self.face_data)

    def __repr__(self) -> str:
        return (
            f"<carat.PolygonMesh: {_count(self.n_vertices, 'vertex')},"
            f" {_count(self.n_edges, 'edge')}, {_count(self.n_faces, 'face')}>"
        )


class PolyhedralMesh(_MeshBase):
    """An immutable volume mesh of polyhedra.

    Cells may have any number of faces, faces any number of vertices. On which side of a face a
    cell lies is found from the closed surfaces of the cells: the orientation of the input does not
    matter. Vertices and cells keep the numbers that they are given.

    Parameters
    ----------
    points : (n, 3) array_like
        Positions [length]. Copied.
    cells : array_like or list
        (n, 4) integers: tetrahedra. (n, 8) integers: hexahedra, in the order of VTK. Or a list of
        cells, each a list of its faces, each a list of vertices. Copied.
    vertex_data, cell_data : dict, optional
        Named values, one row a vertex or cell.
    patches : dict, optional
        Named parts of the boundary: face numbers.

    Raises
    ------
    InvalidMesh
        What :class:`PolygonMesh` refuses; a cell that is not closed, or of fewer than four faces;
        a face of more than two cells.

    See Also
    --------
    from_faces, from_owner_neighbour, from_vtk : other ways to say the same.

    Examples
    --------
    >>> import carat
    >>> V = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> carat.PolyhedralMesh(V, [[0, 1, 2, 3]])
    <carat.PolyhedralMesh: 4 vertices, 6 edges, 4 faces, 1 cell>
    """

    _kind = "volume"

    def __init__(
        self,
        points: Any,
        cells: Any,
        *,
        vertex_data: Optional[Mapping[str, Any]] = None,
        cell_data: Optional[Mapping[str, Any]] = None,
        patches: Optional[Mapping[str, Any]] = None,
    ) -> None:
        positions = _arrays.points(points)
        if _is_table(cells):
            table = _arrays.integers(cells, "cells")
            if table.size == 0:
                table = table.reshape(0, 4)
            if table.ndim != 2 or table.shape[1] not in (4, 8):
                raise InvalidMesh(
                    f"cells: shape {_arrays.shape_of(table)}; expected (n, 4) tetrahedra, (n, 8)"
                    " hexahedra, or a list of cells, each a list of faces"
                )
            core = _core.polyhedral_mesh_of_rows(positions, table)
        else:
            core = _core.polyhedral_mesh(positions, *_cells_of_faces(cells))
        self._set(core, vertex_data, cell_data, patches)

    def _set(
        self,
        core: _core.PolyhedralMesh,
        vertex_data: Optional[Mapping[str, Any]] = None,
        cell_data: Optional[Mapping[str, Any]] = None,
        patches: Optional[Mapping[str, Any]] = None,
        patch_types: Optional[Mapping[str, str]] = None,
    ) -> None:
        self._core = core
        self.vertex_data = _fields(vertex_data, core.n_vertices, "vertex_data", "vertices")
        #: Named values at the cells.
        self.cell_data = _fields(cell_data, core.n_cells, "cell_data", "cells")
        #: Named parts of the boundary: ascending face numbers.
        self.patches: dict[str, Ints] = {
            str(name): _arrays.ids(faces, f'patch "{name}"')
            for name, faces in (patches or {}).items()
        }
        #: What simulation codes call these, e.g. ``"wall"``; only of meshes that were read.
        self.patch_types: dict[str, str] = dict(patch_types or {})

    @classmethod
    def _of(cls, core: _core.PolyhedralMesh, *fields: Any) -> PolyhedralMesh:
        mesh = cls.__new__(cls)
        mesh._set(core, *fields)
        return mesh

    @classmethod
    def from_faces(cls, points: Any, faces: Any, cells: Any) -> PolyhedralMesh:
        """From faces, and cells as lists of face numbers.

        Parameters
        ----------
        points : (n, 3) array_like
            Positions [length].
        faces, cells : array_like or list
            Vertices of every face; faces of every cell. In any of the forms that
            :class:`PolygonMesh` takes.
        """
        face_parts = _arrays.csr_rows(faces, "faces")
        cell_parts = _arrays.csr_rows(cells, "cells")
        return cls._of(_core.polyhedral_mesh(_arrays.points(points), *face_parts, *cell_parts))

    @classmethod
    def from_owner_neighbour(
        cls, points: Any, faces: Any, owner: Any, neighbour: Any
    ) -> PolyhedralMesh:
        """From the cells on both sides of every face, as OpenFOAM holds them.

        Parameters
        ----------
        points : (n, 3) array_like
            Positions [length].
        faces : array_like or list
            Vertices of every face, inner faces first.
        owner : (n_faces,) array_like
            One cell of every face.
        neighbour : (n_inner_faces,) array_like
            The other cell of every inner face.
        """
        return cls._of(
            _core.polyhedral_mesh_of_owners(
                _arrays.points(points),
                *_arrays.csr_rows(faces, "faces"),
                _arrays.ids(owner, "owner").astype(np.int64),
                _arrays.ids(neighbour, "neighbour").astype(np.int64),
            )
        )

    @classmethod
    def from_vtk(
        cls,
        points: Any,
        cells: Any,
        cell_types: Any,
        faces: Optional[Any] = None,
        face_locations: Optional[Any] = None,
    ) -> PolyhedralMesh:
        """From the arrays of a VTK unstructured grid.

        Parameters
        ----------
        points : (n, 3) array_like
            Positions [length].
        cells : (k,) array_like
            Of every cell the number of its vertices and these, one after the other. A polyhedron's
            entry is its stream of faces, unless `faces` is given.
        cell_types : (n_cells,) array_like
            10 tetrahedron, 11 voxel, 12 hexahedron, 13 wedge, 14 pyramid, 42 polyhedron.
        faces : (k,) array_like, optional
            Streams of the polyhedra: number of faces, then of every face its size and vertices.
        face_locations : (n_cells,) array_like, optional
            Where a cell's stream begins in `faces`; -1 for cells that are no polyhedra.
        """
        stream = _arrays.integers(cells, "cells").astype(np.int64).reshape(-1)
        types = _arrays.integers(cell_types, "cell_types").astype(np.int64).reshape(-1)
        if (faces is None) != (face_locations is None):
            raise InvalidOption("faces and face_locations have to be given together")
        if faces is not None:
            stream = _insert_face_streams(
                stream,
                types,
                _arrays.integers(faces, "faces").astype(np.int64).reshape(-1),
                _arrays.integers(face_locations, "face_locations").astype(np.int64).reshape(-1),
            )
        return cls._of(_core.polyhedral_mesh_of_vtk(_arrays.points(points), stream, types))

    @property
    def n_cells(self) -> int:
        """Number of cells."""
        return int(self._core.n_cells)

    @property
    def n_elements(self) -> int:
        """Number of cells."""
        return self.n_cells

    @property
    def cell_indices(self) -> Ints:
        """Face numbers of all cells one after the other; a read-only view."""
        indices: Ints = self._core.cells[0]
        return indices

    @property
    def cell_offsets(self) -> Ints:
        """(n_cells + 1,): cell c is ``cell_indices[cell_offsets[c]:cell_offsets[c + 1]]``."""
        offsets: Ints = self._core.cells[1]
        return offsets

    @property
    def cells(self) -> list[list[int]]:
        """One list of face numbers a cell; a copy."""
        return _rows_as_lists(self._core.cells)

    @property
    def cell_vertices(self) -> list[list[int]]:
        """One list of vertex numbers a cell; a copy."""
        return _rows_as_lists(self._core.cell_vertices)

    @property
    def face_cells(self) -> Ints:
        """(n_faces, 2) the cells below and above every face, -1: none; a read-only view."""
        cells: Ints = self._core.face_cells
        return cells

    def with_points(self, points: Any) -> PolyhedralMesh:
        """The same cells, sharing their memory, at other positions; without the fields.

        Parameters
        ----------
        points : (n_vertices, 3) array_like
            Positions [length].
        """
        return self._of(
            self._core.with_points(_arrays.points(points)), None, None, self.patches,
            self.patch_types,
        )

    def boundary_surface(self) -> tuple[PolygonMesh, Ints, Ints]:
        """The boundary as a surface, and the vertex and face of the volume of each of its own."""
        core, vertices, faces = self._core.boundary_surface()
        return PolygonMesh._of(core), vertices, faces

    def _arrays(self) -> tuple[npt.NDArray[Any], ...]:
        return (
            self.points,
            self.face_indices,
            self.face_offsets,
            self.cell_indices,
            self.cell_offsets,
        )

    def __reduce__(self) -> Any:
        return _restore_volume, (
            np.array(self.points),
            np.array(self.face_indices),
            np.array(self.face_offsets),
            np.array(self.cell_indices),
            np.array(self.cell_offsets),
            self.vertex_data,
            self.cell_data,
            self.patches,
            self.patch_types,
        )

    def __repr__(self) -> str:
        return (
            f"<carat.PolyhedralMesh: {_count(self.n_vertices, 'vertex')},"
            f" {_count(self.n_edges, 'edge')}, {_count(self.n_faces, 'face')},"
            f" {_count(self.n_cells, 'cell')}>"
        )


#: A mesh of either kind.
Mesh = Union[PolygonMesh, PolyhedralMesh]


def _count(n: int, noun: str) -> str:
    plural = {"vertex": "vertices"}.get(noun, noun + "s")
    return f"{n} {noun if n == 1 else plural}"


def _restore_surface(
    points: Any, indices: Any, offsets: Any, vertex_data: Any, face_data: Any
) -> PolygonMesh:
    return PolygonMesh(points, (indices, offsets), vertex_data=vertex_data, face_data=face_data)


def _restore_volume(
    points: Any, indices: Any, offsets: Any, cell_indices: Any, cell_offsets: Any, *fields: Any
) -> PolyhedralMesh:
    core = _core.polyhedral_mesh(points, indices, offsets, cell_indices, cell_offsets)
    n_faces = len(offsets) - 1
    if core.n_faces != n_faces:
        # Two sides of a baffle, which lists of faces merge; only meshes with inner faces first
        # have any.
        cells_of = np.repeat(np.arange(len(cell_offsets) - 1), np.diff(cell_offsets))
        order = np.argsort(cell_indices, kind="stable")
        first = np.searchsorted(cell_indices[order], np.arange(n_faces + 1))
        owner = cells_of[order][first[:-1]]
        inner = np.flatnonzero(np.diff(first) == 2)
        neighbour = cells_of[order][first[inner] + 1]
        core = _core.polyhedral_mesh_of_owners(
            points,
            indices.astype(np.int64),
            offsets.astype(np.int64),
            owner.astype(np.int64),
            neighbour.astype(np.int64),
        )
    return PolyhedralMesh._of(core, *fields)


def _is_table(cells: Any) -> bool:
    """Whether these are rows of vertices: an array, or a list of lists of numbers."""
    if isinstance(cells, np.ndarray):
        return bool(cells.dtype != object)
    if not isinstance(cells, (list, tuple)):
        return hasattr(cells, "__array__")
    if not cells or not isinstance(cells[0], (list, tuple, np.ndarray)):
        return True
    first: list[Any] = list(cells[0])
    return bool(first) and all(isinstance(v, (int, np.integer)) for v in first)


def _cells_of_faces(cells: Iterable[Any]) -> tuple[npt.NDArray[Any], ...]:
    """(face indices, face offsets, cell indices, cell offsets) of cells as lists of faces."""
    if isinstance(cells, (str, bytes)) or not isinstance(cells, Iterable):
        raise InvalidType(
            f"cells: {type(cells).__name__}; expected (n, 4) tetrahedra, (n, 8) hexahedra, or a list"
            " of cells, each a list of faces"
        )
    faces: list[Any] = []
    offsets = [0]
    for c, cell in enumerate(cells):
        if isinstance(cell, (str, bytes)) or not isinstance(cell, Iterable):
            raise InvalidType(f"cells: entry {c} is {cell!r}; expected a list of faces", (c,))
        faces.extend(cell)
        offsets.append(len(faces))
    numbers = np.arange(len(faces), dtype=np.int64)
    return (*_arrays.csr_rows(faces, "cells"), numbers, np.array(offsets, dtype=np.int64))


def _insert_face_streams(
    stream: npt.NDArray[np.int64],
    types: npt.NDArray[np.int64],
    faces: npt.NDArray[np.int64],
    locations: npt.NDArray[np.int64],
) -> npt.NDArray[np.int64]:
    """Puts the faces of polyhedra in place of their vertices."""
    if locations.shape != types.shape:
        raise InvalidMesh(
            f"face_locations: {locations.size} entries for {types.size} cells; expected one a cell"
        )
    pieces: list[npt.NDArray[np.int64]] = []
    at = 0
    for c, kind in enumerate(types):
        if at >= stream.size:
            raise InvalidMesh(f"cell {c}: the list of cells ends before it", (c,))
        end = at + 1 + int(stream[at])
        if kind != 42:
            pieces.append(stream[at:end])
        else:
            begin = here = int(locations[c])
            if not 0 <= begin < faces.size:
                raise InvalidMesh(f"cell {c}: no stream of faces at {begin}", (c,))
            here += 1
            for _ in range(int(faces[begin])):
                if here >= faces.size:
                    raise InvalidMesh(f"cell {c}: its stream of faces ends early", (c,))
                here += 1 + max(0, int(faces[here]))
            pieces += [np.array([here - begin], dtype=np.int64), faces[begin:here]]
        at = end
    pieces.append(stream[at:])
    return np.concatenate(pieces).astype(np.int64)
