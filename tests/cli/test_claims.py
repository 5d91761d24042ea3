"""carat claims: the table of promises."""
from support import CaratTest, main


class Claims(CaratTest):
    def test_promises_are_kept(self):
        report = self.report("claims", "--family", "plane-triangles", "--family", "cube-tets")
        names = {(entry["name"], entry["kind"]) for entry in self.report(
            "list", "operators")["operators"]}
        rows = {(row["operator"], row["kind"]): row["claims"] for row in report["results"]}
        self.assertEqual(set(rows), names)
        self.assertEqual(report["counts"]["violated"], 0)
        for row in rows.values():
            self.assertEqual(row["symmetric"]["verdict"], "kept")
            self.assertLessEqual(row["symmetric"]["measured"], row["symmetric"]["limit"])
        counted = [claim["verdict"] for row in rows.values() for claim in row.values()]
        for verdict, count in report["counts"].items():
            self.assertEqual(counted.count(verdict), count, verdict)

    def test_denials_of_the_literature_are_told_from_violations(self):
        report = self.report("claims", "--operator", "diamond", "--family", "plane-triangles")
        (row,) = report["results"]
        self.assertEqual(row["claims"]["equals_cotan"]["verdict"], "denied")
        self.assertGreater(row["claims"]["equals_cotan"]["measured"], 0.01)
        self.assertEqual(row["claims"]["kernel"], {"verdict": "kept", "measured": 1, "limit": 1})

    def test_table_has_a_row_an_operator_and_family(self):
        lines = self.succeed("claims", "--operator", "bunge", "--family", "plane-quads",
                             "--family", "cube-prisms").splitlines()
        rows = [line.split()[:2] for line in lines if line.startswith("bunge ")]
        self.assertEqual(rows, [["bunge", "plane-quads"], ["bunge", "cube-prisms"]])

    def test_wrong_choices(self):
        self.fail_with(2, "claims", "--operator", "sesame", says="sesame")
        self.fail_with(2, "claims", "--family", "sesame", says="sesame")
        self.fail_with(2, "claims", "--operator", "cotan", "--family", "plane-quads",
                       says="defined")
        self.fail_with(2, "claims", "--operator", "bunge", "--family", "plane-quads",
                       "--level", "9", says=["unknowns", "coarser"])


if __name__ == "__main__":
    main()
