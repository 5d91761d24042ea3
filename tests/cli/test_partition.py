"""carat partition: parts as files."""

from support import CaratTest, main


class Partition(CaratTest):
    def check(self, mesh, element, extension, n):
        sizes = self.report("info", mesh)["sizes"]
        report = self.report("partition", mesh, "-n", n, "-o", "parts")
        self.assertEqual(sum(part[f"own_{element}s"] for part in report["parts"]),
                         sizes[f"{element}s"])
        self.assertEqual(sum(part["own_vertices"] for part in report["parts"]), sizes["vertices"])
        self.assertLess(report["imbalance"], 1.2)
        self.assertEqual([part["output"] for part in report["parts"]],
                         [f"parts/part_{p}{extension}" for p in range(n)])
        for part in report["parts"]:
            here = self.report("info", part["output"])["sizes"]
            self.assertEqual(here[f"{element}s"],
                             part[f"own_{element}s"] + part[f"halo_{element}s"])

    def test_a_folder_holds_the_mesh_with_its_fields(self):
        self.generate("ball-voronoi", 1, "ball.vtu")
        self.succeed("geodesics", "ball.vtu", "--source", 0, "-o", "distance.vtu")
        self.assertEqual(self.report("partition", "distance.vtu", "-n", 3, "-o", "parts")["output"],
                         "parts/mesh.pvtu")
        whole, joined = (self.report("info", name) for name in ("distance.vtu", "parts/mesh.pvtu"))
        self.assertEqual(joined["sizes"], whole["sizes"])
        names = {where: [field["name"] for field in fields]
                 for where, fields in joined["fields"].items()}
        self.assertEqual(names, {"vertex": ["row", "component", "distance"],
                                 "cell": ["part", "direction"]})
        self.assertEqual([joined["fields"]["vertex"][2], joined["fields"]["cell"][1]],
                         [whole["fields"]["vertex"][0], whole["fields"]["cell"][0]])
        self.succeed("convert", "parts/mesh.pvtu", "joined.vtu")
        self.succeed("poisson", "parts/mesh.pvtu", "--rhs", 1, "--dirichlet", 0)
        # Parts of parts: the numbers are those of the mesh that is divided.
        self.succeed("partition", "parts/mesh.pvtu", "-n", 2, "-o", "again")
        self.assertEqual(self.report("info", "again/mesh.pvtu")["sizes"], whole["sizes"])

    def test_one_file(self):
        mesh = self.generate("plane-quads", 2)
        report = self.report("partition", mesh, "-n", 3, "-o", "mesh.cparts")
        self.assertEqual(report["output"], "mesh.cparts")
        self.assertEqual(len(report["parts"]), 3)
        self.assertEqual(sorted(self.files()), sorted([mesh, "mesh.cparts"]))
        self.fail_with(3, "partition", mesh, "-n", 3, "-o", "no/mesh.cparts", says="no")

    def test_patches_are_kept_by_one_file_alone(self):
        # A tetrahedron with a patch.
        faces = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]
        self.write_ovm("tet.ovm", [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [faces],
                       {"floor": [faces[0]]})
        notes = self.report("partition", "tet.ovm", "-n", 1, "-o", "parts")["notes"]
        self.assertEqual(notes, ["dropped the boundary patches floor: the files in parts are of a "
                                 "format without patches; a file .cparts keeps them"])
        self.assertNotIn("notes", self.report("partition", "tet.ovm", "-n", 1, "-o", "a.cparts"))

    def test_surfaces(self):
        self.check(self.generate("sphere-hexagons", 2), "face", ".vtp", 3)

    def test_volumes(self):
        self.check(self.generate("ball-voronoi", 1, "ball.vtu"), "cell", ".vtu", 4)

    def test_nothing_is_written_unasked(self):
        mesh = self.generate("plane-quads", 1)
        self.assertNotIn("output", self.report("partition", mesh, "-n", 2)["parts"][0])
        self.assertEqual(self.files(), [mesh])

    def test_bad_input(self):
        mesh = self.generate("plane-quads", 1)
        self.fail_with(2, "partition", mesh, "-n", 0, says="--parts")
        self.fail_with(2, "partition", mesh, says="--parts")
        self.fail_with(3, "partition", mesh, "-n", 2, "-o", "no/where", says="cannot be made")


if __name__ == "__main__":
    main()
