#!/usr/bin/env python3
"""Compares two files of bench/run.py: the ratio of medians of every benchmark that both have.

The spread is what the repetitions leave open: from the fastest of the second over the slowest of
the first to the slowest over the fastest. A benchmark counts as faster or slower where 1 lies
outside of it; a single run decides nothing.

Example:
  bench/compare.py before.json after.json
  bench/compare.py before.json after.json --only poisson: --counter peak_MB
"""

import argparse
import json
import pathlib
import statistics
import sys


def read(path):
    try:
        results = json.loads(pathlib.Path(path).read_text())["results"]
    except (OSError, ValueError, KeyError) as error:
        sys.exit(f"compare.py: error: {path}: no file of bench/run.py ({error})")
    return results


def values(entry, counter):
    return entry["seconds"] if counter is None else entry["counters"].get(counter, [])


def comparisons(before, after, counter):
    """(name, ratio, lowest, highest, median before, median after, whether both were repeated), where
    both have values > 0."""
    for name, entry in before.items():
        if name not in after:
            continue
        old, new = values(entry, counter), values(after[name], counter)
        if not old or not new or min(old) <= 0 or min(new) <= 0:
            continue
        a, b = statistics.median(old), statistics.median(new)
        yield (name, b / a, min(new) / max(old), max(new) / min(old), a, b,
               min(len(old), len(new)) > 1)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before")
    parser.add_argument("after")
    parser.add_argument("--only", metavar="TEXT", default="", help="names with this text in them")
    parser.add_argument("--counter", metavar="NAME", help="of this counter instead of seconds")
    options = parser.parse_args()

    before, after = read(options.before), read(options.after)
    rows = [row for row in comparisons(before, after, options.counter) if options.only in row[0]]
    if not rows:
        print("compare.py: error: the files have nothing in common", file=sys.stderr)
        return 1
    width = max(len(row[0]) for row in rows)
    print(f"{'benchmark':{width}}  {'before':>10} {'after':>10} {'ratio':>7}  spread")
    counts = {"faster": 0, "slower": 0, "same": 0}
    for name, ratio, low, high, a, b, repeated in sorted(rows, key=lambda row: row[1]):
        verdict = "same"
        if repeated:
            verdict = "faster" if high < 1 else "slower" if low > 1 else "same"
        counts[verdict] += 1
        mark = "" if verdict == "same" else "  " + verdict
        print(f"{name:{width}}  {a:10.4g} {b:10.4g} {ratio:7.3f}  {low:.3f} .. {high:.3f}{mark}")
    mean = statistics.geometric_mean(row[1] for row in rows)
    alone = len(before.keys() ^ after.keys())
    print(f"{len(rows)} compared: {counts['faster']} faster, {counts['slower']} slower, "
          f"{counts['same']} undecided; geometric mean {mean:.3f}; "
          f"{alone} in one of the files only")
    return 0


if __name__ == "__main__":
    sys.exit(main())
