#!/usr/bin/env python3
"""The command line tool, test_cli_outputs.py PATH_TO_HMF: what hmf solve writes.
"""
import csv
import json
import math
import os
import struct
import subprocess
import sys
import time
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../support"))
import tool_case  # noqa: E402
from tool_case import Case, main, obj_text, pixels_of, torus, triangles_of  # noqa: E402


def star_of(arms, inner):
    """A flat star: its points and triangles."""
    n = 2 * arms
    radius = [1 if k % 2 == 0 else inner for k in range(n)]
    points = [(radius[k] * math.cos(math.pi * k / arms), radius[k] * math.sin(math.pi * k / arms), 0) for k in range(n)]
    return points, [(k, (k + 1) % n, (k + 2) % n) for k in range(1, n, 2)] + [(1, k, k + 2) for k in range(3, n - 1, 2)]


def torus_of(sections, sides, thick, thin):
    """A torus around a circle, whose sections are thick and thin in turn."""
    points, corner = [], lambda i, j: i % sections * sides + j % sides
    for i in range(sections):
        around, size = 2 * math.pi * i / sections, thin if i % 2 else thick
        for j in range(sides):
            angle = 2 * math.pi * j / sides
            radius = 4 + size * math.cos(angle)
            points.append((radius * math.cos(around), radius * math.sin(around), size * math.sin(angle)))
    triangles = []
    for i in range(sections):
        for j in range(sides):
            a, b, c, d = corner(i, j), corner(i, j + 1), corner(i + 1, j), corner(i + 1, j + 1)
            triangles += [(a, c, d), (a, d, b)]
    return points, triangles


