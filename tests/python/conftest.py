"""What the tests of the Python package share."""

import os
import subprocess

import pytest

import carat


@pytest.fixture(scope="session")
def program():
    """Runs the program carat."""
    path = os.environ["CARAT_PROGRAM"]

    def run(*arguments):
        done = subprocess.run(
            [path, *map(str, arguments)], capture_output=True, text=True, timeout=300
        )
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run


@pytest.fixture(scope="session")
def surface():
    return carat.generate("sphere-hexagons", level=2, jitter=0.1)


@pytest.fixture(scope="session")
def plane():
    return carat.generate("plane-voronoi", level=1)


@pytest.fixture(scope="session")
def volume():
    return carat.generate("cube-voronoi", level=1)
