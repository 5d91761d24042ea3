"""Matrices: the properties that they must have, their memory, and what goes with them."""

import pickle

import numpy as np
import pytest
import scipy.sparse
import scipy.sparse.csgraph
import scipy.sparse.linalg

import carat

EPS = np.finfo(float).eps


def families(kind):
    return [family.name for family in carat.families(kind)]


def equal(a, b):
    """Bit by bit."""
    return (
        np.array_equal(a.indptr, b.indptr)
        and np.array_equal(a.indices, b.indices)
        and np.array_equal(a.data, b.data)
    )


@pytest.mark.parametrize("family", families("surface") + families("volume"))
def test_conventions(family):
    mesh = carat.generate(family, level=1, jitter=0.1)
    ops = carat.discretize(mesh)
    S, M, G, D = ops.stiffness, ops.mass, ops.gradient, ops.divergence
    ones = np.ones(mesh.n_vertices)
    size = abs(S).max()
    # Rows have at most a few hundred entries, each rounded.
    assert abs(S - S.T).max() <= 1e-13 * size
    assert np.abs(S @ ones).max() <= 1e-12 * size
    assert scipy.sparse.linalg.norm(ops.laplacian + S) == 0
    assert abs(D @ G + S).max() <= 1e-12 * size
    x = mesh.points[:, 0]
    assert x @ (S @ x) > 0
    assert M.sum() == pytest.approx(ops.sample_measure.sum(), rel=1e-12)
    assert ops.lumped_mass == pytest.approx(np.asarray(M.sum(axis=1)).ravel(), rel=1e-12)
    if isinstance(mesh, carat.PolyhedralMesh):
        # Linear precision: the gradient of x is (1, 0, 0), the Laplacian zero inside.
        vectors = ops.element_vectors(G @ x)
        assert np.abs(vectors - [1, 0, 0]).max() < 1e-10
        inner = np.setdiff1d(np.arange(mesh.n_vertices), mesh.boundary_vertices)
        assert np.abs((S @ x)[inner]).max(initial=0) <= 1e-11 * size
    assert ops.vertex_vectors(G @ x).shape == (mesh.n_vertices, 3)


def test_stiffness_hands_over(plane):
    S, M = carat.stiffness(plane)
    for matrix in (S, M):
        assert isinstance(matrix, scipy.sparse.csr_matrix)
        assert matrix.dtype == np.float64 and matrix.indices.dtype == np.int32
        assert matrix.data.flags.writeable and not matrix.data.flags.owndata
        assert matrix.has_sorted_indices and matrix.has_canonical_format
        matrix.check_format(full_check=True)
    ops = carat.discretize(plane)
    assert equal(S, ops.stiffness) and equal(M, ops.mass)


@pytest.mark.parametrize("name", [entry.name for entry in carat.operators("surface")])
def test_stiffness_and_discretize_agree_on_triangles(name):
    mesh = carat.generate("sphere-triangles", level=2, jitter=0.1)
    S, M = carat.stiffness(mesh, operator=name)
    ops = carat.discretize(mesh, operator=name)
    assert equal(S, ops.stiffness) and equal(M, ops.mass)


def test_matrices_share_the_memory(plane):
    ops = carat.discretize(plane)
    assert ops.stiffness is ops.stiffness
    assert np.shares_memory(ops.stiffness.data, ops._core.stiffness()[0])
    S = ops.stiffness
    entries = S.data.copy()
    del ops
    assert np.array_equal(S.data, entries)


def test_scipy_can_use_them(plane):
    S, M = carat.stiffness(plane)
    n_components, _ = scipy.sparse.csgraph.connected_components(S)
    assert n_components == 1
    scipy.sparse.linalg.splu((M + S).tocsc()).solve(np.ones(plane.n_vertices))
    S.data *= 2  # they are the caller's own


def test_bits_do_not_depend_on_threads(surface, volume):
    for mesh in (surface, volume):
        one = carat.discretize(mesh, threads=1)
        three = carat.discretize(mesh, threads=3)
        for name in ("stiffness", "mass", "gradient", "divergence"):
            assert equal(getattr(one, name), getattr(three, name))


def test_points_and_faces_as_well_as_a_mesh(surface):
    S, M = carat.stiffness(surface)
    S2, M2 = carat.stiffness(surface.points, surface.faces)
    assert equal(S, S2) and equal(M, M2)


