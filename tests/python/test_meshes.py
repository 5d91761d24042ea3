"""Meshes from everything that callers have, and back."""

import copy
import pickle
import types

import numpy as np
import pytest

import carat

SQUARES = np.array([[x, y, 0.0] for y in range(3) for x in range(3)])
QUADS = np.array([[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 7, 6], [4, 5, 8, 7]])
MIXED = [[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 6], [4, 7, 6], [4, 5, 8, 7]]
CUBE = np.array([[x, y, z] for z in (0.0, 1) for y in (0.0, 1) for x in (0.0, 1)])
HEX = [0, 1, 3, 2, 4, 5, 7, 6]
CUBE_FACES = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]]


@pytest.mark.parametrize("dtype", [np.int8, np.uint8, np.int16, np.int32, np.int64, np.uint64])
@pytest.mark.parametrize("order", ["C", "F", "strided"])
def test_any_integer_type_and_order(dtype, order):
    expected = carat.PolygonMesh(SQUARES, QUADS.tolist())
    faces = QUADS.astype(dtype)
    if order == "F":
        faces = np.asfortranarray(faces)
    elif order == "strided":
        faces = np.repeat(np.repeat(faces, 2, axis=0), 2, axis=1)[::2, ::2]
    assert carat.PolygonMesh(SQUARES, faces) == expected


@pytest.mark.parametrize("dtype", [np.float16, np.float32, np.float64, np.int32, np.longdouble])
@pytest.mark.parametrize("order", ["C", "F", "strided", "big-endian"])
def test_any_real_type_and_order(dtype, order):
    points = SQUARES.astype(dtype)
    if order == "F":
        points = np.asfortranarray(points)
    elif order == "strided":
        points = np.repeat(points, 2, axis=0)[::2]
    elif order == "big-endian":
        points = points.astype(points.dtype.newbyteorder(">"))
    assert carat.PolygonMesh(points, QUADS) == carat.PolygonMesh(SQUARES, QUADS)


def test_forms_of_faces_agree():
    expected = carat.PolygonMesh(SQUARES, MIXED)
    padded = np.array([row + [-1] * (4 - len(row)) for row in MIXED])
    offsets = np.cumsum([0] + [len(row) for row in MIXED])
    flat = np.concatenate(MIXED)
    ragged = np.empty(len(MIXED), dtype=object)
    ragged[:] = MIXED
    for faces in (
        padded,
        padded.astype(np.int32),
        (flat, offsets),
        (flat.astype(np.int32), offsets),
        [tuple(row) for row in MIXED],
        [np.array(row) for row in MIXED],
        (row for row in MIXED),
        ragged,
    ):
        assert carat.PolygonMesh(SQUARES, faces) == expected
    assert expected.faces == MIXED
    assert expected.face_offsets.tolist() == offsets.tolist()


def test_points_in_the_plane():
    assert carat.PolygonMesh(SQUARES[:, :2], QUADS) == carat.PolygonMesh(SQUARES, QUADS)


def test_no_faces_and_no_points():
    empty = carat.PolygonMesh(np.zeros((0, 3)), [])
    assert (empty.n_vertices, empty.n_faces) == (0, 0)
    assert carat.stiffness(empty)[0].shape == (0, 0)
    for cells in ([], np.zeros((0, 4), int), np.zeros((0, 8), int)):
        assert carat.PolyhedralMesh(CUBE, cells).n_cells == 0
    lonely = carat.PolygonMesh(SQUARES, [])
    S, M = carat.stiffness(lonely)
    assert S.shape == (9, 9) and S.nnz == 0 and M.nnz == 0


def test_what_is_given_is_not_kept():
    points, faces = SQUARES.copy(), QUADS.copy()
    mesh = carat.PolygonMesh(points, faces)
    points[:] = 7
    faces[:] = 0
    assert mesh == carat.PolygonMesh(SQUARES, QUADS)


def test_views_cannot_be_written_to_and_outlive_the_mesh():
    mesh = carat.PolygonMesh(SQUARES, QUADS)
    views = [mesh.points, mesh.edges, mesh.face_indices, mesh.face_offsets]
    again = mesh.points
    assert np.shares_memory(views[0], again)
    del mesh
    for view in views:
        with pytest.raises(ValueError):
            view[...] = 0
    assert np.array_equal(views[0], SQUARES)


def test_numbers_of_a_surface(surface):
    assert surface.n_vertices - surface.n_edges + surface.n_faces == 2
    assert surface.statistics()["euler_characteristic"] == 2
    assert len(surface.boundary_vertices) == 0
    normals = surface.vertex_normals
    outward = surface.points / np.linalg.norm(surface.points, axis=1, keepdims=True)
    assert np.all((normals * outward).sum(axis=1) > 0.9)
    dual = surface.dual()
    assert dual.n_vertices == surface.n_faces
    triangles, sources = surface.triangulate()
    assert len(sources) == triangles.n_faces and np.all(np.diff(triangles.face_offsets) == 3)
    assert np.all(surface.vertex_components == 0)


