"""Bad input: the exit code, one line that says what and where, and no half-written files."""

import json
import resource
import signal
import subprocess

from support import PROGRAM, CaratTest, main

SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"


class Usage(CaratTest):
    def setUp(self):
        super().setUp()
        self.generate("plane-quads", 0)

    def test_command_line(self):
        for arguments, says in [
            (["geodesic"], "did you mean 'geodesics'?"),
            (["frobnicate"], "unknown command 'frobnicate'"),
            (["info"], "MESH is required"),
            (["info", "mesh.ply", "--frobnicate"], "--frobnicate"),
            (["info", "mesh.ply", "--threads", "-1"], "Value -1 not in range 0 to 1024"),
            (["info", "mesh.ply", "--threads", "many"], "Value many not in range 0 to 1024"),
            (["list", "colours"], "colours not in {operators,families,formats,apps,experiments}"),
            (["generate", "plane-quads", "-o", "a.ply"], "--level is required"),
            (["generate", "plane-quads", "--level", "x", "-o", "a.ply"], "--level = x"),
            (["generate", "plane-quads", "--level", "-1", "-o", "a.ply"], "level -1"),
            (["generate", "plane-quads", "--level", "99", "-o", "a.ply"], "level 99"),
            (["generate", "plane-quads", "--level", "99999999999", "-o", "a.ply"], "99999999999"),
            (["generate", "plane-quads", "--level", 0, "--jitter", 2, "-o", "a.ply"], "jitter 2"),
            (["generate", "plane-quads", "--level", 0, "--jitter", "nan", "-o", "a.ply"], "nan"),
            (["generate", "klein-bottle", "--level", 0, "-o", "a.ply"], "sphere-hexagons"),
            (["curvature", "mesh.ply", "--operator", "fem"], "fem not in {diamond"),
            (["curvature", "mesh.ply", "--virtual-point", "middle"], "middle"),
            (["curvature", "mesh.ply", "--weights", "heavy"], "heavy"),
            (["curvature", "mesh.ply", "-o", "a.obj"], "carry no fields"),
            (["geodesics", "mesh.ply"], "--source is required"),
            (["geodesics", "mesh.ply", "--source", "a"], "--source = a"),
            (["geodesics", "mesh.ply", "--source", 0, 1], "not expected: 1"),
            (["geodesics", "mesh.ply", "--source", -1], "--source -1"),
            (["geodesics", "mesh.ply", "--source", 100000],
             ["--source 100000", "vertices 0 to 48"]),
            (["geodesics", "mesh.ply", "--source", 99999999999], "99999999999"),
            (["geodesics", "mesh.ply", "--source", 0, "--t-coef", 0], "t_coef"),
            (["geodesics", "mesh.ply", "--source", 0, "--t-coef", "nan"], "t_coef"),
            (["view", "mesh.ply", "-o", "page.ply"], "page.ply"),
        ]:
            with self.subTest(arguments=arguments):
                self.fail_with(2, *arguments, says=says)
        self.assertEqual(self.files(), ["mesh.ply"])

    def test_source_files(self):
        mesh = ["geodesics", "mesh.ply", "--each"]
        for content, says in [("0\n# none\n49\n", ["list.txt: line 3: vertex 49", "vertices 0 to 48"]),
                              ("0\n1 -2\n", "line 2: vertex -2"),
                              ("0\n1 x\n", "line 2: 'x' is not a whole number"),
                              ("0\n1.5\n", "line 2"),
                              ("# none\n", "lists no source")]:
            with self.subTest(content=content):
                self.write("list.txt", content)
                self.fail_with(3, *mesh, "--sources-file", "list.txt", "-o", "a.npy", says=says)
        self.fail_with(3, *mesh, "--sources-file", "gone.txt", says="gone.txt")
        self.write("list.txt", "".join(f"{k}\n" for k in range(49)) * 2)
        self.fail_with(2, *mesh, "--sources-file", "list.txt", "-o", "a.vtp",
                       says=["98 distances are too many", ".npy"])
        self.fail_with(3, *mesh, "--source", 0, "-o", "no/a.npy", says="folder no does not exist")
        self.fail_with(2, "geodesics", "mesh.ply", "--source", 0, "-o", "a.npy", says="--each")
        self.fail_with(2, *mesh, "--source", 0, "--solver", "magic", says="multigrid")
        self.assertEqual(self.files(), ["list.txt", "mesh.ply"])

    def test_expressions(self):
        for text, says in [
            ("sin(x", ["'sin(x', character 6", "missing parenthesis"]),
            ("foo(x)", ["character 1", '"foo"']),
            ("2*y+q", ["character 5", '"q"']),
            ("x+", ["character 3", "unexpected end"]),
            ("", "empty"),
            ("x,y", "2 expressions"),
            ("x # y", "character 3"),
            ("log(-1-x)", "is nan at (0, 0, 0)"),
            ("1/(x-1)", "is inf at (1, 0, 0)"),
            ("1e999", "'1e999'"),
        ]:
            for option in ["--rhs", "--dirichlet", "--exact"]:
                with self.subTest(option=option, text=text):
                    others = [] if option == "--rhs" else ["--rhs", "1"]
                    if option == "--exact":
                        others += ["--dirichlet", "0"]
                    words = [says] if isinstance(says, str) else says
                    self.fail_with(2, "poisson", "mesh.ply", *others, option, text,
                                   says=[option, *words])

    def test_assignments(self):
        for option in ["--rhs", "--exact"]:
            others = [] if option == "--rhs" else ["--rhs", "1", "--dirichlet", "0"]
            self.fail_with(2, "poisson", "mesh.ply", *others, option, "x=1",
                           says=[option, "character 2", '"=="'])
        for option in ["--dirichlet", "--neumann", "--robin"]:
            self.fail_with(2, "poisson", "mesh.ply", "--rhs", "0", option, "x=1",
                           says=[option + " x=", "no boundary patch", "'=='"])
            self.fail_with(2, "poisson", "mesh.ply", "--rhs", "0", option, "=1", says="PATCH=EXPR")
            self.fail_with(2, "poisson", "mesh.ply", "--rhs", "0", option, "1", option, "2",
                           says=[option, "given twice"])
        self.succeed("poisson", "mesh.ply", "--rhs", "0", "--dirichlet", "x<=0.5 ? x==0 : x>=1")

    def test_boundary_data_that_do_nothing(self):
        self.generate("sphere-quads", 0, "sphere.ply")
        for arguments, says in [
            (["mesh.ply", "--rhs", 1, "--dirichlet-where", "x"], "add --dirichlet"),
            (["mesh.ply", "--rhs", 1, "--dirichlet", 0, "--neumann", 1], "no boundary edge"),
            (["mesh.ply", "--rhs", 1, "--dirichlet", 0, "--robin", 1], "no boundary edge"),
            (["mesh.ply", "--rhs", 1, "--dirichlet", 0, "--dirichlet-where", "x>2"],
             "0 at every boundary vertex"),
            (["mesh.ply", "--rhs", 1, "--robin", -1], "alpha"),
            (["mesh.ply", "--rhs", 1, "--dirichlet", 0, "--coefficient", "x-2"], "coefficient"),
            (["sphere.ply", "--rhs", "x", "--dirichlet", 0], "closed"),
            (["sphere.ply", "--rhs", "x", "--neumann", 0], "closed"),
        ]:
            with self.subTest(arguments=arguments):
                self.fail_with(2, "poisson", *arguments, says=says)

    def test_json_errors(self):
        for arguments, kind, exit_code in [
            (["info", "nothing.ply"], "io", 3),
            (["info", "--frobnicate"], "usage", 2),
            (["frobnicate"], "usage", 2),
            (["geodesics", "mesh.ply", "--source", "5000"], "invalid_option", 2),
            (["poisson", "mesh.ply", "--rhs", "1"], "solver_failure", 4),
        ]:
            with self.subTest(arguments=arguments):
                run = self.carat(*arguments, "--json")
                self.assertEqual(run.returncode, exit_code)
                self.assertEqual(len(run.stderr.splitlines()), 1)
                report = json.loads(run.stdout)
                self.assertEqual(list(report), ["error"])
                self.assertEqual(set(report["error"]), {"kind", "message", "elements"})
                self.assertEqual(report["error"]["kind"], kind)
                self.assertEqual(run.stderr, f"carat: error: {report['error']['message']}\n")
        self.assertEqual(json.loads(self.carat("geodesics", "mesh.ply", "--source", 5000, "--json")
                                    .stdout)["error"]["elements"], [5000])

    def test_unbalanced_data_are_numerical(self):
        self.fail_with(4, "poisson", "mesh.ply", "--rhs", 1, says=["component 0", "Dirichlet"])

    def test_standard_output_that_is_full(self):
        for mode in [], ["--json"]:
            with open("/dev/full", "w", encoding="ascii") as full:
                run = subprocess.run([PROGRAM, "info", "mesh.ply", *mode], cwd=self.folder,
                                     stdout=full, stderr=subprocess.PIPE, text=True, timeout=60)
            self.assertEqual(run.returncode, 3)
            self.assertIn("standard output", run.stderr)