def test_every_operator():
    names = {entry.name for entry in carat.operators()}
    assert {"diamond", "stabilized_diamond", "bunge", "cotan", "de_goes"} <= names
    triangles = carat.generate("sphere-triangles", level=1)
    tets = carat.generate("cube-tets", level=0)
    for entry in carat.operators():
        mesh = triangles if entry.kind == "surface" else tets
        for mass in entry.masses:
            ops = carat.discretize(mesh, operator=entry.name, mass=mass)
            assert ops.operator == entry.name and ops.mass_kind == mass
            assert (ops.n_unknowns == mesh.n_vertices) == entry.vertex_unknowns
            assert (ops.gradient_dimension > 0) == entry.gradient
            assert ops.unknown_positions.shape == (ops.n_unknowns, 3)
            if not entry.gradient:
                with pytest.raises(carat.InvalidOption, match="gradient"):
                    ops.gradient


def test_options_reach_the_operator(plane, surface):
    plain = carat.stiffness(surface)[0]
    assert not equal(plain, carat.stiffness(surface, virtual_point="centroid")[0])
    assert not equal(plain, carat.stiffness(surface, weights="minimum-norm")[0])
    lumped = carat.stiffness(plane, lumped=True)[1]
    assert (lumped - scipy.sparse.diags(lumped.diagonal())).nnz == 0
    assert equal(lumped, carat.stiffness(plane, mass="lumped")[1])
    half = carat.stiffness(plane, operator="stabilized_diamond", theta=0.5)[0]
    S, B = carat.stiffness(plane)[0], carat.stiffness(plane, operator="bunge")[0]
    assert abs(half - (S + B) / 2).max() < 1e-13 * abs(S).max()


def test_coefficients(volume, plane):
    S = carat.stiffness(volume)[0]
    size = abs(S).max()
    threes = np.full(volume.n_cells, 3.0)
    tensors = np.broadcast_to(3 * np.eye(3), (volume.n_cells, 3, 3))
    for coefficient in (3, threes, threes[:, None], tensors, lambda x: np.full(len(x), 3.0),
                        lambda x: 3.0):
        K = carat.stiffness(volume, coefficient=coefficient)[0]
        assert abs(K - 3 * S).max() <= 1e-13 * size
    six = np.tile([1.0, 2, 3, 0.1, 0.2, 0.3], (volume.n_cells, 1))
    full = np.tile([[1, 0.1, 0.3], [0.1, 2, 0.2], [0.3, 0.2, 3]], (volume.n_cells, 1, 1))
    assert equal(
        carat.stiffness(volume, coefficient=six)[0], carat.stiffness(volume, coefficient=full)[0]
    )
    # A function is called with all points at once, and once for preconditioners beside.
    calls = []

    def varying(x):
        calls.append(len(x))
        return 1 + x[:, 0]

    ops = carat.discretize(plane, coefficient=varying)
    assert calls == [ops.n_samples]
    x = plane.points[:, 0]
    # The energy of x is the integral of 1 + x over the unit square.
    assert x @ (ops.stiffness @ x) == pytest.approx(1.5, rel=1e-3)


def test_diagnostics():
    points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [9, 9, 9], [2, 0, 0]]
    ops = carat.discretize(points, [[0, 1, 2, 3], [0, 1, 5]])
    assert ops.diagnostics["unreferenced_vertices"].elements.tolist() == [4]
    assert ops.diagnostics["degenerate_faces"].elements.tolist() == [1]
    assert len(ops.diagnostics["degenerate_faces"]) == 1
    assert "face" in ops.diagnostics["degenerate_faces"].meaning
    with pytest.raises(carat.DegenerateElement) as caught:
        carat.discretize(points, [[0, 1, 2, 3], [0, 1, 5]], strict=True)
    assert caught.value.elements  # the samples without area


def test_pickle(volume):
    ops = carat.discretize(volume, operator="bunge", lumped=True)
    again = pickle.loads(pickle.dumps(ops))
    assert equal(again.stiffness, ops.stiffness) and equal(again.mass, ops.mass)
    assert again.mesh == ops.mesh


def test_repr(plane):
    text = repr(carat.discretize(plane))
    assert "diamond" in text and str(plane.n_vertices) in text
