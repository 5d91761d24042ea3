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
