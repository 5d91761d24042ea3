"""--engine petsc: over several processes the answers of one. Takes mpirun as second argument, and
which tests: Engine, EngineFull."""

import json
import os
import struct
import subprocess
import sys

MPIRUN = sys.argv.pop(2)

from support import PROGRAM, CaratTest, main  # noqa: E402  (reads the first argument)

os.environ.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                  OMPI_MCA_rmaps_base_oversubscribe="1",
                  OMPI_MCA_mpi_yield_when_idle="1", OPENBLAS_NUM_THREADS="1")


class EngineTest(CaratTest):
    def job(self, n, *arguments):
        return subprocess.run(
            [MPIRUN, "-np", str(n), PROGRAM, "--engine", "petsc", *map(str, arguments)],
            cwd=self.folder, capture_output=True, text=True, timeout=120,
            stdin=subprocess.DEVNULL)

    def finish(self, n, *arguments):
        """Standard output of a job without a fault: that of its first process alone."""
        run = self.job(n, *arguments)
        self.assertEqual(run.returncode, 0, run.stderr)
        return run.stdout

    def job_report(self, n, *arguments):
        return json.loads(self.finish(n, *arguments, "--json"))

    def fields(self, file):
        """{(of, name): values}, of = 'V', or 'E' for faces of a surface and cells of a volume."""
        if not file.endswith((".ply", ".ovm")):
            kind = self.report("info", file)["kind"]
            name = "fields.ply" if kind == "surface" else "fields.ovm"
            self.succeed("convert", file, name)
            file = name
        if file.endswith(".ovm"):
            _, fields = self.read_ovm(file)
            return {("V" if of == "V" else "E", name): [x for row in rows for x in row]
                    for (of, name), rows in fields.items() if of in "VC"}
        header = (self.folder / file).read_bytes().split(b"end_header")[0].decode()
        fields = {}
        for block in header.split("element ")[1:]:
            element = block.split()[0]
            for line in block.splitlines():
                words = line.split()
                if words[:2] == ["property", "double"] and words[2] not in ("x", "y", "z"):
                    fields["V" if element == "vertex" else "E", words[2]] = self.read_field(
                        file, words[2], element)
        return fields

    def assert_same(self, one, many, tolerance, what=None):
        self.assertEqual(len(one), len(many), what)
        # A component that is zero is so beside others that are of the order of 1.
        scale = max(abs(x) for x in one if abs(x) < float("inf")) or 1
        for a, b in zip(one, many):
            self.assertTrue(a == b or abs(a - b) <= tolerance * scale, f"{what}: {a} {b}")

    def compare(self, expected, processes, suffix, *arguments):
        """All fields of the output and what the report says of the mesh and the values.
        expected: {(of, name)}, at least."""
        one = self.report(*arguments, "-o", "one" + suffix)
        fields = self.fields("one" + suffix)
        self.assertLessEqual(expected, set(fields))
        parallel = ".pvtu" if suffix in (".vtu", ".ovm") else ".pvtp"
        for n in processes:
            for output in ["many" + suffix, "many" + parallel][n > processes[0]:]:
                many = self.job_report(n, *arguments, "-o", output)
                of_parts = self.fields(output)
                if output.endswith(parallel):
                    self.assertEqual(sorted(set(of_parts.pop(("E", "part")))), list(range(n)))
                self.assertEqual(set(of_parts), set(fields))
                for name, values in fields.items():
                    # Of u and distances, and of what is derived from them.
                    tolerance = 1e-8 if name[1][:2] in ("gr", "di") and name[1] != "distance" else 1e-9
                    self.assert_same(values, of_parts[name], tolerance, (n, output, name))
                self.assertEqual(many["processes"], n)
                sizes = {k: v for k, v in one["sizes"].items()
                         if k not in ("samples", "gradient_dimension")}
                self.assertEqual(many["sizes"], sizes)
                for key in ["u", "distance"]:
                    if key in one:
                        for extreme in ["min", "max"]:
                            self.assertAlmostEqual(many[key][extreme], one[key][extreme], 9)
                if one.get("errors"):
                    for norm, value in one["errors"].items():
                        self.assertAlmostEqual(many["errors"][norm], value, delta=1e-8 * value)
                self.assertEqual(many["diagnostics"], one["diagnostics"])
                self.assertEqual(many["options"], one["options"])

    def fail_once(self, n, code, words, *arguments):
        """The error of a job, which one process tells."""
        run = self.job(n, *arguments, "--json")
        self.assertEqual(run.returncode, code, run.stderr)
        ours = [line for line in run.stderr.splitlines() if line.startswith("carat: ")]
        self.assertEqual(len(ours), 1, run.stderr)
        self.assertIn(words, ours[0])
        start = run.stdout.index("{")
        error = json.JSONDecoder().raw_decode(run.stdout[start:])[0]["error"]
        self.assertIn(words, error["message"])
        return error

    U = {("V", "u")}

    def cube(self):
        """A cube of cubes with patches that meet, and K in the cells."""
        n = 4

        def vertex(i, j, k):
            return (i * (n + 1) + j) * (n + 1) + k

        def cell(i, j, k):
            a, b, c, d, e, f, g, h = (vertex(i + x, j + y, k + z) for x in (0, 1) for y in (0, 1)
                                      for z in (0, 1))
            return [(a, b, d, c), (e, g, h, f), (a, e, f, b), (c, d, h, g), (a, c, g, e),
                    (b, f, h, d)]

        grid = [(i, j, k) for i in range(n) for j in range(n) for k in range(n)]
        points = [(i / n, j / n, k / n) for i in range(n + 1) for j in range(n + 1)
                  for k in range(n + 1)]
        patches = {"left": [cell(0, j, k)[0] for j in range(n) for k in range(n)],
                   "front": [cell(i, 0, k)[2] for i in range(n) for k in range(n)],
                   "none": []}
        name = self.write_ovm("cube.ovm", points, [cell(*at) for at in grid], patches)
        values = "\n".join(str(1 + i + 2 * j + k) for i, j, k in grid)
        with open(self.folder / name, "a", encoding="ascii") as file:
            file.write(f'CProp double "K"\n{values}\n')
        return name

    def matrix(self, name):
        data = (self.folder / name).read_bytes()
        self.assertEqual(data[:6], b"\x93NUMPY")
        end = 10 + struct.unpack_from("<H", data, 8)[0]
        return struct.unpack(f"<{(len(data) - end) // 8}d", data[end:])


