#!/usr/bin/env python3
"""The command line tool, test_cli_files.py PATH_TO_HMF: files as other programs write them.

Polygons, seams, noise, holes, places in sentences, outputs far from the origin.
"""
import gzip
import io
import json
import math
import os
import subprocess
import sys
import zlib

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../support"))
import tool_case  # noqa: E402
from tool_case import Case, main, moved, obj_text, torus, triangles_of  # noqa: E402


def prism(outline, height):
    """A solid over a polygon: two faces with all its corners, and a quad for each side."""
    n = len(outline)
    points = [(x, y, z) for z in (0, height) for x, y in outline]
    return points, [tuple(range(n))[::-1], tuple(range(n, 2 * n))] + [(i, (i + 1) % n, n + (i + 1) % n, n + i) for i in range(n)]


def block_with_hole():
    """A square block with a square hole through it: top and bottom are two concave faces each."""
    turned = [(0.44 * x - 0.9 * y, 0.9 * x + 0.44 * y) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    outer, points = [(-3, -3), (3, -3), (3, 3), (-3, 3)], []
    for z in (0, 1):
        points += [(x, y, z) for x, y in outer + turned]
    faces = [(8, 9, 10, 14, 13, 12), (10, 11, 8, 12, 15, 14), (0, 4, 5, 6, 2, 1), (2, 6, 7, 4, 0, 3)]
    for i in range(4):
        j = (i + 1) % 4
        faces += [(i, j, 8 + j, 8 + i), (4 + j, 4 + i, 12 + i, 12 + j)]
    return points, faces


def soup(points, triangles, noise=0.0):
    """Each triangle with corners of its own, moved by up to the noise."""
    lone = []
    for k, v in enumerate(v for t in triangles for v in t):
        lone.append(tuple(x + noise * math.sin(12.9898 * (3 * k + axis)) for axis, x in enumerate(points[v])))
    return lone, [(3 * t, 3 * t + 1, 3 * t + 2) for t in range(len(triangles))]


class Polygons(Case):
    def info(self, path, *options):
        return json.loads(self.run_tool("info", path, "--json", *options).stdout)

    def test_concave_faces_do_not_fold(self):
        bracket = [(4, 0), (4, 1), (1, 1), (1, 4), (0, 4), (0, 0)]
        found = self.info(self.write("bracket.obj", obj_text(*prism(bracket, 2))))
        self.assertAlmostEqual(found["area"], 2 * 7 + 16 * 2, 12)
        path, report = self.write("block.obj", obj_text(*block_with_hole())), self.path("r.json")
        done = self.run_tool("solve", path, "--repair", "--report", report)
        self.assertIn("nothing to repair", done.stderr)
        self.assertEqual(json.loads(self.read("r.json"))["mesh"]["genus"], 1)

    def test_corners_on_straight_sides(self):
        """A box whose top has a corner in the middle of each side."""
        square = [(0, 0), (1, 0), (2, 0), (2, 1), (2, 2), (1, 2), (0, 2), (0, 1)]
        points, faces = prism(square, 1)
        for turn in range(8):
            top = faces[1][turn:] + faces[1][:turn]
            self.run_tool("solve", self.write("box.obj", obj_text(points, [faces[0], top] + faces[2:])))

    def test_sentences_name_faces_and_lines(self):
        """Of the file, also where polygons were cut, vertices dropped and components taken apart."""
        points, faces = prism([(0, 0), (4, 0), (4, 4), (0, 4)], 1)
        lines = obj_text(points, faces).splitlines()
        flat = "v 9 0 0\nv 10 0 0\nv 11 0 0\nv 12 0 0\n"
        # An unused vertex, a comment; face 3 is a straight line.
        lines[8:8] = ["v 7 7 7", "# comment"] + flat.splitlines()
        at = next(i for i, line in enumerate(lines) if line.startswith("f")) + 3
        text = "\n".join(lines[:at] + ["f 10 11 12 13"] + lines[at:]) + "\n"
        done = self.refused(3, "solve", self.write("flat.obj", "\n".join(lines[8:at - 3] + ["f 2 3 4 5"]) + "\n"), says=["(face 0, line 7)"])
        self.assertNotRegex(done.stderr, r"[Tt]riangle \d|\(\d+, \d+, \d+\)")
        both = self.run_tool("solve", self.write("both.obj", text), "--report", self.path("r.json"))
        self.assertIn("a triangle has no area (face 3, line %d)" % (at + 1), both.stderr)
        self.assertEqual(text.splitlines()[at], "f 10 11 12 13")
        # Of triangles the numbers stay, and the line comes with them.
        turned = self.triangles[:5] + [self.triangles[5][::-1]] + self.triangles[6:]
        path = self.write("turned.obj", obj_text(self.points, turned))
        done = self.refused(3, "solve", path, says=["(triangle 5, line %d)" % (len(self.points) + 6)])
        self.assertRegex(done.stderr, r"Triangle 5 and triangle \d+ both run")


class Points(Case):
    def setUp(self):
        super().setUp()
        self.whole = json.loads(self.run_tool("info", self.mesh, "--json").stdout)

    def test_seams(self):
        """Vertices that are there twice along a circle: said, counted, and joined on demand."""
        m = 16
        points = self.points + self.points[:m]
        n = len(self.points)
        last = 2 * m * 23  # triangles of the last ring reach round to the first vertices
        triangles = self.triangles[:last] + [tuple(v + n if v < m else v for v in t) for t in self.triangles[last:]]
        path = self.write("seam.obj", obj_text(points, triangles))
        sentence = "16 vertices on the boundary lie at points of others; --repair --join-points joins them"
        for command in ("info", "solve"):
            self.assertIn(sentence, self.run_tool(command, path).stderr)
        self.assertEqual(json.loads(self.run_tool("info", path, "--json").stdout)["doubled_points"], 16)
        done = self.run_tool("solve", path, "--repair", "--join-points")
        self.assertNotIn("lie at points", done.stderr)
        self.assertIn("joined 16 vertices", done.stderr)
        self.assertIn("genus 1, %d edges" % (3 * n), done.stdout)
        self.assertNotIn("lie at points", self.run_tool("solve", self.mesh).stderr)

    def test_distance(self):
        path = self.write("soup.obj", obj_text(*soup(self.points, self.triangles, 1e-7)))
        for words in (("--join-points", "1e-6"), ("--join-points=1e-6",)):
            found = json.loads(self.run_tool("info", path, "--json", "--repair", *words).stdout)
            self.assertEqual((found["genus"], found["vertices"], found["edges"]), (1, self.whole["vertices"], self.whole["edges"]))
        self.refused(3, "solve", path, "--repair", "--join-points")
        self.refused(2, "solve", path, "--join-points", "1e-6", says=["--repair"])
        self.refused(2, "solve", path, "--repair", "--join-points=-1", says=["--join-points", "[0, inf)"])
        exact = self.write("exact.obj", obj_text(*soup(self.points, self.triangles)))
        self.run_tool("solve", "--repair", "--join-points", exact)
        # In reach across the cells of a grid, whatever the place of the mesh in it.
        for shift in (0.0, 0.3e-6, 1.1e-6, 2.7e-6, 1000.1):
            lone, faces = soup(moved(self.points, shift), self.triangles, 1e-7)
            self.write("soup.obj", obj_text(lone, faces))
            found = json.loads(self.run_tool("info", path, "--json", "--repair", "--join-points", "5e-7").stdout)
            self.assertEqual(found["vertices"], self.whole["vertices"])

    def test_isolated_vertices(self):
        """Dropped with a note, wherever they are."""
        values = self.path("v.csv")
        self.run_tool("solve", self.mesh, "--values", values)
        expected = self.read("v.csv")
        points = self.points + [(9, 9, 9)]
        self.write("more.obj", obj_text(points, self.triangles))
        done = self.run_tool("solve", self.path("more.obj"), "--values", values)
        self.assertIn("dropped 1 unused vertex", done.stderr)
        self.assertEqual(self.read("v.csv"), expected)
        first = [(9, 9, 9), (8, 8, 8)] + self.points
        self.write("more.obj", obj_text(first, [tuple(v + 2 for v in t) for t in self.triangles]))
        for words in (("solve",), ("quads",), ("info",)):
            out = [self.path("q.obj")] if words == ("quads",) else []
            done = self.run_tool(*words, self.path("more.obj"), *out)
            self.assertIn("dropped 2 unused vertices", done.stderr)
        self.assertEqual(json.loads(self.run_tool("info", self.path("more.obj"), "--json").stdout)["unused_vertices"], 2)


class Holes(Case):
    def test_a_hole_is_never_silent(self):
        missing = [t for k, t in enumerate(self.triangles) if k not in (100, 101)]
        path, report = self.write("hole.obj", obj_text(self.points, missing)), self.path("r.json")
        for command in ("info", "solve"):
            done = self.run_tool(command, path)
            self.assertIn("1 boundary looks like a hole by accident, the smallest with 4 edges", done.stderr)
        self.run_tool("solve", path, "--report", report)
        self.assertIn("4 edges", json.loads(self.read("r.json"))["warnings"][0])
        for command in ("info", "solve"):
            self.refused(3, command, path, "--closed", says=["1 boundary, the first with 4 edges", "--fill-holes 4"])
        self.refused(3, "solve", path, "--closed", "--fill-holes", "3")
        done = self.run_tool("solve", path, "--closed", "--fill-holes", "4", "--report", report)
        self.assertIn("filled 1 hole", done.stderr)
        found = json.loads(self.read("r.json"))
        self.assertEqual((found["mesh"]["boundaries"], found["mesh"]["genus"], found["repairs"]), (0, 1, ["filled 1 hole"]))
        self.run_tool("solve", self.mesh, "--report", report)
        self.assertAlmostEqual(found["energy"], json.loads(self.read("r.json"))["energy"], 5)
        # Counts are those of the surface, in the report and in its list.
        self.run_tool("solve", path, "--report", report)
        found = json.loads(self.read("r.json"))
        orders = [s["index"] for s in found["singularities"]]
        self.assertEqual((found["zeros"], found["index_sum"]), (-sum(i for i in orders if i < 0), sum(orders)))
        # A wide opening is none by accident.
        points, quads = torus()
        tube = self.write("tube.obj", obj_text(points, triangles_of(quads)[:2 * 16 * 20]))
        self.assertNotIn("accident", self.run_tool("info", tube).stderr)

    def test_holes_of_many_edges(self):
        """Convex, concave, and one whose diagonals are edges of the mesh already."""
        around = [t for t in self.triangles if 40 not in t]
        path = self.write("fan.obj", obj_text(self.points, around))
        found = json.loads(self.run_tool("info", path, "--json", "--fill-holes", "6").stdout)
        self.assertEqual((found["boundaries"], found["genus"], found["vertices"], found["triangles"]), (0, 1, len(self.points) - 1, len(self.triangles) - 2))
        # The four corners of a tetrahedron are all joined: without two faces both diagonals of the hole are edges.
        points, faces = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 2, 1), (0, 1, 3)]
        path = self.write("half.obj", obj_text(points, faces))
        found = json.loads(self.run_tool("info", path, "--json", "--fill-holes", "4").stdout)
        self.assertEqual((found["boundaries"], found["genus"]), (0, 0))


