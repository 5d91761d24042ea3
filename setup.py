"""Builds the extension module with CMake; everything else is in pyproject.toml.

CARAT_BUILD_DIR names a build tree that has been configured with -DCARAT_BUILD_PYTHON=ON already, to
build in instead of a new one.
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = Path(__file__).resolve().parent


def version():
    """CMakeLists.txt is the only place that has it."""
    text = (ROOT / "CMakeLists.txt").read_text()
    return re.search(r"project\(carat VERSION ([0-9.]+)", text).group(1)


class CMakeBuild(build_ext):
    def build_extension(self, ext):
        target = Path(self.get_ext_fullpath(ext.name)).resolve().parent
        configured = os.environ.get("CARAT_BUILD_DIR")
        build = Path(configured or Path(self.build_temp) / "cmake").resolve()
        if not configured:
            self.configure(build)
        jobs = str(self.parallel or os.cpu_count() or 1)
        subprocess.run(
            ["cmake", "--build", build, "--target", "carat_python", "--parallel", jobs], check=True
        )
        target.mkdir(parents=True, exist_ok=True)
        for module in (build / "python" / "carat").glob("_core*.so"):
            self.copy_file(str(module), str(target / module.name))

    def configure(self, build):
        build.mkdir(parents=True, exist_ok=True)
        options = [
            f"-DCMAKE_BUILD_TYPE={'Debug' if self.debug else 'Release'}",
            f"-DPython_EXECUTABLE={sys.executable}",
            "-DCARAT_BUILD_PYTHON=ON",
            "-DCARAT_BUILD_TESTS=OFF",
        ]
        generator = ["-G", "Ninja"] if shutil.which("ninja") else []
        subprocess.run(["cmake", ROOT, *generator, *options], cwd=build, check=True)


setup(
    version=version(),
    ext_modules=[Extension("carat._core", sources=[])],
    cmdclass={"build_ext": CMakeBuild},
)
