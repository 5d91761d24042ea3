"""bench/run.py, compare.py and plot.py: what they make of measurements, and of wrong files."""

import importlib.util
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

BENCH = pathlib.Path(__file__).resolve().parent.parent.parent / "bench"


def load(name):
    spec = importlib.util.spec_from_file_location(name, BENCH / (name + ".py"))
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def entry(*seconds, **counters):
    return {"seconds": list(seconds), "counters": {k: list(v) for k, v in counters.items()}}


class Compare(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_tool(self, before, after, *options):
        for name, results in (("a", before), ("b", after)):
            text = results if isinstance(results, str) else json.dumps({"results": results})
            (self.folder / name).write_text(text)
        return subprocess.run([sys.executable, BENCH / "compare.py", self.folder / "a",
                               self.folder / "b", *options], capture_output=True, text=True)

    def line_of(self, run, name):
        (line,) = [line for line in run.stdout.splitlines() if line.startswith(name + " ")]
        return line.split()

    def test_ratios_are_of_medians_and_verdicts_of_spreads(self):
        run = self.run_tool(
            {"x": entry(1, 2, 3), "y": entry(4, 5), "z": entry(2, 4), "old": entry(1)},
            {"x": entry(1, 1.5, 2), "y": entry(10, 11), "z": entry(1, 1.5), "new": entry(1)})
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(self.line_of(run, "x"), "x 2 1.5 0.750 0.333 .. 2.000".split())
        self.assertEqual(self.line_of(run, "y"), "y 4.5 10.5 2.333 2.000 .. 2.750 slower".split())
        self.assertEqual(self.line_of(run, "z"), "z 3 1.25 0.417 0.250 .. 0.750 faster".split())
        self.assertIn("3 compared: 1 faster, 1 slower, 1 undecided", run.stdout)
        self.assertIn("2 in one of the files only", run.stdout)

    def test_single_runs_decide_nothing(self):
        run = self.run_tool({"x": entry(1)}, {"x": entry(9, 9)})
        self.assertIn("0 slower", run.stdout)

    def test_counters_and_names_can_be_chosen(self):
        before = {"a:x": entry(1, peak=[10, 10]), "b:x": entry(1, peak=[1, 1])}
        after = {"a:x": entry(1, peak=[5, 5]), "b:x": entry(1, peak=[1, 1])}
        run = self.run_tool(before, after, "--counter", "peak", "--only", "a:")
        self.assertEqual(self.line_of(run, "a:x")[3], "0.500")
        self.assertNotIn("b:x", run.stdout)

    def test_wrong_files_are_told(self):
        run = self.run_tool("no json", {})
        self.assertEqual(run.returncode, 1)
        self.assertIn("no file of bench/run.py", run.stderr)
        run = self.run_tool({"x": entry(1)}, {"y": entry(1)})
        self.assertEqual(run.returncode, 1)
        self.assertIn("nothing in common", run.stderr)


class Run(unittest.TestCase):
    def test_repetitions_are_gathered_without_their_aggregates(self):
        run = load("run")
        common = {"name": "solve/mesh/10/iterations:1/repeats:2/manual_time", "time_unit": "ms",
                  "run_name": "solve/mesh/10/iterations:1/repeats:2/manual_time", "cpu_time": 1}
        results = {}
        failed = run.collect("poisson", {"benchmarks": [
            {**common, "run_type": "iteration", "real_time": 20, "nnz": 7},
            {**common, "run_type": "iteration", "real_time": 30, "nnz": 7},
            {**common, "run_type": "aggregate", "real_time": 25},
            {**common, "run_type": "iteration", "real_time": 0, "error_occurred": True,
             "error_message": "lost"}]}, results)
        self.assertEqual(failed, 1)
        self.assertEqual(results, {"poisson:solve/mesh/10":
                                   {"seconds": [0.02, 0.03], "counters": {"nnz": [7, 7]}}})


class Plot(unittest.TestCase):
    def test_slopes_are_powers_of_the_size(self):
        plot = load("plot")
        results = {f"poisson:diamond/auto/quads/{n}/threads:1":
                   entry(1e-9 * n ** 1.25, vertices=[n], peak_MB=[n]) for n in (10, 10**5, 10**6)}
        found = plot.curves(results)
        self.assertAlmostEqual(plot.slope(found["quads", "diamond", "auto"]), 1.25)
        self.assertIsNone(plot.slope(found["quads", "diamond", "auto"][:2]))


if __name__ == "__main__":
    unittest.main(verbosity=2)
