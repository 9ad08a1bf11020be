#!/usr/bin/env python3
"""The command line tool, test_cli.py PATH_TO_HMF: usage, meshes in every format, the demo.

Formats, exit status and sentence of every error.
"""
import json
import os
import re
import resource
import shutil
import struct
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../support"))
import tool_case  # noqa: E402
from tool_case import beside, box, Case, main, obj_text, pixels_of, tetrahedron, torus  # noqa: E402


class Usage(Case):
    def test_help_and_version(self):
        self.assertIn("solve", self.run_tool("--help").stdout)
        self.assertIn("--loops", self.run_tool("solve", "--help").stdout)
        self.assertRegex(self.run_tool("--version").stdout, r"hmf \d+\.\d+\.\d+")
        self.assertEqual(self.run_tool("help").stdout, self.run_tool("--help").stdout)
        for command in ("demo", "quads"):
            self.assertEqual(self.run_tool("help", command).stdout, self.run_tool(command, "--help").stdout)
        self.refused(2, "help", "paint", says=["paint"])
        self.refused(2, "help", "solve", "quads", says=["one command"])

    def test_manual_and_completion(self):
        """Every option of every command is in the manual page and in the completion of each shell."""
        page = self.run_tool("manual").stdout
        self.assertTrue(page.startswith(".TH HMF 1"))
        self.assertIn("with boundary", page)
        shells = {shell: self.run_tool("completion", shell).stdout for shell in ("bash", "zsh", "fish")}
        for command in ("solve", "info", "batch", "demo"):
            for option in re.findall(r"^  (--[a-z-]+)", self.run_tool(command, "--help").stdout, re.M):
                self.assertIn(option.replace("-", "\\-"), page)
                for shell, text in shells.items():
                    self.assertIn(option[2:] if shell == "fish" else option, text, shell)
            for default in re.findall(r"\(default [^)]*\)", self.run_tool(command, "--help").stdout):
                self.assertIn(default.replace("-", "\\-"), page)
        build = os.path.dirname(os.path.abspath(tool_case.TOOL))
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

    def test_defaults_can_be_given(self):
        """A default that the help names is one that the option takes."""
        for command, rest in ("solve", ()), ("quads", (self.path("q.obj"),)):
            rows = re.findall(r"^  (--[a-z-]+) N (?:.*\n {28})*.*\(default (\d+)\)$", self.run_tool(command, "--help").stdout, re.M)
            self.assertIn(("--threads", "0"), rows)
            self.run_tool(command, self.mesh, *rest, *(word for row in rows for word in row))

    def test_usage_errors(self):
        self.refused(2)
        self.refused(2, "paint")
        self.refused(2, "solve")
        self.refused(2, "solve", self.mesh, "--method", "magic", says=["magic"])
        self.refused(2, "solve", self.mesh, "--ratio", "x")
        self.refused(2, "solve", self.mesh, "--coarsest", "1.5", says=["not a whole number"])
        self.refused(2, "solve", self.mesh, "--coarsest", "9" * 30, says=["too large"])
        self.refused(5, "solve", self.folder.name + "/.", says=["cannot be read"])
        self.refused(2, "solve", self.mesh, "--ratio", "3", says=["ratio"])
        self.refused(2, "solve", self.mesh, "--unknown")
        for slip, meant in ("--imag", "--image"), ("--iamge", "--image"), ("--loop", "--loops"), ("--weight", "--weights"):
            self.refused(2, "solve", self.mesh, slip, says=["there is no option " + slip + "; " + meant + " is one;"])
        self.refused(2, "solve", self.mesh, "--weights", "1,2,3", says=["--weights", "1 loop;"])
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
        for weights in ("-1", "0", "1,-2", "inf"):
            self.refused(2, "solve", self.mesh, "--weights=" + weights, says=["--weights", "is not in (0, inf)"])
        self.refused(2, "solve", self.mesh, "--conjugate=1", says=["--conjugate", "no value"])
        self.refused(2, "solve", self.mesh, "--coarsest", "1.5", says=["--coarsest", "whole number"])
        self.refused(2, "solve", self.mesh, "--coarsest", "-1", says=["--coarsest", "whole number"])
        for option in ("--spacing", "--ratio", "--tolerance", "--size"):
            self.refused(2, "solve", self.mesh, option, "nan", says=[option, "nan is not in"])
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
            done = subprocess.run([tool_case.TOOL, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)
            for word in ("hmf_", "HMF_", "NULL", "options", "struct_size", "time_limit", "memory_limit", "stop_level", "edge_length", "(option"):
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

    def test_info_always_has_its_json(self):
        """Also of a file that is no mesh, and once."""
        for status, path in ((5, self.path("missing.obj")), (3, self.write("text.obj", "no mesh")), (3, self.write("bad.obj", "v 0 0 0\nf 1 2 3\n"))):
            done = self.refused(status, "info", path, "--json")
            report = json.loads(done.stdout)
            self.assertEqual((report["mesh"], report["valid"]), (path, False))
            self.assertIn(report["message"], done.stderr)
            self.assertEqual(self.refused(status, "info", path).stdout, "")

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
        done = self.run_tool("solve", path, "--report", report)
        self.assertIn("genus 1, 1 boundary, ", done.stdout)
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
        counted = "1 loop with a weight" if first["loops"] == 1 else "%d loops with weights" % first["loops"]
        self.assertIn("even: %d marked vertices, %s; unevenness %.2f" % (first["mesh"]["marked"], counted, first["unevenness"]), done.stdout)
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
        self.assertEqual((report["class"], report["converged"], report["options"]["marks"]), ("proven", True, "auto"))
        self.assertIn("class proven", text)
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
        self.assertEqual((report["mesh"]["marked"], report["poles"], report["index_sum"], report["class"]), (1, 0, -1, "proven"))

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
        self.refused(3, "info", self.write("text.obj", "hello\n"), says=["text.obj: ", "hello"])
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
            tool = subprocess.Popen([tool_case.TOOL, "info", path], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            text = tool.communicate(timeout=600)[1].decode()
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
                ("repeated", p, t + [(0, 0, 1)], "triangle %d" % len(t))]:
            path = self.write(name + ".obj", obj_text(points, triangles))
            self.refused(3, "info", path, says=[path, says, "--repair"])
            self.refused(3, "solve", path, says=[path, says, "--repair"])
            self.assertFalse(json.loads(self.refused(3, "info", path, "--json").stdout)["valid"])


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
    main()
