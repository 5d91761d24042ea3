"""The numbers behind the commands, read back from what they write."""

import math

from support import CaratTest, great_circle, main


def multiply(a, b):
    """Product of sparse matrices given as {(row, column): value}."""
    rows = {}
    for (k, j), value in b.items():
        rows.setdefault(k, []).append((j, value))
    product = {}
    for (i, k), value in a.items():
        for j, other in rows.get(k, ()):
            product[i, j] = product.get((i, j), 0) + value * other
    return product


class Matrices(CaratTest):
    def check(self, family, operator, area):
        mesh = self.generate(family, 0)
        report = self.report("operators", mesh, "--operator", operator, "-o", "out")
        n = report["sizes"]["vertices"]
        rows, columns, s = self.read_matrix("out/stiffness.mtx")
        self.assertEqual((rows, columns, len(s)), (n, n, report["nnz"]["stiffness"]))
        _, _, m = self.read_matrix("out/mass.mtx")
        n_rows, columns, g = self.read_matrix("out/gradient.mtx")
        self.assertEqual((n_rows, columns),
                         (report["sizes"]["gradient_dimension"] * report["sizes"]["samples"], n))
        rows, columns, d = self.read_matrix("out/divergence.mtx")
        self.assertEqual((rows, columns), (n, n_rows))
        largest = max(map(abs, s.values()))
        # Sums of at most a hundred terms, each rounded relative to the largest.
        tolerance = 1e-13 * largest
        for i in range(n):
            self.assertGreater(s[i, i], 0)
            self.assertLess(abs(sum(s.get((i, j), 0) for j in range(n))), tolerance)
        laplacian = multiply(d, g)
        for key in set(s) | set(laplacian):
            self.assertLess(abs(s.get(key, 0) + laplacian.get(key, 0)), tolerance)
        self.assertLess(abs(sum(m.values()) - area(report)), 1e-13 * area(report))
        return s

    def test_plane(self):
        for operator in ["diamond", "bunge"]:
            self.check("plane-quads", operator, lambda report: 1.0)

    def test_sphere_of_triangles(self):
        def area(_):
            return self.report("info", "mesh.ply")["statistics"]["area"]
        diamond, bunge, cotan = (self.check("sphere-triangles", operator, area)
                                 for operator in ["diamond", "bunge", "cotan"])
        largest = max(map(abs, cotan.values()))
        difference = max(abs(bunge.get(k, 0) - cotan.get(k, 0)) for k in set(bunge) | set(cotan))
        self.assertLess(difference, 1e-13 * largest)
        self.assertGreater(max(abs(diamond.get(k, 0) - cotan.get(k, 0)) for k in diamond),
                           1e-3 * largest)

    def test_threads_do_not_matter(self):
        mesh = self.generate("sphere-hexagons", 3)
        for threads in [1, 2]:
            self.succeed("operators", mesh, "-o", f"out{threads}", "--threads", threads)
        for name in ["stiffness", "mass", "gradient", "divergence"]:
            one, two = ((self.folder / f"out{t}" / f"{name}.mtx").read_bytes() for t in [1, 2])
            self.assertEqual(one, two, name)


class Curvature(CaratTest):
    def test_sign_of_spheres(self):
        self.generate("sphere-quads", 1, "sphere.obj")
        points, faces = self.read_obj("sphere.obj")
        self.write_off("inside.off", [[3 * x for x in p] for p in points],
                       [face[::-1] for face in faces])
        for mesh, expected in [("sphere.obj", 1), ("inside.off", -1 / 3)]:
            found = self.report("curvature", mesh, "--signed")["mean_curvature"]
            for end in ["min", "max"]:
                self.assertAlmostEqual(found[end] / expected, 1, delta=0.05)
        found = self.report("curvature", "inside.off")["mean_curvature"]
        self.assertAlmostEqual(found["min"] * 3, 1, delta=0.05)

    def test_boundary_is_not_defined(self):
        self.generate("plane-concave", 0)
        report = self.report("curvature", "mesh.ply")
        self.assertGreater(report["diagnostics"]["undefined_vertices"]["count"], 0)
        # Flat: what is left is rounding, relative to one over the edge length of about 0.1.
        self.assertLess(report["mean_curvature"]["max"], 1e-9)