class Outputs(Case):
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
            "mesh", "method", "levels", "loops", "build_seconds", "loops_seconds", "solve_seconds", "total_seconds", "energy", "unevenness", "weights", "residual_max", "components_solved",
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
            self.assertEqual(set(level), {"vertices", "edges", "nld", "raised_count", "sweeps", "linear_solves", "optimize_seconds", "interpolate_seconds"})
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
            "loops": "cut", "through": None, "weights": [1], "marks": "auto", "start": None, "method": "newton", "collapse": "midpoint", "ratio": 0.5, "coarsest": 0, "mollify": None,
            "tolerance": 1e-8, "time-limit": None, "threads": found["threads"], "report": report, "conformality": False, "image": self.path("i.png"), "pattern": "stripes", "camera": "auto", "image-size": "1400x1050", "legend": False, "period": found["options"]["period"],
            "spacing": None, "conjugate": False, "size": None, "repair": False, "join-points": None, "fill-holes": 0, "closed": False})
        # What it says are the defaults gives the same bits.
        self.run_tool("solve", mesh, "--values", self.path("a.csv"))
        self.run_tool("solve", mesh, "--values", self.path("b.csv"), "--loops", "cut", "--weights", "1", "--method", "newton", "--collapse", "midpoint",
                      "--ratio", "0.5", "--coarsest", "0", "--tolerance", "1e-8")
        self.assertEqual(self.read("a.csv"), self.read("b.csv"))
        self.run_tool("solve", mesh, "--report", report, "--conformality")
        found = json.loads(self.read("r.json"))
        self.assertLessEqual({"dilatation_mean", "dilatation_median", "dilatation_p99", "flipped_count", "degenerate_count", "seam_edges",
                              "seam_length", "parameterize_seconds"}, set(found))
        self.run_tool("solve", mesh, "--report", report, "--method", "whitehead")
        found = json.loads(self.read("r.json"))["options"]
        self.assertEqual((found["method"], found["tolerance"]), ("whitehead", 1e-8))

    def test_converged_is_small_residual(self):
        """Whatever a method measures on the way; the exit status says whether it came to its own end."""
        seen = set()
        for words in (["newton"], ["newton", "--tolerance", "1e-3"], ["whitehead"], ["whitehead", "--tolerance", "0.1"], ["single-level"],
                      ["single-level", "--tolerance", "1e-3"]):
            self.run_tool("solve", self.mesh, "--report", self.path("r.json"), "--method", *words)
            found = json.loads(self.read("r.json"))
            self.assertIs(found["converged"], found["residual_max"] <= found["options"]["tolerance"], words)
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
        done = subprocess.run([tool_case.TOOL, *arguments], input=content, stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=300)
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
        self.assertIn(b"--values and by --report", self.pipe(mesh, "solve", "-", "--values", "-", "--report", "-", status=2).stderr)
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
        self.assertEqual((report["flipped_count"], report["degenerate_count"]), (0, 0))
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
        # Only an .obj has a picture beside it.
        self.run_tool("solve", self.mesh, "--atlas", self.path("b.glb"), "--loops", "cut", "--image", self.path("b.png"), "--image-size", "64x48")
        self.refused(2, "solve", self.mesh, "--atlas", self.path("b.obj"), "--image", self.path("b.png"), says=["b.png: is written by ", "--image", " and by ", "--atlas %s" % self.path("b.obj")])
        self.refused(2, "solve", self.mesh, "--atlas", self.path("a.ply"), says=[".glb"])

    def test_coordinates_beyond_floats(self):
        huge = self.path("huge.obj")
        with open(self.mesh) as old, open(huge, "w") as new:
            for line in old:
                words = line.split()
                new.write(" ".join(["v", *(repr(1e60 * float(w)) for w in words[1:4])]) + "\n" if words[:1] == ["v"] else line)
        for option in ("--textured", "--atlas"):
            self.refused(3, "solve", huge, option, self.path("h.glb"), says=["3.4e38", ".obj"])
        self.refused(3, "quads", huge, self.path("h.glb"), says=["3.4e38", ".obj"])
        self.run_tool("solve", huge, "--quads", self.path("h.obj"))

    def test_units_of_pictures_and_numbers(self):
        """Squares of areas overflow; in a unit that is a power of two nothing changes."""
        points, quads = torus()
        there = [(x + 8, y, z) for x, y, z in points]
        triangles = triangles_of(quads)
        both = triangles + [[v + len(points) for v in t] for t in triangles]
        made = []
        for exponent in (0, 500, -500):
            unit = 2.0 ** exponent
            mesh = self.write("unit.obj", obj_text([tuple(unit * x for x in p) for p in points + there], both))
            self.run_tool("quads", mesh, self.path("out.obj"), "--count", "400", "--refine", "0", "--image", self.path("out.png"), "--report", self.path("out.json"))
            made.append((json.loads(self.read("out.json"))["quads"], self.read("out.png")))
        self.assertGreater(len(made[0][1]), 50000)
        self.assertEqual(made[1], made[0])
        self.assertEqual(made[2], made[0])

    def test_fewest_quads(self):
        """A torus needs three rows of three quads: a smaller wish is told so."""
        points, quads = torus()
        mesh = self.write("t.obj", obj_text(points, triangles_of(quads)))
        for count, fewest in (("4", 9), ("400", None)):
            done = self.run_tool("quads", mesh, self.path("q.obj"), "--count", count, "--report", self.path("r.json"))
            self.assertEqual(json.loads(self.read("r.json")).get("quads_fewest"), fewest)
            self.assertEqual("4 were wished, and these loops and marked vertices need about 9" in done.stdout, count == "4")
            self.assertEqual("4 quads are wished, and these loops and marked vertices need about 9" in done.stderr, count == "4")

    def test_quads_of_a_star(self):
        """No quad of a flat star looks down, and an area that is not the star's is said."""
        points, triangles = star_of(8, .5)
        star = self.write("star.obj", obj_text(points, triangles))
        area = sum(points[k - 1][0] * points[k][1] - points[k - 1][1] * points[k][0] for k in range(16)) / 2
        for refine in ("0", "600"):
            said = self.run_tool("quads", star, self.path("q.obj"), "--count", "200", "--refine", refine).stdout
            lines = [line.split() for line in self.read("q.obj").decode().splitlines()]
            at = [tuple(map(float, line[1:3])) for line in lines if line[0] == "v"]
            covered = 0
            for a, b, c, d in ([at[int(v.split("/")[0]) - 1] for v in line[1:]] for line in lines if line[0] == "f"):
                signed = ((c[0] - a[0]) * (d[1] - b[1]) - (c[1] - a[1]) * (d[0] - b[0])) / 2
                self.assertGreater(signed, 0)
                covered += signed
            self.assertEqual("times the area of the surface" in said, not 0.9 <= covered / area <= 1.1)

    def test_quads_of_cut_loops(self):
        """A torus is too thin in places for quads of even loops: then quads of cut loops are made, the same as those one asks for."""
        thin = self.write("thin.obj", obj_text(*torus_of(4, 3, 1, .1)))
        said = self.run_tool("quads", thin, self.path("q.obj"), "--count", "130").stderr
        self.assertIn("these are of --loops cut", said)
        self.assertEqual(said.count(": cut into"), 2)  # one solve for each loops: what was compared is written
        self.assertEqual(self.run_tool("quads", thin, self.path("c.obj"), "--count", "130", "--loops", "cut").stderr.count("--loops cut"), 0)
        self.assertEqual(self.read("q.obj"), self.read("c.obj"))
        self.assertNotIn("these are of --loops cut", self.run_tool("quads", self.mesh, self.path("q.obj"), "--count", "130").stderr)

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
        def share(pixels, color):
            return sum(color(*p) for row in pixels for p in row) / (len(pixels) * len(pixels[0]))
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
        # hmf quads draws its own quads: more lines for more of them.
        dark = []
        for count in ("50", "1500"):
            self.run_tool("quads", self.mesh, self.path("q.obj"), "--count", count, "--image", self.path("i.png"), "--image-size", "400x300")
            dark.append(share(pixels_of(self.read("i.png")), lambda r, g, b: max(r, g, b) < 130))
        self.assertGreater(dark[1], dark[0] + 0.02)
        self.refused(2, "quads", self.mesh, self.path("q.obj"), "--legend", says=["--image"])
        # Around the z axis: from the top (z) there is a hole in the middle, from the front it is flat.
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


