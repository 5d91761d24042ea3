"""Wrong calls: each raises the right class with a message that names what is wrong."""

import numpy as np
import pytest

import carat

SQUARE = [[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
FACES = [[0, 1, 2, 3]]
TET = [[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]


def square():
    return carat.PolygonMesh(SQUARE, FACES)


def tet():
    return carat.PolyhedralMesh(TET, [[0, 1, 2, 3]])


def sphere():
    return carat.generate("sphere-quads", level=1)


def two_squares():
    points = SQUARE + [[x + 5, y, z] for x, y, z in SQUARE]
    return carat.PolygonMesh(points, [[0, 1, 2, 3], [4, 5, 6, 7]])


class NoMesh:
    pass


# name: (call, class, also derived from, words of the message)
CALLS = {
    # shapes
    "points_transposed": (
        lambda: carat.PolygonMesh(np.zeros((3, 100)), FACES),
        carat.InvalidMesh, ValueError, ["(3, 100)", "(n, 3)", "transpose"],
    ),
    "points_flat": (
        lambda: carat.PolygonMesh(np.zeros(12), FACES),
        carat.InvalidMesh, ValueError, ["(12,)", "(n, 3)"],
    ),
    "points_of_four": (
        lambda: carat.PolygonMesh(np.zeros((5, 4)), FACES),
        carat.InvalidMesh, ValueError, ["(5, 4)", "(n, 3)"],
    ),
    "faces_flat": (
        lambda: carat.PolygonMesh(SQUARE, np.array([0, 1, 2, 3])),
        carat.InvalidMesh, ValueError, ["(4,)", "(m, k)", "offsets"],
    ),
    "faces_cubic": (
        lambda: carat.PolygonMesh(SQUARE, np.zeros((2, 2, 3), int)),
        carat.InvalidMesh, ValueError, ["(2, 2, 3)"],
    ),
    "faces_nested": (
        lambda: carat.PolygonMesh(SQUARE, [[[0, 1, 2]]]),
        carat.InvalidMesh, ValueError, ["nested"],
    ),
    "cells_of_five": (
        lambda: carat.PolyhedralMesh(TET, np.zeros((2, 5), int)),
        carat.InvalidMesh, ValueError, ["(2, 5)", "(n, 4)", "(n, 8)"],
    ),
    "right_hand_side_too_short": (
        lambda: carat.Poisson(square()).solve(np.ones(3), dirichlet=0),
        carat.InvalidOption, ValueError, ["(3,)", "(4,)"],
    ),
    "right_hand_side_of_columns": (
        lambda: carat.Poisson(square()).solve(np.ones((4, 2)), dirichlet=0),
        carat.InvalidOption, ValueError, ["(4, 2)", "(4,)"],
    ),
    "dirichlet_values_of_another_length": (
        lambda: carat.Poisson(square()).solve(1, dirichlet=([0, 1], [1.0, 2, 3])),
        carat.InvalidOption, ValueError, ["(3,)", "(2,)"],
    ),
    "field_of_another_length": (
        lambda: carat.write("unwritten.vtp", square(), vertex={"u": np.ones(5)}),
        carat.InvalidOption, ValueError, ['"u"', "(5,)", "4 vertices"],
    ),
    "element_vectors_of_another_length": (
        lambda: carat.discretize(square()).element_vectors(np.ones(5)),
        carat.InvalidOption, ValueError, ["5 values"],
    ),
    "coefficient_of_another_length": (
        lambda: carat.discretize(tet(), coefficient=np.ones(7)),
        carat.InvalidOption, ValueError, ["(7,)", "(1,)"],
    ),
    "with_other_number_of_points": (
        lambda: square().with_points(np.zeros((3, 3))),
        carat.InvalidMesh, ValueError, ["3", "4"],
    ),
    # types
    "points_of_words": (
        lambda: carat.PolygonMesh([["a", "b", "c"]], FACES),
        carat.InvalidType, TypeError, ["points", "real numbers"],
    ),
    "points_complex": (
        lambda: carat.PolygonMesh(np.zeros((4, 3), complex), FACES),
        carat.InvalidType, TypeError, ["complex128", "real"],
    ),
    "points_ragged": (
        lambda: carat.PolygonMesh([[0, 0, 0], [1, 0]], FACES),
        carat.InvalidOption, ValueError, ["points", "no array"],
    ),
    "faces_of_floats": (
        lambda: carat.PolygonMesh(SQUARE, np.array([[0.0, 1, 2, 3]])),
        carat.InvalidType, TypeError, ["float64", "integers", "astype"],
    ),
    "faces_a_number": (
        lambda: carat.PolygonMesh(SQUARE, 3),
        carat.InvalidType, TypeError, ["faces", "int"],
    ),
    "faces_a_word": (
        lambda: carat.PolygonMesh(SQUARE, "0 1 2"),
        carat.InvalidType, TypeError, ["faces", "str"],
    ),
    "faces_list_of_numbers": (
        lambda: carat.PolygonMesh(SQUARE, [0, 1, 2, 3]),
        carat.InvalidType, TypeError, ["entry 0", "list of numbers"],
    ),
    "cells_none": (
        lambda: carat.PolyhedralMesh(TET, None),
        carat.InvalidType, TypeError, ["cells", "NoneType", "(n, 4)"],
    ),
    "no_mesh": (
        lambda: carat.stiffness(NoMesh()),
        carat.InvalidType, TypeError, ["NoMesh", "no mesh"],
    ),
    "points_without_faces": (
        lambda: carat.stiffness(np.zeros((4, 3))),
        carat.InvalidType, TypeError, ["ndarray", "faces"],
    ),
    "none_for_a_mesh": (
        lambda: carat.HeatGeodesics(None),
        carat.InvalidType, TypeError, ["NoneType"],
    ),
    "count_no_number": (
        lambda: carat.eigenmodes(square(), k=2.5),
        carat.InvalidType, TypeError, ["k", "2.5", "whole"],
    ),
    "threads_no_number": (
        lambda: carat.stiffness(square(), threads="all"),
        carat.InvalidType, TypeError, ["threads", "'all'"],
    ),
    "mask_for_sources": (
        lambda: carat.HeatGeodesics(square()).distance(np.array([True, False, False, False])),
        carat.InvalidType, TypeError, ["bool", "flatnonzero"],
    ),
    "one_number_for_many_sources": (
        lambda: carat.HeatGeodesics(square()).distance_many(3),
        carat.InvalidType, TypeError, ["3", "[[0], [1]]"],
    ),
    "dirichlet_a_word": (
        lambda: carat.Poisson(square()).solve(1, dirichlet=[1, 2, 3]),
        carat.InvalidType, TypeError, ["dirichlet", "list", "(vertices, values)"],
    ),
    "fields_no_dictionary": (
        lambda: carat.write("unwritten.vtp", square(), vertex=np.ones(4)),
        carat.InvalidType, TypeError, ["vertex", "ndarray", '{"u": u}'],
    ),
    "coefficient_returns_words": (
        lambda: carat.discretize(square(), coefficient=lambda x: "one"),
        carat.InvalidOption, ValueError, ["coefficient", "str", "one number"],
    ),
    "coefficient_returns_too_few": (
        lambda: carat.discretize(square(), coefficient=lambda x: np.ones(3)),
        carat.InvalidOption, ValueError, ["3 values", "points"],
    ),
    # values
    "point_nan": (
        lambda: carat.PolygonMesh([[0, 0, 0], [1, 0, np.nan], [1, 1, 0]], [[0, 1, 2]]),
        carat.InvalidMesh, ValueError, ["vertex 1", "nan"],
    ),
    "right_hand_side_nan": (
        lambda: carat.Poisson(square()).solve([1, np.nan, 1, 1], dirichlet=([0], 0)),
        carat.InvalidOption, ValueError, ["not finite"],
    ),
    "dirichlet_infinite": (
        lambda: carat.Poisson(square()).solve(1, dirichlet={2: np.inf}),
        carat.InvalidOption, ValueError, ["vertex 2", "inf"],
    ),
    "coefficient_negative": (
        lambda: carat.discretize(square(), coefficient=-1.0),
        carat.InvalidOption, ValueError, ["coefficient", "-1"],
    ),
    "tensor_not_symmetric": (
        lambda: carat.discretize(tet(), coefficient=[[[1, 2, 0], [0, 1, 0], [0, 0, 1]]]),
        carat.InvalidOption, ValueError, ["symmetric"],
    ),
    "time_step_zero": (
        lambda: carat.HeatGeodesics(square(), t_coef=0),
        carat.InvalidOption, ValueError, ["t_coef", "positive"],
    ),
    "count_zero": (
        lambda: carat.eigenmodes(square(), k=0),
        carat.InvalidOption, ValueError, ["k", "0", "at least 1"],
    ),
    "count_above_vertices": (
        lambda: carat.eigenmodes(square(), k=5),
        carat.InvalidOption, ValueError, ["5", "4"],
    ),
    "threads_negative": (
        lambda: carat.stiffness(square(), threads=-2),
        carat.InvalidOption, ValueError, ["threads", "-2"],
    ),
    "threads_too_many": (
        lambda: carat.stiffness(square(), threads=10**9),
        carat.InvalidOption, ValueError, ["threads", str(10**9), "1024"],
    ),
    "theta_above_one": (
        lambda: carat.stiffness(square(), operator="stabilized_diamond", theta=1.5),
        carat.InvalidOption, ValueError, ["theta", "1.5"],
    ),
    # indices
    "face_out_of_range": (
        lambda: carat.PolygonMesh(SQUARE, [[0, 1, 2], [0, 2, 4]]),
        carat.InvalidMesh, ValueError, ["face 1", "4"],
    ),
    "face_negative": (
        lambda: carat.PolygonMesh(SQUARE, [[0, -2, 2]]),
        carat.InvalidMesh, ValueError, ["-2"],
    ),
    "face_beyond_32_bits": (
        lambda: carat.PolygonMesh(SQUARE, np.array([[0, 1, 2**40]])),
        carat.InvalidMesh, ValueError, [str(2**40)],
    ),
    "face_unsigned_64_bits": (
        lambda: carat.PolygonMesh(SQUARE, np.array([[0, 1, 2**64 - 1]], dtype=np.uint64)),
        carat.InvalidMesh, ValueError, [str(2**64 - 1)],
    ),
    "face_of_two": (
        lambda: carat.PolygonMesh(SQUARE, [[0, 1, 2], [1, 2]]),
        carat.InvalidMesh, ValueError, ["face 1", "2"],
    ),
    "padding_inside": (
        lambda: carat.PolygonMesh(SQUARE, np.array([[0, -1, 1, 2]])),
        carat.InvalidMesh, ValueError, ["row 0", "-1"],
    ),
    "offsets_descend": (
        lambda: carat.PolygonMesh(SQUARE, (np.array([0, 1, 2, 3]), np.array([0, 4, 3, 4]))),
        carat.InvalidMesh, ValueError, ["offset"],
    ),
    "offsets_beyond": (
        lambda: carat.PolygonMesh(SQUARE, (np.array([0, 1, 2, 3]), np.array([0, 9]))),
        carat.InvalidMesh, ValueError, ["offsets", "4"],
    ),
    "source_out_of_range": (
        lambda: carat.HeatGeodesics(square()).distance(4),
        carat.InvalidOption, ValueError, ["4", "3"],
    ),
    "source_negative": (
        lambda: carat.HeatGeodesics(square()).distance_many([[0], [-1]]),
        carat.InvalidOption, ValueError, ["source set 1", "-1"],
    ),
    "no_source": (
        lambda: carat.HeatGeodesics(square()).distance([]),
        carat.InvalidOption, ValueError, ["source"],
    ),
    "dirichlet_vertex_out_of_range": (
        lambda: carat.Poisson(square()).solve(1, dirichlet=([0, 99], 0)),
        carat.InvalidOption, ValueError, ["99", "3"],
    ),
    "neumann_side_inside": (
        lambda: carat.Poisson(carat.generate("plane-quads", level=1)).solve(
            0, dirichlet=([0], 0), neumann={100: 1.0}
        ),
        carat.InvalidOption, ValueError, ["edge 100", "boundary"],
    ),
    "unknown_patch": (
        lambda: carat.Poisson(tet()).solve(0, dirichlet={"inlet": 1.0}),
        carat.InvalidOption, ValueError, ["'inlet'", "none"],
    ),
    # meshes that cannot be
    "tet_not_closed": (
        lambda: carat.PolyhedralMesh(TET, [[[0, 1, 2], [0, 1, 3], [0, 2, 3], [0, 1, 2]]]),
        carat.InvalidMesh, ValueError, ["cell 0"],
    ),
    "cell_of_three_faces": (
        lambda: carat.PolyhedralMesh(TET, [[[0, 1, 2], [0, 1, 3], [0, 2, 3]]]),
        carat.InvalidMesh, ValueError, ["cell 0", "3"],
    ),
    "vtk_type_unknown": (
        lambda: carat.PolyhedralMesh.from_vtk(TET, [4, 0, 1, 2, 3], [24]),
        carat.InvalidMesh, ValueError, ["cell 0", "24", "polyhedron"],
    ),
    "vtk_list_too_short": (
        lambda: carat.PolyhedralMesh.from_vtk(TET, [4, 0, 1], [10]),
        carat.InvalidMesh, ValueError, ["cell 0", "4"],
    ),
    "no_face_with_area": (
        lambda: carat.discretize([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]], strict=True),
        carat.DegenerateElement, ValueError, ["0", "leave out strict=True"],
    ),
    "nothing_to_measure_from": (
        lambda: carat.HeatGeodesics([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]]).distance(0),
        carat.Error, Exception, ["0"],
    ),
    "dual_of_three_faces_at_an_edge": (
        lambda: carat.PolygonMesh(
            [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1]],
            [[0, 1, 2], [0, 1, 3], [0, 1, 4]],
        ).dual(),
        carat.InvalidMesh, ValueError, ["edge"],
    ),
    # options
    "operator_unknown": (
        lambda: carat.stiffness(square(), operator="diamon"),
        carat.InvalidOption, ValueError, ["diamon", "diamond", "bunge"],
    ),
    "operator_of_volumes": (
        lambda: carat.stiffness(square(), operator="ceve"),
        carat.InvalidOption, ValueError, ["ceve", "diamond"],
    ),
    "operator_of_triangles": (
        lambda: carat.stiffness(square(), operator="cotan"),
        carat.InvalidMesh, ValueError, ["face 0", "4"],
    ),
    "operator_no_word": (
        lambda: carat.stiffness(square(), operator=7),
        carat.InvalidType, TypeError, ["operator", "7"],
    ),
    "option_misspelt": (
        lambda: carat.stiffness(square(), virtual_points="area"),
        carat.InvalidType, TypeError, ["'virtual_points'", "virtual_point"],
    ),
    "virtual_point_unknown": (
        lambda: carat.discretize(square(), virtual_point="middle"),
        carat.InvalidOption, ValueError, ["middle", "area", "centroid"],
    ),
    "virtual_point_without_use": (
        lambda: carat.discretize(SQUARE, [[0, 1, 2]], operator="cotan", virtual_point="area"),
        carat.InvalidOption, ValueError, ["cotan", "virtual"],
    ),
    "mass_unknown": (
        lambda: carat.discretize(square(), mass="heavy"),
        carat.InvalidOption, ValueError, ["heavy", "lumped"],
    ),
    "mass_contradiction": (
        lambda: carat.discretize(square(), mass="full", lumped=True),
        carat.InvalidOption, ValueError, ["full", "lumped"],
    ),
    "solver_unknown": (
        lambda: carat.Poisson(square(), solver="magic"),
        carat.InvalidOption, ValueError, ["magic", "cholesky"],
    ),
    "faces_beside_a_mesh": (
        lambda: carat.stiffness(square(), FACES),
        carat.InvalidOption, ValueError, ["faces", "leave them out"],
    ),
    "curvature_of_a_volume": (
        lambda: carat.mean_curvature(tet()),
        carat.InvalidType, TypeError, ["surfaces", "boundary_surface"],
    ),
    "boundary_of_a_closed_surface": (
        lambda: carat.Poisson(sphere()).solve(1, dirichlet=0),
        carat.InvalidOption, ValueError, ["no boundary"],
    ),
    "family_unknown": (
        lambda: carat.generate("sphere-octagons"),
        carat.InvalidOption, ValueError, ["sphere-octagons", "sphere-hexagons", "cube-voronoi"],
    ),
    "level_too_deep": (
        lambda: carat.generate("sphere-quads", level=40),
        carat.InvalidOption, ValueError, ["level", "40"],
    ),
    "kind_unknown": (
        lambda: carat.families("line"),
        carat.InvalidOption, ValueError, ["'line'", "surface"],
    ),
    # files
    "file_missing": (
        lambda: carat.read("no/such/file.obj"),
        carat.IoError, OSError, ["no/such/file.obj"],
    ),
    "path_no_path": (
        lambda: carat.read(7),
        carat.InvalidType, TypeError, ["path", "int"],
    ),
    "format_unknown": (
        lambda: carat.write("mesh.xyz", square()),
        carat.IoError, OSError, ["mesh.xyz", ".obj"],
    ),
    "folder_missing": (
        lambda: carat.write("no/such/folder/mesh.obj", square()),
        carat.IoError, OSError, ["no/such/folder/mesh.obj"],
    ),
    "cells_of_a_surface": (
        lambda: carat.write("unwritten.vtp", square(), cell={"u": [1.0]}),
        carat.InvalidOption, ValueError, ["cell", "face="],
    ),
    "fields_in_a_format_without": (
        lambda: carat.write("unwritten.obj", square(), vertex={"u": np.ones(4)}),
        carat.InvalidOption, ValueError, ["unwritten.obj", ".vtp"],
    ),
    # problems without a solution
    "floating_data_out_of_balance": (
        lambda: carat.Poisson(square()).solve(1.0),
        carat.SolverFailure, RuntimeError, ["balance", "Dirichlet"],
    ),
    "two_dirichlet_values": (
        lambda: carat.Poisson(square()).solve(0, dirichlet=([0, 0], [1.0, 2.0])),
        carat.InvalidOption, ValueError, ["vertex 0", "two values"],
    ),
    "report_before_any_solution": (
        lambda: carat.Poisson(square()).report,
        carat.InvalidOption, ValueError, ["solve()"],
    ),
}


@pytest.mark.parametrize("name", CALLS)
def test_wrong_call(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    call, kind, builtin, words = CALLS[name]
    with pytest.raises(carat.Error) as caught:
        call()
    error = caught.value
    assert isinstance(error, kind), (type(error), error)
    assert isinstance(error, builtin)
    message = str(error)
    assert "\n" not in message
    for word in words:
        assert word in message, message
    assert isinstance(error.elements, tuple)
    assert list(tmp_path.iterdir()) == []  # nothing half-written


def test_there_are_forty():
    assert len(CALLS) >= 40


def test_elements_are_named():
    with pytest.raises(carat.InvalidMesh) as caught:
        carat.PolygonMesh(SQUARE, [[0, 1, 2], [0, 2, 4]])
    assert caught.value.elements


def test_exceptions_of_callbacks_arrive():
    class Own(Exception):
        pass

    def fails(x):
        raise Own("mine")

    with pytest.raises(Own, match="mine"):
        carat.discretize(square(), coefficient=fails)
    with pytest.raises(Own, match="mine"):
        carat.Poisson(square()).solve(fails)
    with pytest.raises(Own, match="mine"):
        carat.HeatGeodesics(sphere()).distance_many([[0], [1]], progress=fails)