def test_boundary_of_a_surface():
    mesh = carat.PolygonMesh(SQUARES, QUADS)
    assert mesh.boundary_vertices.tolist() == [0, 1, 2, 3, 5, 6, 7, 8]
    assert len(mesh.boundary_sides) == 8
    assert set(mesh.edges[mesh.boundary_sides].reshape(-1)) == set(mesh.boundary_vertices)


def volumes():
    """The unit cube in every form."""
    faces, cells = CUBE_FACES, [[0, 1, 2, 3, 4, 5]]
    stream = [6] + sum(([4, *face] for face in faces), [])
    return {
        "hexes": carat.PolyhedralMesh(CUBE, np.array([HEX])),
        "hexes_list": carat.PolyhedralMesh(CUBE, [HEX]),
        "cells_of_faces": carat.PolyhedralMesh(CUBE, [faces]),
        "faces_and_cells": carat.PolyhedralMesh.from_faces(CUBE, faces, cells),
        "faces_and_padded_cells": carat.PolyhedralMesh.from_faces(
            CUBE, np.array(faces), np.array([[0, 1, 2, 3, 4, 5, -1]])
        ),
        "owner_neighbour": carat.PolyhedralMesh.from_owner_neighbour(CUBE, faces, [0] * 6, []),
        "vtk": carat.PolyhedralMesh.from_vtk(CUBE, [8, *HEX], [12]),
        "vtk_voxel": carat.PolyhedralMesh.from_vtk(CUBE, [8, *range(8)], [11]),
        "vtk_polyhedron": carat.PolyhedralMesh.from_vtk(CUBE, [len(stream), *stream], [42]),
        "vtk_streams": carat.PolyhedralMesh.from_vtk(
            CUBE, [8, *range(8)], [42], faces=stream, face_locations=[0]
        ),
    }


@pytest.mark.parametrize("form", list(volumes()))
def test_forms_of_volumes_agree(form):
    mesh = volumes()[form]
    assert (mesh.n_vertices, mesh.n_edges, mesh.n_faces, mesh.n_cells) == (8, 12, 6, 1)
    expected = carat.stiffness(volumes()["hexes"])[0].toarray()
    assert np.allclose(carat.stiffness(mesh)[0].toarray(), expected, rtol=0, atol=1e-14)
    assert sorted(map(sorted, mesh.faces)) == sorted(map(sorted, CUBE_FACES))


def test_mixed_vtk_cells():
    points = np.concatenate((CUBE, [[0.5, 0.5, 2.0]]))
    faces = [[4, 5, 7, 6], [4, 5, 8], [5, 7, 8], [7, 6, 8], [6, 4, 8]]
    stream = [len(faces)] + sum(([len(face), *face] for face in faces), [])
    expected = carat.PolyhedralMesh.from_vtk(points, [8, *HEX, 5, 4, 5, 7, 6, 8], [12, 14])
    mixed = carat.PolyhedralMesh.from_vtk(points, [8, *HEX, len(stream), *stream], [12, 42])
    apart = carat.PolyhedralMesh.from_vtk(
        points, [8, *HEX, 5, 4, 5, 6, 7, 8], [12, 42], faces=stream, face_locations=[-1, 0]
    )
    for mesh in (mixed, apart):
        assert mesh.n_faces == expected.n_faces == 10
        assert mesh.statistics()["volume"] == pytest.approx(1 + 1 / 3)


def test_numbers_of_a_volume(volume):
    assert volume.statistics()["volume"] == pytest.approx(1)
    surface, vertices, faces = volume.boundary_surface()
    assert np.array_equal(surface.points, volume.points[vertices])
    assert np.array_equal(faces, volume.boundary_sides)
    assert np.array_equal(vertices, volume.boundary_vertices)
    below, above = volume.face_cells.T
    assert np.all((below < 0) ^ (above < 0) == np.isin(np.arange(volume.n_faces), faces))
    assert len(volume.cells) == len(volume.cell_vertices) == volume.n_cells


def same_answers(a, b):
    return (carat.stiffness(a)[0] != carat.stiffness(b)[0]).nnz == 0


@pytest.mark.parametrize("kind", ["surface", "volume"])
def test_pickle_and_copy(kind, request):
    mesh = request.getfixturevalue(kind)
    mesh = type(mesh)._of(mesh._core, {"u": np.arange(mesh.n_vertices, dtype=float)})
    for other in (pickle.loads(pickle.dumps(mesh)), copy.copy(mesh), copy.deepcopy(mesh)):
        assert other == mesh and same_answers(other, mesh)
        assert np.array_equal(other.vertex_data["u"], mesh.vertex_data["u"])


