import re
"""What every command does when all is well."""

import ast
import os
import struct
import subprocess

from support import PROGRAM, CaratTest, main

APPS = ["curvature", "geodesics", "poisson", "eigen"]
COMMANDS = ["info", *APPS, "operators", "view", "convert", "generate", "list"]

# Kind -> command, operator, mass, theta where they are not the operator's own.
DEFAULTS = {
    "surface": [("curvature", "diamond", "lumped", None),
                ("eigen", "stabilized_diamond", "moment-exact", None),
                ("geodesics", "stabilized_diamond", None, 0.8),
                ("operators", "diamond", None, None),
                ("poisson", "stabilized_diamond", None, None)],
    "volume": [("eigen", "stabilized_diamond", None, None),
               ("geodesics", "diamond", None, None),
               ("operators", "diamond", None, None),
               ("poisson", "diamond", None, None)],
}


class Help(CaratTest):
    def test_program(self):
        text = self.succeed("--help")
        for command in COMMANDS:
            self.assertRegex(text, rf"(?m)^  {command} ")
        self.assertIn("Examples:", text)
        self.assertRegex(self.succeed("--version"), r"^carat \d+\.\d+\.\d+\n$")
        bare = self.carat()
        self.assertEqual((bare.returncode, bare.stdout), (2, text))

    def test_commands(self):
        for command in COMMANDS:
            for flag in ["-h", "--help"]:
                text = self.succeed(command, flag)
                self.assertIn("Examples:", text)
                self.assertIn(f"carat {command} ", text.split("Examples:")[1])
                self.assertIn("--json", text)
                self.assertIn("--threads", text)
                self.assertLess(max(map(len, text.splitlines())), 101, command)

    def test_defaults_and_choices_come_from_the_registries(self):
        operators = self.report("list", "operators")["operators"]
        names = {kind: [o["name"] for o in operators if o["kind"] == kind]
                 for kind in ["surface", "volume"]}
        for kind, of_kind in names.items():
            uses = [(use["command"], o["name"], use.get("mass"), use.get("theta"))
                    for o in operators if o["kind"] == kind for use in o["default_of"]]
            self.assertEqual(sorted(uses), DEFAULTS[kind])
            self.assertEqual(uses[0], ("operators", of_kind[0], None, None))
        both = list(dict.fromkeys(names["surface"] + names["volume"]))
        for command in APPS + ["operators"]:
            choices = names["surface"] if command == "curvature" else both
            text = self.succeed(command, "--help")
            for kind in DEFAULTS:
                for use, name, mass, theta in DEFAULTS[kind]:
                    if use != command:
                        continue
                    words = name + (f", mass {mass}" if mass else "")
                    words += f", theta {theta}" if theta else ""
                    before = "in volumes " if kind == "volume" else "Default: "
                    self.assertIn(before + words, re.sub(r"\s+", " ", text))
            for name in choices:
                self.assertRegex(text, rf"(Surfaces|volumes):\s[\w\s,]*\b{name}\b")


class DefaultOperators(CaratTest):
    """What the commands take where no operator is named."""

    def test_every_command_takes_its_own(self):
        self.generate("sphere-hexagons", 1, "surface.ply")
        self.generate("cube-voronoi", 0, "volume.vtu")
        for kind, mesh in [("surface", "surface.ply"), ("volume", "volume.vtu")]:
            for command, name, mass, theta in DEFAULTS[kind]:
                more = {"geodesics": ["--source", 0], "eigen": ["-k", 2],
                        "poisson": ["--rhs", "0"], "operators": ["-o", "out"]}.get(command, [])
                bare = self.report(command, mesh, *more)["options"]
                self.assertEqual(bare["operator"], name)
                if mass:
                    self.assertEqual(bare["mass"], mass)
                if theta:
                    self.assertEqual(bare["theta"], theta)
                # Who names an operator gets it as it is; who names an option gets that one.
                named = self.report(command, mesh, *more, "--operator", "diamond")["options"]
                self.assertEqual((named["operator"], named["mass"]), ("diamond", "full"))
                full = self.report(command, mesh, *more, "--mass", "full")["options"]
                self.assertEqual((full["operator"], full["mass"]), (name, "full"))
                if name == "stabilized_diamond":
                    other = self.report(command, mesh, *more, "--theta", 0.5)["options"]
                    self.assertEqual(other["theta"], 0.5)


