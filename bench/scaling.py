#!/usr/bin/env python3
"""Solves Poisson's equation over 1, 2, 4 processes and writes time and memory as one JSON file.

Strong scaling: one box of hexahedra, divided. Weak scaling: a box that grows with the number of
processes. Every process reads its own part of a .cparts file. Best of two runs.

Example:
  bench/scaling.py -o scaling.json               some minutes
  bench/scaling.py -o scaling.json --side 40 --repeats 1
  bench/scaling.py --table scaling.json          the tables of docs/scaling.md
"""

import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
CARAT = ROOT / "build/release/carat"
# Of OpenMPI: also in containers, and with more processes than cores.
ENVIRONMENT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
               "OMPI_MCA_rmaps_base_oversubscribe": "1", "OPENBLAS_NUM_THREADS": "1"}


def run(*command):
    done = subprocess.run([str(word) for word in command], env=ENVIRONMENT, capture_output=True,
                          text=True)
    if done.returncode != 0:
        sys.exit(f"scaling.py: {' '.join(map(str, command))}: {done.stderr}")
    return done.stdout


def box(path, nx, ny, nz):
    """A box of cubes as a legacy VTK file; with a value a point, as its claims are checked."""
    n = (nx + 1) * (ny + 1) * (nz + 1)
    path.write_text("# vtk DataFile Version 3.0\nbox\nASCII\nDATASET STRUCTURED_POINTS\n"
                    f"DIMENSIONS {nx + 1} {ny + 1} {nz + 1}\nORIGIN 0 0 0\n"
                    f"SPACING {1 / ny} {1 / ny} {1 / ny}\nPOINT_DATA {n}\n"
                    "SCALARS zero char 1\nLOOKUP_TABLE default\n" + "0\n" * n)


def measure(folder, n, cells, operator, repeats):
    mesh, parts = folder / "box.vtk", folder / "box.cparts"
    box(mesh, *cells)
    run(CARAT, "partition", mesh, "-n", n, "-o", parts)
    best = None
    for _ in range(repeats):
        report = json.loads(run("mpirun", "-np", n, CARAT, "--engine", "petsc", "poisson", parts,
                                "--rhs", "1", "--dirichlet", "0", "--operator", operator,
                                "--json"))
        if best is None or sum(report["seconds"].values()) < sum(best["seconds"].values()):
            best = report
    return {"operator": operator, "processes": n, "box": cells, "cells": best["sizes"]["cells"],
            "vertices": best["sizes"]["vertices"], "seconds": best["seconds"],
            "iterations": best["solver"]["iterations"], "method": best["solver"]["method"],
            "parts": best["parts"]}


def table(rows):
    print("| processes | cells | read | assemble | set up | solve | iterations | memory of a "
          "process | halo cells | sent for matrices |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for row in rows:
        seconds, parts = row["seconds"], row["parts"]
        print(f"| {row['processes']} | {row['cells']:,} | " +
              " | ".join(f"{seconds[phase]:.2f} s"
                         for phase in ["read", "assemble", "setup", "solve"]) +
              f" | {row['iterations']} | {parts['peak_memory']['largest'] / 1e6:.0f} MB | "
              f"{parts['halo_elements']['sum']:,} | "
              f"{parts['matrix_bytes_sent']['sum'] / 1e6:.1f} MB |")


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", help="the JSON file")
    parser.add_argument("--table", metavar="FILE", help="print such a file as tables")
    parser.add_argument("--side", type=int, default=64, help="cells along a side (default: 64)")
    parser.add_argument("--processes", type=int, nargs="+", default=[1, 2, 4])
    parser.add_argument("--repeats", type=int, default=2)
    options = parser.parse_args()
    if options.table:
        for name, rows in json.loads(pathlib.Path(options.table).read_text())["runs"].items():
            print(f"\n{name}\n")
            table(rows)
        return
    if not options.output:
        parser.error("-o FILE or --table FILE is required")
    side, runs = options.side, {}
    with tempfile.TemporaryDirectory(prefix="carat-scaling-") as folder:
        folder = pathlib.Path(folder)
        for operator in ["diamond", "bunge"]:
            for kind, cells in [("strong", lambda n: (side, side, side)),
                                ("weak", lambda n: (side * n, side, side))]:
                rows = runs.setdefault(f"{kind}, {operator}", [])
                for n in options.processes:
                    rows.append(measure(folder, n, cells(n), operator, options.repeats))
                    print(f"{kind} {operator} {n}", file=sys.stderr)
    pathlib.Path(options.output).write_text(
        json.dumps({"cores": os.cpu_count(), "runs": runs}, indent=1) + "\n")


if __name__ == "__main__":
    main()
