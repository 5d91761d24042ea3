"""Geodesics, Poisson, eigenmodes, curvature: known answers, many right-hand sides, reuse."""

import pickle
import threading
import time

import numpy as np
import pytest

import carat


def test_distance_on_the_sphere():
    mesh = carat.generate("sphere-quads", level=4)
    heat = carat.HeatGeodesics(mesh)
    exact = np.arccos(np.clip(mesh.points @ mesh.points[0], -1, 1))
    assert np.abs(heat.distance(0) - exact).max() < 0.05
    both = heat.distance([0, 17])
    assert np.abs(both - np.minimum(heat.distance(0), heat.distance(17))).max() < 0.1
    assert "stabilized_diamond" in repr(heat)
    assert heat.unresolved_samples == 0 and heat.solver["method"]
    assert set(heat.diagnostics) and heat.time_step > 0


@pytest.mark.parametrize("kind", ["surface", "volume"])
def test_many_distances_are_the_single_ones(kind, request):
    mesh = request.getfixturevalue(kind)
    heat = carat.HeatGeodesics(mesh, expected_sources=20)
    seen = []
    many = heat.distance_many([[0], 1, [2, 3]] * 7, progress=seen.append)
    assert many.shape == (21, mesh.n_vertices) and seen[-1] == 21
    for row, sources in zip(many, [[0], [1], [2, 3]]):
        single = heat.distance(sources)
        assert np.abs(row - single).max() <= 1e-10 * single.max()


def test_options_of_geodesics(surface):
    plain = carat.HeatGeodesics(surface)
    assert carat.HeatGeodesics(surface, t_coef=2).time_step == pytest.approx(2 * plain.time_step)
    assert carat.HeatGeodesics(surface, edge_length="mean").time_step < plain.time_step
    elements = carat.HeatGeodesics(surface, directions="elements").distance(0)
    assert elements == pytest.approx(plain.distance(0), abs=0.2)
    weighted = plain.distance([0, 5], weights=[1.0, 100.0])
    assert not np.array_equal(weighted, plain.distance([0, 5]))
    with pytest.raises(carat.InvalidOption, match="coefficient"):
        carat.HeatGeodesics(surface, coefficient=2.0)


def test_unreachable_vertices_are_infinitely_far():
    points = [[0, 0], [1, 0], [0, 1], [5, 0], [6, 0], [5, 1], [9, 9]]
    distance = carat.HeatGeodesics(points, [[0, 1, 2], [3, 4, 5]]).distance(0)
    assert np.isfinite(distance[:3]).all() and np.isinf(distance[3:]).all()


def error_of(level):
    """Largest error of Poisson's equation on the unit square."""
    mesh = carat.generate("plane-quads", level=level)
    solve = carat.Poisson(mesh).solve
    exact = lambda x: np.sin(np.pi * x[:, 0]) * np.cos(np.pi * x[:, 1])
    u = solve(lambda x: 2 * np.pi**2 * exact(x), dirichlet=exact)
    return np.abs(u - exact(mesh.points)).max()


def test_poisson_converges():
    errors = [error_of(level) for level in (2, 3, 4)]
    assert errors[0] / errors[1] > 3.2 and errors[1] / errors[2] > 3.2


def test_forms_of_conditions_agree(plane):
    poisson = carat.Poisson(plane)
    rim = plane.boundary_vertices
    expected = poisson.solve(1.0, dirichlet=(rim, 2.0))
    for dirichlet in (
        2.0,
        lambda x: np.full(len(x), 2.0),
        (rim, np.full(len(rim), 2.0)),
        (rim.astype(np.int64), lambda x: 2.0),
        {int(v): 2.0 for v in rim},
    ):
        assert np.array_equal(poisson.solve(1.0, dirichlet=dirichlet), expected)
    ones = np.ones(plane.n_vertices)
    for f in (1, ones, ones.astype(np.float32), lambda x: ones):
        assert np.array_equal(poisson.solve(f, dirichlet=2.0), expected)
    load = carat.stiffness(plane, operator=poisson.operator)[1] @ ones
    assert poisson.solve(load, dirichlet=2.0, integrated=True) == pytest.approx(expected, rel=1e-12)


def test_a_factorisation_is_kept(plane, monkeypatch):
    poisson = carat.Poisson(plane)
    made = []
    original = carat._core.poisson
    monkeypatch.setattr(
        carat._core, "poisson", lambda *arguments: made.append(1) or original(*arguments)
    )
    rim = plane.boundary_vertices
    for value in (0.0, 1.0, 2.0):
        u = poisson.solve(value, dirichlet=(rim, value))
        fresh = carat.Poisson(plane).solve(value, dirichlet=(rim, value))
        assert np.array_equal(u, fresh)
    assert len(made) == 1 + 3  # the fresh ones are their own
    poisson.solve(0.0, dirichlet=(rim[:3], 1.0))
    assert len(made) == 5