class Meshes(CaratTest):
    def refuse(self, name, content, says):
        if content is not None:
            self.write(name, content)
        before = self.files()
        for arguments in [["info", name], ["convert", name, "out.ply"],
                          ["geodesics", name, "--source", 0, "-o", "out.vtp"],
                          ["operators", name, "-o", "out"]]:
            self.fail_with(3, *arguments, says=[name, *([says] if isinstance(says, str) else says)])
        self.assertEqual(self.files(), before)

    def test_missing(self):
        self.refuse("nothing.ply", None, "No such file")

    def test_folder(self):
        (self.folder / "folder.ply").mkdir()
        self.refuse("folder.ply", None, "folder")

    def test_empty(self):
        self.refuse("empty.obj", "", "empty")

    def test_wrong_format(self):
        self.refuse("text.ply", "This is a letter, not a mesh.\n", [])
        self.refuse("image.xyz", b"\x89PNG\r\n\x1a\n\0\0\0", "'.xyz'")

    def test_truncated(self):
        self.generate("sphere-quads", 0, "whole.ply")
        self.generate("sphere-quads", 0, "whole.vtp")
        self.generate("sphere-quads", 0, "whole.off")
        for whole in ["whole.ply", "whole.vtp", "whole.off"]:
            content = (self.folder / whole).read_bytes()
            self.refuse("cut." + whole[-3:], content[:len(content) * 2 // 3], [])

    def test_index_out_of_range(self):
        self.refuse("index.obj", SQUARE + "f 1 2 9\n", ["line 5", "9"])
        self.refuse("index.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n", "7")

    def test_face_without_three_vertices(self):
        self.refuse("two.obj", SQUARE + "f 1 2 3\nf 1 2\n", "line 6")
        self.refuse("same.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 0\n", "face 0")

    def test_not_a_number(self):
        self.refuse("nan.obj", "v 0 0 nan\nv 1 0 0\nv 1 1 0\nf 1 2 3\n", "nan")

    def test_impossible_counts(self):
        self.refuse("huge.ply", "ply\nformat ascii 1.0\nelement vertex 1000000000000\n"
                    "property double x\nproperty double y\nproperty double z\n"
                    "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n",
                    "1000000000000")
        self.refuse("huge.off", "OFF\n1000000000000 1 0\n0 0 0\n", "1000000000000")

    def test_simplices_only_operator(self):
        self.generate("plane-quads", 0, "quads.ply")
        self.fail_with(3, "curvature", "quads.ply", "--operator", "cotan", says="triangle")

    def test_strict(self):
        self.write("flat.obj", SQUARE + "v 2 0 0\nf 1 2 3 4\nf 1 2 5\n")
        report = self.report("curvature", "flat.obj", "--operator", "bunge")
        self.assertGreater(report["diagnostics"]["excluded_samples"]["count"], 0)
        self.fail_with(3, "curvature", "flat.obj", "--operator", "bunge", "--strict",
                       says=["degenerate", "leave out --strict"])

    def test_one_is_not_many(self):
        self.write("one.obj", SQUARE + "v 9 9 9\nf 1 2 3\nf 1 3 4\nf 1 2 3\n")
        lines = self.succeed("info", "one.obj").splitlines()
        for line in ["! 1 edge of more than two faces", "! 1 face with the vertices of"]:
            self.assertTrue(any(found.startswith(line) for found in lines), line)
        self.assertTrue(any(line.startswith("! 1 vertex without a face") for line in lines))


class Outputs(CaratTest):
    def setUp(self):
        super().setUp()
        self.generate("plane-quads", 1)

    def every_writer(self, suffix=""):
        for extension in ["ply", "off", "obj", "vtp", "vtu", "html"]:
            yield ["convert", "mesh.ply", f"out{suffix}.{extension}"], f"out{suffix}.{extension}"
        yield (["geodesics", "mesh.ply", "--source", 0, "-o", f"far{suffix}.vtp"],
               f"far{suffix}.vtp")

    def test_places_that_cannot_be_written(self):
        for arguments, _ in self.every_writer():
            arguments[-1] = "missing/" + arguments[-1]
            self.fail_with(3, *arguments, says=["missing", "create it first"])
            arguments[-1] = "/proc/" + arguments[-1].split("/")[1]
            self.fail_with(3, *arguments, says=arguments[-1])
        self.fail_with(3, "operators", "mesh.ply", "-o", "missing/out", says="missing")
        self.fail_with(3, "operators", "mesh.ply", "-o", "/proc/out", says="/proc/out")
        self.fail_with(3, "operators", "mesh.ply", "-o", "mesh.ply", says="no folder")
        self.fail_with(3, "convert", "mesh.ply", "out.xyz", says=["'.xyz'", ".vtp"])
        self.fail_with(3, "convert", "mesh.ply", "out.stl", says="'.stl'")
        self.assertEqual(self.files(), ["mesh.ply"])

    def full_disk(self):
        """Files may not grow beyond a few bytes: writing fails, as on a full disk."""
        def limit():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))
        return {"preexec_fn": limit}

    def test_full_disk(self):
        for arguments, name in self.every_writer():
            self.fail_with(3, *arguments, says=name, **self.full_disk())
            self.assertEqual(self.files(), ["mesh.ply"])
            self.write(name, "precious")
            self.fail_with(3, *arguments, says=name, **self.full_disk())
            self.assertEqual((self.folder / name).read_text(), "precious")
            (self.folder / name).unlink()

    def test_full_disk_under_operators(self):
        arguments = ["operators", "mesh.ply", "-o", "out"]
        self.fail_with(3, *arguments, says="out", **self.full_disk())
        self.assertEqual(self.files(), ["mesh.ply"])
        self.succeed(*arguments)
        before = {name: (self.folder / name).read_bytes() for name in self.files()
                  if "." in name}
        self.fail_with(3, *arguments, "--lumped", says="out", **self.full_disk())
        self.assertEqual({name: (self.folder / name).read_bytes() for name in self.files()
                          if "." in name}, before)

    def test_existing_folder_is_updated(self):
        (self.folder / "out").mkdir()
        self.write("out/notes.txt", "mine")
        self.succeed("operators", "mesh.ply", "-o", "out")
        lumped = self.report("operators", "mesh.ply", "-o", "out", "--lumped")
        kept = json.loads((self.folder / "out/operators.json").read_text())
        self.assertEqual(kept["options"]["mass"], "lumped")
        self.assertEqual(kept["nnz"], lumped["nnz"])
        self.assertEqual(self.files(), sorted(
            ["mesh.ply", "out", "out/notes.txt", *("out/" + f for f in lumped["files"])]))


if __name__ == "__main__":
    main()
