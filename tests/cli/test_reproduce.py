"""carat reproduce: its data, its cache, and its messages."""
import csv
import json
import math
import random
import unittest

from support import CaratTest, main


# Terms c exp(-a (9x-x0)^2 - b (9y-y0)^2 - d (9y-y0)) of Franke's function: c, a, x0, b, y0, d.
TERMS = [(0.75, 1 / 4, 2, 1 / 4, 2, 0), (0.75, 1 / 49, -1, 0, -1, 1 / 10),
         (0.5, 1 / 4, 7, 1 / 4, 3, 0), (-0.2, 1, 4, 1, 7, 0)]


def franke():
    """Franke's function and minus its Laplacian, as expressions."""
    value, source = [], []
    for c, a, x0, b, y0, d in TERMS:
        x, y = f"(9*x-({x0}))", f"(9*y-({y0}))"
        term = f"({c})*exp(-({a!r})*{x}^2-({b!r})*{y}^2-({d!r})*{y})"
        value.append(term)
        source.append(f"-{term}*((18*({a!r})*{x})^2+(18*({b!r})*{y}+9*({d!r}))^2"
                      f"-162*({a!r}+{b!r}))")
    return "+".join(value), "".join(source)


class Reproduce(CaratTest):
    def reproduce(self, *arguments):
        return self.report("reproduce", *arguments, "-o", "out")

    def rows(self, name):
        with open(self.folder / "out" / f"{name}.csv", newline="") as file:
            return list(csv.DictReader(file))

    def test_data_and_cache(self):
        first = self.reproduce("franke-plane", "--quick", "--levels", 2)
        self.assertEqual(first["cases"]["failed"], 0)
        self.assertEqual(first["cases"]["cached"], 0)
        rows = self.rows("franke-plane")
        self.assertEqual(first["cases"]["measured"], len(rows))
        self.assertEqual({row["family"] for row in rows},
                         {"plane-triangles", "plane-quads", "plane-voronoi", "plane-concave"})
        for row in rows:
            self.assertTrue(0 < float(row["rmse"]) < 0.2, row)
        # The same numbers in all files.
        alone = json.loads((self.folder / "out/franke-plane.json").read_text())
        report = json.loads((self.folder / "out/report.json").read_text())
        for document in [alone, report]:
            self.assertEqual(document["carat"], "0.1.0")
            self.assertEqual(document["seed"], 1)
            self.assertGreater(document["machine"]["cores"], 0)
            [experiment] = document["experiments"]
            self.assertEqual(experiment["name"], "franke-plane")
            names = [column["name"] for column in experiment["columns"]]
            self.assertEqual(names, list(rows[0]))
            self.assertEqual([row[names.index("rmse")] for row in experiment["rows"]],
                             [float(row["rmse"]) for row in rows])
            for figure in experiment["figures"]:
                used = [figure["x"], figure["y"], figure["panel"], *figure["series"]]
                self.assertLessEqual(set(used), set(names))
        before = (self.folder / "out/franke-plane.csv").read_bytes()
        again = self.reproduce("franke-plane", "--quick", "--levels", 2)
        self.assertEqual(again["cases"],
                         {"measured": 0, "cached": len(rows), "failed": 0})
        self.assertEqual((self.folder / "out/franke-plane.csv").read_bytes(), before)
        # What an interrupted run has not measured, and what is damaged, is measured.
        cache = sorted((self.folder / "out/cache").iterdir())
        cache[0].unlink()
        cache[1].write_text('{"key": "carat')
        mended = self.reproduce("franke-plane", "--quick", "--levels", 2)
        self.assertEqual(mended["cases"]["measured"], 2)
        self.assertIn("is damaged", " ".join(mended["notes"]))
        self.assertEqual((self.folder / "out/franke-plane.csv").read_bytes(), before)
        fresh = self.reproduce("franke-plane", "--quick", "--levels", 2, "--fresh")
        self.assertEqual(fresh["cases"]["measured"], len(rows))

    def test_rows_can_be_measured_again_from_their_own_parameters(self):
        """Three rows at random, by `carat poisson` instead."""
        self.reproduce("franke-plane", "--quick", "--levels", 2)
        rows = self.rows("franke-plane")
        for row in random.Random().sample(rows, 3):
            self.generate(row["family"], row["level"], "mesh.vtp")
            options = ["--operator", row["operator"], "--mass", row["mass"]]
            for name in ["theta", "tau"]:
                if row[name]:
                    options += [f"--{name}", row[name]]
            error = self.error_of(options)
            self.assertAlmostEqual(error / float(row["rmse"]), 1, delta=1e-6, msg=str(row))

    def error_of(self, options):
        value, source = franke()
        report = self.report("poisson", "mesh.vtp", "--rhs", source, "--dirichlet", value,
                             "--exact", value, *options)
        # The program takes the mean over all vertices, those of the boundary with no error.
        n = report["sizes"]["vertices"]
        return report["errors"]["rmse"] * math.sqrt(n / (n - report["sizes"]["dirichlet_vertices"]))

    def test_pictures(self):
        """One surface by other faces over the same vertices."""
        self.generate("sphere-hexagons", 2, "model.ply")
        report = self.reproduce("curvature-picture", "geodesics-picture", "--model", "model.ply")
        self.assertEqual(report["cases"]["failed"], 0)
        curvature = self.rows("curvature-picture")
        sizes = self.report("info", "model.ply")["sizes"]
        for row in curvature:
            self.assertEqual(int(row["vertices"]), sizes["vertices"])
            if row["tessellation"] == "polygons":
                self.assertEqual(int(row["faces"]), sizes["faces"])
                self.assertEqual(float(row["max_difference"]), 0)
                options = ["--operator", row["operator"], "--mass", row["mass"]]
                options += ["--theta", row["theta"]] if row["theta"] else []
                H = self.report("curvature", "model.ply", *options)["mean_curvature"]
                self.assertAlmostEqual(max(abs(H["max"]), abs(H["min"])) / float(row["max"]), 1,
                                       delta=1e-9)
            else:
                self.assertEqual(row["tessellation"], "triangles")
                self.assertEqual(int(row["faces"]), 2 * (sizes["vertices"] - 2))
                self.assertTrue(0 < float(row["max_difference"]) < 10)
        distances = self.rows("geodesics-picture")
        for row in distances:
            self.assertLess(abs(float(row["max"]) - math.pi), 0.3)
            self.assertLess(float(row["relative"]), 0.1)
            if row["tessellation"] == "quads":
                triangles = 2 * (sizes["vertices"] - 2)
                self.assertTrue(triangles / 2 <= int(row["faces"]) < 0.7 * triangles)
        for name in ["curvature-picture", "geodesics-picture"]:
            self.assertGreater((self.folder / f"out/{name}.png").stat().st_size, 30000)
            self.assertIn("<svg", (self.folder / f"out/{name}.svg").read_text()[:300])
        # Two parts: the distance is infinite on one of them, and a vertex belongs to none.
        self.write("parts.off", "OFF\n9 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 0\n4 0 0\n4 1 0\n3 1 0\n"
                   "99 99 99\n4 0 1 2 3\n4 4 5 6 7\n")
        parts = self.reproduce("geodesics-picture", "--model", "parts.off")
        self.assertEqual(parts["cases"]["failed"], 0)
        self.assertGreater((self.folder / "out/geodesics-picture.png").stat().st_size, 5000)
        # A model triangulated already is made into polygons.
        self.succeed("convert", "model.ply", "triangles.ply", "--triangulate")
        self.reproduce("geodesics-picture", "--model", "triangles.ply")
        for row in self.rows("geodesics-picture"):
            self.assertEqual(int(row["vertices"]), 2 * (sizes["vertices"] - 2))

    def test_a_model_that_cannot_be_read(self):
        for _ in range(2):  # the failure is not taken from the cache as a result
            report = self.reproduce("curvature-picture", "--model", "nowhere.ply")
            self.assertEqual(report["cases"], {"measured": 0, "cached": 0, "failed":
                                               len(self.rows("curvature-picture"))})
        for note in report["notes"]:
            self.assertIn("pass a surface with --model", note)
        self.assertFalse((self.folder / "out/curvature-picture.png").exists())
        self.assertTrue((self.folder / "out/report.html").exists())

    def test_list(self):
        listed = self.report("list", "experiments")["experiments"]
        names = [experiment["name"] for experiment in listed]
        self.assertEqual(len(names), len(set(names)))
        for name in ["franke-plane", "franke-cube", "ball-eigenvalues", "columns"]:
            self.assertIn(name, names)

    def test_errors(self):
        self.fail_with(2, "reproduce", "figure-8", "-o", "out", says=["figure-8", "franke-plane"])
        self.fail_with(2, "reproduce", "franke-plane", says="--output")
        self.write("file", "")
        self.fail_with(3, "reproduce", "franke-plane", "--quick", "-o", "file",
                       says="cannot make the folder")


if __name__ == "__main__":
    main()
