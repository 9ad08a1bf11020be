#!/usr/bin/env python3
"""The command line tool, test_cli_solve.py PATH_TO_HMF: starts, loops, weights, limits, interruption.
"""
import csv
import json
import math
import os
import signal
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../support"))
import tool_case  # noqa: E402
from tool_case import beside, Case, main, obj_text, torus, triangles_of  # noqa: E402


class Solve(Case):
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
        self.run_tool("solve", mesh, "--mollify", "1e-5", "--values", self.path("mollified.csv"))
        result = self.run_tool("solve", mesh, "--repair", "--values", self.path("repaired.csv"), "--report", self.path("flat.json"))
        self.assertIn("accepted triangles without area", result.stderr)
        self.assertEqual(self.read("mollified.csv"), self.read("repaired.csv"))
        self.assertEqual(json.loads(self.read("flat.json"))["repairs"], ["accepted triangles without area (--mollify 1e-5)"])
        self.assertIn("accepted triangles without area", self.run_tool("info", mesh, "--repair").stderr)
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
        for text in (meridian, meridian + " 0", "# the seam\n\nv: " + meridian.replace(" ", ",") + "  # and its end\n"):
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
        # On a torus of revolution: around the tube, and around the hole.
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

        # Around the tube: vertices 0 to 15.
        (loop,), found = drawn("0 5 10")
        self.assertEqual(loop, list(range(16)))
        self.assertEqual((found["class"], found["options"]["through"], found["options"]["loops"]), ("proven", "0 5 10", None))
        self.run_tool("solve", self.mesh, "--loops", self.write("loops.txt", " ".join(map(str, range(16)))), "--report", report)
        self.assertEqual(json.loads(self.read("r.json"))["energy"], found["energy"])
        places = " ".join(",".join("%.3f" % (x + 0.004) for x in self.points[v]) for v in (0, 5, 10, 0))
        self.assertEqual(drawn(places)[0], [loop])
        # Around the hole; each way is as short as any other, found by relaxing every edge.
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
        self.refused(2, "solve", scene, "--through", "0 5 %d" % n, says=["--through: loop 0", "one component"])
        for picked, says in (("", "nothing is picked"), (" ; ", "loop 0 has 0"), ("0 5", "loop 0 has 2 picked vertices"), ("0 0 5 0", "loop 0 has 2"),
                             ("0 5 x", "\"x\""), ("0 5 -1", "\"-1\""), ("0 5 99999", "vertex 99999 does not exist"), ("0 5 1,2", "no place"), ("0 5 1,2,nan", "no place"),
                             ("0 5 1,2,3,4", "no place"), ("0 5 10;0 1", "loop 1 has 2")):
            self.refused(2, "solve", self.mesh, "--through", picked, says=["--through", says])
        self.refused(3, "solve", self.mesh, "--through", "0 1 2", says=["--through, loop 0", "goes back the way it came"])
        self.refused(2, "solve", self.mesh, "--through", "0 5 1e3,0,0", says=["--through: 1e3,0,0 is ", "from the surface", "unit and axes"])
        self.refused(2, "solve", self.mesh, "--through", "0 5 10", "--loops", "cut", says=["--through", "--loops"])
        self.refused(2, "solve", self.mesh, "--through", "0 5 10", "--weights", "1,2", says=["2 weights for 1 loop;"])

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
            self.refused(2, "solve", self.mesh, "--weights=" + weight)
        self.refused(3, "solve", self.mesh, "--weights=1e200")

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
        """Control-C while the bar on the terminal says that it solves."""
        points, quads = torus(240, 150)
        mesh = self.write("large.obj", obj_text(points, triangles_of(quads)))
        terminal, its_end = os.openpty()
        tool = subprocess.Popen([tool_case.TOOL, "solve", mesh, "--method", "single-level", "--tolerance", "1e-15", "--values", self.path("v.csv")],
                                stdout=subprocess.DEVNULL, stderr=its_end)
        os.close(its_end)
        said = b""
        try:
            while part := os.read(terminal, 4096):
                was_solving, said = b"\rsolve" in said.replace(b"\033[K", b""), said + part
                if not was_solving and b"\rsolve" in said.replace(b"\033[K", b""):
                    tool.send_signal(signal.SIGINT)
        except OSError:
            pass  # the other end is closed
        os.close(terminal)
        self.assertEqual(tool.wait(timeout=600), 4, said.decode())
        self.assertIn("interrupted", said.decode())
        self.assertEqual(len(self.read("v.csv").splitlines()), 3 * len(points))


if __name__ == "__main__":
    main()
