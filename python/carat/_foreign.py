"""Meshes from what other packages call one."""

from __future__ import annotations

from typing import Any, Optional

import numpy as np
import numpy.typing as npt

from . import _arrays
from ._errors import InvalidMesh, InvalidOption, InvalidType
from ._mesh import Mesh, PolygonMesh, PolyhedralMesh


def as_mesh(mesh: Any, faces: Optional[Any] = None) -> Mesh:
    """A mesh from what other packages call one.

    Parameters
    ----------
    mesh : object
        A mesh of this package; an object of pyvista (PolyData, UnstructuredGrid), meshio or
        trimesh, known by its attributes; or points, with `faces`. Points alone are no mesh.
    faces : array_like or list, optional
        Faces of a surface, as :class:`PolygonMesh` takes them.

    Returns
    -------
    PolygonMesh or PolyhedralMesh
        Volumes where there is a three-dimensional cell.

    Raises
    ------
    InvalidType
        Nothing can be made of it.
    """
    if faces is not None:
        if isinstance(mesh, (PolygonMesh, PolyhedralMesh)):
            raise InvalidOption("faces were given beside a mesh, which has its own; leave them out")
        return PolygonMesh(mesh, faces)
    if isinstance(mesh, (PolygonMesh, PolyhedralMesh)):
        return mesh
    if hasattr(mesh, "points") and hasattr(mesh, "celltypes"):  # pyvista.UnstructuredGrid
        return _from_unstructured_grid(mesh)
    if hasattr(mesh, "points") and hasattr(mesh, "cells_dict"):  # meshio.Mesh
        return _from_meshio(mesh)
    if hasattr(mesh, "points") and hasattr(mesh, "faces"):  # pyvista.PolyData
        stream = _arrays.integers(mesh.faces, "faces")
        if stream.ndim == 2:
            return PolygonMesh(mesh.points, stream)
        return PolygonMesh(mesh.points, _split_stream(stream))
    if hasattr(mesh, "vertices") and hasattr(mesh, "faces"):  # trimesh.Trimesh
        return PolygonMesh(mesh.vertices, mesh.faces)
    hint = "; points need faces beside them" if isinstance(mesh, (np.ndarray, list, tuple)) else ""
    raise InvalidType(
        f"{type(mesh).__name__} is no mesh: expected a carat.PolygonMesh or PolyhedralMesh, points"
        f" and faces, or a mesh of pyvista, meshio or trimesh{hint}"
    )


def _split_stream(stream: npt.NDArray[Any]) -> tuple[npt.NDArray[Any], npt.NDArray[Any]]:
    """(indices, offsets) of ``[3, a, b, c, 4, d, ...]``."""
    starts = []
    at = 0
    while at < stream.size:
        starts.append(at)
        if stream[at] < 0:
            raise InvalidMesh(f"faces: entry {at} is {stream[at]}; expected a number of vertices")
        at += 1 + int(stream[at])
    if at != stream.size:
        raise InvalidMesh("faces: the last face has fewer vertices than it says")
    counts = stream[starts]
    kept = np.ones(stream.size, dtype=bool)
    kept[starts] = False
    return stream[kept], _arrays.offsets_of(counts)


#: VTK's numbers of the cells that are faces.
_VTK_FACES = {5, 7, 8, 9}


def _from_unstructured_grid(grid: Any) -> Mesh:
    types = np.asarray(grid.celltypes).astype(np.int64)
    if np.any((types >= 10) & (types <= 14) | (types == 42)):
        faces = getattr(grid, "faces", None)
        if np.any(types == 42) and faces is not None:
            locations = grid.GetFaceLocations() if hasattr(grid, "GetFaceLocations") else None
            if locations is not None:
                locations = np.array(
                    [locations.GetValue(i) for i in range(locations.GetNumberOfValues())]
                )
            else:
                locations = np.asarray(grid.face_locations)
            return PolyhedralMesh.from_vtk(grid.points, grid.cells, types, faces, locations)
        return PolyhedralMesh.from_vtk(grid.points, grid.cells, types)
    unknown = set(types.tolist()) - _VTK_FACES
    if unknown:
        raise InvalidMesh(f"cells of VTK's types {sorted(unknown)} are neither faces nor solids")
    indices, offsets = _split_stream(_arrays.integers(grid.cells, "cells").reshape(-1))
    indices = indices.copy()
    for start in offsets[:-1][types == 8]:  # a pixel counts its vertices by rows
        indices[[start + 2, start + 3]] = indices[[start + 3, start + 2]]
    return PolygonMesh(grid.points, (indices, offsets))


#: meshio's names of solids, with VTK's numbers.
_MESHIO_SOLIDS = {"tetra": 10, "hexahedron": 12, "wedge": 13, "pyramid": 14}


def _from_meshio(mesh: Any) -> Mesh:
    solids: list[npt.NDArray[np.int64]] = []
    types: list[int] = []
    faces: list[Any] = []
    unknown: list[str] = []
    for block in mesh.cells:
        kind, data = block.type, block.data
        if kind in _MESHIO_SOLIDS:
            table = np.asarray(data, dtype=np.int64)
            solids.append(np.insert(table, 0, table.shape[1], axis=1).reshape(-1))
            types.extend([_MESHIO_SOLIDS[kind]] * len(table))
        elif kind.startswith("polyhedron"):
            for cell in data:
                stream = [len(cell)]
                for face in cell:
                    stream.extend([len(face), *map(int, face)])
                solids.append(np.array([len(stream), *stream], dtype=np.int64))
                types.append(42)
        elif kind in ("triangle", "quad") or kind.startswith("polygon"):
            faces.extend(np.asarray(data).tolist())
        elif kind not in ("vertex", "line"):
            unknown.append(kind)
    if unknown:
        raise InvalidMesh(
            f"meshio's cells {', '.join(unknown)}: only linear triangles, quads, polygons,"
            " tetrahedra, hexahedra, wedges, pyramids and polyhedra"
        )
    if types:
        return PolyhedralMesh.from_vtk(mesh.points, np.concatenate(solids), types)
    return PolygonMesh(mesh.points, faces)
