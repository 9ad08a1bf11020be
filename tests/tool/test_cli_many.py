#!/usr/bin/env python3
"""The command line tool, test_cli_many.py PATH_TO_HMF: many meshes, several components, repairs.
"""
import csv
import json
import os
import signal
import struct
import subprocess
import sys
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../support"))
import tool_case  # noqa: E402
from tool_case import beside, box, Case, main, moved, obj_text, pixels_of, tetrahedron, torus, triangles_of  # noqa: E402


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
            self.assertEqual([line.count(name) for line, name in zip(sorted(done.stdout.splitlines()[:-1], key=lambda line: line.split("] ")[1]), self.names)], [1] * 4)
            rows = self.lines()
            self.assertEqual([r["input"] for r in rows], self.names)
            self.assertEqual([r["exit_status"] for r in rows], [0, 3, 3, 0])
            self.assertEqual([r["class"] for r in rows], ["proven", "none", "none", "proven"])
            self.assertIn("genus 0", rows[2]["errors"][0])
            self.assertIn("dilatation_mean", rows[0])
            self.assertEqual(rows[0]["options"]["loops"], "tunnel")
        self.run_tool("solve", self.names[0], "--loops", "tunnel", "--conformality", "--report", self.path("r.json"))
        single = json.loads(self.read("r.json"))
        self.assertEqual(set(rows[0]) - {"batch"}, set(single))
        self.assertEqual(rows[0]["energy"], single["energy"])

    def test_spheres(self):
        self.run_tool("batch", self.path("meshes"), "--out", self.out)
        self.assertEqual([(r["exit_status"], r["class"]) for r in self.lines()], [(0, "proven"), (3, "none"), (0, "proven"), (0, "proven")])
        self.assertEqual(self.lines()[2]["mesh"]["marked"], 4)
        os.remove(self.out)
        self.run_tool("batch", self.path("meshes"), "--out", self.out, "--marks", "none")
        self.assertEqual([r["exit_status"] for r in self.lines()], [0, 3, 3, 0])
        self.refused(2, "batch", self.path("meshes"), "--out", self.out, "--save-marks", "m.txt", says=["--save-marks"])

    def test_threads(self):
        """0 is what is taken without the option, and a number goes to each mesh."""
        taken = []
        for words in (), ("--threads", "0"), ("--threads", "3"):
            self.run_tool("batch", self.path("meshes"), "--jobs", "1000", "--out", self.out, *words)
            taken.append(self.lines()[0]["threads"])
            os.remove(self.out)
        self.assertEqual(taken, [1, 1, 3])

    def test_resumes(self):
        self.run_tool("batch", self.path("meshes"), "--out", self.out)
        whole = self.read("out.ndjson").splitlines(keepends=True)
        # As after a crash: the last line is cut off, and one is missing.
        self.write("out.ndjson", whole[0] + whole[1] + whole[2][:50])
        done = self.run_tool("batch", self.path("meshes"), "--out", self.out)
        self.assertEqual(len(done.stdout.splitlines()), 3)
        self.assertRegex(done.stdout.splitlines()[-1], r"^\d+ meshes: \d+ solved, \d+ not, \d+ had a line")
        self.assertEqual(self.read("out.ndjson")[:len(whole[0] + whole[1])], whole[0] + whole[1])
        self.assertEqual([r["input"] for r in self.lines()], self.names)
        self.assertEqual(self.run_tool("batch", self.path("meshes"), "--out", self.out).stdout, "4 meshes: 0 solved, 0 not, 4 had a line; skipped 1 file .txt\n")

    def test_what_changed_is_solved_again(self):
        self.run_tool("batch", self.path("meshes"), "--out", self.out)
        rows = self.lines()
        with open(self.path("meshes/" + os.path.basename(self.names[-1])), "a") as file:
            file.write("\n")
        done = self.run_tool("batch", self.path("meshes"), "--out", self.out)
        self.assertIn("3 had a line; 1 had one of another mesh or other options", done.stdout)
        self.assertEqual([row["input"] for row in self.lines()[len(rows):]], self.names[-1:])
        again = self.run_tool("batch", self.path("meshes"), "--out", self.out, "--ratio", "0.4")
        self.assertIn("0 had a line; 4 had one of", again.stdout)
        self.assertIn("4 had a line", self.run_tool("batch", self.path("meshes"), "--out", self.out, "--ratio", "0.4", "--threads", "1", "--jobs", "2").stdout)

    def test_refusals(self):
        self.refused(2, "batch", self.path("meshes"), says=["--out"])
        self.refused(2, "batch", self.path("meshes"), "--out", self.out, "--jobs", "0", says=["--jobs"])
        self.refused(2, "batch", self.path("meshes"), "--out", self.out, "--image", "i.png", says=["--image"])
        self.refused(2, "batch", self.path("meshes"), "--out", self.out, "--spacing", "1", says=["--spacing"])
        self.refused(5, "batch", self.path("none"), "--out", self.out, says=["none"])
        self.refused(3, "batch", self.folder.name + "/meshes", "--out", self.write("other.ndjson", "hello\n"), says=["other.ndjson:1:"])
        self.assertEqual(self.read("other.ndjson"), b"hello\n")

    def test_interrupt(self):
        """While the first large mesh is solved, or before it has begun; what was interrupted has no line."""
        points, quads = torus(240, 150)
        text = obj_text(points, triangles_of(quads))
        for n in range(3):
            self.write("meshes/large%d.obj" % n, text)
        tool = subprocess.Popen([tool_case.TOOL, "batch", self.path("meshes"), "--out", self.out, "--method", "single-level", "--tolerance", "1e-15"],
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True)
        for name in self.names:
            self.assertIn(name.encode(), tool.stdout.readline())
        os.killpg(tool.pid, signal.SIGINT)
        _, errors = tool.communicate(timeout=600)
        self.assertEqual(tool.returncode, 4, errors.decode())
        self.assertEqual([row["input"] for row in self.lines()], self.names)

    @unittest.skipUnless(os.path.exists("/proc/self/task/%d/children" % os.getpid()), "skipped: needs /proc")
    def test_what_dies_of_the_interrupt_has_no_line(self):
        """The first Control-C reaches the batch, and its mesh ends without a report."""
        points, quads = torus(240, 150)
        self.write("meshes/large.obj", obj_text(points, triangles_of(quads)))
        tool = subprocess.Popen([tool_case.TOOL, "batch", self.path("meshes"), "--out", self.out, "--method", "single-level", "--tolerance", "1e-15"],
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        for _ in self.names:
            tool.stdout.readline()
        child = ""
        while not child:
            with open("/proc/%d/task/%d/children" % (tool.pid, tool.pid)) as file:
                child = file.read().strip()
        tool.send_signal(signal.SIGINT)
        os.kill(int(child), signal.SIGKILL)
        tool.communicate(timeout=600)
        self.assertEqual(tool.returncode, 4)
        self.assertEqual([row["input"] for row in self.lines()], self.names)


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

    def test_quads_beside_two_triangles(self):
        """Two triangles back to back carry nothing: they are named, the quads of the rest are written, by any number of threads."""
        points, triangles = beside(self.small, ([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2), (0, 2, 1)]))
        scene, outs = self.write("two.obj", obj_text(points, triangles)), [self.path("1.obj"), self.path("2.obj")]
        for threads, out in zip("12", outs):
            done = self.run_tool("quads", scene, out, "--count", "300", "--threads", threads)
            self.assertIn("component 1 (2 triangles", done.stderr)
        self.assertEqual(self.read("1.obj"), self.read("2.obj"))
        found = json.loads(self.run_tool("info", outs[0], "--json").stdout)
        self.assertEqual((found["genus"], found["components"]), (1, 1))
        # Alone they are an error.
        self.refused(3, "quads", self.write("flat.obj", obj_text(points[-3:], [(0, 1, 2), (0, 2, 1)])), outs[0], says=["No loops"])

    def test_one_rule_for_the_exit_status(self):
        """An output that one of two components cannot have is a note, also in the report; one that none can have is an error."""
        points, triangles = self.small
        huge = self.write("huge.obj", obj_text(*beside(self.small, ([tuple(1e9 * x for x in p) for p in points], triangles))))
        done = self.run_tool("solve", huge, "--quads", self.path("q.obj"), "--size", "1", "--report", self.path("r.json"))
        self.assertRegex(done.stderr, "component 1 .*There would be about")
        report = json.loads(self.read("r.json"))
        self.assertEqual([report[key] for key in ("exit_status", "errors", "components_solved", "quads_components")], [0, [], 2, 1])
        self.assertIn("component 1", report["notes"][0])
        self.refused(3, "solve", huge, "--quads", self.path("q.obj"), "--size", "1e-9", says=["component 0", "component 1"])

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
        # The sphere is gray, the rest is not.
        gray = sum(max(p) - min(p) < 6 and 100 < p[0] < 200 for row in pixels_of(self.read("i.png")) for p in row)
        self.assertGreater(gray, 100)
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
        self.refused(2, "solve", self.scene, *none, "--weights", "1", says=["1 weight for 2 loops"])

    def test_marks(self):
        """Each sphere gets marks of its own; those of a file go to the component they lie on."""
        ball = box(12, 3, 3)
        self.parts[1] = ball
        points, triangles = beside(*self.parts)
        scene, saved = self.write("scene.obj", obj_text(points, triangles)), self.path("saved.txt")
        done = self.run_tool("solve", scene, "--save-marks", saved, "--values", self.path("v.csv"), "--report", self.path("r.json"), "--image", self.path("i.png"))
        self.assertIn("3 components, 3 solved, genus 2", done.stdout)
        self.assertIn("class proven", done.stdout)
        report = json.loads(self.read("r.json"))
        self.assertEqual([c["class"] for c in report["components"]], ["proven", "proven", "proven"])
        for count in (report["mesh"]["triangles"], report["mesh"]["marked"], report["zeros"], report["class_repeats"], report["levels"][0]["edges"]):
            self.assertIsInstance(count, int)
        own, found = self.alone(1, "--save-marks", self.path("own.txt"))
        marked = found["mesh"]["marked"]
        self.assertEqual((report["class"], report["converged"], report["mesh"]["marked"], report["index_sum"]), ("proven", True, marked, 4 - marked))
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
        self.assertEqual([c["class"] for c in again["components"]], ["proven", "none", "proven"])
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
        self.assertEqual([line[:5] for line in done.stderr.splitlines() if "warning" not in line], ["hmf: "])
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
        number = int(done.stderr.split("triangles (triangle ")[1].split(", line ")[0])
        self.assertEqual(number, len(triangles) - 1)
        self.assertIn("triangles (triangle %d, line %d)" % (number, len(points) + number + 1), done.stderr)
        self.assertIn("dropped 1 unused vertex", self.run_tool("solve", self.write("unused.obj", obj_text(points + [(0, 0, 0)], triangles))).stderr)

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
        self.repaired(p + [(0, 0, 0), (1, 1, 1)], t + t[:1], "dropped 1 duplicate triangle", "dropped 2 unused vertices")
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
        self.assertIn("the outputs refer to the changed mesh; --save-mesh", done.stderr)
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

    @tool_case.without_sanitizers
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
                    else: # half of the double, where marks inside count twice
                        twice = 8 - 8 * genus - 4 * boundaries - 2 * c["index_sum"] - marked
                        self.assertTrue(0 <= twice <= marked, c["mesh"])
                    self.assertEqual(c["class"], "proven")
                self.assertLess(row["residual_max"], 1e-8)
            else:
                self.assertRegex(row["errors"][0], "genus 0|boundary")


if __name__ == "__main__":
    main()
