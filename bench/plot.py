#!/usr/bin/env python3
"""Draws cost against size from a file of bench/run.py, and fits the slopes.

Writes FOLDER/performance-{surfaces,volumes}.svg: seconds and memory from the mesh in memory to the
solution of Poisson's equation, one thread. Prints the slopes as a Markdown table: the power of the
number of vertices with which seconds grow, over the sizes from 100 000 vertices on, and the factor
that ten times the size costs by it.

Needs matplotlib (Debian: python3-matplotlib).

Example:
  bench/plot.py today.json -o docs/images
"""

import argparse
import json
import math
import pathlib
import statistics
import sys

# Operator and solver: label, colour, style.
SERIES = {
    ("diamond", "auto"): ("diamond", "#d1495b", "o-"),
    ("stabilized_diamond", "auto"): ("stabilized_diamond", "#edae49", "s-"),
    ("bunge", "auto"): ("bunge", "#00798c", "^-"),
    ("diamond", "cholesky"): ("diamond, Cholesky", "#6c757d", "x--"),
}
SURFACES, VOLUMES = ("triangles", "quads", "hexagons"), ("tets", "hexahedra", "truncated")
LARGE = 1e5


def curves(results, threads=1):
    """{(mesh, operator, solver): [(vertices, seconds, megabytes), ...]} by ascending size."""
    found = {}
    for name, entry in results.items():
        program, _, benchmark = name.partition(":")
        parts = benchmark.split("/")
        if program != "poisson" or parts[-1] != f"threads:{threads}":
            continue
        operator, solver, mesh = parts[:3]
        point = (statistics.median(entry["counters"]["vertices"]),
                 statistics.median(entry["seconds"]),
                 statistics.median(entry["counters"]["peak_MB"]))
        found.setdefault((mesh, operator, solver), []).append(point)
    return {key: sorted(points) for key, points in found.items()}


def slope(points):
    """Least squares of log seconds over log vertices; None with less than two sizes."""
    points = [(math.log(n), math.log(s)) for n, s, _ in points if n > 0.9 * LARGE]
    if len(points) < 2:
        return None
    x_mean = statistics.mean(x for x, _ in points)
    y_mean = statistics.mean(y for _, y in points)
    return (sum((x - x_mean) * (y - y_mean) for x, y in points)
            / sum((x - x_mean) ** 2 for x, _ in points))


def draw(found, meshes, path):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    pyplot.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "carat", "font.size": 9})
    figure, axes = pyplot.subplots(2, 3, figsize=(9.6, 6), sharex=True, sharey="row",
                                   layout="constrained")
    for column, mesh in enumerate(meshes):
        for (operator, solver), (label, colour, style) in SERIES.items():
            points = found.get((mesh, operator, solver))
            if not points:
                continue
            sizes = [point[0] for point in points]
            for row, quantity in enumerate((1, 2)):
                axes[row][column].loglog(sizes, [point[quantity] for point in points], style,
                                         color=colour, label=label, markersize=4, linewidth=1.3)
        reference = found.get((mesh, "diamond", "auto"))
        if reference:
            n0, s0, _ = reference[0]
            n1 = reference[-1][0]
            axes[0][column].loglog([n0, n1], [0.4 * s0, 0.4 * s0 * n1 / n0], ":", color="#999999",
                                   label="linear", linewidth=1)
        axes[0][column].set_title(mesh)
        axes[1][column].set_xlabel("vertices")
        for row in (0, 1):
            axes[row][column].grid(True, which="major", color="#dddddd", linewidth=0.6)
    axes[0][0].set_ylabel("seconds")
    axes[1][0].set_ylabel("peak memory [MB]")
    axes[0][0].legend(frameon=False, fontsize=8)
    figure.savefig(path, metadata={"Date": None})
    pyplot.close(figure)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", type=pathlib.Path)
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True, metavar="FOLDER")
    options = parser.parse_args()
    found = curves(json.loads(options.results.read_text())["results"])
    if not found:
        sys.exit(f"plot.py: error: {options.results}: has no results of carat_bench_poisson")
    if not options.output.is_dir():
        sys.exit(f"plot.py: error: {options.output}: no such folder")
    draw(found, SURFACES, options.output / "performance-surfaces.svg")
    draw(found, VOLUMES, options.output / "performance-volumes.svg")
    print("| mesh | operator | solver | slope | ten times the size |\n|---|---|---|---|---|")
    for mesh in SURFACES + VOLUMES:
        for operator, solver in SERIES:
            value = slope(found.get((mesh, operator, solver), []))
            if value is not None:
                print(f"| {mesh} | {operator} | {solver} | {value:.2f} | {10 ** value:.1f} |")


if __name__ == "__main__":
    main()