def test_pickle_keeps_baffles():
    # Two cubes that touch in a wall which has a face on either side.
    points = np.concatenate((CUBE, [[2, 0, 0], [2, 1, 0], [2, 0, 1], [2, 1, 1]]))
    wall = [1, 3, 7, 5]
    left = [f for f in CUBE_FACES if f != wall]
    right = [[1, 8, 9, 3], [5, 10, 11, 7], [1, 8, 10, 5], [3, 9, 11, 7], [8, 9, 11, 10]]
    faces = [*left, wall, *right, wall]
    mesh = carat.PolyhedralMesh.from_owner_neighbour(points, faces, [0] * 6 + [1] * 6, [])
    assert mesh.n_faces == 12 and len(mesh.boundary_sides) == 12
    again = pickle.loads(pickle.dumps(mesh))
    assert again == mesh and np.array_equal(again.face_cells, mesh.face_cells)


def test_equality():
    a = carat.PolygonMesh(SQUARES, QUADS)
    assert a == carat.PolygonMesh(SQUARES, QUADS.tolist())
    assert a != carat.PolygonMesh(SQUARES + 1, QUADS)
    assert a != carat.PolygonMesh(SQUARES, MIXED)
    assert a != 3
    with pytest.raises(TypeError):
        hash(a)


def test_repr():
    assert repr(carat.PolygonMesh(SQUARES, QUADS)) == (
        "<carat.PolygonMesh: 9 vertices, 12 edges, 4 faces>"
    )
    assert repr(volumes()["hexes"]) == (
        "<carat.PolyhedralMesh: 8 vertices, 12 edges, 6 faces, 1 cell>"
    )


def test_moved_vertices(surface, volume):
    for mesh in (surface, volume):
        moved = mesh.with_points(2 * mesh.points)
        assert np.array_equal(moved.points, 2 * mesh.points)
        assert np.shares_memory(moved.face_indices, mesh.face_indices)


# --- objects of other packages ------------------------------------------------------------------


def test_trimesh():
    thing = types.SimpleNamespace(vertices=SQUARES, faces=QUADS[:, :3])
    assert carat.as_mesh(thing) == carat.PolygonMesh(SQUARES, QUADS[:, :3])


def test_pyvista_surface():
    stream = np.concatenate([[len(row), *row] for row in MIXED])
    thing = types.SimpleNamespace(points=SQUARES.astype(np.float32), faces=stream)
    assert carat.as_mesh(thing) == carat.PolygonMesh(SQUARES, MIXED)


def test_pyvista_grid():
    stream = [len(CUBE_FACES)] + sum(([4, *face] for face in CUBE_FACES), [])
    hexes = types.SimpleNamespace(
        points=CUBE, cells=np.array([8, *HEX]), celltypes=np.array([12], dtype=np.uint8)
    )
    assert carat.as_mesh(hexes) == volumes()["hexes"]
    polyhedra = types.SimpleNamespace(
        points=CUBE,
        cells=np.array([8, *range(8)]),
        celltypes=np.array([42], dtype=np.uint8),
        faces=np.array(stream),
        face_locations=np.array([0]),
    )
    assert carat.as_mesh(polyhedra).n_faces == 6
    flat = types.SimpleNamespace(
        points=SQUARES,
        cells=np.array([4, 0, 1, 4, 3, 4, 1, 2, 4, 5, 3, 3, 4, 6]),
        celltypes=np.array([9, 8, 5], dtype=np.uint8),  # quad, pixel, triangle
    )
    assert carat.as_mesh(flat).faces == [[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 6]]
    with pytest.raises(carat.InvalidMesh, match="24"):
        carat.as_mesh(types.SimpleNamespace(points=CUBE, cells=[2, 0, 1], celltypes=[24]))


def test_vtk_itself():
    vtk = pytest.importorskip("vtkmodules.vtkCommonDataModel")
    from vtkmodules.vtkCommonCore import vtkIdList, vtkPoints

    points = vtkPoints()
    for point in CUBE:
        points.InsertNextPoint(point)
    grid = vtk.vtkUnstructuredGrid()
    grid.SetPoints(points)
    stream = vtkIdList()
    for number in [6] + sum(([4, *face] for face in CUBE_FACES), []):
        stream.InsertNextId(number)
    grid.InsertNextCell(42, stream)
    # The attributes that pyvista adds to it.
    cells = np.array([8, *range(8)])

    class Grid:
        points = CUBE
        celltypes = np.array([42])

        def __init__(self):
            self.cells = cells
            locations = grid.GetFaces()
            self.faces = np.array(
                [locations.GetValue(i) for i in range(locations.GetNumberOfValues())]
            )

        def GetFaceLocations(self):
            return grid.GetFaceLocations()

    assert carat.as_mesh(Grid()).n_faces == 6


