#!/usr/bin/env python3
"""What a call from Python costs beside the same from C++: time and memory, in one run.

Example:
  PYTHONPATH=build/release/python bench/binding.py build/release/bench/binding

Both sides stay alive and take turns, so that whatever else the machine does meets both.
"""

import argparse
import json
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np

CALLEE = """
import sys, time
import numpy as np
import carat
V = np.fromfile(sys.argv[1], dtype=np.float64).reshape(-1, 3)
F = np.fromfile(sys.argv[2], dtype=np.int32).reshape(-1, 3)
def peak():
    for line in open("/proc/self/status"):
        if line.startswith("VmHWM"):
            return 1024 * int(line.split()[1])
open("/proc/self/clear_refs", "w").write("5")
before = peak()
for line in sys.stdin:
    start = time.perf_counter()
    S, M = carat.stiffness(V, F, threads=int(sys.argv[3]))
    seconds = time.perf_counter() - start
    print(f"{seconds:.9f} {S.nnz}", flush=True)
    del S, M
print(peak() - before, flush=True)
"""


class Side:
    def __init__(self, *command):
        self.process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        self.seconds = []

    def call(self):
        self.process.stdin.write("\n")
        self.process.stdin.flush()
        seconds, entries = self.process.stdout.readline().split()
        self.seconds.append(float(seconds))
        self.entries = int(entries)

    def end(self):
        self.process.stdin.close()
        self.peak = int(self.process.stdout.readline())
        self.process.wait()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", help="the C++ side, build/release/bench/binding")
    parser.add_argument("--side", type=int, default=1000, help="vertices a side of a square")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--rounds", type=int, default=15)
    options = parser.parse_args()

    n = options.side
    y, x = np.mgrid[0:n, 0:n] / (n - 1)
    points = np.stack([x, y, 0.1 * np.sin(5 * x)], axis=-1).reshape(-1, 3)
    corner = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).reshape(-1, 1)
    faces = np.concatenate((corner + [0, 1, n + 1], corner + [0, n + 1, n])).astype(np.int32)
    with tempfile.TemporaryDirectory() as folder:
        files = f"{folder}/points", f"{folder}/faces"
        points.tofile(files[0])
        faces.tofile(files[1])
        threads = str(options.threads)
        python = Side(sys.executable, "-c", CALLEE, *files, threads)
        cpp = Side(options.program, *files, threads)
        for _ in range(options.rounds):
            python.call()
            cpp.call()
            time.sleep(0.05)
        python.end()
        cpp.end()
    assert python.entries == cpp.entries
    # The first call of a side also warms it up.
    ratios = [p / c for p, c in zip(python.seconds[1:], cpp.seconds[1:])]
    print(
        json.dumps(
            {
                "vertices": n * n,
                "threads": options.threads,
                "python_seconds": min(python.seconds),
                "cpp_seconds": min(cpp.seconds),
                "ratio_of_fastest": min(python.seconds) / min(cpp.seconds),
                "median_ratio": statistics.median(ratios),
                "python_peak_bytes": python.peak,
                "cpp_peak_bytes": cpp.peak,
                "ratio_of_memory": python.peak / cpp.peak,
            },
            indent=2,
        )
    )


if __name__ == "__main__":
    main()
