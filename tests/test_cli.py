#!/usr/bin/env python3
"""Tests of the command line tool: test_cli.py PATH_TO_HMF

Formats, every output, exit status and sentence of every error.
"""
import csv
import json
import math
import os
import resource
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest

TOOL = None


def torus(n=24, m=16):
    """Vertices and quads of a torus."""
    points, quads = [], []
    for i in range(n):
        for j in range(m):
            a, b = 2 * math.pi * i / n, 2 * math.pi * (j + 0.3 * i) / m
            r = 2 + 0.8 * math.cos(b)
            points.append((r * math.cos(a), r * math.sin(a), 0.8 * math.sin(b)))
    # The grid turns while it goes round: 0.3 * n is not whole, so shift the seam.
    for i in range(n):
        shift = round(0.3 * n) if i == n - 1 else 0
        for j in range(m):
            k = (i + 1) % n
            quads.append((i * m + j, k * m + (j + shift) % m, k * m + (j + 1 + shift) % m, i * m + (j + 1) % m))
    return points, quads


def triangles_of(quads):
    return [t for q in quads for t in ((q[0], q[1], q[2]), (q[0], q[2], q[3]))]


def tetrahedron():
    return [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]


def obj_text(points, faces, face_format="{}"):
    lines = ["v %.17g %.17g %.17g" % p for p in points]
    lines += ["f " + " ".join(face_format.format(i + 1) for i in f) for f in faces]
    return "\n".join(lines) + "\n"


