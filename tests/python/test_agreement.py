"""The same numbers from Python, from C++ and from the program: to the last bit."""

import json
import os
import subprocess

import numpy as np
import pytest
import scipy.io
import scipy.sparse

import carat

FAMILIES = [
    "sphere-triangles",
    "sphere-quads",
    "sphere-hexagons",
    "sphere-concave",
    "plane-voronoi",
    "cube-tets",
    "cube-hexahedra",
    "cube-voronoi",
    "cube-pyramids",
]


SURFACES = FAMILIES[:5]
OPEN = [name for name in FAMILIES if not name.startswith("sphere")]


@pytest.fixture(scope="module", params=FAMILIES)
def file(request, tmp_path_factory):
    """A mesh in a file that keeps every bit."""
    mesh = carat.generate(request.param, level=1, jitter=0.1)
    kind = "vtp" if isinstance(mesh, carat.PolygonMesh) else "ovm"
    path = tmp_path_factory.mktemp("meshes") / f"{request.param}.{kind}"
    carat.write(path, mesh)
    return path


@pytest.mark.parametrize("operator", ["diamond", "stabilized_diamond", "bunge", "vem"])
def test_matrices_of_cpp(file, operator, tmp_path):
    subprocess.run(
        [os.environ["CARAT_DUMP_MATRICES"], file, operator, tmp_path], check=True, timeout=100
    )
    for name, matrix in zip(
        ("stiffness", "mass"), carat.stiffness(carat.read(file), operator=operator)
    ):
        for part in ("data", "indices", "indptr"):
            ours = getattr(matrix, part)
            theirs = np.fromfile(tmp_path / f"{name}.{part}", dtype=ours.dtype)
            assert np.array_equal(ours, theirs), (name, part)


def test_matrices_of_the_program(file, tmp_path, program):
    program("operators", file, "-o", tmp_path / "matrices")
    ops = carat.discretize(carat.read(file))
    for name in ("stiffness", "mass", "gradient", "divergence"):
        theirs = scipy.io.mmread(tmp_path / "matrices" / f"{name}.mtx").tocsr()
        ours = getattr(ops, name)
        if name in ("stiffness", "mass"):
            # Of symmetric matrices the file holds the lower triangle.
            ours = scipy.sparse.tril(ours, format="csr")
            theirs = scipy.sparse.tril(theirs, format="csr")
        theirs.sort_indices()
        ours.sort_indices()
        assert np.array_equal(ours.indices, theirs.indices), name
        assert np.array_equal(ours.data, theirs.data), name


def field(path, name):
    return carat.read(path).vertex_data[name]


def written(file, tmp_path):
    return tmp_path / ("out.vtp" if file.suffix == ".vtp" else "out.vtu")


def test_geodesics(file, tmp_path, program):
    out = written(file, tmp_path)
    program("geodesics", file, "--source", 0, "--source", 5, "-o", out)
    ours = carat.HeatGeodesics(carat.read(file)).distance([0, 5])
    # The program asks for frames beside the gradient; the numbers are the same.
    assert np.array_equal(ours, field(out, "distance"))


def test_eigenmodes(file, program):
    report = json.loads(program("eigen", file, "-k", 6, "--json"))
    assert carat.eigenmodes(carat.read(file), k=6).values.tolist() == report["eigenvalues"]


@pytest.mark.parametrize("file", OPEN, indirect=True)
def test_poisson(file, tmp_path, program):
    mesh = carat.read(file)
    out = written(file, tmp_path)
    program("poisson", file, "--rhs", "1", "--dirichlet", "0", "-o", out)
    ours = carat.Poisson(mesh).solve(1.0, dirichlet=0.0)
    assert np.array_equal(ours, field(out, "u"))


@pytest.mark.parametrize("file", SURFACES, indirect=True)
def test_curvature(file, tmp_path, program):
    mesh = carat.read(file)
    program("curvature", file, "--signed", "-o", tmp_path / "out.vtp")
    ours = carat.mean_curvature(mesh, signed=True)
    assert np.array_equal(ours, field(tmp_path / "out.vtp", "mean_curvature"))


def test_statistics(file, program):
    report = json.loads(program("info", file, "--json"))
    statistics = carat.read(file).statistics()
    for name in ("vertices", "edges", "faces"):
        assert statistics[name] == report["sizes"][name]


def test_names(program):
    report = json.loads(program("list", "families", "--json"))
    text = json.dumps(report)
    assert all(family.name in text for family in carat.families())
    text = program("list", "operators", "--json")
    assert all(entry.name in text for entry in carat.operators())


def test_version(program):
    assert carat.__version__ in program("--version")
