"""--engine petsc: over several processes the answers of one. Takes mpirun as second argument."""

import json
import os
import subprocess
import sys

MPIRUN = sys.argv.pop(2)

from support import PROGRAM, CaratTest, main  # noqa: E402  (reads the first argument)

os.environ.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                  OMPI_MCA_rmaps_base_oversubscribe="1", OPENBLAS_NUM_THREADS="1")


class Engine(CaratTest):
    def job(self, n, *arguments):
        return subprocess.run(
            [MPIRUN, "-np", str(n), PROGRAM, "--engine", "petsc", *map(str, arguments)],
            cwd=self.folder, capture_output=True, text=True, timeout=120,
            stdin=subprocess.DEVNULL)

    def field(self, file, name):
        """Values at the vertices; of a volume those of its boundary."""
        if file.endswith(".ply"):
            return self.read_field(file, name)
        self.succeed("convert", file, "boundary.ply", "--surface")
        return self.read_field("boundary.ply", name)

    def compare(self, fields, suffix, *arguments):
        self.succeed(*arguments, "-o", "one" + suffix)
        for n in [1, 3]:
            run = self.job(n, *arguments, "-o", "many" + suffix)
            self.assertEqual(run.returncode, 0, run.stderr)
            for name in fields:
                one, many = (self.field(which + suffix, name) for which in ["one", "many"])
                self.assertEqual(len(one), len(many))
                scale = max(map(abs, one))
                self.assertGreater(scale, 0)
                self.assertLess(max(abs(a - b) for a, b in zip(one, many)), 1e-9 * scale, name)

    def test_poisson_on_a_surface(self):
        mesh = self.generate("plane-voronoi", 2, "mesh.vtu")
        self.compare(["u", "error"], ".ply", "poisson", mesh, "--rhs", "1+x", "--dirichlet", "x",
                     "--dirichlet-where", "y<0.5", "--robin", "2", "--neumann", "cos(x)",
                     "--coefficient", "1+x*y", "--exact", "x")

    def test_poisson_in_a_volume(self):
        mesh = self.generate("ball-voronoi", 1, "mesh.vtu")
        self.compare(["u"], ".vtu", "poisson", mesh, "--rhs", "1", "--dirichlet", "y",
                     "--dirichlet-where", "x<0", "--operator", "stabilized_diamond")
        self.compare(["u"], ".vtu", "poisson", mesh, "--rhs", "x", "--operator", "bunge")

    def test_geodesics(self):
        mesh = self.generate("sphere-hexagons", 2, "mesh.vtu")
        self.compare(["distance"], ".ply", "geodesics", mesh, "--source", "3", "--source", "50")

    def test_eigenmodes(self):
        mesh = self.generate("cube-tets", 1, "mesh.vtu")
        one = self.report("eigen", mesh, "-k", "6", "--dirichlet")["eigenvalues"]
        run = self.job(2, "eigen", mesh, "-k", "6", "--dirichlet", "--json")
        self.assertEqual(run.returncode, 0, run.stderr)
        report = json.loads(run.stdout)
        self.assertEqual(report["solver"]["kind"], "slepc")
        self.assertEqual(report["solver"]["processes"], 2)
        many = report["eigenvalues"]
        for a, b in zip(one, many, strict=True):
            self.assertLess(abs(a - b), 1e-9 * a)

    def test_report_says_what_solved(self):
        mesh = self.generate("plane-quads", 2, "mesh.vtu")
        run = self.job(2, "poisson", mesh, "--rhs", "1", "--dirichlet", "0", "--json")
        solver = json.loads(run.stdout)["solver"]
        self.assertEqual((solver["kind"], solver["processes"]), ("petsc", 2))
        self.assertLess(solver["residual"], 1e-10)

    def test_options_of_petsc_count(self):
        mesh = self.generate("plane-quads", 2, "mesh.vtu")
        run = self.job(2, "poisson", mesh, "--rhs", "1", "--dirichlet", "0", "-pc_type", "jacobi",
                       "-ksp_converged_reason")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("jacobi", run.stdout)
        self.assertIn("CONVERGED_RTOL", run.stdout)

    def test_failures_end_the_job_with_one_message(self):
        mesh = self.generate("plane-quads", 2, "mesh.vtu")
        for code, words, arguments in [
                (3, "cannot be read", ["poisson", "none.vtu", "--rhs", "1"]),
                (4, "no solution exists", ["poisson", mesh, "--rhs", "1"]),
                (2, "coefficient is", ["poisson", mesh, "--rhs", "1", "--dirichlet", "0",
                                       "--coefficient", "x-0.5"]),
                (2, "--solver", ["poisson", mesh, "--rhs", "1", "--solver", "cholesky"]),
                (2, "not expected", ["curvature", mesh])]:
            run = self.job(3, *arguments)
            self.assertEqual(run.returncode, code, run.stderr)
            ours = [line for line in run.stderr.splitlines() if line.startswith("carat: ")]
            self.assertEqual(len(ours), 1, run.stderr)
            self.assertIn(words, ours[0])


if __name__ == "__main__":
    main()