class List(CaratTest):
    def test_lists(self):
        lists = {what: self.report("list", what)[what]
                 for what in ["operators", "families", "formats", "apps"]}
        names = {what: [entry["name"] for entry in entries] for what, entries in lists.items()}
        self.assertEqual(names["operators"],
                         ["diamond", "stabilized_diamond", "bunge", "cotan", "alexa_wardetzky", "de_goes",
                          "vem", "diamond", "stabilized_diamond", "bunge", "primal_tet",
                          "dual_tet", "ceve", "cevefe", "vem"])
        for family in ["sphere-hexagons", "ball-voronoi"]:
            self.assertIn(family, names["families"])
        self.assertIn("vtp", names["formats"])
        self.assertEqual(sorted(names["apps"]), sorted(APPS))
        for what in ["formats", "apps"]:
            lines = self.succeed("list", what).splitlines()
            self.assertEqual([line.split()[0] for line in lines], names[what])

    def test_kinds_are_grouped(self):
        for what in ["operators", "families"]:
            lines = self.succeed("list", what).splitlines()
            expected = []
            for kind in ["surface", "volume"]:
                expected += [kind.capitalize() + "s"] + [
                    "  " + entry["name"] for entry in self.report("list", what)[what]
                    if entry["kind"] == kind]
            self.assertEqual([line[:2].strip(" ") + line[2:].split()[0] if line[0] != " "
                              else "  " + line.split()[0] for line in lines], expected)

    def test_formats_of_volumes(self):
        formats = {f["name"]: f for f in self.report("list", "formats")["formats"]}
        self.assertTrue(formats["vtu"]["reads_volumes"] and formats["vtu"]["writes_volumes"])
        self.assertFalse(formats["ply"]["reads_volumes"] or formats["ply"]["writes_volumes"])


