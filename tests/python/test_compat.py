"""Scripts in the documented forms of other packages, with nothing changed but the import."""

import numpy as np
import pytest
import scipy.sparse.linalg as sla

import carat
import carat.compat.potpourri3d as pp3d
import carat.compat.robust_laplacian as robust_laplacian


@pytest.fixture()
def triangles():
    mesh = carat.generate("sphere-triangles", level=2)
    return np.array(mesh.points), np.array(mesh.face_indices).reshape(-1, 3)


def test_robust_laplacian(triangles):
    verts, faces = triangles
    L, M = robust_laplacian.mesh_laplacian(verts, faces)
    # Positive semidefinite, as that package documents: shift-invert needs no change of sign.
    n_eig = 10
    evals, evecs = sla.eigsh(L, n_eig, M, sigma=1e-8)
    assert evals == pytest.approx([0] + 3 * [2] + 5 * [6] + [12], abs=0.4)
    assert evecs.shape == (len(verts), n_eig)
    L, M = robust_laplacian.mesh_laplacian(verts, faces, mollify_factor=1e-4)
    assert (M - M.T).nnz == 0 and M.nnz == len(verts)
    assert M.sum() == pytest.approx(4 * np.pi, rel=0.05)
    assert abs(L - pp3d.cotan_laplacian(verts, faces)).max() == 0
    with pytest.raises(NotImplementedError):
        robust_laplacian.point_cloud_laplacian(verts)


def test_robust_laplacian_of_polygons():
    mesh = carat.generate("sphere-hexagons", level=2)
    L, M = robust_laplacian.mesh_laplacian(mesh.points, mesh.faces)
    assert abs(L - carat.stiffness(mesh)[0]).max() == 0 and M.nnz == mesh.n_vertices


def test_potpourri3d_distances(triangles):
    V, F = triangles
    solver = pp3d.MeshHeatMethodDistanceSolver(V, F)
    dist = solver.compute_distance(7)
    exact = np.arccos(np.clip(V @ V[7], -1, 1))
    assert np.abs(dist - exact).max() < 0.15
    dist = solver.compute_distance_multisource([1, 2, 3])
    assert dist[[1, 2, 3]] == pytest.approx(np.zeros(3), abs=0.1)
    assert np.array_equal(pp3d.compute_distance(V, F, 7), solver.compute_distance(7))
    assert np.array_equal(pp3d.compute_distance_multisource(V, F, [1, 2, 3]), dist)
    pp3d.MeshHeatMethodDistanceSolver(V, F, t_coef=2.0, use_robust=False)


def test_potpourri3d_quantities(triangles):
    V, F = triangles
    L = pp3d.cotan_laplacian(V, F, denom_eps=1e-10)
    assert np.abs(L @ np.ones(len(V))).max() < 1e-12
    assert V[:, 0] @ (L @ V[:, 0]) > 0
    areas = pp3d.face_areas(V, F)
    corners = V[F]
    expected = 0.5 * np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    assert areas == pytest.approx(expected)
    assert pp3d.vertex_areas(V, F).sum() == pytest.approx(areas.sum())
    assert pp3d.edges(V, F).shape == (len(V) + len(F) - 2, 2)


def test_potpourri3d_files(tmp_path, triangles):
    V, F = triangles
    name = str(tmp_path / "mesh.ply")
    pp3d.write_mesh(V, F, name)
    V2, F2 = pp3d.read_mesh(name)
    assert np.array_equal(V, V2) and np.array_equal(F, F2)
    V3, polygons = pp3d.read_polygon_mesh(name)
    assert np.array_equal(V3, V) and polygons == F.tolist()
