#!/usr/bin/env python3
"""Runs the benchmarks one after the other and writes all that they measured as one JSON file.

Example:
  bench/run.py -o today.json                          all of them; an hour and a half
  bench/run.py -o quick.json --quick                  small meshes; some minutes
  bench/run.py -o poisson.json --only poisson --filter 'diamond/auto'

Two such files are compared by bench/compare.py; bench/plot.py draws one.
"""

import argparse
import datetime
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
PREFIX = "carat_bench"
# Google Benchmark's own keys of an entry; everything else is a counter of ours.
OWN_KEYS = {"name", "family_index", "per_family_instance_index", "run_name", "run_type",
            "repetitions", "repetition_index", "threads", "iterations", "real_time", "cpu_time",
            "time_unit", "error_occurred", "error_message"}
UNITS = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}


def programs(build):
    """Short name -> executable."""
    found = {}
    for path in sorted((build / "bench").glob(PREFIX + "*")):
        # That of multigrid is beside other libraries, and no benchmark of Google's.
        if path.is_file() and os.access(path, os.X_OK) and path.name != PREFIX + "_multigrid":
            found[path.name[len(PREFIX):].lstrip("_") or "surface"] = path
    return found


def short_name(run_name):
    """Without what only says how it was run: how often, and by which clock."""
    parts = [part for part in run_name.split("/")
             if not part.startswith(("iterations:", "repeats:")) and part != "manual_time"]
    return "/".join(parts)


def collect(program, output, results):
    """Adds the runs of one program: a list of values a benchmark and counter."""
    failed = 0
    for run in output["benchmarks"]:
        if run["run_type"] != "iteration":
            continue
        if run.get("error_occurred"):
            print(f"run.py: {run['name']}: {run['error_message']}", file=sys.stderr)
            failed += 1
            continue
        key = program + ":" + short_name(run["run_name"])
        entry = results.setdefault(key, {"seconds": [], "counters": {}})
        entry["seconds"].append(run["real_time"] * UNITS[run["time_unit"]])
        for counter, value in run.items():
            if counter not in OWN_KEYS:
                entry["counters"].setdefault(counter, []).append(value)
    return failed


def commit():
    answer = subprocess.run(["git", "-C", ROOT, "describe", "--always", "--dirty"],
                            capture_output=True, text=True)
    return answer.stdout.strip() if answer.returncode == 0 else None


def processor():
    try:
        for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return None


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", required=True, type=pathlib.Path, help="the JSON file")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build" / "release",
                        help="folder of the build (default: build/release)")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="these programs only")
    parser.add_argument("--filter", metavar="REGEX", help="these benchmarks only")
    parser.add_argument("--quick", action="store_true", help="small meshes")
    options = parser.parse_args()

    known = programs(options.build)
    if not known:
        parser.error(f"no benchmarks in {options.build}/bench; configure with "
                     "-DCARAT_BUILD_BENCH=ON and build")
    wanted = options.only or list(known)
    for name in wanted:
        if name not in known:
            parser.error(f"no program {name}; there are {', '.join(known)}")
    if not options.output.absolute().parent.is_dir():
        parser.error(f"{options.output}: the folder is missing")

    # carat's threads are options of each benchmark; those of BLAS would hide behind them.
    environment = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    if options.quick:
        environment |= {"CARAT_BENCH_VERTICES": "20000", "CARAT_BENCH_LARGEST": "30000"}
    results, seconds, failed, context = {}, {}, 0, {}
    with tempfile.TemporaryDirectory() as folder:
        for name in wanted:
            print(f"run.py: {name}", file=sys.stderr)
            file = pathlib.Path(folder) / (name + ".json")
            command = [known[name], f"--benchmark_out={file}", "--benchmark_out_format=json"]
            if options.filter:
                command.append(f"--benchmark_filter={options.filter}")
            start = time.monotonic()
            if subprocess.run(command, env=environment).returncode != 0:
                print(f"run.py: error: {name} failed", file=sys.stderr)
                return 1
            seconds[name] = time.monotonic() - start
            text = file.read_text() if file.exists() else ""
            if text:  # empty where no benchmark has such a name
                output = json.loads(text)
                context = output["context"]
                failed += collect(name, output, results)

    report = {"commit": commit(),
              "date": datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds"),
              "machine": {"processor": processor(), "cores": os.cpu_count(),
                          "caches": context.get("caches")},
              "quick": options.quick,
              "program_seconds": seconds,
              "failed": failed,
              "results": results}
    temporary = options.output.with_name(options.output.name + ".part")
    temporary.write_text(json.dumps(report, indent=1) + "\n")
    temporary.replace(options.output)
    print(f"run.py: {len(results)} benchmarks, {failed} failed runs -> {options.output}",
          file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