class Far(Case):
    def test_outputs_far_from_the_origin(self):
        """A mesh of 3 cm, 900 km away: every output has its shape."""
        points = [(4e5 + x / 200, 8e5 + y / 200, z / 200) for x, y, z in self.points]
        path = self.write("far.obj", obj_text(points, self.triangles))
        area = json.loads(self.run_tool("info", path, "--json").stdout)["area"]

        def area_of(name):
            return json.loads(self.run_tool("info", self.path(name), "--json", "--repair", "--join-points").stdout)["area"]

        self.run_tool("solve", path, "--obj", self.path("o.obj"), "--textured", self.path("o.glb"), "--save-mesh", self.path("m.obj"),
                      "--leaves", self.path("l.obj"))
        for name, places in (("o.obj", 1e-12), ("m.obj", 1e-12), ("o.glb", 1e-5)):
            self.assertLess(abs(area_of(name) / area - 1), places, name)
        leaves = [tuple(map(float, line.split()[1:])) for line in self.read("l.obj").decode().splitlines() if line.startswith("v ")]
        middle = [(math.hypot(x - 4e5, y - 8e5) - 0.01) ** 2 + z * z for x, y, z in leaves]
        self.assertLess(max(math.sqrt(s) for s in middle), 0.0041)
        areas = []
        for name in ("q.obj", "q.off", "q.ply", "q.glb"):
            self.run_tool("quads", path, self.path(name), "--count", "500")
            areas.append(area_of(name))
        for found in areas:
            self.assertLess(abs(found / areas[2] - 1), 1e-4)
            self.assertLess(abs(found / area - 1), 0.1)
        # Near the origin nothing is taken away.
        self.run_tool("solve", self.mesh, "--textured", self.path("near.glb"))
        self.assertNotIn(b"translation", self.read("near.glb"))
        self.assertIn(b"translation", self.read("o.glb"))

    def test_edges_that_floats_lose_are_said(self):
        points, (a, b, _) = [(x + 5, y + 6, z + 7) for x, y, z in self.points], self.triangles[0]
        points[b] = tuple(x + 1e-12 * (y - x) for x, y in zip(points[a], points[b]))
        done = self.run_tool("solve", self.write("close.obj", obj_text(points, self.triangles)), "--textured", self.path("close.glb"))
        self.assertIn("close.glb: 1 edge is too short for its single precision", done.stderr)


