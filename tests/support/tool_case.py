"""Meshes, pictures and the base class for tests of the command line tool."""
import math
import os
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

TOOL = None  # path

# As in sample.hpp: cases of long runs, whose code shorter ones reach as well.
without_sanitizers = unittest.skipIf(os.environ.get("HMF_WITH_SANITIZERS"), "long with sanitizers")


def torus(n=24, m=16):
    """Vertices and quads of a torus."""
    points, quads = [], []
    for i in range(n):
        for j in range(m):
            a, b = 2 * math.pi * i / n, 2 * math.pi * (j + 0.3 * i) / m
            r = 2 + 0.8 * math.cos(b)
            points.append((r * math.cos(a), r * math.sin(a), 0.8 * math.sin(b)))
    # The grid turns while it goes around: 0.3 * n is not whole, so shift the seam.
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
    names = [name for name, _ in chunks]
    assert names == [b"IHDR"] + [b"IDAT"] * (len(names) - 2) + [b"IEND"] and len(names) > 2
    width, height, *rest = struct.unpack(">IIBBBBB", chunks[0][1])
    assert rest == [8, 2, 0, 0, 0]
    raw, size = zlib.decompress(b"".join(data for _, data in chunks[1:-1])), 3 * width + 1
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


def main():
    """Runs the tests of the calling script, whose first argument is the path of the tool."""
    global TOOL
    if len(sys.argv) < 2 or not os.path.exists(sys.argv[1]):
        sys.exit("usage: %s PATH_TO_HMF [unittest arguments]" % os.path.basename(sys.argv[0]))
    TOOL = os.path.abspath(sys.argv.pop(1))
    result = unittest.main(verbosity=2, exit=False).result
    for test, _ in result.failures + result.errors:
        print("run it alone: python3 %s %s %s" % (os.path.abspath(sys.argv[0]), TOOL, test.id().replace("__main__.", "")))
    sys.exit(not result.wasSuccessful())