class Reports(CaratTest):
    def setUp(self):
        super().setUp()
        self.generate("sphere-hexagons", 1)

    def check(self, report, command, phases):
        for key in ["command", "version", "threads", "input", "sizes", "seconds", "diagnostics"]:
            self.assertIn(key, report)
        self.assertEqual(report["command"], command)
        self.assertEqual(list(report["seconds"]), phases)
        for seconds in report["seconds"].values():
            self.assertGreaterEqual(seconds, 0)
        for finding in report["diagnostics"].values():
            self.assertEqual(set(finding), {"count", "elements", "meaning"})

    def test_info(self):
        report = self.report("info", "mesh.ply")
        self.check(report, "info", ["read", "statistics", "symbolic", "numeric"])
        self.assertEqual(report["sizes"]["vertices"] - report["sizes"]["edges"]
                         + report["sizes"]["faces"], 2)
        statistics = report["statistics"]
        self.assertEqual(statistics["faces_of_valence"]["5"], 12)
        self.assertEqual(statistics["components"], 1)
        self.assertTrue(statistics["closed"])
        self.assertGreater(statistics["area"], 12)
        self.assertLess(statistics["area"], 12.5664)
        self.assertEqual(report["fields"], {"vertex": [], "face": []})
        self.assertIn("12 of 5", self.succeed("info", "mesh.ply"))

    def test_curvature(self):
        report = self.report("curvature", "mesh.ply", "--signed", "-o", "out.vtp")
        self.check(report, "curvature", ["read", "symbolic", "numeric", "solve", "write"])
        self.assertGreater(report["nnz"]["stiffness"], report["nnz"]["mass"])
        self.assertGreater(report["mean_curvature"]["min"], 0.9)
        fields = self.report("info", "out.vtp")["fields"]
        self.assertEqual([f["name"] for f in fields["vertex"]], ["mean_curvature"])

    def test_geodesics(self):
        report = self.report("geodesics", "mesh.ply", "--source", 3, "--source", 5,
                             "-o", "out.vtu")
        self.check(report, "geodesics", ["read", "symbolic", "numeric", "factor", "solve", "write"])
        self.assertEqual(report["options"]["sources"], [3, 5])
        self.assertGreater(report["time_step"], 0)
        fields = self.report("info", "out.vtu")["fields"]
        self.assertEqual([f["name"] for f in fields["vertex"]], ["distance"])
        self.assertEqual([(f["name"], f["components"]) for f in fields["face"]],
                         [("direction", 3)])

    def npy(self, name):
        """Shape and rows of a matrix of doubles, read as the format says."""
        content = (self.folder / name).read_bytes()
        self.assertEqual(content[:8], b"\x93NUMPY\x01\x00")
        start = 10 + struct.unpack("<H", content[8:10])[0]
        self.assertEqual(start % 64, 0)
        header = ast.literal_eval(content[10:start].decode("ascii"))
        self.assertEqual(header["fortran_order"], False)
        rows, columns = header["shape"]
        order = header["descr"]
        self.assertIn(order, ["<f8", ">f8"])
        values = struct.unpack(f"{order[0]}{rows * columns}d", content[start:])
        return [values[columns * k:columns * (k + 1)] for k in range(rows)]

    def field(self, name, *arguments):
        """A vertex field of a PLY file that holds x, y, z and it alone."""
        self.succeed("geodesics", "mesh.ply", *arguments, "-o", name)
        content = (self.folder / name).read_bytes()
        n = int(content.split(b"element vertex ")[1].split()[0])
        start = content.index(b"end_header\n") + 11
        return [row[3] for row in struct.iter_unpack("<4d", content[start:start + 32 * n])]

    def test_distances_from_each_source(self):
        (self.folder / "sources.txt").write_text("# landmarks\n7\n\n3 5  # the nearest\n" +
                                                 "".join(f"{k}\n" for k in range(20)))
        report = self.report("geodesics", "mesh.ply", "--source", 11, "--sources-file",
                             "sources.txt", "--each", "-o", "distances.npy")
        self.check(report, "geodesics", ["read", "symbolic", "numeric", "factor", "solve"])
        rows = self.npy("distances.npy")
        n = report["sizes"]["vertices"]
        self.assertEqual(report["source_sets"], 23)
        self.assertEqual(report["matrix"]["shape"], [23, n])
        self.assertEqual(report["matrix"]["bytes"],
                         (self.folder / "distances.npy").stat().st_size)
        self.assertEqual(report["incomplete_source_sets"], 0)
        self.assertEqual(report["largest_distance"]["value"], max(map(max, rows)))
        self.assertGreater(report["seconds_per_source_set"], 0)
        for k, arguments in {0: ["--source", 11], 1: ["--source", 7],
                             2: ["--source", 3, "--source", 5], 22: ["--source", 19]}.items():
            for a, b in zip(rows[k], self.field("one.ply", *arguments), strict=True):
                self.assertAlmostEqual(a, b, delta=1e-12)
        # Without --each: the nearest of all.
        (self.folder / "two.txt").write_text("3\n5\n")
        self.assertEqual(self.field("one.ply", "--sources-file", "two.txt"),
                         self.field("two.ply", "--source", 3, "--source", 5))
        self.report("geodesics", "mesh.ply", "--source", 3, "--source", 5, "--each", "-o", "f.vtp")
        fields = self.report("info", "f.vtp")["fields"]
        self.assertEqual([f["name"] for f in fields["vertex"]], ["distance_0", "distance_1"])
        self.assertEqual(fields["face"], [])

    def test_time_step_options(self):
        step = {name: self.report("geodesics", "mesh.ply", "--source", 0, *arguments)["time_step"]
                for name, arguments in {"max": [], "four": ["--t-coef", 4],
                                        "mean": ["--edge-length", "mean"]}.items()}
        self.assertEqual(step["four"], 4 * step["max"])
        self.assertLess(step["mean"], step["max"])

    def test_poisson(self):
        report = self.report("poisson", "mesh.ply", "--rhs", "2*x", "--exact", "x", "-o", "out.ply")
        self.check(report, "poisson", ["read", "symbolic", "numeric", "factor", "solve", "write"])
        self.assertEqual(report["floating_components"], 1)
        self.assertEqual(set(report["errors"]), {"rmse", "l2", "max"})
        self.assertLess(report["errors"]["max"], 0.1)
        names = [f["name"] for f in self.report("info", "out.ply")["fields"]["vertex"]]
        for name in ["u", "error"]:
            self.assertIn(name, names)
        self.assertIsNone(self.report("poisson", "mesh.ply", "--rhs", "x")["errors"])

    def test_operators(self):
        report = self.report("operators", "mesh.ply", "-o", "out")
        self.check(report, "operators", ["read", "symbolic", "numeric", "write"])
        self.assertEqual(self.files(), ["mesh.ply", "out"] + sorted(
            "out/" + file for file in report["files"]))
        self.assertEqual(set(report["files"]), {"stiffness.mtx", "mass.mtx", "gradient.mtx",
                                                "divergence.mtx", "operators.json"})

    def test_options_reach_the_operator(self):
        self.generate("sphere-concave", 0, "concave.ply")
        plain = self.report("curvature", "concave.ply")
        for arguments in [["--operator", "bunge"], ["--mass", "full"], ["--virtual-point", "centroid"],
                          ["--virtual-point", "trace"], ["--weights", "minimum-norm"]]:
            other = self.report("curvature", "concave.ply", *arguments)
            self.assertNotEqual(other["options"], plain["options"])
            self.assertNotEqual(other["mean_curvature"]["max"], plain["mean_curvature"]["max"],
                                arguments)
        self.generate("plane-lshape", 0, "l.ply")
        arguments = ["curvature", "l.ply", "--virtual-point", "centroid"]
        moved = self.report(*arguments)["diagnostics"]
        kept = self.report(*arguments, "--keep-flipped")["diagnostics"]
        self.assertGreater(moved["moved_virtual_vertices"]["count"], 0)
        self.assertEqual(moved["flipped_virtual_vertices"]["count"], 0)
        self.assertEqual(kept["flipped_virtual_vertices"]["count"],
                         moved["moved_virtual_vertices"]["count"])

    def test_view(self):
        self.succeed("geodesics", "mesh.ply", "--source", 0, "-o", "distance.vtp")
        report = self.report("view", "distance.vtp", "mesh.ply", "-o", "page.html")
        self.check(report, "view", ["read", "write"])
        self.assertEqual(report["input"], ["distance.vtp", "mesh.ply"])
        page = (self.folder / "page.html").read_text()
        self.assertIn('"distance"', page)
        self.assertNotRegex(page, r'(?:src|href)="https?:')
        self.succeed("curvature", "mesh.ply", "-o", "curvature.html")
        self.assertIn('"mean_curvature"', (self.folder / "curvature.html").read_text())

    def test_generate(self):
        report = self.report("generate", "plane-quads", "--level", 2, "--jitter", 0.2, "--seed", 3,
                             "--anisotropy", 2, "-o", "a.ply")
        self.check(report, "generate", ["generate", "write"])
        self.generate("plane-quads", 2, "b.ply", "--jitter", 0.2, "--seed", 3, "--anisotropy", 2)
        self.generate("plane-quads", 2, "c.ply", "--jitter", 0.2, "--seed", 4, "--anisotropy", 2)
        a, b, c = ((self.folder / f"{name}.ply").read_bytes() for name in "abc")
        self.assertEqual(a, b)
        self.assertNotEqual(a, c)

    def test_nothing_is_written_without_output(self):
        for arguments in [["curvature", "mesh.ply"], ["geodesics", "mesh.ply", "--source", 0],
                          ["poisson", "mesh.ply", "--rhs", "x"], ["info", "mesh.ply"]]:
            self.assertIn("time: ", self.succeed(*arguments))
        self.assertEqual(self.files(), ["mesh.ply"])

    def test_progress_is_for_terminals(self):
        run = self.carat("geodesics", "mesh.ply", "--source", 0)
        self.assertEqual(run.stderr, "")

    def test_progress_line_on_a_terminal(self):
        self.generate("sphere-quads", 5, "large.ply")
        master, terminal = os.openpty()
        with open(os.devnull, "w") as nowhere:
            subprocess.run([PROGRAM, "geodesics", "large.ply", "--source", "0", "--threads", "1"],
                           cwd=self.folder, stderr=terminal, stdout=nowhere, check=True,
                           env={**os.environ, "TERM": "xterm"}, timeout=120)
        os.close(terminal)
        drawn = b""
        try:
            while chunk := os.read(master, 4096):
                drawn += chunk
        except OSError:
            pass  # how a closed terminal ends
        os.close(master)
        self.assertIn(b"factor", drawn)
        self.assertTrue(drawn.endswith(b"\r\033[K"), drawn[-20:])


