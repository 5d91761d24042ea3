"""carat bench: what operators and solvers cost on a mesh."""
from support import CaratTest, main


class Bench(CaratTest):
    def test_every_operator_is_measured_or_said_to_be_left_out(self):
        self.generate("sphere-hexagons", 2)
        report = self.report("bench", "mesh.ply", "--repetitions", "1")
        rows = report["results"]
        known = {entry["name"] for entry in self.report("list", "operators")["operators"]
                 if entry["kind"] == "surface"}
        self.assertEqual({row["operator"] for row in rows}, known)
        measured = [row for row in rows if "seconds" in row]
        self.assertEqual(report["counts"], {"measured": len(measured), "failed": 0, "left_out": 1})
        (left_out,) = [row for row in rows if "left_out" in row]
        self.assertEqual(left_out["operator"], "cotan")
        for row in measured:
            seconds = row["seconds"]
            parts = sum(seconds[key] for key in ("symbolic", "numeric", "set_up", "solve"))
            self.assertAlmostEqual(seconds["total"], parts)
            self.assertLess(row["residual"], 1e-10)
            self.assertGreater(row["nnz"]["stiffness"], row["unknowns"])
            self.assertGreater(row["numeric_GB_per_s"], 0)
            self.assertEqual(row["iterations"] > 0, row["method"].startswith("conjugate"))
        solvers = {row["solver"] for row in measured if row["operator"] == "diamond"}
        self.assertEqual(solvers, {"auto", "cholesky", "multigrid", "incomplete-cholesky",
                                   "sparser-cholesky"})

    def test_operators_with_other_unknowns_are_factorised(self):
        self.succeed("generate", "cube-hexahedra", "--level", "1", "-o", "cube.vtu")
        rows = self.report("bench", "cube.vtu", "--repetitions", "1", "--operator", "ceve",
                           "--operator", "bunge")["results"]
        self.assertEqual([row["solver"] for row in rows if row["operator"] == "ceve"],
                         ["cholesky"])
        self.assertEqual(len([row for row in rows if row["operator"] == "bunge"]), 4)

    def test_table_has_a_line_a_case(self):
        self.generate("plane-triangles", 1)
        lines = self.succeed("bench", "mesh.ply", "--operator", "cotan", "--solver", "cholesky",
                             "multigrid", "--repetitions", "1").splitlines()
        rows = [line.split()[:2] for line in lines if line.startswith("cotan ")]
        self.assertEqual(rows, [["cotan", "cholesky"], ["cotan", "multigrid"]])
        self.assertIn("2 cases measured, 0 failed, 0 operators not for this mesh", lines)

    def test_wrong_choices(self):
        self.generate("plane-quads", 1)
        self.fail_with(2, "bench", "mesh.ply", "--operator", "sesame", says="sesame")
        self.fail_with(2, "bench", "mesh.ply", "--solver", "sesame", says="sesame")
        self.fail_with(2, "bench", "mesh.ply", "--repetitions", "0", says="repetitions")
        self.fail_with(3, "bench", "missing.ply", says="missing.ply")


class Profile(CaratTest):
    def test_phases_have_seconds_bytes_and_rates(self):
        self.generate("plane-quads", 3)
        report = self.report("poisson", "mesh.ply", "--rhs", "1", "--dirichlet", "0",
                             "-o", "u.vtp")
        self.assertEqual(list(report["profile"]), list(report["seconds"]))
        for phase, cost in report["profile"].items():
            self.assertEqual(cost["seconds"], report["seconds"][phase])
            if cost["bytes"] is not None:
                self.assertAlmostEqual(cost["GB_per_s"] * cost["seconds"] * 1e9, cost["bytes"],
                                       delta=1e-6 * cost["bytes"])
        size = (self.folder / "mesh.ply").stat().st_size
        self.assertEqual(report["profile"]["read"]["bytes"], size)
        self.assertEqual(report["profile"]["write"]["bytes"],
                         (self.folder / "u.vtp").stat().st_size)
        for phase in ("factor", "solve"):
            self.assertGreater(report["profile"][phase]["GB_per_s"], 0)
        entries = sum(report["nnz"][key] for key in ("stiffness", "mass"))
        self.assertGreater(report["profile"]["numeric"]["bytes"], 12 * entries)
        self.assertGreater(report["peak_memory"], 1e6)

    def bytes_of_all_phases(self, *arguments):
        report = self.report(*arguments)
        for phase, cost in report["profile"].items():
            self.assertGreater(cost["bytes"] or 0, 0, phase)
            self.assertGreater(cost["GB_per_s"], 0, phase)
        return report, {phase: cost["bytes"] for phase, cost in report["profile"].items()}

    def test_products_without_matrices_count_in_the_numeric_phase_and_in_the_solver(self):
        self.generate("plane-voronoi", 4)
        report, moved = self.bytes_of_all_phases(
            "poisson", "mesh.ply", "--rhs", "1", "--dirichlet", "0", "--solver", "multigrid",
            "--operator", "diamond")
        solver = report["solver"]
        self.assertFalse(solver["assembled"])
        sizes = report["sizes"]
        self.assertGreater(moved["numeric"], solver["operator_bytes"] + 24 * sizes["vertices"])
        self.assertEqual(moved["solve"], solver["iterations"] *
                         (solver["operator_bytes"] + 16 * solver["factor_nnz"]))

    def test_one_triangle_of_the_matrices_gives_the_same_solution(self):
        self.generate("plane-triangles", 4)
        arguments = ["poisson", "mesh.ply", "--rhs", "sin(3*x)", "--dirichlet", "x*y",
                     "--operator", "diamond", "--solver", "multigrid", "--matrix-storage"]
        full = self.report(*arguments, "full")
        for extra in [], ["--exact", "x"]:
            half = self.report(*arguments, "triangle", *extra)
            self.assertEqual((full["solver"]["halved"], half["solver"]["halved"]), (False, True))
            self.assertIn("with one triangle", half["solver"]["method"])
            self.assertLess(half["solver"]["operator_bytes"],
                            0.65 * full["solver"]["operator_bytes"])
            for bound in "min", "max":
                self.assertAlmostEqual(half["u"][bound], full["u"][bound], delta=1e-9)
        self.fail_with(2, *arguments, "half", says=["'half'", "full, triangle"])

    def test_eigenpairs_and_distances_have_bytes_in_all_phases(self):
        self.generate("plane-quads", 3)
        self.generate("cube-hexahedra", 3, name="cube.vtu")
        report, few = self.bytes_of_all_phases("eigen", "mesh.ply", "-k", "5")
        self.assertGreater(few["solve"], 16 * report["solver"]["factor_nnz"])
        many = self.bytes_of_all_phases("eigen", "mesh.ply", "-k", "40")[1]
        self.assertGreater(many["solve"], few["solve"])
        self.bytes_of_all_phases("eigen", "cube.vtu", "-k", "2", "--solver", "iterative")
        report, one = self.bytes_of_all_phases("geodesics", "mesh.ply", "--source", "0")
        self.assertGreater(one["solve"], 16 * report["solver"]["factor_nnz"])
        self.assertGreater(one["factor"], 12 * report["solver"]["factor_nnz"])
        # Several sets read the factors together.
        sources = [word for v in range(8) for word in ("--source", str(v))]
        each = self.bytes_of_all_phases("geodesics", "mesh.ply", "--each", *sources)[1]
        self.assertGreater(each["solve"], one["solve"])
        self.assertLess(each["solve"], 8 * one["solve"])
        self.bytes_of_all_phases("geodesics", "cube.vtu", "--source", "0", "--solver", "multigrid")


if __name__ == "__main__":
    main()