def test_neumann_and_robin(volume):
    top = volume.boundary_sides
    centres = np.array(
        [volume.points[volume.faces[f]].mean(axis=0) for f in top]
    )
    upper, lower = top[centres[:, 2] > 1 - 1e-9], top[centres[:, 2] < 1e-9]
    mesh = carat.PolyhedralMesh.from_faces(volume.points, volume.faces, volume.cells)
    mesh.patches.update(floor=lower, ceiling=upper)
    poisson = carat.Poisson(mesh)
    z = mesh.points[:, 2]
    # u = z: flux 1 in through the ceiling.
    u = poisson.solve(0.0, dirichlet={"floor": 0.0}, neumann={"ceiling": 1.0})
    assert np.abs(u - z).max() < 1e-9
    u = poisson.solve(0.0, dirichlet={"floor": 0.0}, neumann=(upper, np.ones(len(upper))))
    assert np.abs(u - z).max() < 1e-9
    # u = z: du/dn + 2 u = 1 + 2 at the ceiling.
    u = poisson.solve(0.0, dirichlet={"floor": 0.0}, robin=(upper, 2.0, 3.0))
    assert np.abs(u - z).max() < 1e-9
    u = poisson.solve(0.0, dirichlet={"floor": 0.0}, robin=("ceiling", 2.0, 3.0))
    assert np.abs(u - z).max() < 1e-9
    assert poisson.report.residual < 1e-10 and poisson.report.floating_components == 0


def test_floating_components_have_mean_zero(surface):
    poisson = carat.Poisson(surface)
    u = poisson.solve(surface.points[:, 0])
    mass = carat.stiffness(surface, operator=poisson.operator)[1]
    assert abs((mass @ u).sum()) < 1e-12
    assert poisson.report.floating_components == 1


def test_unknowns_beyond_the_vertices():
    mesh = carat.generate("cube-hexahedra", level=1)
    poisson = carat.Poisson(mesh, operator="cevefe")
    assert poisson.n_unknowns > mesh.n_vertices
    u = poisson.solve(0.0, dirichlet=lambda x: x[:, 0] + 2 * x[:, 1])
    at = carat.discretize(mesh, operator="cevefe").unknown_positions
    assert np.abs(u - at[:, 0] - 2 * at[:, 1]).max() < 1e-10


def test_matrix_free_is_the_same():
    mesh = carat.generate("cube-truncated", level=2)
    u = carat.Poisson(mesh, solver="multigrid").solve(1.0, dirichlet=0.0)
    assert u == pytest.approx(
        carat.Poisson(mesh, solver="cholesky").solve(1.0, dirichlet=0.0), abs=1e-9
    )


def test_eigenmodes():
    mesh = carat.generate("sphere-hexagons", level=3)
    progress = []
    modes = carat.eigenmodes(mesh, k=16, progress=progress.append)
    lam, U = modes
    assert np.array_equal(lam, modes.values) and np.all(np.diff(lam) >= 0)
    exact = np.repeat([0, 2, 6, 12], [1, 3, 5, 7])
    assert lam == pytest.approx(exact, abs=0.05)
    M = carat.stiffness(mesh, operator="stabilized_diamond", mass="moment-exact")[1]
    assert np.abs(U.T @ (M @ U) - np.eye(16)).max() < 1e-10
    assert modes.residuals.max() < 1e-9 and modes.zero_modes == 1
    assert "16 on" in repr(modes) and progress[-1] == 16
    again = pickle.loads(pickle.dumps(modes))
    assert np.array_equal(again.vectors, U)
    assert np.array_equal(carat.eigenmodes(mesh, k=16).vectors, U)


def test_eigenmodes_with_dirichlet_data(volume):
    lam, U = carat.eigenmodes(volume, k=2, dirichlet=True)
    assert lam[0] == pytest.approx(3 * np.pi**2, rel=0.1)
    assert np.abs(U[volume.boundary_vertices]).max() == 0
    some, _ = carat.eigenmodes(volume, k=1, dirichlet=volume.boundary_vertices[:10])
    assert 0 < some[0] < lam[0]


def test_curvature():
    mesh = carat.generate("sphere-hexagons", level=3)
    H = carat.mean_curvature(2 * mesh.points, mesh.faces, signed=True)
    assert H == pytest.approx(np.full(mesh.n_vertices, 0.5), abs=0.02)
    inside_out = carat.PolygonMesh(mesh.points, [face[::-1] for face in mesh.faces])
    assert carat.mean_curvature(inside_out, signed=True) == pytest.approx(-2 * H, rel=1e-9)
    assert np.all(carat.mean_curvature(inside_out) > 0)


def test_solvers_are_not_pickled(surface):
    for thing in (carat.HeatGeodesics(surface), carat.Poisson(surface)):
        with pytest.raises(TypeError, match="pickle"):
            pickle.dumps(thing)


def test_other_threads_go_on():
    """Python's lock is released: a counter counts while the library works."""
    mesh = carat.generate("plane-triangles", level=5)
    counted = []
    stop = threading.Event()

    def count():
        while not stop.is_set():
            counted.append(time.perf_counter())
            time.sleep(0.001)

    counter = threading.Thread(target=count)
    counter.start()
    start = time.perf_counter()
    carat.eigenmodes(mesh, k=30, threads=1)
    end = time.perf_counter()
    stop.set()
    counter.join()
    inside = [t for t in counted if start < t < end]
    assert len(inside) >= 5


def test_several_threads_at_once(surface, volume):
    """One solver, and one mesh whose connectivity is not derived yet, used by four threads."""
    heat = carat.HeatGeodesics(surface)
    expected = [heat.distance(v) for v in range(4)]
    fresh = carat.PolyhedralMesh.from_faces(volume.points, volume.faces, volume.cells)
    results = [None] * 4

    def work(v):
        results[v] = heat.distance(v), carat.stiffness(fresh)[0]

    threads = [threading.Thread(target=work, args=(v,)) for v in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for v, (distance, S) in enumerate(results):
        assert np.array_equal(distance, expected[v])
        assert (S != results[0][1]).nnz == 0