class Engine(EngineTest):
    def test_poisson_on_a_surface(self):
        mesh = self.generate("plane-voronoi", 2, "mesh.vtu")
        gradients = {(of, f"gradient_{k}") for of in "VE" for k in "xyz"}
        self.compare(self.U | gradients | {("V", "error")}, [1, 3], ".ply", "poisson", mesh,
                     "--rhs", "1+x", "--dirichlet", "x", "--dirichlet-where", "y<0.5", "--robin",
                     "2", "--neumann", "cos(x)", "--coefficient", "1+x*y", "--exact", "x")

    def test_meshes_in_parts(self):
        for family, level, suffix in [("plane-concave", 2, ".pvtp"), ("cube-hexahedra", 1, ".pvtu")]:
            mesh = self.generate(family, level, "mesh" + suffix.replace("p", "", 1))
            poisson = ["--rhs", "x", "--dirichlet", "y", "--exact", "y"]
            self.finish(3, "poisson", mesh, *poisson, "-o", "first" + suffix)
            one = self.report("poisson", mesh, *poisson, "-o", "one" + suffix.replace("p", "", 1))
            many = self.job_report(3, "poisson", "first" + suffix, *poisson, "-o", "u" + suffix)
            self.assertNotIn("divide", many["seconds"])
            for norm, value in one["errors"].items():
                self.assertAlmostEqual(many["errors"][norm], value, delta=1e-8 * value)
            sizes = {k: v for k, v in one["sizes"].items()
                     if k not in ("samples", "gradient_dimension")}
            self.assertEqual(many["sizes"], sizes)
            whole, parts = (self.fields(f) for f in
                            ["one" + suffix.replace("p", "", 1), "u" + suffix])
            for name, values in whole.items():
                self.assert_same(values, parts[name], 1e-8, name)
            one = self.report("geodesics", mesh, "--source", "5")["distance"]["max"]
            many = self.job_report(3, "geodesics", "first" + suffix, "--source", "5")
            self.assertAlmostEqual(many["distance"]["max"], one, 8)
            one = self.report("eigen", mesh, "-k", "4")["eigenvalues"]
            many = self.job_report(3, "eigen", "first" + suffix, "-k", "4")["eigenvalues"]
            self.assert_same(one, many, 1e-9)
            self.fail_once(3, 2, "comes in parts", "eigen", "first" + suffix, "-o", "u.ply")
            self.fail_once(2, 2, "3", "eigen", "first" + suffix)

    def test_geodesics_in_a_volume(self):
        mesh = self.generate("ball-tets", 1, "mesh.vtu")
        self.compare({("V", "distance"), ("E", "direction")}, [4], ".ovm", "geodesics", mesh,
                     "--source", "3", "--edge-length", "mean")

    def test_report_says_what_solved(self):
        mesh = self.generate("plane-quads", 2, "mesh.vtu")
        solver = self.job_report(2, "poisson", mesh, "--rhs", "1", "--dirichlet", "0")["solver"]
        self.assertEqual((solver["kind"], solver["processes"]), ("petsc", 2))
        self.assertLess(solver["residual"], 1e-10)

    def test_options_of_petsc_count(self):
        mesh = self.generate("plane-quads", 2, "mesh.vtu")
        output = self.finish(2, "poisson", mesh, "--rhs", "1", "--dirichlet", "0", "-pc_type",
                             "jacobi", "-ksp_converged_reason")
        self.assertIn("jacobi", output)
        self.assertIn("CONVERGED_RTOL", output)

    def test_other_processes_are_silent(self):
        run = self.job(3, "poisson", "--help")
        self.assertEqual(run.returncode, 0)
        self.assertEqual(run.stdout.count("Solve Poisson's equation"), 1)
        mesh = self.generate("plane-quads", 1, "mesh.vtu")
        output = self.finish(3, "operators", mesh, "-o", "folder", "--operator", "vem")
        self.assertEqual(output.count("written"), 1)
        output = subprocess.run([MPIRUN, "-np", "2", PROGRAM + "-petsc", "info", mesh],
                                cwd=self.folder, capture_output=True, text=True, timeout=60)
        self.assertEqual(output.stdout.count("box"), 1)

    def test_a_failure_leaves_the_last_output(self):
        mesh = self.generate("plane-quads", 2, "mesh.vtu")
        solve = ["poisson", mesh, "--rhs", "1", "-o", "u.pvtp"]
        self.finish(2, *solve, "--dirichlet", "0")
        before = {f: (self.folder / f).read_bytes() for f in self.files()}
        self.fail_once(2, 4, "no solution exists", *solve)
        # The name of a piece is taken by a folder, which only the last process meets.
        (self.folder / "v_1.vtp").mkdir()
        self.fail_once(2, 3, "is a folder", *solve[:-1], "v.pvtp", "--dirichlet", "0")
        self.assertEqual([f for f in self.files() if f[0] == "v"], ["v_1.vtp"])
        self.assertEqual(before, {f: (self.folder / f).read_bytes() for f in before})
        self.assertEqual([f for f in self.files() if ".part" in f], [])


