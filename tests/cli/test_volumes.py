"""Volume meshes through every command: what it answers, its numbers, and meshes that are bad."""

import math
import pathlib

from support import CaratTest, main

TETRAHEDRON = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
CORNERS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]


def grid(n, size=1.0):
    """Points and cells of n^3 cubes, each with its faces outwards."""
    m = n + 1
    points = [(size * (v % m) / n, size * (v // m % m) / n, size * (v // m // m) / n)
              for v in range(m ** 3)]
    cells = []
    for c in range(n ** 3):
        o = c % n + m * (c // n % n + m * (c // n // n))
        a, b, c1, d = o, o + 1, o + 1 + m, o + m
        e, f, g, h = a + m * m, b + m * m, c1 + m * m, d + m * m
        cells.append([(a, e, h, d), (b, c1, g, f), (a, b, f, e), (d, h, g, c1), (a, d, c1, b),
                      (e, f, g, h)])
    return points, cells


class Answers(CaratTest):
    def setUp(self):
        super().setUp()
        self.generate("ball-voronoi", 0, "ball.vtu")

    def test_info(self):
        report = self.report("info", "ball.vtu")
        self.assertEqual(report["kind"], "volume")
        statistics, sizes = report["statistics"], report["sizes"]
        self.assertEqual(sum(statistics["cells_of_kind"].values()), sizes["cells"])
        self.assertGreater(statistics["cells_of_kind"]["polyhedra"], sizes["cells"] / 2)
        self.assertEqual(sum(statistics["cells_of_size"].values()), sizes["cells"])
        self.assertEqual(statistics["inner_faces"] + statistics["boundary_faces"], sizes["faces"])
        self.assertEqual(sizes["vertices"] - sizes["edges"] + sizes["faces"] - sizes["cells"], 1)
        self.assertEqual(statistics["components"], 1)
        self.assertEqual(statistics["boundary"]["euler_characteristic"], 2)
        self.assertLess(statistics["volume"], 4 * math.pi / 3)
        self.assertGreater(statistics["volume"], 3)
        self.assertEqual(report["fields"], {"vertex": [], "cell": []})
        self.assertEqual(report["patches"], [])
        for name in ["inverted_cells", "flat_cells", "hanging_vertices", "faces_without_cells"]:
            self.assertEqual(report["diagnostics"][name]["count"], 0, name)
        self.assertEqual(list(report["seconds"]), ["read", "statistics", "symbolic", "numeric"])
        text = self.succeed("info", "ball.vtu")
        for words in ["polyhedra", "faces a cell: ", "cell quality ", "operator diamond: "]:
            self.assertIn(words, text)

    def test_fields_of_every_app(self):
        for arguments, vertex, cell in [
                (["geodesics", "--source", 0], ["distance"], [("direction", 3)]),
                (["poisson", "--rhs", 1, "--dirichlet", 0, "--exact", 0],
                 ["u", "error", "gradient"], [("gradient", 3)]),
                (["eigen", "-k", 2], ["mode_1", "mode_2"], [])]:
            for name in ["out.vtu", "out.ovm"]:
                self.succeed(arguments[0], "ball.vtu", *arguments[1:], "-o", name)
                fields = self.report("info", name)["fields"]
                self.assertEqual([f["name"] for f in fields["vertex"]], vertex)
                self.assertEqual([(f["name"], f["components"]) for f in fields["cell"]], cell)
            self.succeed(arguments[0], "ball.vtu", *arguments[1:], "-o", "out.html")
            self.assertIn(f'"{vertex[0]}"', (self.folder / "out.html").read_text())

    def test_view_shows_both_kinds(self):
        self.generate("sphere-quads", 0, "sphere.ply")
        report = self.report("view", "ball.vtu", "sphere.ply", "-o", "page.html")
        self.assertIn("cells", report["sizes"][0])
        self.assertNotIn("cells", report["sizes"][1])

    def test_convert_keeps_the_mesh(self):
        self.succeed("convert", "ball.vtu", "a.ovm")
        self.succeed("convert", "a.ovm", "b.vtu")
        self.succeed("convert", "b.vtu", "c.ovm")
        first, last = (self.report("info", name)["statistics"] for name in ["ball.vtu", "c.ovm"])
        self.assertEqual(first["cells_of_size"], last["cells_of_size"])
        self.assertEqual(self.read_ovm("a.ovm")[0], self.read_ovm("c.ovm")[0])

    def test_boundary(self):
        self.succeed("geodesics", "ball.vtu", "--source", 0, "-o", "a.ovm")
        report = self.report("convert", "a.ovm", "boundary.ply", "--surface")
        self.assertEqual((report["kind"], report["output_kind"]), ("volume", "surface"))
        info = self.report("info", "boundary.ply")
        self.assertTrue(info["statistics"]["closed"])
        self.assertGreater(info["statistics"]["enclosed_volume"], 3)
        self.assertEqual([f["name"] for f in info["fields"]["vertex"]], ["distance", "vertex_id"])
        self.assertEqual([f["name"] for f in info["fields"]["face"]],
                         ["direction", "face_id", "cell_id"])
        ids = self.read_field("boundary.ply", "vertex_id")
        distance = self.read_ovm("a.ovm")[1]["V", "distance"]
        self.assertEqual(self.read_field("boundary.ply", "distance"),
                         [distance[int(v)][0] for v in ids])
        cells = self.read_field("boundary.ply", "cell_id", "face")
        directions = self.read_ovm("a.ovm")[1]["C", "direction"]
        for axis in range(3):
            self.assertEqual(self.read_field("boundary.ply", f"direction_{'xyz'[axis]}", "face"),
                             [directions[int(c)][axis] for c in cells])
        self.succeed("curvature", "boundary.ply")
        report = self.report("convert", "a.ovm", "t.obj", "--surface", "--triangulate")
        self.assertEqual(len(report["notes"]), 2)
        self.assertEqual({len(face) for face in self.read_obj("t.obj")[1]}, {3})
        self.succeed("convert", "boundary.ply", "same.ply", "--surface")

    def test_operators_of_the_kind(self):
        for operator in ["diamond", "bunge"]:
            self.assertEqual(self.report("eigen", "ball.vtu", "-k", 1, "--operator", operator)
                             ["options"]["operator"], operator)
        self.fail_with(2, "eigen", "ball.vtu", "--operator", "cotan",
                       says=["--operator cotan", "volumes", "diamond, bunge, primal_tet"])
        self.fail_with(2, "eigen", "ball.vtu", "--operator", "fem", says="not in {diamond,")
        self.fail_with(3, "eigen", "ball.vtu", "--operator", "primal_tet", says="tetrahedra")
        self.generate("sphere-quads", 0, "sphere.ply")
        self.fail_with(2, "poisson", "sphere.ply", "--rhs", "x", "--operator", "primal_tet",
                       says=["surfaces", "diamond, bunge, cotan"])

    def test_kinds_that_do_not_fit(self):
        before = self.files()
        for exit_code, arguments, says in [
                (3, ["curvature", "ball.vtu"], ["ball.vtu", "boundary", "--surface"]),
                (2, ["convert", "ball.vtu", "a.ply"], ["a.ply", ".vtu", "--surface"]),
                (2, ["convert", "ball.vtu", "a.vtp"], "a.vtp"),
                (2, ["convert", "ball.vtu", "a.vtu", "--dual"], ["--dual", "--surface"]),
                (2, ["convert", "ball.vtu", "a.vtu", "--triangulate"], "--triangulate"),
                (2, ["generate", "ball-tets", "--level", 0, "-o", "a.obj"], ["a.obj", ".ovm"]),
                (2, ["geodesics", "ball.vtu", "--source", 0, "-o", "a.vtp"], "a.vtp"),
                (2, ["geodesics", "ball.vtu", "--source", 9999], "vertices 0 to"),
                (2, ["eigen", "ball.vtu", "-k", 0], "0"),
                (2, ["eigen", "ball.vtu", "-k", 99999], "99999"),
                (2, ["eigen", "ball.vtu", "-k", "many"], "many"),
                (2, ["poisson", "ball.vtu", "--rhs", 1, "--dirichlet", "wall=0"],
                 ["wall", "has none"])]:
            with self.subTest(arguments=arguments):
                self.fail_with(exit_code, *arguments, says=says)
        self.generate("sphere-quads", 0, "sphere.ply")
        self.fail_with(2, "convert", "sphere.ply", "a.ovm", says=["a.ovm", ".vtp"])
        self.fail_with(2, "eigen", "sphere.ply", "--dirichlet", says="closed")
        self.fail_with(2, "poisson", "sphere.ply", "--rhs", "x", "--coefficient-field", "k",
                       says="--coefficient")
        self.assertEqual(self.files(), sorted(before + ["sphere.ply"]))


class Matrices(CaratTest):
    def check(self, family, operator):
        self.generate(family, 0, "mesh.vtu")
        report = self.report("operators", "mesh.vtu", "--operator", operator, "-o", "out")
        n = report["sizes"]["vertices"]
        _, _, s = self.read_matrix("out/stiffness.mtx")
        _, _, m = self.read_matrix("out/mass.mtx")
        self.assertEqual(len(s), report["nnz"]["stiffness"])
        self.assertAlmostEqual(sum(m.values()), 1, delta=1e-12)  # rounding of 10^4 terms
        largest = max(map(abs, s.values()))
        sums = [0.0] * n
        for (i, _), value in s.items():
            sums[i] += value
        self.assertLess(max(map(abs, sums)), 1e-13 * largest)
        self.assertIn("sums to the volume", report["sign_convention"])
        rows, columns, g = self.read_matrix("out/gradient.mtx")
        self.assertEqual((rows, columns), (3 * report["sizes"]["samples"], n))
        self.assertIn("row 3 s + k", report["frame_convention"])
        self.assertIn("x, y, z", report["frame_convention"])
        # Component k of the gradient of the k-th coordinate is 1, of the others 0.
        self.succeed("convert", "mesh.vtu", "mesh.ovm")
        points, _ = self.read_ovm("mesh.ovm")
        for k in range(3):
            product = [0.0] * rows
            for (row, v), value in g.items():
                product[row] += value * points[v][k]
            worst = max(abs(value - (row % 3 == k)) for row, value in enumerate(product))
            self.assertLess(worst, 1e-10)  # thin samples of Voronoi cells
        return report

    def test_diamond(self):
        report = self.check("cube-voronoi", "diamond")
        self.assertIn("ordered by the faces", report["frame_convention"])

    def test_others(self):
        self.check("cube-prisms", "bunge")
        self.check("cube-tets", "primal_tet")


class Poisson(CaratTest):
    def test_linear_solutions_are_exact(self):
        self.generate("cube-voronoi", 0, "cube.vtu")
        linear = "1+x-2*y+3*z"
        report = self.report("poisson", "cube.vtu", "--rhs", 0, "--dirichlet", linear,
                             "--exact", linear)
        self.assertLess(report["errors"]["max"], 1e-11)
        # The flux of the gradient (1, -2, 3) through the sides.
        flux = "x<1e-9 ? -1 : x>1-1e-9 ? 1 : y<1e-9 ? 2 : y>1-1e-9 ? -2 : z<1e-9 ? -3 : 3"
        report = self.report("poisson", "cube.vtu", "--rhs", 0, "--neumann", flux,
                             "--exact", linear)
        self.assertEqual(report["floating_components"], 1)
        self.assertGreater(report["sizes"]["neumann_faces"], 0)
        self.assertLess(report["errors"]["max"], 1e-10)

    def test_converges(self):
        errors = []
        for level in [1, 2]:
            self.generate("cube-truncated", level, "cube.vtu")
            errors.append(self.report(
                "poisson", "cube.vtu", "--rhs", "3*pi^2*sin(pi*x)*sin(pi*y)*sin(pi*z)",
                "--dirichlet", 0, "--exact", "sin(pi*x)*sin(pi*y)*sin(pi*z)")["errors"]["l2"])
        self.assertAlmostEqual(math.log2(errors[0] / errors[1]), 2, delta=0.5)

    def patched_cube(self, size=1.0):
        points, cells = grid(3, size)
        patches = {name: [face for cell in cells for face in cell
                          if all(points[v][axis] == end for v in face)]
                   for name, axis, end in [("west", 0, 0.0), ("east", 0, size), ("top", 2, size)]}
        return self.write_ovm("cube.ovm", points, cells, patches)

    def test_patches(self):
        mesh = self.patched_cube()
        found = self.report("info", mesh)["patches"]
        self.assertEqual([(p["name"], p["faces"]) for p in found],
                         [("west", 9), ("east", 9), ("top", 9)])
        self.assertIn("boundary patch west: 9 faces", self.succeed("info", mesh))
        report = self.report("poisson", mesh, "--rhs", 0, "--dirichlet", "west=1",
                             "--dirichlet", "east=3+0*y", "--exact", "1+2*x")
        self.assertEqual(report["sizes"]["dirichlet_vertices"], 32)
        self.assertLess(report["errors"]["max"], 1e-13)
        report = self.report("poisson", mesh, "--rhs", 0, "--dirichlet", "west=1",
                             "--neumann", "east=2", "--exact", "1+2*x")
        self.assertEqual(report["sizes"]["neumann_faces"], 9)
        self.assertLess(report["errors"]["max"], 1e-13)
        # u' = 2 = g - alpha u = g - 4 * 3 at x = 1
        report = self.report("poisson", mesh, "--rhs", 0, "--dirichlet", "west=1", "--robin",
                             "east=4", "--neumann", "east=14", "--exact", "1+2*x")
        self.assertEqual((report["sizes"]["robin_faces"], report["sizes"]["neumann_faces"]), (9, 0))
        self.assertLess(report["errors"]["max"], 1e-13)
        # What no patch names; where both meet, the patch holds.
        report = self.report("poisson", mesh, "--rhs", 0, "--dirichlet", "x", "--dirichlet",
                             "west=x==0", "-o", "out.ovm")
        points, fields = self.read_ovm("out.ovm")
        for point, (u,) in zip(points, fields["V", "u"]):
            if point[0] == 0:
                self.assertEqual(u, 1)
        self.fail_with(2, "poisson", mesh, "--rhs", 0, "--dirichlet", "north=1",
                       says=["north", "west, east, top"])
        report = self.report("convert", mesh, "boundary.ply", "--surface")
        self.assertEqual(report["patches"], ["west", "east", "top"])
        numbers = self.read_field("boundary.ply", "patch", "face")
        self.assertEqual([numbers.count(k) for k in [-1, 0, 1, 2]], [27, 9, 9, 9])
        # Every third cell of the grid is at x = 0.
        cells = self.read_field("boundary.ply", "cell_id", "face")
        west = {int(c) for c, patch in zip(cells, numbers) if patch == 0}
        self.assertEqual(west, set(range(0, 27, 3)))

    def test_coefficients_of_cells(self):
        points, cells = grid(4)
        self.write_ovm("cube.ovm", points, cells)
        text = (self.folder / "cube.ovm").read_text()
        centres = [[sum(points[v][k] for face in cell for v in face) / 24 for k in range(3)]
                   for cell in cells]

        def with_field(kind, values):
            self.write("k.ovm", text + f'CProp {kind} "k"\n' + "".join(
                " ".join(map(str, value)) + "\n" for value in values))
            return ["poisson", "k.ovm", "--coefficient-field", "k", "--rhs", 0]

        # Layers in series: the flux is the same in both, so the slopes are as 3 to 1.
        layers = with_field("double", [[1 if x < 0.5 else 3] for x, _, _ in centres])
        report = self.report(*layers, "--dirichlet", "x", "--dirichlet-where",
                             "x<1e-9 || x>1-1e-9", "--exact", "x<=0.5 ? 1.5*x : 0.75+(x-0.5)/2")
        # Diamonds over the face between the layers see both: first order in the cells of 1/4.
        self.assertLess(report["errors"]["max"], 0.1)
        # div(K grad u) = 0 for linear u and constant K; flux K grad u for u = x + y + z.
        flux = " : ".join(f"{c}<1e-9 ? -({f}) : {c}>1-1e-9 ? ({f})"
                          for c, f in [("x", "2+0.5+0.25"), ("y", "0.5+3+0.125"),
                                       ("z", "0.25+0.125+4")]) + " : 0"
        for kind, tensor in [("vec6d", [2, 3, 4, 0.5, 0.125, 0.25]),
                             ("vec9d", [2, 0.5, 0.25, 0.5, 3, 0.125, 0.25, 0.125, 4])]:
            arguments = with_field(kind, [tensor] * len(cells))
            report = self.report(*arguments, "--neumann", flux, "--exact", "x+y+z")
            self.assertLess(report["errors"]["max"], 1e-12)
        skew = with_field("vec9d", [[2, 0.5, 0, 0, 3, 0, 0, 0, 4]] * len(cells))
        self.fail_with(2, *skew, "--dirichlet", "x", says=["cell 0", "not symmetric"])
        self.fail_with(2, *with_field("vec2d", [[1, 1]] * len(cells)), "--dirichlet", "x",
                       says=["2 components", "xx yy zz"])
        self.fail_with(2, *with_field("double", [[-1]] * len(cells)), "--dirichlet", "x",
                       says="cell 0")
        self.fail_with(2, "poisson", "k.ovm", "--coefficient-field", "q", "--rhs", 0,
                       "--dirichlet", "x", says=["--coefficient-field q", "it has k"])


class Geodesics(CaratTest):
    def test_distances_in_a_cube_are_euclidean(self):
        self.generate("cube-tets", 2, "cube.ovm")
        points, _ = self.read_ovm("cube.ovm")
        source = min(range(len(points)), key=lambda v: sum(x * x for x in points[v]))
        self.succeed("geodesics", "cube.ovm", "--source", source, "-o", "out.ovm")
        distance = self.read_ovm("out.ovm")[1]["V", "distance"]
        errors = [d - math.dist(points[source], p) for p, (d,) in zip(points, distance)]
        # First order in the edges of about 0.1.
        self.assertLess(math.sqrt(sum(e * e for e in errors) / len(errors)), 0.05)

    def test_components(self):
        self.write_ovm("two.ovm", CORNERS + [(x + 5, y, z) for x, y, z in CORNERS] + [(9, 9, 9)],
                       [TETRAHEDRON, [tuple(v + 4 for v in face) for face in TETRAHEDRON]])
        report = self.report("geodesics", "two.ovm", "--source", 1)
        self.assertEqual(report["diagnostics"]["unreachable_vertices"]["elements"],
                         [4, 5, 6, 7, 8])
        self.fail_with(2, "geodesics", "two.ovm", "--source", 8, says="8")
        info = self.report("info", "two.ovm")
        self.assertEqual(info["statistics"]["components"], 2)
        self.assertEqual(info["diagnostics"]["unreferenced_vertices"]["elements"], [8])
        lines = self.succeed("info", "two.ovm").splitlines()
        self.assertEqual(sum("without a cell" in line for line in lines), 1)


class Eigen(CaratTest):
    def test_cube(self):
        self.generate("cube-tets", 2, "cube.vtu")
        report = self.report("eigen", "cube.vtu", "-k", 4, "--dirichlet")
        exact = [3, 6, 6, 6]
        for value, factor in zip(report["eigenvalues"], exact):
            self.assertAlmostEqual(value / (factor * math.pi ** 2), 1, delta=0.05)
        self.assertLess(max(report["residuals"]), 1e-9)
        both = {solver: self.report("eigen", "cube.vtu", "-k", 4, "--solver", solver)
                for solver in ("cholesky", "iterative")}
        for solver, run in both.items():
            self.assertEqual(run["solver"]["kind"], solver)
            self.assertGreater(run["solver"]["bytes"], 0)
        for one, other in zip(*(run["eigenvalues"] for run in both.values())):
            self.assertAlmostEqual(one, other, delta=1e-9)
        self.fail_with(2, "eigen", "cube.vtu", "--solver", "qr", says="cholesky, iterative")
        report = self.report("eigen", "cube.vtu", "-k", 5, "-o", "out.ovm")
        self.assertEqual(report["zero_modes"], 1)
        for value, factor in zip(report["eigenvalues"], [0, 1, 1, 1, 2]):
            self.assertAlmostEqual(value / math.pi ** 2, factor, delta=0.05)
        _, fields = self.read_ovm("out.ovm")
        constant = [u for (u,) in fields["V", "mode_1"]]
        self.assertAlmostEqual(min(constant), 1, delta=1e-12)  # M-norm 1 in a volume of 1
        self.assertAlmostEqual(max(constant), 1, delta=1e-12)

    def test_sphere(self):
        self.generate("sphere-hexagons", 2)
        report = self.report("eigen", "mesh.ply", "-k", 9, "-o", "out.ply")
        for value, exact in zip(report["eigenvalues"], [0] + 3 * [2] + 5 * [6]):
            self.assertAlmostEqual(value, exact, delta=0.15)
        lines = self.succeed("eigen", "mesh.ply", "-k", 9).splitlines()
        rows = lines[next(i for i, line in enumerate(lines) if line.startswith("mode ")) + 1:]
        self.assertEqual([row.split()[0] for row in rows[:9]], list("123456789"))
        self.assertEqual(len(rows[8].split()), 3)
        names = [f["name"] for f in self.report("info", "out.ply")["fields"]["vertex"]]
        self.assertEqual(names, [f"mode_{k}" for k in range(1, 10)])


class BadMeshes(CaratTest):
    def refuse(self, name, says):
        before = self.files()
        for arguments in [["info", name], ["convert", name, "out.vtu"],
                          ["poisson", name, "--rhs", 1, "--dirichlet", 0, "-o", "out.vtu"],
                          ["eigen", name, "-o", "out.html"]]:
            self.fail_with(3, *arguments, says=[name, *([says] if isinstance(says, str) else says)])
        self.assertEqual(self.files(), before)

    def test_open_cell(self):
        self.write_ovm("open.ovm", CORNERS + [(1, 1, 1)],
                       [[(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 4)]])
        self.refuse("open.ovm", ["cell 0", "not closed"])

    def test_cell_of_two_parts(self):
        points = CORNERS + [(x + 5, y, z) for x, y, z in CORNERS]
        self.write_ovm("parts.ovm", points,
                       [TETRAHEDRON + [tuple(v + 4 for v in face) for face in TETRAHEDRON]])
        self.refuse("parts.ovm", ["cell 0", "several parts"])

    def test_face_of_three_cells(self):
        def tetrahedron(d):
            return [(0, 2, 1), (0, 1, d), (1, 2, d), (2, 0, d)]
        self.write_ovm("three.ovm", CORNERS + [(0, 0, -1), (1, 1, 2)],
                       [tetrahedron(3), tetrahedron(4), tetrahedron(5)])
        self.refuse("three.ovm", ["three cells", "0, 1 and 2"])

    def test_not_a_number(self):
        self.write_ovm("nan.ovm", [(0, 0, math.nan), *CORNERS[1:]], [TETRAHEDRON])
        self.refuse("nan.ovm", "nan")

    def test_truncated(self):
        self.generate("ball-hexahedra", 0, "whole.vtu")
        self.generate("ball-hexahedra", 0, "whole.ovm")
        for whole in ["whole.vtu", "whole.ovm"]:
            content = (self.folder / whole).read_bytes()
            for part in [0.3, 0.6, 0.95]:
                self.write("cut" + whole[5:], content[:int(part * len(content))])
                self.refuse("cut" + whole[5:], [])

    def test_impossible_counts(self):
        self.write("huge.ovm", "OVM ASCII\nVertices\n1000000000000\n0 0 0\n")
        self.refuse("huge.ovm", "1000000000000")

    def test_inverted_cells_are_named(self):
        points, cells = grid(2)
        points[13] = (-0.9, -0.9, -0.9)  # the middle: cell 0 is inside out
        self.write_ovm("bad.ovm", points, cells)
        diagnostics = self.report("info", "bad.ovm")["diagnostics"]
        self.assertEqual(diagnostics["inverted_cells"]["elements"], [0])
        self.assertIn("! 1 inverted cell,", self.succeed("info", "bad.ovm"))
        for arguments in [["poisson", "--rhs", 1, "--dirichlet", 0], ["geodesics", "--source", 26]]:
            run = self.carat(arguments[0], "bad.ovm", *arguments[1:], "--json")
            self.assertIn(run.returncode, [0, 4], run.stderr)
            self.assertNotRegex(run.stdout, r"\b(NaN|Infinity|nan|inf)\b")
        self.fail_with(3, "poisson", "bad.ovm", "--rhs", 1, "--dirichlet", 0, "--strict",
                       says=["degenerate", "leave out --strict"])

    def test_needles(self):
        points, cells = grid(2)
        self.write_ovm("needle.ovm", [(x, y, 1e-7 * z) for x, y, z in points], cells)
        info = self.report("info", "needle.ovm")
        self.assertEqual(info["diagnostics"]["flat_cells"]["count"], 0)
        self.assertEqual(info["diagnostics"]["short_edges"]["count"], 18)
        report = self.report("poisson", "needle.ovm", "--rhs", 0, "--dirichlet", "x",
                             "--exact", "x")
        self.assertLess(report["errors"]["max"], 1e-9)
        self.write_ovm("flat.ovm", [(x, y, 0) for x, y, z in points], cells)
        info = self.report("info", "flat.ovm")
        self.assertEqual(info["diagnostics"]["flat_cells"]["count"], 8)
        self.assertGreater(info["diagnostics"]["excluded_samples"]["count"], 0)


def foam(kind, body):
    return (f"FoamFile\n{{\n    version 2.0;\n    format ascii;\n    class {kind};\n"
            f"    location \"constant/polyMesh\";\n    object x;\n}}\n{body}\n")


class OpenFoam(CaratTest):
    """A case folder as OpenFOAM leaves it: the form of the documented example."""

    def setUp(self):
        super().setUp()
        points, cells = grid(2)
        owners = {}
        for c, cell in enumerate(cells):
            for face in cell:
                owners.setdefault(frozenset(face), []).append((c, face))
        inner = sorted((u for u in owners.values() if len(u) == 2), key=lambda u: u[0][0])
        outer = [u for u in owners.values() if len(u) == 1]

        def west(use):
            return all(points[v][0] == 0 for v in use[0][1])
        outer.sort(key=lambda use: not west(use))
        n_west = sum(map(west, outer))
        folder = self.folder / "case/constant/polyMesh"
        folder.mkdir(parents=True)

        def write(name, kind, entries):
            body = f"{len(entries)}\n(\n" + "\n".join(entries) + "\n)"
            (folder / name).write_text(foam(kind, body))
        write("points", "vectorField", [f"({x} {y} {z})" for x, y, z in points])
        faces = inner + outer
        write("faces", "faceList", [f"4({' '.join(map(str, use[0][1]))})" for use in faces])
        write("owner", "labelList", [str(use[0][0]) for use in faces])
        write("neighbour", "labelList", [str(use[1][0]) for use in inner])
        patches = [("west", len(inner), n_west), ("walls", len(inner) + n_west,
                                                  len(outer) - n_west)]
        write("boundary", "polyBoundaryMesh",
              [f"{name}\n{{\n    type wall;\n    nFaces {n};\n    startFace {start};\n}}"
               for name, start, n in patches])

    def test_every_command(self):
        for path in ["case", "case/constant/polyMesh"]:
            report = self.report("info", path)
            self.assertEqual(report["sizes"]["cells"], 8)
            self.assertEqual(report["statistics"]["cells_of_kind"], {"hexahedra": 8})
            self.assertEqual([(p["name"], p["type"], p["faces"]) for p in report["patches"]],
                             [("west", "wall", 4), ("walls", "wall", 20)])
            self.assertAlmostEqual(report["statistics"]["volume"], 1, delta=1e-14)
        report = self.report("poisson", "case", "--rhs", 0, "--dirichlet", "west=1", "--exact", 1,
                             "-o", "u.vtu")
        self.assertEqual(report["sizes"]["dirichlet_vertices"], 9)
        self.assertLess(report["errors"]["max"], 1e-14)
        self.succeed("geodesics", "case", "--source", 0, "-o", "distance.vtu")
        self.report("eigen", "case", "-k", 3, "-o", "modes.html")
        self.succeed("view", "case", "u.vtu", "-o", "page.html")
        self.assertIn('"case"', (self.folder / "page.html").read_text())
        self.succeed("convert", "case", "case.ovm")
        self.assertEqual(len(self.report("info", "case.ovm")["patches"]), 2)
        self.assertEqual(self.report("convert", "case", "case.vtu")["notes"],
                         ["dropped the boundary patches west, walls: case.vtu is of a format "
                          "without patches"])
        self.assertFalse(any(pathlib.Path(self.folder / "case").glob("*.vtu")))

    def test_damaged(self):
        path = self.folder / "case/constant/polyMesh/faces"
        content = path.read_text()
        path.write_text(content[:len(content) // 2])
        self.fail_with(3, "info", "case", says="case")
        path.unlink()
        self.fail_with(3, "info", "case", says="case")


if __name__ == "__main__":
    main()
