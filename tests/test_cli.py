#!/usr/bin/env python3
"""Tests of the command line tool: test_cli.py PATH_TO_HMF

Formats, every output, exit status and sentence of every error.
"""
import csv
import json
import math
import os
import re
import resource
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import zlib

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


def box(a, b, c):
    """Vertices and triangles of the surface of a box of a x b x c cubes, a sphere."""
    points, triangles, size = [], [], (a, b, c)
    def vertex(*p):
        if p not in points:
            points.append(p)
        return points.index(p)
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for at in (0, size[axis]):
            for i in range(size[u]):
                for j in range(size[v]):
                    square = []
                    for x, y in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)):
                        p = [at] * 3
                        p[u], p[v] = x, y
                        square.append(vertex(*p))
                    triangles += triangles_of([square if at else square[::-1]])
    return points, triangles


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


def pixels_of(png):
    """Rows of (red, green, blue) of a PNG, after every check that its format allows."""
    assert png[:8] == b"\x89PNG\r\n\x1a\n"
    at, chunks = 8, []
    while at < len(png):
        length, name = struct.unpack(">I4s", png[at:at + 8])
        data, (crc,) = png[at + 8:at + 8 + length], struct.unpack(">I", png[at + 8 + length:at + 12 + length])
        assert crc == zlib.crc32(name + data)
        chunks.append((name, data))
        at += 12 + length
    assert [name for name, _ in chunks] == [b"IHDR", b"IDAT", b"IEND"]
    width, height, *rest = struct.unpack(">IIBBBBB", chunks[0][1])
    assert rest == [8, 2, 0, 0, 0]
    raw, size = zlib.decompress(chunks[1][1]), 3 * width + 1
    assert len(raw) == size * height
    rows, above = [], bytes(3 * width)
    for y in range(height):
        assert raw[y * size] == 4
        row = bytearray(raw[y * size + 1:(y + 1) * size])
        for x in range(3 * width):
            a, b, c = row[x - 3] if x >= 3 else 0, above[x], above[x - 3] if x >= 3 else 0
            p = a + b - c
            row[x] = (row[x] + min((a, b, c), key=lambda q: abs(p - q))) & 255
        rows.append([tuple(row[3 * x:3 * x + 3]) for x in range(width)])
        above = row
    return rows