class EngineFull(EngineTest):
    def test_floating_means_are_those_of_the_whole(self):
        mesh = self.generate("sphere-hexagons", 1, "mesh.vtu")
        self.compare(self.U | {("V", "error")}, [3], ".ply", "poisson", mesh, "--rhs", "2*z",
                     "--exact", "z+5", "--operator", "bunge")

    def test_poisson_in_a_volume(self):
        mesh = self.generate("ball-voronoi", 1, "mesh.vtu")
        gradients = {(of, "gradient") for of in "VE"}
        self.compare(self.U | gradients, [3], ".ovm", "poisson", mesh, "--rhs", "1",
                     "--dirichlet", "y", "--dirichlet-where", "x<0", "--operator",
                     "stabilized_diamond")
        self.compare(self.U | gradients, [2], ".ovm", "poisson", mesh, "--rhs", "x", "--operator",
                     "bunge")

    def test_patches_and_coefficients_of_cells(self):
        mesh = self.cube()
        data = ["--rhs", "1", "--dirichlet", "left=1+y", "--dirichlet", "front=z", "--robin",
                "2", "--coefficient-field", "K"]
        self.compare(self.U, [1, 4], ".ovm", "poisson", mesh, *data)
        self.succeed("partition", mesh, "-n", "3", "-o", "cube.cparts")
        one = self.report("poisson", mesh, *data, "-o", "one.ovm")
        many = self.job_report(3, "poisson", "cube.cparts", *data, "-o", "many.pvtu")
        self.assertEqual(many["sizes"]["dirichlet_vertices"], one["sizes"]["dirichlet_vertices"])
        self.assertEqual(many["sizes"]["robin_faces"], one["sizes"]["robin_faces"])
        parts = self.fields("many.pvtu")
        for name, values in self.fields("one.ovm").items():
            self.assert_same(values, parts[name], 1e-8, name)
        for words, more in [("there is no boundary patch of this name", ["--neumann", "right=1"]),
                            ("this patch has no faces", ["--neumann", "none=1"]),
                            ("no such field of cells", ["--coefficient-field", "k"])]:
            self.fail_once(3, 2, words, "poisson", "cube.cparts", "--rhs", "1", *more)

    def test_geodesics(self):
        mesh = self.generate("sphere-hexagons", 2, "mesh.vtu")
        self.compare({("V", "distance"), ("E", "direction_x")}, [1, 3], ".ply", "geodesics", mesh,
                     "--source", "3", "--source", "50")
        self.compare({("V", "distance")}, [2], ".ply", "geodesics", mesh, "--source", "3",
                     "--edge-length", "mean", "--directions", "elements", "--t-coef", "3")

    def test_distances_from_each_source(self):
        mesh = self.generate("plane-quads", 2, "mesh.vtu")
        sources = ["--source", "0", "--source", "7", "--source", "30", "--each"]
        one = self.report("geodesics", mesh, *sources, "-o", "one.npy")
        many = self.job_report(3, "geodesics", mesh, *sources, "-o", "many.npy")
        for key in ["source_sets", "incomplete_source_sets", "unresolved_samples"]:
            self.assertEqual(many[key], one[key])
        self.assertEqual(many["matrix"], one["matrix"])
        self.assertEqual(many["largest_distance"]["source_set"],
                         one["largest_distance"]["source_set"])
        self.assert_same(self.matrix("one.npy"), self.matrix("many.npy"), 1e-9)
        self.compare({("V", "distance_2")}, [2], ".ply", "geodesics", mesh, *sources)

    def test_eigenmodes(self):
        mesh = self.generate("cube-tets", 1, "mesh.vtu")
        arguments = ["eigen", mesh, "-k", "6", "--dirichlet"]
        one = self.report(*arguments, "-o", "one.vtu")
        many = self.job_report(2, *arguments, "-o", "many.pvtu")
        self.assertEqual((many["solver"]["kind"], many["solver"]["processes"]), ("slepc", 2))
        for a, b in zip(one["eigenvalues"], many["eigenvalues"], strict=True):
            self.assertLess(abs(a - b), 1e-9 * a)
        # The first is alone; its residual is about 1e-10, its distance to the next of its own size.
        first = ("V", "mode_1")
        self.assert_same(self.fields("one.vtu")[first], self.fields("many.pvtu")[first], 1e-7)
        self.fail_once(2, 2, "the mesh is closed", "eigen",
                       self.generate("sphere-quads", 1, "closed.vtu"), "--dirichlet")

    def test_operators(self):
        surface = self.generate("plane-concave", 2, "surface.vtu")
        triangles = self.generate("plane-triangles", 2, "triangles.vtu")
        volume = self.generate("cube-voronoi", 1, "volume.vtu")
        for n, mesh, more in [(3, surface, []),
                              (2, triangles, ["--operator", "stabilized_diamond"]),
                              (4, surface, ["--operator", "de_goes"]),
                              (3, surface, ["--operator", "bunge", "--lumped"]),
                              (3, volume, ["--operator", "stabilized_diamond"]),
                              (1, volume, []),
                              (2, volume, ["--operator", "bunge"]),
                              (2, volume, ["--operator", "vem"])]:
            one = self.report("operators", mesh, *more, "-o", "one")
            many = self.job_report(n, "operators", mesh, *more, "-o", "many")
            for key in ["files", "nnz", "sign_convention", "frame_convention", "diagnostics",
                        "options", "sizes", "kind"]:
                self.assertEqual(many.get(key), one.get(key), (mesh, more, key))
            for file in one["files"]:
                if not file.endswith(".mtx"):
                    continue
                a, b = self.read_matrix("one/" + file), self.read_matrix("many/" + file)
                self.assertEqual(a[:2], b[:2])
                # Explicit zeros of the pattern are written too.
                self.assertEqual(a[2].keys(), b[2].keys(), (mesh, more, file))
                scale = max(map(abs, a[2].values()))
                worst = max(abs(value - b[2][place]) for place, value in a[2].items())
                self.assertLess(worst, 1e-13 * scale, (mesh, more, file))
        self.assertEqual([f for f in self.files() if "part" in f], [])

    def test_failures_end_the_job_with_one_message(self):
        mesh = self.generate("plane-quads", 2, "mesh.vtu")
        closed = self.generate("sphere-quads", 1, "closed.vtu")
        for code, words, arguments in [
                (3, "cannot be read", ["poisson", "none.vtu", "--rhs", "1"]),
                (3, "cannot be read", ["poisson", "none.pvtu", "--rhs", "1"]),
                (4, "no solution exists", ["poisson", mesh, "--rhs", "1"]),
                (2, "coefficient is", ["poisson", mesh, "--rhs", "1", "--dirichlet", "0",
                                       "--coefficient", "x-0.5"]),
                (2, "--rhs '1/x' is inf", ["poisson", mesh, "--rhs", "1/x", "--dirichlet", "0"]),
                (2, "--rhs 'x+'", ["poisson", mesh, "--rhs", "x+"]),
                (2, "the mesh is closed", ["poisson", closed, "--rhs", "z", "--dirichlet", "0"]),
                (2, "is 0 at every boundary vertex", ["poisson", mesh, "--rhs", "1", "--dirichlet",
                                                      "0", "--dirichlet-where", "x>2"]),
                (2, "no boundary edge is left", ["poisson", mesh, "--rhs", "1", "--dirichlet", "0",
                                                 "--robin", "1"]),
                (2, "--solver", ["poisson", mesh, "--rhs", "1", "--solver", "cholesky"]),
                (2, "--matrix-storage", ["poisson", mesh, "--rhs", "1",
                                         "--matrix-storage", "triangle"]),
                (2, "carry no fields", ["poisson", mesh, "--rhs", "1", "-o", "u.obj"]),
                (3, "does not exist; create it first", ["poisson", mesh, "--rhs", "1", "-o",
                                                        "no/u.pvtu"]),
                (2, "this vertex does not exist", ["geodesics", mesh, "--source", "100000"]),
                (2, "cannot be assembled in parts", ["eigen", self.generate(
                    "cube-tets", 0, "tets.vtu"), "--operator", "ceve"]),
                (2, "written as .pvtu", ["eigen", "tets.vtu", "-k", "1", "-o", "u.pvtp"]),
                (3, "is no folder", ["operators", mesh, "-o", mesh])]:
            self.fail_once(3, code, words, *arguments)
        run = self.job(3, "curvature", mesh)
        self.assertEqual(run.returncode, 2)
        self.assertEqual(run.stderr.count("not expected"), 1)
        self.assertEqual(self.files(), ["closed.vtu", "mesh.vtu", "tets.vtu"])

    def test_errors_name_elements_of_the_whole_mesh(self):
        # A strip of quads, of which two have no area.
        n = 12
        points = [(x, y, 0) for x in range(n + 1) for y in (0, 1)]
        for x in (9, 10):
            points[2 * x + 1] = points[2 * x]
        points[2 * 8 + 1] = points[2 * 8]
        mesh = self.write_off("strip.off", points, [(2 * x, 2 * x + 2, 2 * x + 3, 2 * x + 1)
                                                    for x in range(n)])
        for name in ["bunge", "diamond"]:
            arguments = ["eigen", mesh, "-k", "2", "--operator", name]
            run = self.carat(*arguments, "--strict", "--json")
            one = json.loads(run.stdout)["error"]
            self.assertEqual((run.returncode, one["kind"]), (3, "degenerate_element"))
            many = self.fail_once(3, 3, "is degenerate", *arguments, "--strict")
            self.assertEqual((many["kind"], many["elements"]), (one["kind"], one["elements"]))
            self.assertIn(f" {one['elements'][0]} is degenerate", many["message"])
        mesh = self.cube()
        text = (self.folder / mesh).read_text().rstrip().splitlines()
        text[-10] = "-1"
        self.write(mesh, "\n".join(text) + "\n")
        for name in ["bunge", "diamond"]:
            error = self.fail_once(3, 2, "coefficient of cell 54 is", "poisson", mesh, "--rhs", "1",
                                   "--dirichlet", "0", "--coefficient-field", "K", "--operator",
                                   name)
            self.assertEqual(error["elements"], [54])


if __name__ == "__main__":
    main()