class Case(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.points, self.quads = torus()
        self.triangles = triangles_of(self.quads)
        self.mesh = self.write("torus.obj", obj_text(self.points, self.triangles))

    def tearDown(self):
        self.folder.cleanup()

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def write(self, name, content):
        with open(self.path(name), "wb") as f:
            f.write(content if isinstance(content, bytes) else content.encode())
        return self.path(name)

    def read(self, name):
        with open(self.path(name), "rb") as f:
            return f.read()

    def run_tool(self, *arguments, status=0):
        done = subprocess.run([TOOL, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True, timeout=300)
        self.assertEqual(done.returncode, status, "hmf %s\n%s%s" % (" ".join(arguments), done.stdout, done.stderr))
        return done

    def refused(self, status, *arguments, says=()):
        done = self.run_tool(*arguments, status=status)
        text = done.stdout + done.stderr
        for part in says:
            self.assertIn(part, text)
        return done


class Usage(Case):
    def test_help_and_version(self):
        self.assertIn("solve", self.run_tool("--help").stdout)
        self.assertIn("--loops", self.run_tool("solve", "--help").stdout)
        self.assertRegex(self.run_tool("--version").stdout, r"hmf \d+\.\d+\.\d+")

    def test_usage_errors(self):
        self.refused(2)
        self.refused(2, "paint")
        self.refused(2, "solve")
        self.refused(2, "solve", self.mesh, "--method", "magic", says=["magic"])
        self.refused(2, "solve", self.mesh, "--ratio", "x")
        self.refused(2, "solve", self.mesh, "--ratio", "3", says=["ratio"])
        self.refused(2, "solve", self.mesh, "--unknown")
        self.refused(2, "solve", self.mesh, "--weights", "1,2,3", says=["--weights", "1 loops"])
        self.refused(2, "solve", self.mesh, "--values", self.path("a.txt"), says=[".csv or .npy"])
        self.refused(2, "solve", self.mesh, "--image", self.path("a.gif"), says=[".png"])
        self.refused(2, "solve", self.mesh, "--obj", self.path("t.txt"), says=[".obj"])
        self.refused(2, "solve", self.mesh, "--obj", self.path("t.obj"), "--image", self.path("t.png"), says=["two"])
        self.refused(2, "solve", self.mesh, "--pattern", "checkerboard", says=["--image"])
        self.refused(2, "solve", self.mesh, "--pattern", "dots", says=["dots"])
        self.refused(2, "solve", self.mesh, "--values", self.write("in.csv", ""), "--loops", self.path("in.csv"), says=["input"])
        self.refused(2, "solve", self.mesh, "--values", self.path("a.csv"), "--history", self.path("a.csv"), says=["two"])
        self.refused(2, "info", self.write("mesh.xyz", "0 0 0"), says=[".xyz", ".stl"])

    def test_file_errors(self):
        self.refused(5, "info", self.path("missing.obj"), says=["missing.obj"])
        self.refused(5, "solve", self.mesh, "--loops", self.path("missing.txt"), says=["missing.txt"])
        self.refused(5, "solve", self.mesh, "--values", self.path("no/such/folder.csv"), says=["folder.csv"])
        self.refused(5, "demo", self.mesh, says=["torus.obj"])
        if os.path.exists("/dev/full"):
            os.symlink("/dev/full", self.path("full.csv"))
            self.refused(5, "solve", self.mesh, "--values", self.path("full.csv"), says=["full.csv"])


class Meshes(Case):
    def counts(self, path):
        return json.loads(self.run_tool("info", path, "--json").stdout)

    def test_info(self):
        text = self.run_tool("info", self.mesh).stdout
        self.assertIn("genus 1", text)
        report = self.counts(self.mesh)
        n = len(self.points)
        self.assertEqual((report["vertices"], report["edges"], report["triangles"], report["genus"]), (n, 3 * n, 2 * n, 1))
        self.assertTrue(report["valid"])

    def test_formats(self):
        n = len(self.points)
        stl = b"\0" * 80 + struct.pack("<I", len(self.triangles))
        for t in self.triangles:
            stl += struct.pack("<3f", 0, 0, 0) + b"".join(struct.pack("<3f", *self.points[i]) for i in t) + b"\0\0"
        ascii_stl = "solid t\n" + "".join(
            "facet normal 0 0 0\nouter loop\n" + "".join("vertex %.9g %.9g %.9g\n" % self.points[i] for i in t) + "endloop\nendfacet\n"
            for t in self.triangles) + "endsolid t\n"
        ply_head = ("ply\nformat %s 1.0\nelement vertex %d\nproperty double x\nproperty double y\nproperty double z\n"
                    "element face %d\nproperty list uchar int vertex_indices\nend_header\n")
        ply = ply_head % ("ascii", n, len(self.quads)) + "".join("%r %r %r\n" % p for p in self.points)
        ply += "".join("4 %d %d %d %d\n" % q for q in self.quads)
        binary_ply = (ply_head % ("binary_little_endian", n, len(self.triangles))).encode()
        binary_ply += b"".join(struct.pack("<3d", *p) for p in self.points) + b"".join(struct.pack("<B3i", 3, *t) for t in self.triangles)
        off = "OFF\n%d %d 0\n" % (n, len(self.triangles)) + "".join("%r %r %r\n" % p for p in self.points)
        off += "".join("3 %d %d %d\n" % t for t in self.triangles)
        glb, gltf, numbers = self.gltf()
        self.write("numbers.bin", numbers)
        vt = "vt 0 0\nvn 0 0 1\nmtllib a.mtl\no torus\ng a\ns 1\nusemtl b\nl 1 2\n# comment\n"
        negative = obj_text(self.points, []) + "".join("f " + " ".join(str(i - n) for i in t) + "\n" for t in self.triangles)
        for name, content in [
                ("b.stl", stl), ("a.stl", ascii_stl), ("a.ply", ply), ("b.PLY", binary_ply), ("a.off", off), ("quads.obj", obj_text(self.points, self.quads)),
                ("slashes.obj", vt + obj_text(self.points, self.triangles, "{}/1/1")), ("normals.obj", vt + obj_text(self.points, self.triangles, "{}//1")),
                ("texture.obj", vt + obj_text(self.points, self.triangles, "{}/1")), ("crlf.obj", obj_text(self.points, self.triangles).replace("\n", "\r\n")),
                ("negative.obj", negative), ("a.glb", glb), ("a.gltf", gltf)]:
            report = self.counts(self.write(name, content))
            self.assertEqual((report["vertices"], report["triangles"], report["genus"]), (n, 2 * n, 1), name)
            # Without an extension the content says what it is.
            guessed = self.counts(self.write("mesh", content))
            self.assertEqual(dict(guessed, mesh=report["mesh"]), report, name)
        # Formats with doubles give the same bits.
        values = []
        for name in ("torus.obj", "a.off", "d.ply"):
            if name == "d.ply":
                self.write(name, (ply_head % ("binary_big_endian", n, len(self.triangles))).encode()
                           + b"".join(struct.pack(">3d", *p) for p in self.points)
                           + b"".join(struct.pack(">B3i", 3, *t) for t in self.triangles))
            self.run_tool("solve", self.path(name), "--values", self.path("v.csv"))
            values.append(self.read("v.csv"))
        self.assertEqual(values[0], values[1])
        self.assertEqual(values[0], values[2])

    def gltf(self):
        """The torus as the bytes of a .glb, a .gltf, and numbers.bin beside it."""
        corners = [i for t in self.triangles for i in t]
        points = b"".join(struct.pack("<3f", *p) for p in self.points)
        numbers = points + struct.pack("<%dH" % len(corners), *corners)
        document = {
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, "translation": [1, 2, 3]}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}], "buffers": [{"byteLength": len(numbers)}],
            "bufferViews": [{"buffer": 0, "byteLength": len(points)}, {"buffer": 0, "byteOffset": len(points), "byteLength": 2 * len(corners)}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(self.points), "type": "VEC3"},
                          {"bufferView": 1, "componentType": 5123, "count": len(corners), "type": "SCALAR"}]}
        text = json.dumps(document).encode()
        text += b" " * (-len(text) % 4)
        padded = numbers + b"\0" * (-len(numbers) % 4)
        glb = struct.pack("<4sIII4s", b"glTF", 2, 28 + len(text) + len(padded), len(text), b"JSON") + text
        glb += struct.pack("<I4s", len(padded), b"BIN\0") + padded
        document["buffers"][0]["uri"] = "numbers.bin"
        return glb, json.dumps(document), numbers

    def test_unreadable(self):
        good = obj_text(self.points, self.triangles)
        self.refused(3, "info", self.write("empty.obj", ""), says=["empty.obj"])
        self.refused(3, "info", self.write("text.obj", "hello\n"), says=["text.obj:1:", "hello"])
        self.refused(3, "info", self.write("vertex.obj", "v 0 0 0\nv 0 x 0\n" + good), says=[":2:", '"x" is not a number'])
        self.refused(3, "info", self.write("short.obj", good + "f 1 2\n"), says=["face %d" % len(self.triangles), "three corners"])
        self.refused(3, "info", self.write("index.obj", good + "f 1 2 9999\n"), says=["face %d" % len(self.triangles), "does not exist"])
        self.refused(3, "info", self.write("zero.obj", good + "f -9999 2 3\n"), says=["does not exist"])
        self.refused(3, "info", self.write("cut.off", "OFF\n4 4 0\n0 0 0\n1 0 0\n"), says=["cut.off"])
        self.refused(3, "info", self.write("cut.ply", "ply\nformat ascii 1.0\nelement vertex 3\n"), says=["cut.ply"])
        done = self.refused(3, "info", self.write("long.obj", good + "f 1 2 4294967297\n"), says=["vertex 4294967297", "does not exist"])
        self.assertIn(":%d:" % (good.count("\n") + 1), done.stderr)
        self.refused(3, "info", self.write("not.ply", good), says=["not.ply:1:", "looks like OBJ"])
        self.refused(3, "info", self.write("what", "0 0 0\n"), says=["neither its name nor its content"])
        self.refused(5, "info", self.write("alone.gltf", self.gltf()[1]), says=["numbers.bin", "cannot be opened"])
        self.refused(3, "info", self.write("cut.stl", b"\0" * 80 + struct.pack("<I", 5) + b"\0" * 60), says=["cut.stl"])

    def test_headers_are_not_believed(self):
        """A small file never takes much memory, whatever its header declares."""
        points = "0 0 0\n1 0 0\n0 1 0\n"
        ply = "ply\nformat %s 1.0\nelement vertex 1000000000\nproperty float x\nproperty float y\nproperty float z\n" \
              "element face 1\nproperty list int int vertex_indices\nend_header\n"
        for name, content in [
                ("face.off", "OFF\n3 1 0\n" + points + "1000000000 0 1 2\n"), ("vertices.off", "OFF\n1000000000 1 0\n" + points),
                ("text.ply", ply % "ascii" + points), ("binary.ply", (ply % "binary_little_endian").encode() + b"\0" * 64),
                ("count.stl", b"\0" * 80 + struct.pack("<I", 1000000000))]:
            path = self.write(name, content)
            tool = subprocess.Popen([TOOL, "info", path], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            text = tool.communicate(timeout=60)[1].decode()
            self.assertEqual(tool.returncode, 3, text)
            self.assertIn("1000000000", text)
        # In KiB, of all that this program has run; a thousand million of anything takes more.
        self.assertLess(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss, 700000)

    def test_marks(self):
        # The surface of a long box, a sphere; and marks on a torus.
        points, triangles, number = [], [], {}
        def vertex(p):
            if p not in number:
                number[p] = len(points)
                points.append(p)
            return number[p]
        size = (12, 3, 3)
        for axis in range(3):
            u, v = (axis + 1) % 3, (axis + 2) % 3
            for at in (0, size[axis]):
                for i in range(size[u]):
                    for j in range(size[v]):
                        square = []
                        for x, y in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)):
                            p = [0, 0, 0]
                            p[axis], p[u], p[v] = at, x, y
                            square.append(vertex(tuple(p)))
                        if at == 0:
                            square.reverse()
                        triangles += [(square[0], square[1], square[2]), (square[0], square[2], square[3])]
        box = self.write("box.obj", obj_text(points, triangles))
        done = self.run_tool("solve", box, "--report", self.path("box.json"))
        report = json.loads(self.read("box.json").decode())
        marked = report["mesh"]["marked"]
        self.assertGreaterEqual(marked, 4)
        self.assertIn("marked %d vertices, two at each of %d tips" % (marked, marked // 2), done.stdout)
        self.assertEqual((report["poles"], report["index_sum"]), (0, 4 - marked))
        corners = [number[p] for p in ((0, 0, 0), (0, 3, 3), (12, 0, 0), (12, 3, 3), (12, 3, 0))]
        marks = self.write("marks.txt", "\n".join(map(str, corners[:4])) + "\n\t%d" % corners[4])
        done = self.run_tool("solve", box, "--marks", marks, "--loops", "pants", "--report", self.path("box.json"),
                             "--image", self.path("box.png"), "--quads", self.path("quads.obj"))
        self.assertNotIn("tips", done.stdout)
        report = json.loads(self.read("box.json").decode())
        self.assertEqual((report["mesh"]["marked"], report["loops"], report["poles"], report["index_sum"]), (5, 2, 0, -1))
        self.refused(3, "solve", box, "--marks", "none", says=["genus 0", "Mark four"])
        self.refused(3, "solve", box, "--marks", self.write("bad.txt", "1 2 x"), says=["bad.txt", "number 3"])
        self.refused(3, "solve", box, "--marks", self.write("bad.txt", "1 2 3 %d" % len(points)), says=["number 4"])
        self.run_tool("solve", self.mesh, "--marks", self.write("one.txt", "7"), "--report", self.path("t.json"))
        report = json.loads(self.read("t.json").decode())
        self.assertEqual((report["mesh"]["marked"], report["poles"], report["index_sum"]), (1, 0, -1))
        self.refused(3, "solve", self.mesh, "--marks", self.write("twice.txt", "7 8 7"), says=["twice.txt", "vertex 7 is marked twice"])

    def test_refused_meshes(self):
        points, triangles = tetrahedron()
        self.refused(3, "info", self.write("sphere.obj", obj_text(points, triangles)), says=["sphere.obj", "genus 0"])
        done = self.refused(3, "info", self.path("sphere.obj"), "--json")
        self.assertFalse(json.loads(done.stdout)["valid"])
        t, p = self.triangles, self.points
        n = len(p)
        for name, points, triangles, says in [
                ("open", p, t[:-1], "edge"), ("triple", p + [(9, 9, 9)], t + [(0, 1, n)], "edge"), ("turned", p, t[:-1] + [t[-1][::-1]], "triangle"),
                ("repeated", p, t + [(0, 0, 1)], "triangle %d" % len(t)), ("unused", p + [(9, 9, 9)], t, "vertex %d" % n),
                ("two", p + [(x + 9, y, z) for x, y, z in p], t + [(a + n, b + n, c + n) for a, b, c in t], "component")]:
            path = self.write(name + ".obj", obj_text(points, triangles))
            self.refused(3, "info", path, says=[path, says])
            self.refused(3, "solve", path, says=[path, says])


class Solve(Case):
    def test_outputs(self):
        out = {name: self.path(name) for name in ("v.csv", "r.json", "h.csv", "i.png", "v.npy")}
        done = self.run_tool("solve", self.mesh, "--values", out["v.csv"], "--report", out["r.json"], "--history", out["h.csv"],
                             "--image", out["i.png"])
        self.assertEqual(done.stderr, "")
        self.assertEqual(len(done.stdout.splitlines()), 1)
        for word in ("genus 1", "energy", "residual", "zeros", "poles", " s"):
            self.assertIn(word, done.stdout)
        self.run_tool("solve", self.mesh, "--values", out["v.npy"])

        edges = []
        seen = set()
        for t in self.triangles:
            for a, b in ((t[0], t[1]), (t[1], t[2]), (t[2], t[0])):
                if frozenset((a, b)) not in seen:
                    seen.add(frozenset((a, b)))
                    edges.append(frozenset((a, b)))
        with open(out["v.csv"]) as f:
            rows = list(csv.reader(f))
        self.assertEqual([frozenset((int(a), int(b))) for a, b, _ in rows], edges)
        values = [float(row[2]) for row in rows]
        npy = self.read("v.npy")
        self.assertEqual(npy[:8], b"\x93NUMPY\x01\x00")
        length = struct.unpack("<H", npy[8:10])[0]
        self.assertEqual((10 + length) % 64, 0)
        self.assertIn("'shape': (%d,)" % len(edges), npy[10:10 + length].decode())
        self.assertEqual(list(struct.unpack("<%dd" % len(edges), npy[10 + length:])), values)
        by_edge = dict(zip(edges, values))
        for t in self.triangles:
            f = sorted(by_edge[frozenset(e)] for e in ((t[0], t[1]), (t[1], t[2]), (t[2], t[0])))
            self.assertGreaterEqual(f[0] + f[1], f[2])

        report = json.loads(self.read("r.json").decode())
        self.assertEqual(set(report), {
            "mesh", "method", "levels", "loops", "build_seconds", "loops_seconds", "solve_seconds", "total_seconds", "energy", "residual_max",
            "residual_mean", "poles", "zeros", "index_sum", "bad_flips", "bad_flips_left", "converged", "peak_memory_bytes",
            "dilatation_mean", "dilatation_median", "dilatation_p99", "flipped_triangles", "degenerate_triangles", "seam_edges", "seam_length",
            "parameterize_seconds"})
        self.assertEqual(report["mesh"], {"vertices": len(self.points), "edges": len(edges), "triangles": len(self.triangles), "genus": 1,
                                          "marked": 0})
        self.assertEqual((report["loops"], report["poles"], report["index_sum"]), (1, 0, 0))
        self.assertIs(report["converged"], True)
        self.assertGreater(report["energy"], 0)
        self.assertGreater(report["peak_memory_bytes"], 0)
        self.assertGreaterEqual(len(report["levels"]), 1)
        for level in report["levels"]:
            self.assertEqual(set(level), {"vertices", "edges", "nld", "iterations", "linear_solves", "optimize_seconds", "interpolate_seconds"})
        self.assertEqual(report["levels"][0]["edges"], len(edges))

        history = self.read("h.csv").decode().splitlines()
        self.assertEqual(history[0], "seconds,energy,residual_max,level,kind")
        self.assertGreater(len(history), 1)
        png = self.read("i.png")
        self.assertEqual(png[:8], b"\x89PNG\r\n\x1a\n")
        self.assertEqual(struct.unpack(">II", png[16:24]), (1400, 1050))

    def test_texture(self):
        obj, image = self.path("t.obj"), self.path("i.png")
        self.run_tool("solve", self.mesh, "--obj", obj, "--image", image, "--pattern", "checkerboard", "--report", self.path("r.json"))
        self.assertEqual(self.read("i.png")[:8], b"\x89PNG\r\n\x1a\n")
        self.assertEqual(self.read("t.png")[:8], b"\x89PNG\r\n\x1a\n")
        self.assertIn("map_Kd t.png", self.read("t.mtl").decode())
        lines = self.read("t.obj").decode().splitlines()
        self.assertIn("mtllib t.mtl", lines)
        texture = [tuple(float(x) for x in line.split()[1:]) for line in lines if line.startswith("vt ")]
        faces = [[tuple(int(i) - 1 for i in corner.split("/")) for corner in line.split()[1:]] for line in lines if line.startswith("f ")]
        self.assertEqual([tuple(v for v, _ in f) for f in faces], self.triangles)
        # Cut open along two loops, not along every edge.
        self.assertLess(len(texture), 1.5 * len(self.points))
        for f in faces:
            (x0, y0), (x1, y1), (x2, y2) = (texture[t] for _, t in f)
            self.assertGreater((x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0), 0)
        report = json.loads(self.read("r.json").decode())
        self.assertEqual((report["flipped_triangles"], report["degenerate_triangles"]), (0, 0))
        self.assertLess(report["dilatation_mean"], 1.2)
        # Not harmonic: refused with the remedy; what else was asked for is written.
        self.refused(3, "solve", self.mesh, "--method", "whitehead", "--tolerance", "0.1", "--obj", self.path("u.obj"), "--values", self.path("u.csv"),
                     says=["hmf_relax"])
        self.assertTrue(os.path.exists(self.path("u.csv")))

    def test_start(self):
        first, second, report = self.path("first.csv"), self.path("second.csv"), self.path("r.json")
        self.run_tool("solve", self.mesh, "--values", first, "--method", "whitehead", "--report", report)
        coarse = json.loads(self.read("r.json"))["energy"]
        self.run_tool("solve", self.mesh, "--start", first, "--values", second, "--report", report)
        again = json.loads(self.read("r.json"))["energy"]
        self.run_tool("solve", self.mesh, "--report", report)
        exact = json.loads(self.read("r.json"))["energy"]
        self.assertLess(abs(again - exact), 1e-10 * exact)
        self.assertGreaterEqual(coarse, exact * (1 - 1e-12))
        self.assertNotEqual(self.read("first.csv"), self.read("second.csv"))
        lines = self.read("first.csv").decode().splitlines()
        bad = self.path("bad.csv")
        for change, says in (
            (lines[:-1], "%d values for %d edges" % (len(lines) - 1, len(lines))),
            (lines + lines[:1], "bad.csv:%d: more lines" % (len(lines) + 1)),
            (lines[:4] + ["1;2;3"] + lines[5:], "bad.csv:5: not a line"),
            (lines[:4] + ["1,2,x"] + lines[5:], "bad.csv:5: not a line"),
            (lines[:4] + ["0,0,1"] + lines[5:], "bad.csv:5: edge 4 of the mesh"),
            (lines[:4] + [lines[4].rsplit(",", 1)[0] + ",99"] + lines[5:], "not closed"),
        ):
            self.write("bad.csv", "\n".join(change) + "\n")
            self.refused(3, "solve", self.mesh, "--start", bad, says=[says])
        self.refused(2, "solve", self.mesh, "--start", first, "--loops", "cut", says=["--start"])
        self.refused(2, "solve", self.mesh, "--start", first, "--values", first, says=["input"])
        self.refused(2, "solve", self.mesh, "--start", self.mesh, says=[".csv"])

    def test_mollify(self):
        points = list(self.points)
        a, b, c = self.triangles[0]
        points[a] = tuple((p + q) / 2 for p, q in zip(points[b], points[c]))
        mesh = self.write("flat.obj", obj_text(points, self.triangles))
        self.refused(3, "solve", mesh, says=["no area", "mollify"])
        self.run_tool("solve", mesh, "--mollify", "1e-5")
        self.refused(2, "solve", mesh, "--mollify", "0.5", says=["mollify in [0, 0.1]"])

    def test_same_bits_twice(self):
        for name in ("a.csv", "b.csv"):
            self.run_tool("solve", self.mesh, "--values", self.path(name))
        self.assertEqual(self.read("a.csv"), self.read("b.csv"))

    def test_methods_agree(self):
        energies = []
        for method in ("newton", "whitehead", "single-level"):
            self.run_tool("solve", self.mesh, "--method", method, "--tolerance", "1e-10", "--report", self.path("r.json"))
            report = json.loads(self.read("r.json").decode())
            self.assertEqual(report["method"], method)
            energies.append(report["energy"])
        for energy in energies:
            self.assertAlmostEqual(energy / energies[0], 1, 2)

    def test_loops(self):
        m = 16
        meridian = " ".join(str(j) for j in range(m))
        report = self.path("r.json")
        energies = []
        for text in (meridian, "# the seam\n\nv: " + meridian.replace(" ", ",") + "  # and its end\n"):
            self.run_tool("solve", self.mesh, "--loops", self.write("loops.txt", text), "--report", report)
            energies.append(json.loads(self.read("r.json").decode())["energy"])
        # The strip of triangles beside that meridian.
        self.run_tool("solve", self.mesh, "--loops", self.write("loops.txt", "t: " + " ".join(str(t) for t in range(2 * m))), "--report", report)
        energies.append(json.loads(self.read("r.json").decode())["energy"])
        for energy in energies:
            self.assertAlmostEqual(energy / energies[0], 1, 3)
        self.run_tool("solve", self.mesh, "--loops", self.write("loops.txt", meridian), "--weights", "2", "--report", report)
        self.assertAlmostEqual(json.loads(self.read("r.json").decode())["energy"] / energies[0], 4, 2)

    def test_library_loops(self):
        # On a torus of revolution: round the tube, and round the hole.
        energy = {}
        for kind in ("cut", "handle", "tunnel", "pants"):
            self.run_tool("solve", self.mesh, "--loops", kind, "--report", self.path("r.json"))
            with open(self.path("r.json")) as file:
                energy[kind] = json.load(file)["energy"]
        self.assertEqual(energy["cut"], energy["handle"])
        self.assertEqual(energy["cut"], energy["pants"])
        self.assertNotAlmostEqual(energy["handle"], energy["tunnel"])

    def test_loops_through_levels(self):
        points, quads = torus(90, 40)
        mesh = self.write("large.obj", obj_text(points, triangles_of(quads)))
        loops = self.write("loops.txt", " ".join(map(str, range(40))))
        energies = []
        for coarsest in ("100", "3600"):
            self.run_tool("solve", mesh, "--loops", loops, "--coarsest", coarsest, "--report", self.path("r.json"))
            report = json.loads(self.read("r.json").decode())
            self.assertEqual(len(report["levels"]) > 1, coarsest == "100")
            energies.append(report["energy"])
        self.assertAlmostEqual(energies[0] / energies[1], 1, 9)

    def test_bad_loops(self):
        def bad(text, *says):
            path = self.write("loops.txt", text)
            self.refused(3, "solve", self.mesh, "--loops", path, says=[path, *says])
        bad("", "no loops")
        bad("0 1 x\n", ":1:", "\"x\"")
        bad("0 1 2.5\n", ":1:", "2.5")
        bad("# comment\n0 1 -2\n", ":2:", "-2")
        bad("0 1 99999\n", ":1:", "99999", "does not exist")
        bad("t: 99999\n", ":1:", "triangle 99999")
        bad("0 1 2\nt: 0 1\n", ":2:")
        bad("t:\n", ":1:")
        bad("\n0 5 9\n", ":2")                                            # no path
        # A loop around one vertex bounds a disk.
        star = [t for t in self.triangles if 0 in t]
        ring, follow = [], {t[(t.index(0) + 1) % 3]: t[(t.index(0) + 2) % 3] for t in star}
        at = next(iter(follow))
        for _ in follow:
            ring.append(at)
            at = follow[at]
        bad(" ".join(map(str, ring)), ":1", "disk")
        m = 16
        bad(" ".join(map(str, range(m))) + "\n" + " ".join(map(str, range(4 * m, 5 * m))), ":2", "homotopic")

    def test_bad_weights(self):
        for weight in ("0", "-1", "nan"):
            self.refused(3, "solve", self.mesh, "--weights=" + weight)

    def test_limit_still_writes(self):
        points, quads = torus(120, 60)
        mesh = self.write("large.obj", obj_text(points, triangles_of(quads)))
        done = self.run_tool("solve", mesh, "--method", "single-level", "--tolerance", "1e-15", "--time-limit", "0.02",
                             "--values", self.path("v.csv"), "--report", self.path("r.json"), status=4)
        self.assertIn("best foliation", done.stderr)
        self.assertEqual(len(self.read("v.csv").splitlines()), 3 * len(points))
        self.assertIs(json.loads(self.read("r.json").decode())["converged"], False)

    def test_interrupt_still_writes(self):
        points, quads = torus(240, 150)
        mesh = self.write("large.obj", obj_text(points, triangles_of(quads)))
        tool = subprocess.Popen([TOOL, "solve", mesh, "--method", "single-level", "--tolerance", "1e-15", "--values", self.path("v.csv")],
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        time.sleep(1.5)
        tool.send_signal(signal.SIGINT)
        _, errors = tool.communicate(timeout=60)
        self.assertEqual(tool.returncode, 4, errors.decode())
        self.assertIn("interrupted", errors.decode())
        self.assertEqual(len(self.read("v.csv").splitlines()), 3 * len(points))


class Leaves(Case):
    """Leaves and quads of a surface of genus 3, the sample of the demo."""

    def test_leaves_and_quads(self):
        folder = self.path("demo")
        self.run_tool("demo", folder)
        sample = os.path.join(folder, "sample.obj")
        report, leaves, quads = self.path("r.json"), self.path("l.obj"), self.path("q.obj")
        self.run_tool("solve", sample, "--weights", "1,1,2", "--leaves", leaves, "--spacing", "0.1", "--quads", quads, "--size", "0.1", "--report", report)
        with open(report) as f:
            found = json.load(f)
        cylinders = found["cylinders"]
        self.assertEqual([c["height"] for c in sorted(cylinders, key=lambda c: c["loop"])], [1, 1, 2])
        self.assertEqual(sorted(c["loop"] for c in cylinders), [0, 1, 2])
        self.assertAlmostEqual(sum(c["height"] * c["circumference"] for c in cylinders) / found["energy"], 1, delta=1e-9)
        self.assertAlmostEqual(sum(c["area"] for c in cylinders) / found["energy"], 1, delta=1e-9)

        lines, groups, points = 0, set(), 0
        with open(leaves) as f:
            for line in f:
                word = line.split()
                if word[0] == "v":
                    points += 1
                elif word[0] == "g":
                    groups.add(word[1])
                    group = word[1]
                elif word[0] == "l":
                    lines += 1
                    self.assertTrue(all(1 <= int(i) <= points for i in word[1:]))
                    if group != "critical":
                        self.assertEqual(word[1], word[-1])
        self.assertEqual(groups, {"critical", "cylinder_0", "cylinder_1", "cylinder_2"})
        self.assertEqual(lines, found["leaves"])
        # 8 zeros, counted with their orders; a zero of order m has m + 2 prongs.
        self.assertTrue(40 + 8 / 2 < lines <= 40 + 3 * 8 / 2)

        # The reader of the tool, then every defect of a mesh is looked for.
        self.assertEqual(json.loads(self.run_tool("info", quads, "--json").stdout)["genus"], 3)
        valence, faces = {}, 0
        with open(quads) as f:
            for line in f:
                if line[0] == "f":
                    corners = line.split()[1:]
                    self.assertEqual(len(corners), 4)
                    faces += 1
                    for corner in corners:
                        valence[corner] = valence.get(corner, 0) + 1
        self.assertEqual(faces, found["quads"])
        self.assertEqual(sum((k - 4) / 2 for k in valence.values()), 8)
        try:
            import trimesh
        except ImportError:
            return
        surface = trimesh.load(quads, process=False)
        self.assertTrue(surface.is_watertight and surface.is_winding_consistent)
        self.assertEqual(surface.euler_number, -4)

    def test_refusals(self):
        for option in ("--spacing", "--size"):
            self.run_tool("solve", self.mesh, option, "0", status=2)
        self.run_tool("solve", self.mesh, "--leaves", self.path("l.txt"), status=2)
        self.run_tool("solve", self.mesh, "--leaves", self.path("x.obj"), "--quads", self.path("x.obj"), status=2)


class Demo(Case):
    def test_demo(self):
        folder = self.path("demo")
        done = self.run_tool("demo", folder)
        image = os.path.join(folder, "image.png")
        self.assertIn(image, done.stdout.splitlines()[-1])
        self.assertEqual({"sample.obj", "image.png", "leaves.obj", "quads.obj", "textured.obj", "textured.mtl", "textured.png", "values.csv", "values.npy", "report.json", "history.csv"}, set(os.listdir(folder)))
        report = json.loads(self.read("demo/report.json").decode())
        self.assertEqual(report["mesh"]["genus"], 3)
        self.assertGreater(report["mesh"]["vertices"], 15000)
        self.assertEqual((report["poles"], report["index_sum"], report["loops"]), (0, -8, 3))


if __name__ == "__main__":
    if len(sys.argv) < 2 or not os.path.exists(sys.argv[1]):
        sys.exit("usage: test_cli.py PATH_TO_HMF [unittest arguments]")
    TOOL = os.path.abspath(sys.argv.pop(1))
    unittest.main(verbosity=2)