class Leaves(Case):
    """Leaves and quads of a surface of genus 3, the sample of the demo."""

    def test_zeros_are_drawn_on_the_surface(self):
        """In any unit: the picture of the surface made larger or smaller is the same, with a stripe beside each zero."""
        self.run_tool("demo", self.path("demo"))
        with open(os.path.join(self.path("demo"), "sample.obj")) as f:
            lines = f.read().splitlines()
        made = []
        for unit in (1, 8, 1 / 64):
            scaled = ["v " + " ".join(repr(unit * float(x)) for x in line.split()[1:4]) if line.startswith("v ") else line for line in lines]
            mesh = self.write("unit.obj", "\n".join(scaled) + "\n")
            self.run_tool("solve", mesh, "--image", self.path("i.png"), "--image-size", "400x300", "--camera", "corner")
            made.append(pixels_of(self.read("i.png")))
        self.assertEqual(made[1], made[0])
        self.assertEqual(made[2], made[0])
        blue, red = ([(x, y) for y, row in enumerate(made[0]) for x, p in enumerate(row) if test(*p)]
                     for test in (lambda r, g, b: b > 1.5 * r and b > 1.5 * g, lambda r, g, b: r > 2 * g and r > 2 * b))
        self.assertGreater(len(blue), 20)
        beside = {(x + i, y + j) for x, y in red for i in range(-9, 10) for j in range(-9, 10)}
        self.assertEqual([p for p in blue if p not in beside], [])

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
        self.assertTrue(all(0 <= c["twist"] < c["circumference"] for c in cylinders))
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

    @tool_case.without_sanitizers
    def test_quads_of_few_triangles(self):
        """A long box of 12 triangles has no vertices for leaves to bend at."""
        corners = [(x, y, z) for x in (0, 6) for y in (0, 1) for z in (0, 1)]
        sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        box = self.write("box.obj", obj_text(corners, [t for a, b, c, d in sides for t in ((a, b, c), (a, c, d))]))
        out, loops, unevenness = self.path("q.obj"), self.path("l.txt"), {}
        for count in ("0", "2000"):
            done = self.run_tool("quads", box, out, "--refine", count, "--report", self.path("r.json"), "--save-mesh", self.path("m.obj"), "--save-loops", loops, "--save-marks", self.path("marks.txt"))
            unevenness[count] = json.loads(self.read("r.json"))["unevenness"]
            self.assertEqual("cut into 2000 triangles" in done.stderr, count != "0")
        self.assertLess(unevenness["2000"], 0.7 * unevenness["0"])
        self.assertEqual(self.read("m.obj").count(b"\nf "), 2000)
        self.assertIn("cut into 2000 triangles", self.run_tool("quads", box, out).stderr)
        # Loops of a file are on the mesh as it is.
        self.assertNotIn("cut into", self.run_tool("quads", self.path("m.obj"), out, "--loops", loops, "--marks", self.path("marks.txt"), "--refine", "9000").stderr)

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

    @unittest.skipUnless(os.path.isdir(os.environ.get("HMF_MESHES", "")), "skipped: no folder HMF_MESHES")
    def test_fine_quads_of_real_meshes(self):
        """Sizes at which rows of quads no longer fitted together, and one that nothing could hold."""
        def mesh(name):
            return os.path.join(os.environ["HMF_MESHES"], name + ".obj")
        for name, size, count in (("eight_1.5k", 0.014, 5e3), ("eight_1.5k", 0.008, 1e4), ("dtorus_6.1k", 0.003, 1e5)):
            self.run_tool("solve", mesh(name), "--quads", self.path("q.obj"), "--size", str(size), "--report", self.path("r.json"))
            self.assertGreater(json.loads(self.read("r.json"))["quads"], count, name)
        done = self.refused(3, "solve", mesh("torus_4.6k"), "--quads", self.path("q.obj"), "--size", "1e-5", says=["quads of this size", "larger --size"])
        self.assertNotIn("(option", done.stderr)

    def test_refusals(self):
        for option in ("--spacing", "--size"):
            self.run_tool("solve", self.mesh, option, "0", status=2)
        self.run_tool("solve", self.mesh, "--leaves", self.path("l.txt"), status=2)
        self.run_tool("solve", self.mesh, "--leaves", self.path("x.obj"), "--quads", self.path("x.obj"), status=2)


if __name__ == "__main__":
    main()
