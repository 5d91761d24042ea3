"""Types, documentation, version, and what the package says of itself."""

import doctest
import inspect
import os
import pathlib
import pickle
import re
import shutil
import subprocess
import sys
import zipfile

import pytest

import carat
import carat.compat.potpourri3d
import carat.compat.robust_laplacian

ROOT = pathlib.Path(__file__).resolve().parents[2]
PUBLIC = [name for name in carat.__all__ if name not in ("__version__", "Mesh")]


def run(cache, *arguments):
    package = pathlib.Path(carat.__file__).parent.parent
    done = subprocess.run(
        [sys.executable, "-m", *map(str, arguments)],
        capture_output=True,
        text=True,
        cwd=package,
        env={**os.environ, "MYPYPATH": str(package), "MYPY_CACHE_DIR": str(cache)},
        timeout=280,
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_types_of_the_package_and_examples(tmp_path):
    run(tmp_path, "mypy", "--strict", "--ignore-missing-imports", "carat",
        *sorted(ROOT.glob("examples/python/*.py")))


def test_stubs_are_those_of_the_compiled_part(tmp_path):
    settings = tmp_path / "mypy.ini"
    settings.write_text("[mypy]\nstrict = true\nignore_missing_imports = true\n")
    allowed = tmp_path / "allowed"
    allowed.write_text(
        # What a module imports is no part of it.
        r"carat\..*\.(Callable|Iterable|Iterator|Mapping|Sequence|field|Path|PathLike)(\..*)?" "\n"
        # Classes of pybind11 have a metaclass of their own, and no constructor here.
        r"carat\._core\.[A-Z]\w+(\.__init__)?" "\n"
    )
    run(tmp_path, "mypy.stubtest", "carat", "--mypy-config-file", settings, "--allowlist", allowed,
        "--ignore-unused-allowlist")


def test_documented_examples():
    result = doctest.testmod(carat)
    assert result.attempted > 10 and result.failed == 0
    for name in PUBLIC:
        thing = getattr(carat, name)
        tests = doctest.DocTestFinder().find(thing, name, globs={"carat": carat})
        runner = doctest.DocTestRunner()
        for test in tests:
            assert runner.run(test).failed == 0


@pytest.mark.parametrize("name", PUBLIC)
def test_documentation(name):
    thing = getattr(carat, name)
    text = inspect.getdoc(thing)
    assert text and text[0].isupper()
    if not callable(thing) or issubclass(type(thing), type) and issubclass(thing, Exception):
        return
    # Every parameter is described.
    if not text.startswith(name + "("):
        signature = inspect.signature(thing)
        takes_fields = getattr(thing, "__dataclass_fields__", {})
        for parameter in signature.parameters.values():
            if parameter.name in takes_fields or thing in (carat.View, carat.Discretization):
                continue
            assert re.search(rf"(^|[\s,*]){parameter.name}\b", text), parameter.name


@pytest.mark.parametrize("name", ["HeatGeodesics", "Poisson", "PolygonMesh", "PolyhedralMesh",
                                  "Discretization"])
def test_methods_are_documented(name):
    for key, member in vars(getattr(carat, name)).items():
        if key.startswith("_"):
            continue
        if isinstance(member, classmethod):
            member = member.__func__
        assert inspect.getdoc(member), key


def test_places():
    for name in PUBLIC:
        thing = getattr(carat, name)
        if hasattr(thing, "__module__"):
            assert thing.__module__ == "carat", name
    assert pickle.loads(pickle.dumps(carat.InvalidMesh("why", [3]))).elements == (3,)


def test_version_comes_from_one_place():
    cmake = (ROOT / "CMakeLists.txt").read_text()
    assert f"project(carat VERSION {carat.__version__} " in cmake
    others = (ROOT / "pyproject.toml").read_text() + (ROOT / "setup.py").read_text()
    assert carat.__version__ not in others


def test_wheel(tmp_path):
    """What pip makes: everything inside, with the licences, and importable from anywhere."""
    source = tmp_path / "source"
    source.mkdir()
    for name in ("setup.py", "pyproject.toml", "CMakeLists.txt", "README.md", "LICENSE",
                 "THIRD_PARTY.md"):
        shutil.copy(ROOT / name, source)
    shutil.copytree(ROOT / "python" / "carat", source / "python" / "carat",
                    ignore=shutil.ignore_patterns("__pycache__"))
    package = pathlib.Path(carat.__file__).parent
    environment = {**os.environ, "CARAT_BUILD_DIR": str(package.parents[1])}
    environment.pop("PYTHONPATH")
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check"]
    subprocess.run([*pip, "wheel", "--no-build-isolation", "--no-deps", "--no-index", "-w",
                    tmp_path, source], env=environment, check=True, timeout=250)
    wheel, = tmp_path.glob(f"carat-{carat.__version__}-*.whl")
    with zipfile.ZipFile(wheel) as archive:
        names = {name.rsplit("/", 1)[-1] for name in archive.namelist()}
        archive.extractall(tmp_path / "site")
    assert {"LICENSE", "THIRD_PARTY.md", "py.typed", "_core.pyi", "potpourri3d.py"} <= names
    done = subprocess.run(
        [sys.executable, "-c", "import carat; print(carat.__file__, carat.__version__)"],
        env={**environment, "PYTHONPATH": str(tmp_path / "site")}, cwd=tmp_path,
        capture_output=True, text=True, check=True,
    )
    assert done.stdout.split() == [str(tmp_path / "site/carat/__init__.py"), carat.__version__]


def test_errors_have_one_base():
    for name in PUBLIC:
        thing = getattr(carat, name)
        if isinstance(thing, type) and issubclass(thing, Exception):
            assert issubclass(thing, carat.Error)
