"""Installs a build, moves it elsewhere and uses it from outside, as another project would.

Usage: test_install.py SOURCE BUILD WITH_IO(0|1) CMAKE GENERATOR CXX_COMPILER MPIRUN(none: without distributed)
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE, BUILD, WITH_IO, CMAKE, GENERATOR, COMPILER, MPIRUN = sys.argv[1:8]
SOURCE = pathlib.Path(SOURCE)
WITH_IO = WITH_IO == "1"


def run(*command):
    return subprocess.run([str(word) for word in command], capture_output=True, text=True)


class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="carat-package-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        first = cls.folder / "installed"
        done = run(CMAKE, "--install", BUILD, "--prefix", first)
        if done.returncode != 0:
            raise AssertionError(f"cmake --install: {done.stdout}{done.stderr}")
        cls.prefix = cls.folder / "moved"
        first.rename(cls.prefix)

    def configure(self, source, name, *options):
        return run(CMAKE, "-S", source, "-B", self.folder / name, "-G", GENERATOR,
                   f"-DCMAKE_CXX_COMPILER={COMPILER}", f"-DCMAKE_PREFIX_PATH={self.prefix}",
                   *options)

    def succeed(self, *command):
        done = run(*command)
        self.assertEqual(done.returncode, 0, f"{command}:\n{done.stdout}{done.stderr}")
        return done.stdout

    def core_only(self, name, components="core"):
        return self.configure(SOURCE / "tests/package/core_only", name,
                              f"-DCARAT_COMPONENTS={components}", f"-DCARAT_PREFIX={self.prefix}",
                              f"-DCARAT_EXAMPLES={SOURCE / 'examples'}")

    def build(self, configured, name):
        self.assertEqual(configured.returncode, 0, configured.stdout + configured.stderr)
        self.succeed(CMAKE, "--build", self.folder / name)

    def sample_run(self, example):
        """The output that the header of an example promises."""
        text = (SOURCE / "examples" / f"{example}.cpp").read_text()
        block = re.search(r"^// Sample run: .*\n((?://   .*\n)+)", text, re.M)
        return "".join(line[5:] + "\n" for line in block.group(1).splitlines())

    def test_core_alone(self):
        self.build(self.core_only("core"), "core")
        self.assertEqual(self.succeed(self.folder / "core/laplacian"),
                         self.sample_run("laplacian"))

    @unittest.skipUnless(WITH_IO, "built without io")
    def test_examples(self):
        self.build(self.configure(SOURCE / "examples", "examples"), "examples")
        programs = self.folder / "examples"
        for example in "laplacian", "poisson", "eigenmodes":
            self.assertEqual(self.succeed(programs / example), self.sample_run(example))
        mesh, result = self.folder / "sphere.ply", self.folder / "distance.vtp"
        carat = self.prefix / "bin/carat"
        self.succeed(carat, "generate", "sphere-hexagons", "--level", 2, "-o", mesh)
        output = self.succeed(programs / "geodesics", mesh, result, 0)
        largest = float(output.split()[-1])
        # pi on the exact sphere; the method's error at this level is a few percent.
        self.assertTrue(2.9 < largest < 3.3, output)
        self.assertGreater(result.stat().st_size, 1000)
        failed = run(programs / "geodesics", self.folder / "none.ply", result)
        self.assertEqual(failed.returncode, 3)
        self.assertIn("none.ply", failed.stderr)

    @unittest.skipIf(MPIRUN == "none", "built without PETSc, SLEPc, MPI or Scotch")
    def test_several_processes(self):
        self.build(self.configure(SOURCE / "examples/distributed", "distributed"), "distributed")
        carat, mesh = self.prefix / "bin/carat", self.folder / "ball.vtu"
        self.succeed(carat, "generate", "ball-voronoi", "--level", 2, "-o", mesh)
        self.succeed(carat, "partition", mesh, "-n", 4, "-o", self.folder / "parts")
        os.environ.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                          OMPI_MCA_rmaps_base_oversubscribe="1",
                          OMPI_MCA_mpi_yield_when_idle="1")
        program = self.folder / "distributed/poisson"
        self.assertEqual(self.succeed(MPIRUN, "-np", 4, program, self.folder / "parts/mesh.pvtu"),
                         self.sample_run("distributed/poisson"))
        failed = run(MPIRUN, "-np", 3, program, self.folder / "parts/mesh.pvtu")
        self.assertEqual(failed.returncode, 3, failed.stderr)
        self.assertEqual(failed.stderr.count("poisson: "), 1, failed.stderr)

    def test_a_missing_component_is_named(self):
        failed = self.core_only("volume", "core;volume")
        self.assertNotEqual(failed.returncode, 0)
        self.assertRegex(" ".join(failed.stderr.split()),
                         r"no component 'volume', only: core")

    def test_io_that_was_not_built_is_named(self):
        for targets in self.prefix.glob("lib*/**/caratIoTargets*.cmake"):
            hidden = targets.with_suffix(".hidden")
            targets.rename(hidden)
            self.addCleanup(hidden.rename, targets)
        failed = self.configure(SOURCE / "examples", "without_io")
        self.assertNotEqual(failed.returncode, 0)
        self.assertRegex(" ".join(failed.stderr.split()), r"no component 'io', only: core\.")

    def test_nothing_points_back(self):
        """No installed text names the tree that it was built from or the first prefix."""
        files = [p for p in self.prefix.rglob("*") if p.suffix in (".cmake", ".h", ".def")]
        self.assertTrue(files)
        for path in files:
            text = path.read_text()
            for word in (str(SOURCE), BUILD, str(self.folder)):
                self.assertNotIn(word, text, path)

    def test_licence_and_headers_are_there(self):
        licence, = self.prefix.glob("share/doc/*/LICENSE")
        self.assertEqual(licence.read_text(), (SOURCE / "LICENSE").read_text())
        headers = {p.relative_to(self.prefix / "include").as_posix()
                   for p in (self.prefix / "include").rglob("*.h")}
        for header in headers:
            text = (self.prefix / "include" / header).read_text()
            for include in re.findall(r'#include "(carat/.+\.h)"', text):
                self.assertIn(include, headers, header)
        umbrella = (self.prefix / "include/carat/carat.h").read_text()
        for app in (h for h in headers if h.startswith("carat/apps/")):
            self.assertIn(app, umbrella, "carat.h lacks an app")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[8:], verbosity=2)