class Convert(CaratTest):
    def test_formats_keep_the_mesh(self):
        self.generate("sphere-hexagons", 0, "a.obj")
        for extension in ["off", "ply", "vtp", "vtu"]:
            self.succeed("convert", "a.obj", "b." + extension)
            self.succeed("convert", "b." + extension, "c.obj")
            self.assertEqual(self.read_obj("a.obj"), self.read_obj("c.obj"), extension)

    def test_dual(self):
        self.generate("sphere-triangles", 1)
        report = self.report("convert", "mesh.ply", "dual.ply", "--dual")
        for a, b in [("vertices", "faces"), ("faces", "vertices"), ("edges", "edges")]:
            self.assertEqual(report["sizes"][a], report["output_sizes"][b])

    def fields(self, name):
        return {element: [f["name"] for f in fields]
                for element, fields in self.report("info", name)["fields"].items()}

    def test_fields_go_along(self):
        self.generate("sphere-quads", 1)
        self.succeed("geodesics", "mesh.ply", "--source", 0, "-o", "a.vtp")
        both = {"vertex": ["distance"], "face": ["direction"]}
        self.assertEqual(self.fields("a.vtp"), both)
        self.succeed("convert", "a.vtp", "b.vtu")
        self.assertEqual(self.fields("b.vtu"), both)
        report = self.report("convert", "a.vtp", "triangles.vtp", "--triangulate")
        self.assertEqual(report["output_sizes"]["faces"], 2 * report["sizes"]["faces"])
        self.assertEqual(self.fields("triangles.vtp"), both)
        run = self.carat("convert", "a.vtp", "dual.vtp", "--dual")
        self.assertIn("carat: note: dropped distance:", run.stderr)
        self.assertEqual(self.fields("dual.vtp"), {"vertex": ["direction"], "face": []})
        run = self.carat("convert", "a.vtp", "c.obj")
        self.assertIn("carat: note: dropped direction: c.obj", run.stderr)
        self.assertEqual(run.returncode, 0)

    def test_dual_with_boundary_drops_face_fields(self):
        self.generate("plane-quads", 0)
        self.succeed("poisson", "mesh.ply", "--rhs", 1, "--dirichlet", 0, "-o", "a.vtp")
        report = self.report("convert", "a.vtp", "dual.vtp", "--dual")
        self.assertEqual(len(report["notes"]), 2)
        self.assertEqual(self.fields("dual.vtp"), {"vertex": [], "face": []})


if __name__ == "__main__":
    main()
