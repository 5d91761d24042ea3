"""Runs the program and reads what it writes."""

import json
import math
import os
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest

PROGRAM = os.path.abspath(sys.argv.pop(1)) if len(sys.argv) > 1 else "carat"


class CaratTest(unittest.TestCase):
    """A test with a folder of its own, which is where the program runs."""

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="carat-test-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def carat(self, *arguments, **options):
        return subprocess.run(
            [PROGRAM, *map(str, arguments)],
            cwd=self.folder, capture_output=True, text=True, timeout=120,
            stdin=subprocess.DEVNULL, **options)

    def succeed(self, *arguments):
        """Standard output of a run without a fault."""
        run = self.carat(*arguments)
        self.assertEqual(run.returncode, 0, f"carat {arguments}: {run.stderr}")
        return run.stdout

    def report(self, *arguments):
        """The JSON object of a run; anything else on standard output is an error."""
        text = self.succeed(*arguments, "--json")
        self.assertNotRegex(text, r"\b(NaN|Infinity|nan|inf)\b")
        return json.loads(text)

    def fail_with(self, exit_code, *arguments, says, **options):
        """The message of a run that must fail: one line, on standard error, with these words."""
        run = self.carat(*arguments, **options)
        self.assertEqual(run.returncode, exit_code, f"carat {arguments}: {run.stderr}")
        lines = run.stderr.splitlines()
        self.assertEqual(len(lines), 1, run.stderr)
        self.assertTrue(lines[0].startswith("carat: error: "), lines[0])
        for words in [says] if isinstance(says, str) else says:
            self.assertIn(words, lines[0])
        return lines[0]

    def files(self):
        return sorted(str(p.relative_to(self.folder)) for p in self.folder.rglob("*"))

    def write(self, name, content):
        path = self.folder / name
        if isinstance(content, bytes):
            path.write_bytes(content)
        else:
            path.write_text(content)
        return name

    def generate(self, family, level, name="mesh.ply", *more):
        self.succeed("generate", family, "--level", level, "-o", name, *more)
        return name

    def read_obj(self, name):
        """Points and faces (from 0) of an OBJ file."""
        points, faces = [], []
        for line in (self.folder / name).read_text().splitlines():
            words = line.split()
            if words[:1] == ["v"]:
                points.append(tuple(map(float, words[1:4])))
            elif words[:1] == ["f"]:
                faces.append([int(w.split("/")[0]) - 1 for w in words[1:]])
        return points, faces

    def write_off(self, name, points, faces):
        lines = ["OFF", f"{len(points)} {len(faces)} 0"]
        lines += [" ".join(repr(float(x)) for x in p) for p in points]
        lines += [" ".join(map(str, [len(f), *f])) for f in faces]
        return self.write(name, "\n".join(lines) + "\n")

    def write_ovm(self, name, points, cells, patches=None):
        """Cells as lists of faces, these as tuples of vertices that are seen from outside counter-
        clockwise. Patches: name -> faces."""
        edges, faces, polyhedra = {}, {}, []
        for cell in cells:
            sides = []
            for face in cell:
                key = frozenset(face)
                if key not in faces:
                    faces[key] = (len(faces), face)
                    for a, b in zip(face, face[1:] + face[:1]):
                        edges.setdefault((min(a, b), max(a, b)), len(edges))
                    sides.append(2 * faces[key][0] + 1)
                else:
                    sides.append(2 * faces[key][0])
            polyhedra.append(sides)

        def numbers(values):
            return " ".join(map(str, values))

        lines = ["OVM ASCII", "Vertices", len(points), *(numbers(map(float, p)) for p in points),
                 "Edges", len(edges), *(numbers(e) for e in edges), "Faces", len(faces)]
        for _, face in faces.values():
            half_edges = [2 * edges[min(a, b), max(a, b)] + (a > b)
                          for a, b in zip(face, face[1:] + face[:1])]
            lines.append(numbers([len(face), *half_edges]))
        lines += ["Polyhedra", len(polyhedra), *(numbers([len(p), *p]) for p in polyhedra)]
        for patch, members in (patches or {}).items():
            wanted = {frozenset(face) for face in members}
            lines += [f'FProp bool "{patch}"', *(int(key in wanted) for key in faces)]
        return self.write(name, "\n".join(map(str, lines)) + "\n")

    def read_ovm(self, name):
        """Points, and the fields {(of, name): rows}, with of = 'V' or 'C', of an OVM file."""
        lines = iter((self.folder / name).read_text().splitlines())
        self.assertEqual(next(lines), "OVM ASCII")
        counts, points, fields = {}, [], {}
        for line in lines:
            if line in ("Vertices", "Edges", "Faces", "Polyhedra"):
                counts[line[0]] = int(next(lines))
                rows = [next(lines).split() for _ in range(counts[line[0]])]
                if line == "Vertices":
                    points = [tuple(map(float, row)) for row in rows]
            elif line[1:].startswith("Prop "):
                n = counts["P" if line[0] == "C" else line[0]]
                rows = [list(map(float, next(lines).split())) for _ in range(n)]
                fields[line[0], line.split('"')[1]] = rows
        return points, fields

    def read_matrix(self, name):
        """Rows, columns and {(row, column): value} of a Matrix Market file."""
        with open(self.folder / name, encoding="ascii") as file:
            header = file.readline().split()
            self.assertEqual(header[:4], ["%%MatrixMarket", "matrix", "coordinate", "real"])
            symmetric = header[4] == "symmetric"
            line = file.readline()
            while line.startswith("%"):
                line = file.readline()
            rows, columns, count = map(int, line.split())
            entries = {}
            for line in file:
                row, column, value = line.split()
                i, j = int(row) - 1, int(column) - 1
                entries[i, j] = float(value)
                if symmetric:
                    entries[j, i] = float(value)
                count -= 1
        self.assertEqual(count, 0)
        return rows, columns, entries

    def read_field(self, name, field, element="vertex"):
        """Values of a field of a binary PLY file with double properties."""
        data = (self.folder / name).read_bytes()
        end = data.index(b"end_header\n") + len(b"end_header\n")
        header = data[:end].decode()
        self.assertIn("binary_little_endian", header)
        codes = {"double": "d", "float": "f", "int": "i", "uint": "I", "uchar": "B"}
        at, values = end, []
        for block in header.split("element ")[1:]:
            kind, n = block.split()[:2]
            properties = re.findall(r"property (?:list (\w+) )?(\w+) (\w+)", block)
            for _ in range(int(n)):
                for counts, items, prop in properties:
                    length = 1
                    if counts:
                        length, = struct.unpack_from("<" + codes[counts], data, at)
                        at += struct.calcsize(codes[counts])
                    row = struct.unpack_from(f"<{length}{codes[items]}", data, at)
                    at += struct.calcsize(f"<{length}{codes[items]}")
                    if kind == element and prop == field:
                        values.append(row[0])
        self.assertEqual(at, len(data))
        return values


def great_circle(p, q):
    cross = (p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0])
    return math.atan2(math.hypot(*cross), sum(a * b for a, b in zip(p, q)))


def main():
    unittest.main(verbosity=2)