class Geodesics(CaratTest):
    def test_great_circles(self):
        self.generate("sphere-hexagons", 3, "sphere.obj")
        points, _ = self.read_obj("sphere.obj")
        self.succeed("geodesics", "sphere.obj", "--source", 0, "-o", "out.ply")
        distances = self.read_field("out.ply", "distance")
        self.assertEqual(len(distances), len(points))
        errors = [d - great_circle(points[0], p) for d, p in zip(distances, points)]
        # The mesh is 0.05 wide; measured rmse 0.004, and first order in the width.
        self.assertLess(math.sqrt(sum(e * e for e in errors) / len(errors)), 0.02)

    def test_components(self):
        self.generate("sphere-quads", 0, "sphere.obj")
        points, faces = self.read_obj("sphere.obj")
        n = len(points)
        self.write_off("two.off", points + [[x + 5, y, z] for x, y, z in points] + [[9, 9, 9]],
                       faces + [[v + n for v in face] for face in faces])
        report = self.report("geodesics", "two.off", "--source", 1, "-o", "out.ply")
        unreachable = report["diagnostics"]["unreachable_vertices"]
        self.assertEqual(unreachable["count"], n + 1)
        self.assertEqual(unreachable["elements"][:3], [n, n + 1, n + 2])
        self.assertEqual(report["diagnostics"]["unreferenced_vertices"]["elements"], [2 * n])
        self.assertLess(report["distance"]["max_vertex"], n)
        distances = self.read_field("out.ply", "distance")
        self.assertTrue(all(map(math.isfinite, distances[:n])))
        self.assertEqual(set(distances[n:]), {math.inf})
        self.report("info", "out.ply")
        self.report("view", "out.ply", "-o", "out.html")
        both = self.report("geodesics", "two.off", "--source", 1, "--source", n + 1)
        self.assertEqual(both["diagnostics"]["unreachable_vertices"]["elements"], [2 * n])
        self.fail_with(2, "geodesics", "two.off", "--source", 2 * n, says="no face")

    def test_threads_do_not_matter(self):
        mesh = self.generate("sphere-hexagons", 2)
        results = []
        for threads in [1, 2]:
            self.succeed("geodesics", mesh, "--source", 0, "--threads", threads, "-o", "out.ply")
            results.append(self.read_field("out.ply", "distance"))
        # The factorisation's sums may be ordered otherwise: rounding, grown by its condition.
        self.assertLess(max(abs(a - b) for a, b in zip(*results)), 1e-9)


class Poisson(CaratTest):
    SOLUTION = "sin(pi*x)*sin(pi*y)"
    LOAD = "2*pi^2*sin(pi*x)*sin(pi*y)"

    def slope(self, *arguments, field="l2"):
        """Order of convergence over two levels."""
        errors = []
        for level in [1, 2]:
            self.generate("plane-quads", level)
            errors.append(self.report("poisson", "mesh.ply", *arguments)["errors"][field])
        return math.log2(errors[0] / errors[1])

    def test_dirichlet(self):
        order = self.slope("--rhs", self.LOAD, "--dirichlet", 0, "--exact", self.SOLUTION)
        self.assertAlmostEqual(order, 2, delta=0.2)

    def test_all_kinds_of_boundary_data(self):
        # u = exp(x) cos(y) with K = 1: harmonic. x = 0: Dirichlet; elsewhere the outward flux.
        flux = "x>1-1e-9 ? exp(1)*cos(y) : y>1-1e-9 ? -exp(x)*sin(1) : y<1e-9 ? 0 : -cos(y)"
        exact = ["--exact", "exp(x)*cos(y)"]
        part = ["--dirichlet", "exp(x)*cos(y)", "--dirichlet-where", "x < 1e-9"]
        self.assertAlmostEqual(self.slope("--rhs", 0, *part, "--neumann", flux, *exact), 2,
                               delta=0.3)
        self.assertAlmostEqual(self.slope("--rhs", 0, "--neumann", flux, *exact), 2, delta=0.3)
        robin = ["--robin", 3, "--neumann", f"({flux}) + 3*exp(x)*cos(y)"]
        self.assertAlmostEqual(self.slope("--rhs", 0, *robin, *exact), 2, delta=0.3)

    def test_coefficient(self):
        # -div((1+x) grad x^2) = -(2 + 4x)
        order = self.slope("--rhs=-(2+4*x)", "--coefficient", "1+x", "--dirichlet", "x^2",
                           "--exact", "x^2", field="rmse")
        self.assertAlmostEqual(order, 2, delta=0.3)

    def test_means_are_compared_by_component(self):
        self.generate("sphere-quads", 1, "sphere.obj")
        points, faces = self.read_obj("sphere.obj")
        n = len(points)
        self.write_off("two.off", points + [[x + 5, y, z] for x, y, z in points],
                       faces + [[v + n for v in face] for face in faces])
        # On each sphere u = y plus a constant of its own.
        report = self.report("poisson", "two.off", "--rhs", "2*y",
                             "--exact", "y + (x > 2 ? 100 : 0)")
        self.assertEqual(report["floating_components"], 2)
        self.assertLess(report["errors"]["max"], 0.05)


if __name__ == "__main__":
    main()