class Formats(Case):
    def run_any(self, *arguments):
        done = subprocess.run([tool_case.TOOL, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True, timeout=300)
        return done.returncode, done.stderr

    def test_formats_of_simulation_programs(self):
        """The same quads in each; other cells, and nodes in the middle of edges, are skipped."""
        points, quads, n = self.points, self.quads, len(self.points)
        rows = ["%.17g %.17g %.17g" % p for p in points]
        medit = ["MeshVersionFormatted 2", "Dimension", "3", "Vertices", str(n), *(row + " 0" for row in rows), "Edges", "1", "1 2 5", "Quadrilaterals",
                 str(len(quads)), *(" ".join(str(v + 1) for v in q) + " 7" for q in quads), "Ridges", "1", "1", "End"]
        nodes = ["%d %s" % (10 * k + 3, row) for k, row in enumerate(rows)]
        gmsh2 = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", str(n), *nodes, "$EndNodes", "$Elements", str(len(quads) + 2), "1 15 2 0 1 3",
                 "2 1 2 0 1 3 13", *("%d 3 2 0 1 " % (k + 3) + " ".join(str(10 * v + 3) for v in q) for k, q in enumerate(quads)), "$EndElements"]
        gmsh4 = ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$Nodes", "2 %d 1 99999" % n, "0 1 0 1", "3", rows[0], "2 1 0 %d" % (n - 1),
                 *(str(10 * k + 3) for k in range(1, n)), *rows[1:], "$EndNodes", "$Elements", "2 %d 1 99999" % (len(quads) + 1), "1 1 1 1", "1 3 13",
                 "2 1 3 %d" % len(quads), *("%d " % (k + 2) + " ".join(str(10 * v + 3) for v in q) for k, q in enumerate(quads)), "$EndElements"]
        head = ["# vtk DataFile Version 3.0", "title # \\", "ASCII", "DATASET POLYDATA", "POINTS %d double" % n, *rows]
        vtk3 = head + ["LINES 1 3", "2 0 1", "POLYGONS %d %d" % (len(quads), 5 * len(quads)), *("4 %d %d %d %d" % q for q in quads), "CELL_DATA 1", "x"]
        vtk5 = head + ["POLYGONS %d %d" % (len(quads) + 1, 4 * len(quads)), "OFFSETS vtktypeint64", " ".join(str(4 * k) for k in range(len(quads) + 1)),
                       "CONNECTIVITY vtktypeint64", *("%d %d %d %d" % q for q in quads)]
        grid = [line.replace("POLYDATA", "UNSTRUCTURED_GRID") for line in head] + [
            "CELLS %d %d" % (len(quads) + 1, 5 * len(quads) + 3), "2 0 1", *("4 %d %d %d %d" % q for q in quads), "CELL_TYPES %d" % (len(quads) + 1), "3",
            *["9"] * len(quads)]
        self.run_tool("solve", self.write("quads.obj", obj_text(points, quads)), "--values", self.path("v.csv"))
        expected = self.read("v.csv")
        files = (("a.mesh", medit), ("a.msh", gmsh2), ("b.msh", gmsh4), ("a.vtk", vtk3), ("b.vtk", vtk5), ("c.vtk", grid))
        for name, lines in files:
            text = "\n".join(lines) + "\n"
            plain = self.write("plain", text)
            for path in (self.write(name, text), plain, self.write(name + ".gz", gzip.compress(text.encode())), self.write("packed", gzip.compress(text.encode(), 1))):
                self.run_tool("solve", path, "--values", self.path("v.csv"))
                self.assertEqual(self.read("v.csv"), expected, path)
            # A file that is cut is refused, wherever that is.
            for part in range(1, 10):
                cut = "\n".join(lines[: len(lines) * part // 10])
                self.assertNotEqual(self.run_any("info", self.write(name, cut))[0], 1)
        for name, text, says in (("a.msh", "$MeshFormat\n4.1 1 8\n", "binary .msh is not read here; save it as text, or convert it: the Python package"),
                                 ("a.vtk", "# vtk DataFile Version 3.0\nt\nBINARY\n", "binary .vtk is not read here; save it as text, or convert it: the Python package"),
                                 ("a.vtk", "# vtk DataFile Version 3.0\nt\nHEX\n", "save it as ASCII"),
                                 ("a.vtk", "\n".join(head) + "\nPOLYGONS 1 4\n3 0 1 %d\n" % n, ":%d: a cell names vertex %d" % (len(head) + 2, n)),
                                 ("a.mesh", "Vertices\n1\n0 0 0 0\nTriangles\n1\n1 2 0 0\n", ":6: a cell names vertex 2")):
            self.refused(3, "info", self.write(name, text), says=[says])

    def test_gzip(self):
        """All kinds of blocks, several members, names; damaged ones are refused."""
        text = obj_text(self.points, self.triangles).encode()
        expected = json.loads(self.run_tool("info", self.mesh, "--json").stdout)
        named = io.BytesIO()
        with gzip.GzipFile("torus.obj", "wb", fileobj=named) as file:
            file.write(text)
        packer = zlib.compressobj(9, zlib.DEFLATED, 31, 9, zlib.Z_FIXED)
        for packed in (gzip.compress(text, 0), gzip.compress(text, 1), gzip.compress(text, 9), named.getvalue(), packer.compress(text) + packer.flush(),
                       gzip.compress(text[:5000]) + gzip.compress(text[5000:])):
            found = json.loads(self.run_tool("info", self.write("torus.obj.gz", packed), "--json").stdout)
            for key in ("vertices", "triangles", "area"):
                self.assertEqual(found[key], expected[key])
            for damaged in (packed[:-1], packed[: len(packed) // 2], packed[:12], packed[:-8] + b"abcd" + packed[-4:]):
                self.refused(3, "info", self.write("torus.obj.gz", damaged), says=["damaged or cut"])

    def test_other_formats(self):
        done = self.refused(2, "info", self.write("part.3mf", "PK"), says=[".3mf", ".obj", "Python package", "trimesh"])
        self.assertEqual(len(done.stderr.splitlines()), 1)


if __name__ == "__main__":
    main()
