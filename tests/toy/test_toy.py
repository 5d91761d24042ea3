"""An operator of one file and one line is known to the program, the claims and the benchmark."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

CARAT, BENCH = sys.argv[1:3]


def run(*command, **options):
    return subprocess.run(list(map(str, command)), check=True, capture_output=True, text=True,
                          timeout=120, **options).stdout


def report(*arguments, **options):
    return json.loads(run(CARAT, *arguments, "--json", **options))


class Toy(unittest.TestCase):
    def test_listed(self):
        names = [entry["name"] for entry in report("list", "operators")["operators"]]
        self.assertEqual(names.count("toy"), 1)
        self.assertIn("toy", run(CARAT, "poisson", "--help"))

    def test_used_by_a_command(self):
        with tempfile.TemporaryDirectory() as folder:
            mesh = pathlib.Path(folder) / "mesh.ply"
            run(CARAT, "generate", "plane-quads", "--level", 1, "-o", mesh)
            result = report("poisson", mesh, "--rhs", "1", "--dirichlet", "0", "--operator", "toy")
            self.assertEqual(result["options"]["operator"], "toy")
            refused = subprocess.run([CARAT, "geodesics", mesh, "--source", "0", "--operator",
                                      "toy"], capture_output=True, text=True)
            self.assertEqual(refused.returncode, 2)
            self.assertIn("toy", refused.stderr)

    def test_held_to_its_claims(self):
        result = report("claims", "--operator", "toy", "--family", "plane-voronoi")
        (row,) = result["results"]
        self.assertEqual(row["claims"]["kernel"]["verdict"], "kept")
        self.assertEqual(row["claims"]["linear_precision"]["verdict"], "denied")
        self.assertEqual(row["claims"]["second_order"]["verdict"], "denied")

    def test_benchmarked(self):
        tests = run(BENCH, "--benchmark_list_tests").split()
        self.assertIn("plane-quads/toy", tests)
        self.assertIn("plane-quads/diamond", tests)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