class Usage(Case):
    def test_help_and_version(self):
        self.assertIn("solve", self.run_tool("--help").stdout)
        self.assertIn("--loops", self.run_tool("solve", "--help").stdout)
        self.assertRegex(self.run_tool("--version").stdout, r"hmf \d+\.\d+\.\d+")

    def test_manual_and_completion(self):
        """Every option of every command is in the manual page and in the completion of each shell."""
        page = self.run_tool("manual").stdout
        self.assertTrue(page.startswith(".TH HMF 1"))
        shells = {shell: self.run_tool("completion", shell).stdout for shell in ("bash", "zsh", "fish")}
        for command in ("solve", "info", "batch", "demo"):
            for option in re.findall(r"^  (--[a-z-]+)", self.run_tool(command, "--help").stdout, re.M):
                self.assertIn(option.replace("-", "\\-"), page)
                for shell, text in shells.items():
                    self.assertIn(option[2:] if shell == "fish" else option, text, shell)
        build = os.path.dirname(os.path.abspath(TOOL))
        if shutil.which("cmake") and os.path.exists(os.path.join(build, "CMakeCache.txt")):
            subprocess.run(["cmake", "--install", build, "--prefix", self.path("prefix")], check=True, stdout=subprocess.PIPE)
            for path, text in (("man/man1/hmf.1", page), ("bash-completion/completions/hmf", shells["bash"]), ("zsh/site-functions/_hmf", shells["zsh"]),
                               ("fish/vendor_completions.d/hmf.fish", shells["fish"])):
                self.assertEqual(self.read("prefix/share/" + path).decode(), text)
        if shutil.which("man"):
            done = subprocess.run(["man", "-l", "--warnings", self.write("hmf.1", page)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True,
                                  env=dict(os.environ, MANWIDTH="100", LC_ALL="C.UTF-8"))
            self.assertEqual(done.stderr, "")
            self.assertIn("--camera", done.stdout)
        def replies(*words):
            script = "source '%s'; COMP_WORDS=(hmf %s); COMP_CWORD=%d; _hmf; printf '%%s\\n' \"${COMPREPLY[@]}\"" % (
                self.write("hmf.bash", shells["bash"]), " ".join("'%s'" % w for w in words), len(words))
            return subprocess.run(["bash", "-uc", script], stdout=subprocess.PIPE, check=True, universal_newlines=True, cwd=self.folder.name).stdout.split()
        if shutil.which("bash"):
            self.assertEqual(replies("so"), ["solve"])
            self.assertEqual(replies("solve", "x.obj", "--patt"), ["--pattern"])
            self.assertEqual(replies("solve", "x.obj", "--pattern", ""), ["stripes", "checkerboard", "quads", "dilatation", "scale"])
            self.assertEqual(replies("solve", "tor"), ["torus.obj"])
            self.assertIn("handle", replies("solve", "x.obj", "--loops", ""))
        for shell in ("zsh", "fish"):
            if shutil.which(shell):
                subprocess.run([shell, "-n", self.write("completion", shells[shell])], check=True)
        self.refused(2, "completion", "sh", says=["bash, zsh or fish"])

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

    def test_names(self):
        self.refused(2, says=["demo, info, solve, quads, batch"])
        self.refused(2, "foo", says=["\"foo\"", "demo, info, solve, quads, batch"])
        self.refused(2, "solve", self.mesh, "--imagine", "i.png", says=["--imagine", "hmf solve --help"])
        self.refused(2, "solve", self.mesh, self.mesh, says=["nothing is expected here"])
        self.refused(2, "solve", self.mesh, "--values", says=["--values", "value is missing"])
        self.refused(2, "solve", self.mesh, "--values", "--report", "r.json", says=["--values", "value is missing"])
        self.refused(2, "solve", self.mesh, "--ratio", "0.5", "--ratio=0.6", says=["--ratio", "twice"])
        for weights in ("", "1,", ",1", "1,,2", "1;2", "x"):
            self.refused(2, "solve", self.mesh, "--weights=" + weights, says=["--weights", "not a number"])
        self.refused(2, "solve", self.mesh, "--conjugate=1", says=["--conjugate", "no value"])
        self.refused(2, "solve", self.mesh, "--coarsest", "1.5", says=["--coarsest", "whole number"])
        self.refused(2, "solve", self.mesh, "--method", "magic", says=["newton, whitehead, single-level or paper"])
        for command in ("demo", "info", "solve", "batch"):
            self.assertIn("usage: hmf " + command, self.run_tool(command, "--help").stdout)
        for option in ("--loops", "--save-loops", "--start", "--conformality", "--size", "--marks", "--save-marks", "default auto", "default midpoint", "in (0, 1)"):
            self.assertIn(option, self.run_tool("solve", "-h").stdout)

    def test_options_without_effect(self):
        for option, needed in ((["--conjugate"], "--leaves"), (["--spacing", "0.1"], "--leaves"), (["--size", "0.1"], "--quads"),
                               (["--conformality"], "--report"), (["--join-points"], "--repair"), (["--pattern", "checkerboard"], "--image")):
            self.refused(2, "solve", self.mesh, *option, says=[option[0], "no effect without " + needed])

    def test_advice_names_options(self):
        """No sentence of the tool speaks of the C interface."""
        points, quads = torus()
        a, b, c = self.triangles[0]
        points[a] = tuple((p + q) / 2 for p, q in zip(points[b], points[c]))
        crossing = [(x, y * 0.05, z) if x < 0 else (x, y, z) for x, y, z in self.points]
        values = self.path("v.csv")
        self.run_tool("solve", self.mesh, "--values", values)
        lines = self.read("v.csv").decode().splitlines()
        for words in (["solve", self.write("flat.obj", obj_text(points, self.triangles))],
                      ["solve", self.mesh, "--method", "whitehead", "--tolerance", "0.1", "--obj", self.path("u.obj")],
                      ["solve", self.mesh, "--quads", self.path("q.obj"), "--size", "1e-9"], ["solve", self.mesh, "--ratio", "3"],
                      ["solve", self.write("crossing.obj", obj_text(crossing, self.triangles)), "--loops", "handle"],
                      ["solve", self.write("sphere.obj", obj_text(*tetrahedron())), "--loops", "handle"], ["solve", self.path("sphere.obj"), "--marks", "none"],
                      ["solve", self.mesh, "--tolerance", "2"], ["solve", self.mesh, "--weights=-1"],
                      ["solve", self.mesh, "--start", self.write("w.csv", "\n".join(l.rsplit(",", 1)[0] + ",0" for l in lines))],
                      ["solve", self.mesh, "--start", self.write("x.csv", "\n".join(l.rsplit(",", 1)[0] + ",%d" % (k % 2) for k, l in enumerate(lines)))]):
            done = subprocess.run([TOOL, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)
            for word in ("hmf_", "HMF_", "NULL", "options", "struct_size", "time_limit", "memory_limit", "stop_level", "edge_length"):
                self.assertNotIn(word, done.stderr.replace("lists the options", ""), words)

    def test_file_errors(self):
        self.refused(5, "info", self.path("missing.obj"), says=["missing.obj"])
        self.refused(5, "solve", self.mesh, "--loops", self.path("missing.txt"), says=["missing.txt"])
        self.refused(5, "solve", self.mesh, "--loops", "handel", says=["\"handel\"", "neither a kind", "nor a file", "cut, handle, tunnel, pants and even"])
        self.refused(5, "solve", self.mesh, "--marks", "non", says=["--marks", "\"non\"", "neither auto nor none nor a file"])
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
        self.assertEqual(report["suggested_marks"], [])
        self.assertNotIn("tips", text)

    def test_info_of_sphere(self):
        points, triangles = box(12, 3, 3)
        sphere = self.write("box.obj", obj_text(points, triangles))
        report = self.counts(sphere)
        self.assertEqual((report["valid"], report["genus"], report["vertices"]), (True, 0, len(points)))
        marks = report["suggested_marks"]
        self.assertEqual(len(set(marks)), len(marks))
        self.assertTrue(4 <= len(marks) <= 24 and all(0 <= v < len(points) for v in marks))
        text = self.run_tool("info", sphere).stdout
        self.assertIn("genus 0", text)
        self.assertIn("%d vertices, two at each of %d tips" % (len(marks), len(marks) // 2), text)
        # Two triangles back to back have no four vertices to mark.
        pillow = self.write("pillow.obj", obj_text(points[:3], [(0, 1, 2), (0, 2, 1)]))
        for command in ("info", "solve"):
            self.refused(3, command, pillow, says=["pillow.obj", "genus 0"])
        # What else is wrong with a mesh that has as many vertices and triangles as a sphere.
        for name, faces, says in (("turned", triangles[:-1] + [triangles[-1][::-1]], "triangle"), ("triple", triangles[:-1] + triangles[:1], "edge")):
            path = self.write(name + ".obj", obj_text(points, faces))
            self.assertIn(says, self.refused(3, "info", path, says=[path]).stderr)
            self.assertFalse(json.loads(self.refused(3, "info", path, "--json").stdout)["valid"])

    def test_a_hole_is_no_defect(self):
        path = self.write("open.obj", obj_text(self.points, self.triangles[:-1]))
        info = json.loads(self.run_tool("info", path, "--json").stdout)
        self.assertTrue(info["valid"])
        report = self.path("open.json")
        self.run_tool("solve", path, "--report", report)
        with open(report) as f:
            r = json.load(f)
        self.assertEqual((r["mesh"]["genus"], r["mesh"]["boundaries"], r["poles"], r["converged"]), (1, 1, 0, True))
        self.assertLess(r["residual_max"], 1e-8)

    def test_even(self):
        """Loops, weights and marks of the even design, saved and taken again; a picture of the scale."""
        points, triangles = box(12, 3, 3)
        box_, out = self.write("box.obj", obj_text(points, triangles)), self.path("r.json")
        marks, loops = self.path("marks.txt"), self.path("loops.txt")
        done = self.run_tool("solve", box_, "--loops", "even", "--save-marks", marks, "--save-loops", loops, "--report", out)
        first = json.loads(self.read("r.json"))
        self.assertIn("even: %d marked vertices, %d loops with weights; unevenness %.2f" % (first["mesh"]["marked"], first["loops"], first["unevenness"]), done.stdout)
        self.assertEqual(len(first["weights"]), first["loops"])
        self.assertTrue(all(w == int(w) >= 1 for w in first["weights"]))
        self.run_tool("solve", box_, "--marks", marks, "--loops", loops, "--report", out, "--image", self.path("i.png"), "--pattern", "scale", "--image-size", "300x200")
        again = json.loads(self.read("r.json"))
        self.assertEqual(again["weights"], first["weights"])
        self.assertAlmostEqual(again["energy"] / first["energy"], 1, 9)
        self.assertAlmostEqual(again["unevenness"], first["unevenness"], 6)
        self.run_tool("solve", box_, "--report", out)
        self.assertGreater(json.loads(self.read("r.json"))["unevenness"], first["unevenness"])
        # Other weights than those of the file; no poles where there are handles; several components.
        self.run_tool("solve", box_, "--marks", marks, "--loops", loops, "--weights", ",".join(["2"] * first["loops"]), "--report", out)
        self.assertEqual(json.loads(self.read("r.json"))["weights"], [2] * first["loops"])
        self.run_tool("solve", self.mesh, "--loops", "even", "--marks", "none", "--report", out)
        self.assertEqual(json.loads(self.read("r.json"))["mesh"]["marked"], 0)
        both = beside((points, triangles), box(6, 3, 3))
        done = self.run_tool("solve", self.write("two.obj", obj_text(*both)), "--loops", "even", "--save-marks", marks, "--report", out)
        self.assertIn("marked vertices", done.stdout)
        self.assertEqual(len(self.read("marks.txt").split(b"\n")) - 2, json.loads(self.read("r.json"))["mesh"]["marked"])

    def test_marks(self):
        points, triangles = box(12, 3, 3)
        n = len(points)
        sphere, out = self.write("box.obj", obj_text(points, triangles)), self.path("r.json")
        saved, loops, values = self.path("saved.txt"), self.path("loops.txt"), self.path("v.csv")

        def report_of(*words):
            done = self.run_tool("solve", *words, "--report", out)
            return done.stdout, json.loads(self.read("r.json"))

        # Suggested ones, and the same ones from a file.
        text, report = report_of(sphere, "--save-marks", saved, "--save-loops", loops, "--values", values)
        marked = report["mesh"]["marked"]
        self.assertGreaterEqual(marked, 4)
        self.assertIn("marked %d vertices, two at each of %d tips" % (marked, marked // 2), text)
        self.assertEqual((report["mesh"]["genus"], report["poles"], report["index_sum"]), (0, 0, 4 - marked))
        self.assertEqual((report["class"], report["converged"], report["options"]["marks"]), ("checked", True, "auto"))
        self.assertIn("class checked", text)
        head, *lines = self.read("saved.txt").decode().splitlines()
        self.assertEqual(head, "# %d marked vertices" % marked)
        self.assertEqual([int(line) for line in lines], json.loads(self.run_tool("info", sphere, "--json").stdout)["suggested_marks"])
        self.assertEqual(set(map(int, lines)) - {s["element"] for s in report["singularities"] if s["kind"] == "vertex"}, set())
        text, again = report_of(sphere, "--marks", saved, "--loops", loops, "--save-marks", self.path("again.txt"), "--values", self.path("w.csv"))
        self.assertNotIn("tips", text)
        self.assertEqual(self.read("again.txt"), self.read("saved.txt"))
        self.assertAlmostEqual(again["energy"] / report["energy"], 1, 9)
        text, again = report_of(sphere, "--start", values)
        self.assertAlmostEqual(again["energy"] / report["energy"], 1, 9)

        # Marks of the caller, every output.
        corners = [points.index(p) for p in ((0, 0, 0), (0, 3, 3), (12, 0, 0), (12, 3, 3), (12, 3, 0))]
        marks = self.write("marks.txt", "# corners\n" + ", ".join(map(str, corners[:4])) + "\r\n\t%d # the last" % corners[4])
        text, report = report_of(sphere, "--marks", marks, "--loops", "pants", "--image", self.path("i.png"), "--quads", self.path("q.obj"),
                                 "--obj", self.path("t.obj"), "--leaves", self.path("l.obj"), "--conformality")
        self.assertNotIn("tips", text)
        self.assertEqual((report["mesh"]["marked"], report["loops"], report["poles"], report["index_sum"]), (5, 2, 0, -1))
        self.assertEqual(json.loads(self.run_tool("info", self.path("q.obj"), "--json").stdout)["genus"], 0)
        self.assertEqual(sorted(c["height"] for c in report["cylinders"]), [1, 1])
        violet = sum(r > 2 * g and b > 2 * g and b > 0.7 * r for row in pixels_of(self.read("i.png")) for r, g, b in row)
        self.assertGreater(violet, 500)

        # On other surfaces auto marks none.
        text, report = report_of(self.mesh, "--save-marks", saved)
        self.assertEqual((report["mesh"]["marked"], self.read("saved.txt")), (0, b"# 0 marked vertices\n"))
        self.assertNotIn("marked", text)
        text, report = report_of(self.mesh, "--marks", saved)
        self.assertEqual((report["mesh"]["marked"], report["class"]), (0, "proven"))
        text, report = report_of(self.mesh, "--marks", self.write("one.txt", "7"))
        self.assertEqual((report["mesh"]["marked"], report["poles"], report["index_sum"], report["class"]), (1, 0, -1, "checked"))

        self.refused(3, "solve", sphere, "--marks", "none", says=["genus 0", "--marks auto"])
        self.refused(3, "solve", sphere, "--marks", self.write("three.txt", "1 2 3"), says=["3 marked vertices", "--marks auto"])
        self.refused(3, "solve", sphere, "--loops", "handle", says=["no handles", "--loops cut or --loops pants"])
        bad = self.path("bad.txt")
        for content, says in (("1 2 x", "bad.txt:1: \"x\" is not a vertex"), ("1 2\n-3", "bad.txt:2: \"-3\""), ("1 2.5", "\"2.5\""),
                              ("1 2 3 %d" % n, "vertex %d does not exist; the mesh has %d" % (n, n)), ("1\n2 1", "bad.txt:2: vertex 1 is marked twice, first in line 1"),
                              ("7 8 7", "vertex 7 is marked twice")):
            self.write("bad.txt", content)
            self.refused(3, "solve", sphere, "--marks", bad, says=[says])
        self.refused(2, "solve", sphere, "--marks", bad, "--save-marks", bad, says=["input"])
        self.refused(2, "solve", sphere, "--marks", "auto", "--marks", bad, says=["--marks", "twice"])

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

    def test_refused_meshes(self):
        points, triangles = tetrahedron()
        self.refused(3, "solve", self.write("sphere.obj", obj_text(points, triangles)), "--marks", "none", says=["sphere.obj", "genus 0"])
        t, p = self.triangles, self.points
        n = len(p)
        for name, points, triangles, says in [
                ("triple", p + [(9, 9, 9)], t + [(0, 1, n)], "edge"), ("turned", p, t[:-1] + [t[-1][::-1]], "triangle"),
                ("repeated", p, t + [(0, 0, 1)], "triangle %d" % len(t)), ("unused", p + [(9, 9, 9)], t, "vertex %d" % n)]:
            path = self.write(name + ".obj", obj_text(points, triangles))
            self.refused(3, "info", path, says=[path, says, "--repair"])
            self.refused(3, "solve", path, says=[path, says, "--repair"])
            self.assertFalse(json.loads(self.refused(3, "info", path, "--json").stdout)["valid"])


class Solve(Case):
    def test_outputs(self):
        out = {name: self.path(name) for name in ("v.csv", "r.json", "h.csv", "i.png", "v.npy")}
        done = self.run_tool("solve", self.mesh, "--values", out["v.csv"], "--report", out["r.json"], "--history", out["h.csv"],
                             "--image", out["i.png"])
        self.assertEqual(done.stderr, "")
        self.assertEqual(len(done.stdout.splitlines()), 1)
        for word in ("genus 1", "energy", "residual", "class proven", "zeros", "poles", " s"):
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
            "mesh", "method", "levels", "loops", "build_seconds", "loops_seconds", "solve_seconds", "total_seconds", "energy", "unevenness", "weights", "residual_max",
            "residual_mean", "poles", "zeros", "index_sum", "bad_flips", "bad_flips_left", "converged", "peak_memory_bytes",
            "class", "class_repeats", "class_seconds", "version", "input", "options", "exit_status", "errors", "cpu_seconds", "threads", "singularities"})
        self.assertEqual(report["mesh"], {"vertices": len(self.points), "edges": len(edges), "triangles": len(self.triangles), "genus": 1,
                                          "marked": 0, "components": 1, "boundaries": 0})
        self.assertEqual((report["class"], report["class_repeats"]), ("proven", 0))
        self.assertTrue(0 < report["class_seconds"] < report["solve_seconds"])
        self.assertEqual((report["loops"], report["poles"], report["index_sum"]), (1, 0, 0))
        self.assertIs(report["converged"], True)
        self.assertGreater(report["energy"], 0)
        self.assertGreater(report["peak_memory_bytes"], 0)
        self.assertGreaterEqual(len(report["levels"]), 1)
        for level in report["levels"]:
            self.assertEqual(set(level), {"vertices", "edges", "nld", "raised_count", "iterations", "linear_solves", "optimize_seconds", "interpolate_seconds"})
            self.assertEqual(level["nld"], level["raised_count"])
        self.assertEqual(report["levels"][0]["edges"], len(edges))

        history = self.read("h.csv").decode().splitlines()
        self.assertEqual(history[0], "seconds,energy,residual_max,level,kind")
        self.assertGreater(len(history), 1)
        png = self.read("i.png")
        self.assertEqual(png[:8], b"\x89PNG\r\n\x1a\n")
        self.assertEqual(struct.unpack(">II", png[16:24]), (1400, 1050))
        picture = pixels_of(png)
        self.assertEqual((len(picture), len(picture[0])), (1050, 1400))
        # Red, white, green and the background.
        self.assertGreater(sum(r > 2 * g and r > 2 * b for row in picture for r, g, b in row), 10000)
        self.assertGreater(sum(g > 1.5 * r and g > 1.5 * b for row in picture for r, g, b in row), 100)
        self.assertGreater(len(set(color for row in picture for color in row)), 1000)

    def test_report(self):
        """The report costs nothing but its numbers, and tells what was done."""
        report = self.path("r.json")
        points, quads = torus(90, 40)
        mesh = self.write("large.obj", obj_text(points, triangles_of(quads)))
        started = time.time()
        self.run_tool("solve", mesh, "--report", report, "--image", self.path("i.png"))
        whole = time.time() - started
        found = json.loads(self.read("r.json"))
        # The picture takes most of the time.
        self.assertGreater(found["total_seconds"], 0.7 * whole - 0.1)
        self.assertLessEqual(found["total_seconds"], whole)
        self.assertTrue(0 < found["cpu_seconds"] <= 2 * whole)
        self.assertEqual("hmf %s\n" % found["version"], self.run_tool("--version").stdout)
        self.assertEqual((found["input"], found["exit_status"], found["errors"]), (mesh, 0, []))
        self.assertNotIn("dilatation_mean", found)
        self.assertEqual(found["singularities"], [])
        self.assertEqual(found["options"], {
            "loops": "cut", "through": None, "weights": [1], "marks": "auto", "start": None, "method": "newton", "collapse": "midpoint", "ratio": 0.5, "coarsest": 1000, "mollify": None,
            "tolerance": 1e-8, "time-limit": None, "threads": found["threads"], "report": report, "conformality": False, "image": self.path("i.png"), "pattern": "stripes", "camera": "auto", "image-size": "1400x1050", "legend": False, "period": found["options"]["period"],
            "spacing": None, "conjugate": False, "size": None, "repair": False, "join-points": False})
        # What it says are the defaults gives the same bits.
        self.run_tool("solve", mesh, "--values", self.path("a.csv"))
        self.run_tool("solve", mesh, "--values", self.path("b.csv"), "--loops", "cut", "--weights", "1", "--method", "newton", "--collapse", "midpoint",
                      "--ratio", "0.5", "--coarsest", "1000", "--tolerance", "1e-8")
        self.assertEqual(self.read("a.csv"), self.read("b.csv"))
        self.run_tool("solve", mesh, "--report", report, "--conformality")
        found = json.loads(self.read("r.json"))
        self.assertLessEqual({"dilatation_mean", "dilatation_median", "dilatation_p99", "flipped_triangles", "degenerate_triangles", "seam_edges",
                              "seam_length", "parameterize_seconds"}, set(found))
        self.run_tool("solve", mesh, "--report", report, "--method", "whitehead")
        found = json.loads(self.read("r.json"))["options"]
        self.assertEqual((found["method"], found["tolerance"]), ("whitehead", 1e-6))

    def test_converged_is_small_residual(self):
        """Whatever a method measures on the way; the exit status says whether it came to its own end."""
        seen = set()
        for words in (["newton"], ["newton", "--tolerance", "1e-3"], ["whitehead"], ["whitehead", "--tolerance", "0.1"], ["single-level"],
                      ["single-level", "--tolerance", "1e-3"]):
            self.run_tool("solve", self.mesh, "--report", self.path("r.json"), "--method", *words)
            found = json.loads(self.read("r.json"))
            largest = found["options"]["tolerance"] if words[0] == "newton" else 1e-8
            self.assertIs(found["converged"], found["residual_max"] <= largest, words)
            self.assertEqual((found["exit_status"], found["class"]), (0, "proven"), words)
            seen.add((words[0], found["converged"]))
        self.assertLessEqual({("newton", True), ("whitehead", False), ("single-level", False)}, seen)

    def test_class(self):
        """From loops, and from values that a solve has written."""
        values, report = self.path("v.csv"), self.path("r.json")
        folder = self.path("demo")
        self.run_tool("demo", folder)
        with open(os.path.join(folder, "report.json")) as f:
            self.assertEqual(json.load(f)["class"], "proven")
        sample = os.path.join(folder, "sample.obj")
        for method in ("newton", "whitehead"):
            done = self.run_tool("solve", sample, "--loops", "pants", "--weights", "3,1,2,1,1,5", "--method", method, "--values", values, "--report", report)
            self.assertIn("class proven", done.stdout)
            self.assertEqual(json.loads(self.read("r.json"))["class"], "proven")
        self.run_tool("solve", sample, "--start", values, "--report", report)
        self.assertEqual(json.loads(self.read("r.json"))["class"], "proven")

    def test_failed_output(self):
        """An output that cannot be made does not take the others with it."""
        out = {name: self.path(name) for name in ("q.obj", "i.png", "r.json", "v.csv", "l.obj", "l.txt")}
        done = self.refused(3, "solve", self.mesh, "--quads", out["q.obj"], "--size", "1e-9", "--image", out["i.png"], "--report", out["r.json"],
                            "--values", out["v.csv"], "--leaves", out["l.obj"], "--save-loops", out["l.txt"], says=["--quads", "--size"])
        self.assertEqual(len(done.stderr.splitlines()), 1)
        for name in out:
            self.assertEqual(os.path.exists(out[name]), name != "q.obj", name)
        found = json.loads(self.read("r.json"))
        self.assertEqual(found["exit_status"], 3)
        self.assertEqual(["hmf: " + error for error in found["errors"]], done.stderr.splitlines())
        self.assertGreater(found["leaves"], 0)

    def test_save_loops(self):
        points, quads = torus(90, 40)
        mesh = self.write("large.obj", obj_text(points, triangles_of(quads)))
        loops, again, report = self.path("loops.txt"), self.path("again.txt"), self.path("r.json")
        for kind in ("cut", "handle", "tunnel", "pants"):
            energies = []
            for name, out in ((kind, loops), (loops, again)):
                self.run_tool("solve", mesh, "--loops", name, "--weights", "2", "--coarsest", "100", "--save-loops", out, "--report", report)
                energies.append(json.loads(self.read("r.json"))["energy"])
            self.assertAlmostEqual(energies[0] / energies[1], 1, 9)
            self.assertEqual(self.read("loops.txt"), self.read("again.txt"))
            head, line = self.read("loops.txt").decode().splitlines()
            self.assertEqual(head, "# --weights 2")
            self.assertTrue(line.startswith("t: "))
            triangles = [set(triangles_of(quads)[int(t)]) for t in line[3:].split()]
            for t, u in zip(triangles, triangles[1:] + triangles[:1]):
                self.assertEqual(len(t & u), 2)
        mine = self.write("mine.txt", ",".join(str(j) for j in range(40)))
        self.run_tool("solve", mesh, "--loops", mine, "--save-loops", loops)
        self.assertEqual(self.read("loops.txt").decode(), "# --weights 1\nv: " + " ".join(str(j) for j in range(40)) + "\n")
        self.refused(2, "solve", mesh, "--loops", mine, "--save-loops", mine, says=["input"])

    def pipe(self, content, *arguments, status=0):
        done = subprocess.run([TOOL, *arguments], input=content, stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=300)
        self.assertEqual(done.returncode, status, done.stderr.decode())
        return done

    def test_pipes(self):
        mesh = self.read("torus.obj")
        self.run_tool("solve", self.mesh, "--values", self.path("v.csv"), "--history", self.path("h.csv"), "--image", self.path("i.png"),
                      "--leaves", self.path("l.obj"), "--quads", self.path("q.obj"), "--save-loops", self.path("loops.txt"))
        done = self.pipe(mesh, "solve", "-", "--values", "-")
        self.assertEqual(done.stdout, self.read("v.csv"))
        self.assertIn(b"standard input: genus 1", done.stderr)
        for option, name in (("--image", "i.png"), ("--leaves", "l.obj"), ("--quads", "q.obj"), ("--save-loops", "loops.txt")):
            self.assertEqual(self.pipe(mesh, "solve", "-", option, "-").stdout, self.read(name), option)
        found = json.loads(self.pipe(mesh, "solve", "-", "--report=-").stdout)
        self.assertEqual((found["input"], found["mesh"]["genus"]), ("-", 1))
        self.assertTrue(self.pipe(mesh, "solve", "-", "--history", "-").stdout.startswith(b"seconds,"))
        self.assertIn(b"genus 1", self.pipe(mesh, "info", "-").stdout)
        self.assertIn(b"genus 1", self.pipe(mesh, "solve", "-").stdout)
        self.pipe(self.read("loops.txt"), "solve", self.mesh, "--loops", "-")
        self.pipe(self.read("v.csv"), "solve", self.mesh, "--start", "-")
        self.assertIn(b"standard input", self.pipe(b"v 0 0 x\nf 1 2 3\n", "info", "-", status=3).stderr)
        self.assertIn(b"two options", self.pipe(mesh, "solve", "-", "--values", "-", "--report", "-", status=2).stderr)
        self.assertIn(b"once", self.pipe(mesh, "solve", "-", "--loops", "-", status=2).stderr)
        self.assertIn(b"--obj", self.pipe(mesh, "solve", "-", "--obj", "-", status=2).stderr)

    def test_texture(self):
        obj, image = self.path("t.obj"), self.path("i.png")
        self.run_tool("solve", self.mesh, "--obj", obj, "--image", image, "--pattern", "checkerboard", "--report", self.path("r.json"))
        self.assertEqual(self.read("i.png")[:8], b"\x89PNG\r\n\x1a\n")
        tile = pixels_of(self.read("t.png"))
        red, white = (190, 40, 48), (246, 243, 236)
        self.assertEqual((len(tile), len(tile[0])), (256, 256))
        for y, row in enumerate(tile):
            for x, color in enumerate(row):
                square = red if (64 <= x < 192) != (64 <= y < 192) else white
                line = x % 64 in (0, 63) or y % 64 in (0, 63)
                self.assertEqual(color, tuple(c * 3 // 4 for c in square) if line else square)
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
                     says=["--method newton"])
        self.assertTrue(os.path.exists(self.path("u.csv")))

    def test_atlas(self):
        """Every corner in the unit square, together with the area that the report tells."""
        self.run_tool("solve", self.mesh, "--atlas", self.path("a.obj"), "--report", self.path("a.json"))
        lines = [line.split() for line in self.read("a.obj").decode().splitlines()]
        vt = [tuple(map(float, line[1:])) for line in lines if line[0] == "vt"]
        faces = [[vt[int(corner.split("/")[1]) - 1] for corner in line[1:]] for line in lines if line[0] == "f"]
        self.assertEqual(len(faces), len(self.triangles))
        self.assertTrue(all(0 <= x <= 1 for place in vt for x in place))
        area = sum((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) for a, b, c in faces) / 2
        report = json.loads(self.read("a.json"))
        self.assertAlmostEqual(area, report["atlas_used_area"], 6)
        self.assertEqual(report["options"]["loops"], "even")
        self.run_tool("solve", self.mesh, "--atlas", self.path("a.glb"), "--loops", "cut")
        self.assertEqual(self.read("a.glb")[:4], b"glTF")
        self.refused(2, "solve", self.mesh, "--atlas", self.path("a.ply"), says=[".glb"])

    def test_textured(self):
        """One file with (u, v): read again it is the same mesh; every triangle has the (u, v) of --obj."""
        obj, glb, ply = self.path("t.obj"), self.path("t.glb"), self.path("t.ply")
        self.run_tool("solve", self.mesh, "--obj", obj)
        lines = [line.split() for line in self.read("t.obj").decode().splitlines()]
        vt = [tuple(map(float, line[1:])) for line in lines if line[0] == "vt"]
        wanted = [vt[int(corner.split("/")[1]) - 1] for line in lines if line[0] == "f" for corner in line[1:]]
        for path in (glb, ply):
            self.run_tool("solve", self.mesh, "--textured", path)
        head, body = self.read("t.ply").split(b"end_header\n")
        count = int(head.split(b"element vertex ")[1].split()[0])
        self.assertGreater(count, len(self.points))
        vertices = list(struct.iter_unpack("<5d", body[:40 * count]))
        faces = list(struct.iter_unpack("<BIII", body[40 * count:]))
        self.assertEqual(len(faces), len(self.triangles))
        for (three, *corners), triangle in zip(faces, self.triangles):
            self.assertEqual(three, 3)
            for corner, v in zip(corners, triangle):
                self.assertEqual(vertices[corner][:3], self.points[v])
        found = [vertices[c][3:] for _, *corners in faces for c in corners]
        for a, b in zip(found, wanted):
            self.assertAlmostEqual(a[0], b[0], 6)
            self.assertAlmostEqual(a[1], b[1], 6)
        glb_bytes = self.read("t.glb")
        magic, version, length, size, kind = struct.unpack("<4sIII4s", glb_bytes[:20])
        self.assertEqual((magic, version, length, kind), (b"glTF", 2, len(glb_bytes), b"JSON"))
        gltf, binary = json.loads(glb_bytes[20:20 + size]), glb_bytes[28 + size:]
        def values(number, form):
            view = gltf["bufferViews"][gltf["accessors"][number]["bufferView"]]
            part = binary[view["byteOffset"]:view["byteOffset"] + view["byteLength"]]
            self.assertEqual(len(part), gltf["accessors"][number]["count"] * struct.calcsize("<" + form))
            return list(struct.iter_unpack("<" + form, part))
        uv, order = values(1, "2f"), values(2, "I")
        for (k,), (u, v) in zip(order, wanted):
            self.assertAlmostEqual(uv[k][0], u, 4)
            self.assertAlmostEqual(1 - uv[k][1], v, 4)
        image = gltf["bufferViews"][gltf["images"][0]["bufferView"]]
        self.assertEqual(len(pixels_of(binary[image["byteOffset"]:image["byteOffset"] + image["byteLength"]])), 256)
        self.assertEqual(json.loads(self.run_tool("info", glb, "--json").stdout)["genus"], 1)
        self.assertEqual(json.loads(self.run_tool("info", ply, "--json", "--repair", "--join-points").stdout)["genus"], 1)
        self.refused(2, "solve", self.mesh, "--textured", self.path("t.stl"), says=[".glb"])

    def test_pictures(self):
        """Size, camera, legend and every pattern; what has no effect is refused."""
        def picture(*options):
            self.run_tool("solve", self.mesh, "--image", self.path("i.png"), "--image-size", "160x120", *options)
            return pixels_of(self.read("i.png"))
        def share(pixels, colour):
            return sum(colour(*p) for row in pixels for p in row) / (len(pixels) * len(pixels[0]))
        is_red = lambda r, g, b: r > 2 * g and r > 2 * b
        is_object = lambda r, g, b: max(r, g, b) - min(r, g, b) > 12 or max(r, g, b) < 120
        pictures = {}
        for pattern in ("stripes", "checkerboard", "quads", "dilatation"):
            pictures[pattern] = picture("--pattern", pattern)
            self.assertEqual((len(pictures[pattern]), len(pictures[pattern][0])), (120, 160))
        for pattern in ("stripes", "checkerboard"):
            self.assertGreater(share(pictures[pattern], is_red), 0.05)
        self.assertEqual(share(pictures["quads"], is_red), 0)
        self.assertEqual(len({str(p) for p in pictures.values()}), 4)
        # Round the z axis: from the top (z) there is a hole in the middle, from the front it is flat.
        top, side = picture("--camera", "0,0,1"), picture("--camera", "0,-1,0,0,0,1")
        self.assertFalse(is_object(*top[60][80]))
        self.assertTrue(is_object(*side[60][80]))
        rows = lambda pixels: sum(any(is_object(*p) for p in row) for row in pixels)
        self.assertGreater(rows(top), 1.8 * rows(side))
        self.assertEqual(picture("--camera", "front"), top)
        # A finer period, more stripes: more changes along a row through the tube.
        changes = lambda pixels: sum(is_red(*a) != is_red(*b) for row in pixels for a, b in zip(row, row[1:]))
        self.assertGreater(changes(picture("--camera", "front", "--period", "0.05")), 1.5 * changes(picture("--camera", "front", "--period", "0.2")))
        legend = picture("--camera", "front", "--legend")
        self.assertNotEqual(legend, top)
        for wrong in (("--camera", "up"), ("--camera", "1,2"), ("--camera", "0,0,0"), ("--camera", "1,0,0,2,0,0"), ("--image-size", "10x"), ("--image-size", "1x9"),
                      ("--period", "0"), ("--pattern", "quads", "--period", "1"), ("--size", "1")):
            self.refused(2, "solve", self.mesh, "--image", self.path("i.png"), *wrong, says=[wrong[-2]])
        for option in (("--camera", "top"), ("--image-size", "160x120"), ("--legend",)):
            self.refused(2, "solve", self.mesh, *option, says=["--image"])

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
        # Without --loops the class, and so the weights, are those of the values.
        self.refused(2, "solve", self.mesh, "--start", first, "--weights", "2", says=["--weights", "no effect"])
        self.refused(2, "solve", self.mesh, "--start", first, "--save-loops", self.path("l.txt"), says=["--save-loops"])
        self.run_tool("solve", self.mesh, "--weights", "3", "--values", first)
        self.run_tool("solve", self.mesh, "--start", first, "--leaves", self.path("l.obj"), "--report", report)
        found = json.loads(self.read("r.json"))
        self.assertEqual([(c["loop"], c["height"]) for c in found["cylinders"]], [(None, 3)])
        self.assertEqual(found["options"]["weights"], [3])
        self.assertEqual((found["options"]["loops"], found["options"]["start"]), (None, first))

    def test_start_from_npy(self):
        binary = self.path("v.npy")
        self.run_tool("solve", self.mesh, "--values", binary, "--values", self.path("v.csv"), "--method", "whitehead")
        for name in ("v.npy", "v.csv"):
            self.run_tool("solve", self.mesh, "--start", self.path(name), "--values", self.path("from_" + name + ".csv"))
        self.assertEqual(self.read("from_v.npy.csv"), self.read("from_v.csv.csv"))
        content = self.read("v.npy")
        for bad, says in ((content[:-8], "not one row"), (content + b"x", "not one row"), (content[:40], "ends in its header"), (content[:7], "ends in its header"),
                          (content.replace(b"<f8", b"<f4"), "not one row"), (content.replace(b",), }", b",1)}"), "not one row")):
            self.refused(3, "solve", self.mesh, "--start", self.write("bad.npy", bad), says=["bad.npy", says, "--values"])

    def test_mollify(self):
        points = list(self.points)
        a, b, c = self.triangles[0]
        points[a] = tuple((p + q) / 2 for p, q in zip(points[b], points[c]))
        mesh = self.write("flat.obj", obj_text(points, self.triangles))
        self.refused(3, "solve", mesh, says=["no area", "--mollify 1e-5"])
        self.run_tool("solve", mesh, "--mollify", "1e-5")
        self.refused(2, "solve", mesh, "--mollify", "0.5", says=["--mollify", "[0, 0.1]"])

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

    def test_through(self):
        """Loops drawn by picked vertices or places: the shortest way along edges from each to the next."""
        saved, report = self.path("saved.txt"), self.path("r.json")

        def drawn(picked, *options):
            self.run_tool("solve", self.mesh, "--through", picked, "--save-loops", saved, "--report", report, *options)
            head, *lines = self.read("saved.txt").decode().splitlines()
            return [list(map(int, line[3:].split())) for line in lines], json.loads(self.read("r.json"))

        # Round the tube: vertices 0 to 15.
        (loop,), found = drawn("0 5 10")
        self.assertEqual(loop, list(range(16)))
        self.assertEqual((found["class"], found["options"]["through"], found["options"]["loops"]), ("proven", "0 5 10", None))
        self.run_tool("solve", self.mesh, "--loops", self.write("loops.txt", " ".join(map(str, range(16)))), "--report", report)
        self.assertEqual(json.loads(self.read("r.json"))["energy"], found["energy"])
        places = " ".join(",".join("%.3f" % (x + 0.004) for x in self.points[v]) for v in (0, 5, 10, 0))
        self.assertEqual(drawn(places)[0], [loop])
        # Round the hole; each way is as short as any other, found by relaxing every edge.
        picked = [16 * i for i in range(0, 24, 6)]
        (loop,), _ = drawn(" ".join(map(str, picked)))
        sides = {(a, b) for t in self.triangles for a, b in ((t[0], t[1]), (t[1], t[2]), (t[2], t[0]))}
        sides |= {(b, a) for a, b in sides}
        self.assertTrue(set(zip(loop, loop[1:] + loop[:1])) <= sides)
        size = lambda a, b: math.dist(self.points[a], self.points[b])
        least = 0
        for a, b in zip(picked, picked[1:] + picked[:1]):
            distance = dict.fromkeys(range(len(self.points)), math.inf)
            distance[a] = 0
            changed = True
            while changed:
                changed = False
                for u, v in sides:
                    if distance[u] + size(u, v) < distance[v]:
                        distance[v], changed = distance[u] + size(u, v), True
            least += distance[b]
        self.assertAlmostEqual(sum(map(size, loop, loop[1:] + loop[:1])), least, 12)
        # Two components, a loop on each.
        scene = self.write("scene.obj", obj_text(*beside((self.points, self.triangles), (self.points, self.triangles))))
        n = len(self.points)
        done = self.run_tool("solve", scene, "--through", "0 5 10; %d %d %d" % (n, n + 5, n + 10))
        self.assertIn("2 components, 2 solved", done.stdout)
        self.refused(2, "solve", scene, "--through", "0 5 %d" % n, says=["--through: loop 1", "one component"])
        for picked, says in (("", "nothing is picked"), (" ; ", "loop 1 has 0"), ("0 5", "loop 1 has 2 picked vertices"), ("0 0 5 0", "loop 1 has 2"),
                             ("0 5 x", "\"x\""), ("0 5 -1", "\"-1\""), ("0 5 99999", "vertex 99999 does not exist"), ("0 5 1,2", "no place"), ("0 5 1,2,nan", "no place"),
                             ("0 5 1,2,3,4", "no place"), ("0 5 10;0 1", "loop 2 has 2")):
            self.refused(2, "solve", self.mesh, "--through", picked, says=["--through", says])
        self.refused(3, "solve", self.mesh, "--through", "0 1 2", says=["--through, loop 1", "goes back the way it came"])
        self.refused(2, "solve", self.mesh, "--through", "0 5 10", "--loops", "cut", says=["--through", "--loops"])
        self.refused(2, "solve", self.mesh, "--through", "0 5 10", "--weights", "1,2", says=["2 weights for 1 loops"])

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
        found = json.loads(self.read("r.json").decode())
        self.assertIs(found["converged"], False)
        self.assertEqual((found["exit_status"], found["class"]), (4, "proven"))
        done = self.run_tool("solve", mesh, "--method", "single-level", "--tolerance", "1e-15", "--time-limit", "0.02", status=4)
        self.assertNotIn("written", done.stderr)
        self.assertIn("best foliation", done.stderr)

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

    def test_places_of_zeros(self):
        folder = self.path("demo")
        self.run_tool("demo", folder)
        with open(os.path.join(folder, "report.json")) as f:
            found = json.load(f)
        self.assertEqual(sum(s["index"] for s in found["singularities"]), found["index_sum"])
        with open(os.path.join(folder, "sample.obj")) as f:
            points = [tuple(map(float, line.split()[1:])) for line in f if line[0] == "v"]
        for s in found["singularities"]:
            self.assertIn(s["kind"], ("vertex", "triangle", "cluster"))
            if s["kind"] == "vertex":
                self.assertEqual(tuple(s["position"]), points[s["element"]])

    def test_refusals(self):
        for option in ("--spacing", "--size"):
            self.run_tool("solve", self.mesh, option, "0", status=2)
        self.run_tool("solve", self.mesh, "--leaves", self.path("l.txt"), status=2)
        self.run_tool("solve", self.mesh, "--leaves", self.path("x.obj"), "--quads", self.path("x.obj"), status=2)


class Batch(Case):
    def setUp(self):
        super().setUp()
        os.mkdir(self.path("meshes"))
        points, triangles = tetrahedron()
        self.write("meshes/a.obj", obj_text(self.points, self.triangles))
        self.write("meshes/b.OFF", "OFF\nx")
        self.write("meshes/c.obj", obj_text(points, triangles))
        self.write("meshes/d.obj", obj_text(self.points, self.quads))
        self.write("meshes/notes.txt", "no mesh")
        self.names = [self.path("meshes/" + n) for n in ("a.obj", "b.OFF", "c.obj", "d.obj")]
        self.out = self.path("out.ndjson")

    def lines(self):
        return sorted(map(json.loads, self.read("out.ndjson").decode().splitlines()), key=lambda r: r["input"])

    def test_batch(self):
        for jobs in ("1", "3"):
            if os.path.exists(self.out):
                os.remove(self.out)
            done = self.run_tool("batch", self.path("meshes"), "--jobs", jobs, "--out", self.out, "--loops", "tunnel", "--conformality")
            self.assertEqual(len(done.stdout.splitlines()), 4)
            rows = self.lines()
            self.assertEqual([r["input"] for r in rows], self.names)
            self.assertEqual([r["exit_status"] for r in rows], [0, 3, 3, 0])
            self.assertEqual([r["class"] for r in rows], ["proven", "none", "none", "proven"])
            self.assertIn("genus 0", rows[2]["errors"][0])
            self.assertIn("dilatation_mean", rows[0])
            self.assertEqual(rows[0]["options"]["loops"], "tunnel")
        self.run_tool("solve", self.names[0], "--loops", "tunnel", "--conformality", "--report", self.path("r.json"))
        single = json.loads(self.read("r.json"))
        self.assertEqual(set(rows[0]), set(single))
        self.assertEqual(rows[0]["energy"], single["energy"])

    def test_spheres(self):
        self.run_tool("batch", self.path("meshes"), "--out", self.out)
        self.assertEqual([(r["exit_status"], r["class"]) for r in self.lines()], [(0, "proven"), (3, "none"), (0, "checked"), (0, "proven")])
        self.assertEqual(self.lines()[2]["mesh"]["marked"], 4)
        os.remove(self.out)
        self.run_tool("batch", self.path("meshes"), "--out", self.out, "--marks", "none")
        self.assertEqual([r["exit_status"] for r in self.lines()], [0, 3, 3, 0])
        self.refused(2, "batch", self.path("meshes"), "--out", self.out, "--save-marks", "m.txt", says=["--save-marks"])

    def test_resumes(self):
        self.run_tool("batch", self.path("meshes"), "--out", self.out)
        whole = self.read("out.ndjson").splitlines(keepends=True)
        # As after a crash: the last line is cut off, and one is missing.
        self.write("out.ndjson", whole[0] + whole[1] + whole[2][:50])
        done = self.run_tool("batch", self.path("meshes"), "--out", self.out)
        self.assertEqual(len(done.stdout.splitlines()), 2)
        self.assertEqual(self.read("out.ndjson")[:len(whole[0] + whole[1])], whole[0] + whole[1])
        self.assertEqual([r["input"] for r in self.lines()], self.names)
        self.assertEqual(self.run_tool("batch", self.path("meshes"), "--out", self.out).stdout, "")

    def test_refusals(self):
        self.refused(2, "batch", self.path("meshes"), says=["--out"])
        self.refused(2, "batch", self.path("meshes"), "--out", self.out, "--jobs", "0", says=["--jobs"])
        self.refused(2, "batch", self.path("meshes"), "--out", self.out, "--image", "i.png", says=["--image"])
        self.refused(2, "batch", self.path("meshes"), "--out", self.out, "--spacing", "1", says=["--spacing"])
        self.refused(5, "batch", self.path("none"), "--out", self.out, says=["none"])
        self.refused(3, "batch", self.folder.name + "/meshes", "--out", self.write("other.ndjson", "hello\n"), says=["other.ndjson:1:"])
        self.assertEqual(self.read("other.ndjson"), b"hello\n")

    def test_interrupt(self):
        points, quads = torus(240, 150)
        text = obj_text(points, triangles_of(quads))
        for n in range(3):
            self.write("meshes/large%d.obj" % n, text)
        tool = subprocess.Popen([TOOL, "batch", self.path("meshes"), "--out", self.out, "--method", "single-level", "--tolerance", "1e-15"],
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True)
        time.sleep(1.5)
        os.killpg(tool.pid, signal.SIGINT)
        _, errors = tool.communicate(timeout=60)
        self.assertEqual(tool.returncode, 4, errors.decode())
        self.assertNotIn("large2", self.read("out.ndjson").decode())
        for row in self.lines():
            self.assertIn(row["exit_status"], (0, 3))


def moved(points, shift):
    return [(x + shift, y, z) for x, y, z in points]


def beside(*meshes):
    """Meshes as one, each 9 to the right of the one before; triangles take turns."""
    points, lists = [], []
    for k, (own, triangles) in enumerate(meshes):
        n = len(points)
        points += moved(own, 9 * k)
        lists.append([tuple(i + n for i in t) for t in triangles])
    faces = []
    while any(lists):
        for rest in lists:
            if rest:
                faces.append(rest.pop(0))
    return points, faces


class Components(Case):
    """Several shells in one file: a small torus, a sphere, a larger torus."""

    def setUp(self):
        super().setUp()
        points, quads = torus(30, 22)
        self.large = (points, triangles_of(quads))
        self.small = (self.points, self.triangles)
        self.parts = [self.small, tetrahedron(), self.large]
        self.all_points, self.all_triangles = beside(*self.parts)
        self.scene = self.write("scene.obj", obj_text(self.all_points, self.all_triangles))
        n = len(self.points)
        self.first = [0, n, n + 4]  # vertices

    def values(self, name):
        with open(self.path(name)) as f:
            return {frozenset((int(a), int(b))): float(x) for a, b, x in csv.reader(f)}

    def alone(self, k, *arguments):
        """A component on its own, where it lies in the scene."""
        points, triangles = self.parts[k]
        mesh = self.write("alone%d.obj" % k, obj_text(moved(points, 9 * k), triangles))
        self.run_tool("solve", mesh, "--values", self.path("alone.csv"), "--report", self.path("alone.json"), *arguments)
        found = {frozenset(v + self.first[k] for v in edge): x for edge, x in self.values("alone.csv").items()}
        return found, json.loads(self.read("alone.json"))

    def test_each_as_on_its_own(self):
        done = self.run_tool("solve", self.scene, "--marks", "none", "--values", self.path("v.csv"), "--values", self.path("v.npy"),
                             "--report", self.path("r.json"), "--history", self.path("h.csv"), "--conformality")
        self.assertIn("3 components, 2 solved, genus 2", done.stdout)
        self.assertEqual(len(done.stdout.splitlines()), 1)
        self.assertIn("component 1 (4 triangles, first 1): the mesh has genus 0", done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1)
        values, report = self.values("v.csv"), json.loads(self.read("r.json"))
        self.assertEqual((report["exit_status"], report["errors"], len(report["components"])), (0, [], 3))
        expected, energy = {}, 0
        for k in (0, 2):
            own, found = self.alone(k, "--conformality")
            expected.update(own)
            energy += found["energy"]
            part = report["components"][k]
            for key in ("energy", "residual_max", "zeros", "poles", "loops", "method", "converged", "class", "class_repeats", "dilatation_mean", "index_sum"):
                self.assertEqual(part[key], found[key], key)
            self.assertEqual(dict(found["mesh"], components=None), dict(part["mesh"], components=None))
            self.assertEqual([l["edges"] for l in part["levels"]], [l["edges"] for l in found["levels"]])
        sphere = {frozenset(v + self.first[1] for v in e): 0 for t in tetrahedron()[1] for e in ((t[0], t[1]), (t[1], t[2]), (t[2], t[0]))}
        self.assertEqual(values, {**expected, **sphere})
        self.assertEqual(report["energy"], energy)
        self.assertEqual(report["mesh"], {"vertices": len(self.all_points), "edges": len(values), "triangles": len(self.all_triangles), "genus": 2,
                                          "marked": 0, "components": 3, "boundaries": 0})
        self.assertEqual((report["loops"], report["poles"], report["index_sum"], report["converged"], report["class"]), (2, 0, 0, True, "proven"))
        none = report["components"][1]
        self.assertEqual((none["class"], none["status"], none["mesh"]["genus"], none["mesh"]["vertices"]), ("none", 311, 0, 4))
        # Edges in the order in which the triangles name them.
        order, seen = [], set()
        for t in self.all_triangles:
            for e in ((t[0], t[1]), (t[1], t[2]), (t[2], t[0])):
                if frozenset(e) not in seen:
                    seen.add(frozenset(e))
                    order.append(e)
        rows = [line.split(",") for line in self.read("v.csv").decode().splitlines()]
        self.assertEqual([(int(a), int(b)) for a, b, _ in rows], order)
        npy = self.read("v.npy")
        self.assertEqual(list(struct.unpack("<%dd" % len(rows), npy[-8 * len(rows):])), [float(x) for _, _, x in rows])
        history = self.read("h.csv").decode().splitlines()
        self.assertTrue(history[0].endswith(",component"))
        self.assertEqual({line.split(",")[-1] for line in history[1:]}, {"0", "2"})
        # From its own values: the same class, and the sphere stays without.
        done = self.run_tool("solve", self.scene, "--start", self.path("v.csv"), "--report", self.path("r.json"), "--leaves", self.path("l.obj"))
        self.assertAlmostEqual(json.loads(self.read("r.json"))["energy"] / energy, 1, 9)

    def test_pictures_and_lines(self):
        out = {name: self.path(name) for name in ("t.obj", "i.png", "l.obj", "q.obj", "r.json", "loops.txt")}
        none = ("--marks", "none")
        self.run_tool("solve", self.scene, *none, "--obj", out["t.obj"], "--image", out["i.png"], "--leaves", out["l.obj"], "--conjugate", "--quads", out["q.obj"],
                      "--report", out["r.json"], "--save-loops", out["loops.txt"], "--weights", "1,2")
        report = json.loads(self.read("r.json"))
        lines = self.read("t.obj").decode().splitlines()
        self.assertEqual([tuple(int(c.split("/")[0]) - 1 for c in line.split()[1:]) for line in lines if line.startswith("f ")], self.all_triangles)
        # The sphere is grey, the rest is not.
        grey = sum(max(p) - min(p) < 6 and 100 < p[0] < 200 for row in pixels_of(self.read("i.png")) for p in row)
        self.assertGreater(grey, 100)
        groups = {line.split()[1] for line in self.read("l.obj").decode().splitlines() if line.startswith("g ")}
        self.assertEqual(groups, {"cylinder_0", "cylinder_1", "across_0", "across_1"})
        self.assertEqual(report["leaves"], sum(line.startswith("l ") for line in self.read("l.obj").decode().splitlines()))
        self.assertEqual([[c["height"] for c in report["components"][k]["cylinders"]] for k in (0, 2)], [[1], [2]])
        quads = json.loads(self.run_tool("info", out["q.obj"], "--json").stdout)
        self.assertEqual((quads["genus"], len(quads["components"])), (2, 2))
        head, *loops = self.read("loops.txt").decode().splitlines()
        self.assertEqual((head, len(loops)), ("# --weights 1,2", 2))
        # The saved loops give the same again, in any order.
        for text, weights in ((loops, "1,2"), (loops[::-1], "2,1")):
            self.run_tool("solve", self.scene, *none, "--loops", self.write("again.txt", "\n".join(text)), "--weights", weights, "--report", out["r.json"])
            again = json.loads(self.read("r.json"))
            self.assertAlmostEqual(again["energy"] / report["energy"], 1, 9)
            self.assertEqual(again["components"][1]["class"], "none")
        # Only one component has a loop; a loop on two; too few weights.
        done = self.run_tool("solve", self.scene, "--loops", self.write("one.txt", loops[1]), "--report", out["r.json"])
        self.assertIn("component 0", done.stderr)
        self.assertIn("no loop lies on it", done.stderr)
        self.assertEqual([c["class"] for c in json.loads(self.read("r.json"))["components"]], ["none", "none", "proven"])
        self.refused(3, "solve", self.scene, "--loops", self.write("two.txt", "\n0 1 %d" % self.first[2]), says=["two.txt:2:", "several components"])
        self.refused(2, "solve", self.scene, *none, "--weights", "1", says=["1 weights for 2 loops"])

    def test_marks(self):
        """Each sphere gets marks of its own; those of a file go to the component they lie on."""
        ball = box(12, 3, 3)
        self.parts[1] = ball
        points, triangles = beside(*self.parts)
        scene, saved = self.write("scene.obj", obj_text(points, triangles)), self.path("saved.txt")
        done = self.run_tool("solve", scene, "--save-marks", saved, "--values", self.path("v.csv"), "--report", self.path("r.json"), "--image", self.path("i.png"))
        self.assertIn("3 components, 3 solved, genus 2", done.stdout)
        self.assertIn("class checked", done.stdout)
        report = json.loads(self.read("r.json"))
        self.assertEqual([c["class"] for c in report["components"]], ["proven", "checked", "proven"])
        for count in (report["mesh"]["triangles"], report["mesh"]["marked"], report["zeros"], report["class_repeats"], report["levels"][0]["edges"]):
            self.assertIsInstance(count, int)
        own, found = self.alone(1, "--save-marks", self.path("own.txt"))
        marked = found["mesh"]["marked"]
        self.assertEqual((report["class"], report["converged"], report["mesh"]["marked"], report["index_sum"]), ("checked", True, marked, 4 - marked))
        self.assertIn("marked %d vertices, two at each of %d tips" % (marked, marked // 2), done.stdout)
        values = self.values("v.csv")
        self.assertEqual({e: values[e] for e in own}, own)
        marks = [int(line) for line in self.read("saved.txt").decode().splitlines()[1:]]
        self.assertEqual(marks, [int(line) + self.first[1] for line in self.read("own.txt").decode().splitlines()[1:]])
        self.assertEqual(json.loads(self.run_tool("info", scene, "--json").stdout)["suggested_marks"], marks)
        self.run_tool("solve", scene, "--marks", saved, "--report", self.path("again.json"))
        again = json.loads(self.read("again.json"))
        self.assertAlmostEqual(again["energy"] / report["energy"], 1, 9)
        self.assertEqual([c["mesh"]["marked"] for c in again["components"]], [0, marked, 0])
        # Without a mark on the sphere it has no foliation.
        done = self.run_tool("solve", scene, "--marks", self.write("one.txt", "5"), "--report", self.path("again.json"))
        self.assertIn("genus 0", done.stderr)
        self.assertIn("--marks auto", done.stderr)
        again = json.loads(self.read("again.json"))
        self.assertEqual([c["class"] for c in again["components"]], ["checked", "none", "proven"])
        # A sphere of three vertices.
        mesh = self.write("pillow.obj", obj_text(*beside(self.small, (points[:3], [(0, 1, 2), (0, 2, 1)]))))
        done = self.run_tool("solve", mesh)
        self.assertIn("genus 0; there are too few vertices to mark", done.stderr)
        # Handles are not looked for on a sphere.
        done = self.run_tool("solve", scene, "--loops", "handle", "--report", self.path("again.json"))
        self.assertIn("no handles", done.stderr)
        self.assertEqual([c["class"] for c in json.loads(self.read("again.json"))["components"]], ["proven", "none", "proven"])

    def test_none(self):
        sheet = ([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)], [(0, 1, 2), (2, 1, 3)])
        points, triangles = beside(tetrahedron(), sheet)
        mesh = self.write("none.obj", obj_text(points, triangles))
        done = self.refused(3, "solve", mesh, "--marks", "none", says=["none of 2 components", "component 0", "genus 0", "component 1"])
        self.assertEqual(len(done.stderr.splitlines()), 1)
        self.assertIn("boundaries     1", self.run_tool("info", mesh).stdout)
        points, triangles = beside(([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]), ([(0, 0, 1), (1, 0, 1), (0, 1, 1)], [(0, 1, 2)]))
        mesh = self.write("open.obj", obj_text(points, triangles))
        self.refused(3, "solve", mesh, says=["none of 2 components", "component 1", "--repair --join-points"])
        self.refused(3, "info", mesh, says=["component 0", "boundaries     2"])

    def test_boundary(self):
        points, triangles = beside(self.small, (self.points, self.triangles[1:]))
        mesh = self.write("open.obj", obj_text(points, triangles))
        self.run_tool("solve", mesh, "--report", self.path("r.json"), "--save-loops", self.path("loops.txt"), "--values", self.path("v.csv"))
        report = json.loads(self.read("r.json"))
        self.assertEqual((report["mesh"]["boundaries"], [c["class"] for c in report["components"]]), (1, ["proven", "proven"]))
        info = json.loads(self.run_tool("info", mesh, "--json").stdout)
        self.assertEqual(([c["valid"] for c in info["components"]], info["boundaries"]), ([True, True], 1))
        self.run_tool("solve", mesh, "--loops", self.path("loops.txt"), "--report", self.path("again.json"))
        self.assertAlmostEqual(json.loads(self.read("again.json"))["energy"] / report["energy"], 1, 9)
        # A square of four vertices: both ways, with arcs of the library and of the caller.
        square = self.write("square.obj", obj_text([(0, 0, 0), (3, 0, 0), (3, 2, 0), (0, 2, 0)], [(0, 1, 2), (0, 2, 3)]))
        done = self.run_tool("solve", square, "--report", self.path("r.json"), "--save-loops", self.path("loops.txt"), "--save-marks", self.path("m.txt"))
        self.assertIn("marked 4 vertices: ", done.stdout)
        energy = json.loads(self.read("r.json"))["energy"]
        self.assertLess(min(abs(energy - 1.5), abs(energy - 2 / 3)), 1e-8)
        self.assertIn("\nat", self.read("loops.txt").decode())
        self.run_tool("solve", square, "--loops", self.path("loops.txt"), "--marks", self.path("m.txt"), "--report", self.path("again.json"))
        self.assertEqual(json.loads(self.read("again.json"))["energy"], energy)
        self.refused(3, "solve", square, "--loops", self.write("l.txt", "a: 0 1 2"), says=["marked vertex", "l.txt:1"])
        # An arc that is none.
        self.refused(3, "solve", self.mesh, "--loops", self.write("l.txt", "a: 0 1 2"), says=["no boundary", "l.txt:1"])

    def test_defects_are_named(self):
        points, triangles = beside(self.small, (self.points, self.triangles + self.triangles[:1]))
        mesh = self.write("thrice.obj", obj_text(points, triangles))
        done = self.run_tool("solve", mesh, "--report", self.path("r.json"))
        self.assertIn("component 1", done.stderr)
        self.assertIn("(triangle ", done.stderr)
        report = json.loads(self.read("r.json"))
        self.assertEqual((report["components"][1]["class"], report["components"][1]["status"]), ("none", 306))
        info = json.loads(self.run_tool("info", mesh, "--json").stdout)
        self.assertEqual([c["valid"] for c in info["components"]], [True, False])
        # The named triangle has the number of the file.
        number = int(done.stderr.split("triangles (triangle ")[1].split(")")[0])
        self.assertEqual(number, len(triangles) - 1)
        self.refused(3, "solve", self.write("unused.obj", obj_text(points + [(0, 0, 0)], triangles)), says=["vertex %d" % len(points), "--repair"])

    def test_time_limit(self):
        points, quads = torus(120, 60)
        large = (points, triangles_of(quads))
        scene = self.write("large.obj", obj_text(*beside(large, large)))
        done = self.run_tool("solve", scene, "--method", "single-level", "--tolerance", "1e-15", "--time-limit", "0.02",
                             "--values", self.path("v.csv"), status=4)
        self.assertEqual(done.stderr.count("best foliation"), 2)
        self.assertEqual(len(self.read("v.csv").splitlines()), 6 * len(points))


class Repairs(Case):
    def repaired(self, points, triangles, *says, options=()):
        """Refused, then solved with --repair, which says this; the report of it."""
        mesh = self.write("damaged.obj", obj_text(points, triangles))
        done = self.refused(3, "solve", mesh, says=["--repair"])
        done = self.run_tool("solve", mesh, "--repair", *options, "--save-mesh", self.path("good.obj"), "--report", self.path("r.json"), "--values",
                             self.path("v.csv"))
        self.assertEqual(done.stderr.splitlines(), [mesh + ": " + sentence for sentence in says])
        report = json.loads(self.read("r.json"))
        self.assertEqual(report["repairs"], list(says))
        self.assertIn("closed oriented manifold", self.run_tool("info", mesh, "--repair", *options).stdout.replace("manifolds", "manifold"))
        # What is saved is what was solved.
        self.run_tool("solve", self.path("good.obj"), "--values", self.path("w.csv"))
        self.assertEqual(self.read("v.csv"), self.read("w.csv"))
        return report

    def test_repairs(self):
        p, t, n = self.points, self.triangles, len(self.points)
        self.run_tool("solve", self.mesh, "--values", self.path("expected.csv"))
        expected = self.read("expected.csv")
        self.repaired(p, t + t[:3] + [(5, 5, 6)], "dropped 1 triangle with a vertex or a point twice", "dropped 3 duplicate triangles")
        self.assertEqual(self.read("v.csv"), expected)
        self.repaired(p + [(0, 0, 0), (1, 1, 1)], t, "dropped 2 unused vertices")
        self.assertEqual(self.read("v.csv"), expected)
        self.repaired(p, t[:500] + [u[::-1] for u in t[500:600]] + t[600:], "turned 100 triangles to the sense of the patch around")
        self.assertEqual(sorted(x for _, _, x in csv.reader(self.read("v.csv").decode().splitlines())),
                         sorted(x for _, _, x in csv.reader(expected.decode().splitlines())))
        # Two tori that share a vertex.
        points, triangles = p + moved(p, 9), t + [tuple(i + n for i in u) for u in t]
        points[n + 7] = points[3]
        report = self.repaired([q for k, q in enumerate(points) if k != n + 7],
                               [tuple(3 if i == n + 7 else i - (i > n + 7) for i in u) for u in triangles], "split 1 vertex where several sheets touched")
        self.assertEqual((report["mesh"]["components"], report["mesh"]["genus"], report["mesh"]["vertices"]), (2, 2, 2 * n))
        # Every triangle on its own.
        soup = [p[i] for u in t for i in u]
        self.repaired(soup, [(k, k + 1, k + 2) for k in range(0, len(soup), 3)],
                      "joined %d vertices with others at the same points" % (len(soup) - n), options=["--join-points"])
        # Nothing to do changes nothing.
        mesh = self.write("again.obj", obj_text(p, t + t[:1]))
        done = self.run_tool("solve", mesh, "--repair", "--values", self.path("v.csv"))
        self.assertIn("the outputs refer to the repaired mesh; --save-mesh", done.stderr)
        done = self.run_tool("solve", self.mesh, "--repair", "--values", self.path("v.csv"))
        self.assertEqual(self.read("v.csv"), expected)
        self.assertIn("nothing to repair", done.stderr)

    def test_advice(self):
        p, t, n = self.points, self.triangles, len(self.points)
        mesh = self.write("open.obj", obj_text(p[:3], [(0, 1, 2)]))
        self.refused(3, "solve", mesh, says=["genus 0", "--repair --join-points"])
        done = self.refused(3, "solve", mesh, "--repair", "--join-points", says=["genus 0"])
        self.assertNotIn("--repair", done.stderr)
        json.loads(self.run_tool("info", self.mesh, "--json", "--repair").stdout)
        mesh = self.write("flat.obj", obj_text(p, [(0, 0, 1)]))
        self.refused(3, "solve", mesh, "--repair", says=["no triangle is left"])

    def test_batch(self):
        os.mkdir(self.path("meshes"))
        self.write("meshes/a.obj", obj_text(self.points, self.triangles + self.triangles[:1]))
        self.write("meshes/b.obj", obj_text(*beside((self.points, self.triangles), tetrahedron())))
        self.run_tool("batch", self.path("meshes"), "--out", self.path("o.ndjson"), "--repair", "--join-points")
        rows = sorted(map(json.loads, self.read("o.ndjson").decode().splitlines()), key=lambda r: r["input"])
        self.assertEqual([(r["exit_status"], r["repairs"], r["mesh"]["components"]) for r in rows],
                         [(0, ["dropped 1 duplicate triangle"], 1), (0, [], 2)])

    def test_real_meshes(self):
        """Meshes of the folder HMF_SURFACES: solved, or refused with every component named; never a crash."""
        folder = os.environ.get("HMF_SURFACES", "")
        if not os.path.isdir(folder):
            self.skipTest("HMF_SURFACES is no folder")
        self.run_tool("batch", folder, "--out", self.path("o.ndjson"), "--repair", "--join-points", "--jobs", "2")
        for row in map(json.loads, self.read("o.ndjson").decode().splitlines()):
            self.assertIn(row["exit_status"], (0, 3), row)
            if row["exit_status"] == 0:
                solved = [c for c in row.get("components", [row]) if c["class"] != "none"]
                self.assertEqual(row["poles"], 0)
                for c in solved:
                    genus, marked, boundaries = (c["mesh"][key] for key in ("genus", "marked", "boundaries"))
                    if boundaries == 0:
                        self.assertEqual(c["index_sum"], 4 - 4 * genus - marked)
                    else: # of the double; marks inside count twice
                        twice = 8 - 8 * genus - 4 * boundaries - c["index_sum"] - marked
                        self.assertTrue(0 <= twice <= marked, c["mesh"])
                    self.assertEqual(c["class"], "checked" if marked else "proven")
                self.assertLess(row["residual_max"], 1e-8)
            else:
                self.assertRegex(row["errors"][0], "genus 0|boundary")


class Demo(Case):
    def test_demo(self):
        folder = self.path("demo")
        done = self.run_tool("demo", folder)
        image = os.path.join(folder, "image.png")
        self.assertIn(image, done.stdout.splitlines()[-1])
        self.assertEqual({"sample.obj", "image.png", "leaves.obj", "quads.obj", "textured.obj", "textured.mtl", "textured.png", "values.csv", "values.npy", "report.json", "history.csv", "loops.txt"}, set(os.listdir(folder)))
        report = json.loads(self.read("demo/report.json").decode())
        self.assertEqual(report["mesh"]["genus"], 3)
        self.assertGreater(report["mesh"]["vertices"], 15000)
        self.assertEqual((report["poles"], report["index_sum"], report["loops"]), (0, -8, 3))


if __name__ == "__main__":
    if len(sys.argv) < 2 or not os.path.exists(sys.argv[1]):
        sys.exit("usage: test_cli.py PATH_TO_HMF [unittest arguments]")
    TOOL = os.path.abspath(sys.argv.pop(1))
    unittest.main(verbosity=2)