def test_meshio():
    meshio = pytest.importorskip("meshio")
    flat = meshio.Mesh(SQUARES, [("quad", QUADS[:2]), ("triangle", [[3, 4, 6], [4, 7, 6]])])
    assert carat.as_mesh(flat).faces == QUADS[:2].tolist() + [[3, 4, 6], [4, 7, 6]]
    solid = meshio.Mesh(CUBE, [("hexahedron", [HEX]), ("quad", CUBE_FACES)])
    assert carat.as_mesh(solid) == volumes()["hexes"]
    general = meshio.Mesh(CUBE, [("polyhedron8", [[np.array(face) for face in CUBE_FACES]])])
    assert carat.as_mesh(general).n_faces == 6
    with pytest.raises(carat.InvalidMesh, match="tetra10"):
        carat.as_mesh(meshio.Mesh(np.zeros((10, 3)), [("tetra10", [list(range(10))])]))


# --- files ----------------------------------------------------------------------------------------


def test_surface_file_with_fields(tmp_path, surface):
    u, w = surface.points[:, 0], surface.points
    target = tmp_path / "mesh.vtp"
    carat.write(target, surface, vertex={"u": u, "w": w}, face={"n": np.arange(surface.n_faces)})
    again = carat.read(target)
    assert again == surface
    assert np.array_equal(again.vertex_data["u"], u) and np.array_equal(again.vertex_data["w"], w)
    assert np.array_equal(again.face_data["n"], np.arange(surface.n_faces))
    carat.write(tmp_path / "again.ply", again)  # fields go with the mesh
    assert np.array_equal(carat.read(str(tmp_path / "again.ply")).vertex_data["u"], u)


def test_volume_file_with_patches(tmp_path, volume):
    sides = volume.boundary_sides
    mesh = carat.PolyhedralMesh.from_faces(volume.points, volume.faces, volume.cells)
    mesh.patches["wall"] = sides[:5]
    carat.write(tmp_path / "mesh.ovm", mesh, cell={"c": np.arange(mesh.n_cells)})
    again = carat.read(tmp_path / "mesh.ovm")
    assert np.array_equal(again.patches["wall"], sides[:5])
    assert np.array_equal(again.cell_data["c"], np.arange(mesh.n_cells))
    assert pickle.loads(pickle.dumps(again)).patches.keys() == {"wall"}


def test_damaged_file(tmp_path):
    (tmp_path / "bad.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 x\nf 1 2 3\n")
    with pytest.raises(carat.IoError, match=r"bad\.obj: line 3"):
        carat.read(tmp_path / "bad.obj")
    (tmp_path / "bad.off").write_text("OFF\n1000000000000 1 0\n")
    with pytest.raises(carat.Error, match=r"bad\.off"):
        carat.read(tmp_path / "bad.off")


def test_formats():
    formats = {entry.name: entry for entry in carat.formats()}
    assert formats["obj"].extensions == (".obj",) and not formats["obj"].fields
    assert formats["vtu"].writes_volumes


def test_families():
    assert {"sphere-hexagons", "cube-voronoi"} <= {entry.name for entry in carat.families()}
    assert all(entry.kind == "volume" for entry in carat.families("volume"))
    for family in carat.families():
        mesh = carat.generate(family.name, level=0)
        assert isinstance(mesh, carat.PolygonMesh) == (family.kind == "surface")
    assert carat.generate("plane-quads", level=2, jitter=0.2, seed=3) == carat.generate(
        "plane-quads", level=2, jitter=0.2, seed=3
    )


# --- views ----------------------------------------------------------------------------------------


def test_show(tmp_path, surface, volume):
    for mesh in (surface, volume):
        view = carat.show(mesh, mesh.points[:, 2], path=tmp_path / "view.html", title="heights & more")
        text = (tmp_path / "view.html").read_text()
        assert text == view.html and '"u"' in text and "</html>" in text
        inline = view._repr_html_()
        assert inline.startswith("<iframe srcdoc=") and "<script" not in inline
        assert "heights" in repr(view)
    distances = carat.HeatGeodesics([[0, 0], [1, 0], [0, 1], [5, 5]], [[0, 1, 2]]).distance(0)
    assert np.isinf(distances[3])
    carat.show(carat.PolygonMesh([[0, 0], [1, 0], [0, 1], [5, 5]], [[0, 1, 2]]), distances)
