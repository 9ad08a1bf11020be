"""Pictures of surfaces with their leaves: figures 3, 4, 5, 11, 15 and 16 of the paper.

A surface is drawn by points: each triangle gets points in proportion to its area, and of those in one pixel the nearest
is kept.  Stripes come from the function u of the parameterization, whose level sets are the leaves.
"""
import io
import pathlib
import struct
import zlib

import numpy as np

from . import curves, paper_times, shapes

SIZE = 420


def read_arrays(path):
    """The records of bench_pictures."""
    arrays = {}
    with open(path, "rb") as file:
        while head := file.readline().split():
            name, kind, rows, columns = head[0].decode(), head[1].decode(), int(head[2]), int(head[3])
            count = rows * columns
            arrays[name] = np.frombuffer(file.read(count * int(kind[1])), "<" + kind).reshape(rows, columns)
    return arrays


class View:
    """Seen along the direction in which the shape is thinnest, turned a little."""

    def __init__(self, points):
        self.middle = (points.min(0) + points.max(0)) / 2
        axes = np.linalg.svd((points - points.mean(0))[:: max(1, len(points) // 5000)], full_matrices=False)[2]
        axes[2] = np.cross(axes[0], axes[1])
        a, b = np.radians(20), np.radians(-30)
        turn = np.array([[np.cos(a), 0, np.sin(a)], [0, 1, 0], [-np.sin(a), 0, np.cos(a)]]) @ np.array(
            [[1, 0, 0], [0, np.cos(b), -np.sin(b)], [0, np.sin(b), np.cos(b)]])
        self.turn = turn @ axes
        flat = self.place(points)
        self.middle = self.middle + ((flat.min(0) + flat.max(0)) / 2) @ self.turn
        self.scale = 0.94 * SIZE / np.ptp(flat[:, :2], axis=0).max()
        self.height = int(np.ptp(flat[:, 1]) * self.scale / 0.94) + 8

    def place(self, points):
        return (points - self.middle) @ self.turn.T


class Canvas:
    def __init__(self, view):
        self.view = view
        self.depth = np.full(view.height * SIZE, -np.inf)
        self.color = np.full((view.height * SIZE, 3), 255, np.uint8)

    def put(self, points, colors, lift=0.0, radius=0):
        """lift: towards the eye, in the unit of the points."""
        flat = self.view.place(points)
        for dx in range(-radius, radius + 1):
            for dy in range(-radius, radius + 1):
                if dx * dx + dy * dy > radius * radius + 1:
                    continue
                x = np.rint(SIZE / 2 + self.view.scale * flat[:, 0]).astype(int) + dx
                y = np.rint(self.view.height / 2 - self.view.scale * flat[:, 1]).astype(int) + dy
                good = (x >= 0) & (x < SIZE) & (y >= 0) & (y < self.view.height)
                pixel, depth = (y * SIZE + x)[good], flat[good, 2] + lift
                order = np.argsort(depth, kind="stable")  # the nearest is written last
                nearer = depth[order] > self.depth[pixel[order]]
                chosen = order[nearer]
                self.depth[pixel[chosen]] = depth[chosen]
                self.color[pixel[chosen]] = np.broadcast_to(colors, (len(points), 3))[good][chosen]

    def png(self):
        rows = self.color.reshape(self.view.height, SIZE, 3)
        plain = b"".join(b"\0" + row.tobytes() for row in rows)

        def chunk(kind, data):
            return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        stream = io.BytesIO()
        head = struct.pack(">IIBBBBB", SIZE, self.view.height, 8, 2, 0, 0, 0)
        stream.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head))
        stream.write(chunk(b"IDAT", zlib.compress(plain, 9)) + chunk(b"IEND", b""))
        return stream.getvalue()


def samples(points, triangles, count=900_000):
    """Triangles and barycentric coordinates, dense enough for every pixel."""
    corner = points[triangles]
    area = np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1)
    random = np.random.default_rng(0)
    chosen = random.choice(len(triangles), count, p=area / area.sum())
    a, b = random.random((2, count))
    weight = np.stack([1 - np.sqrt(a), np.sqrt(a) * (1 - b), np.sqrt(a) * b], 1)
    return chosen, weight


def shades(points, triangles, view, chosen):
    corner = view.place(points)[triangles]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
    return (0.45 + 0.55 * np.abs(normal @ [0.3, 0.4, 0.87]))[chosen]


def draw(arrays, prefix="", view=None, stripes=8.0, edges=False, leaves=None, count=900_000):
    points = np.array(arrays[prefix + "positions"])
    triangles = arrays[prefix + "triangles"].astype(int)
    view = view or View(points)
    canvas = Canvas(view)
    chosen, weight = samples(points, triangles, count)
    base = np.full((len(chosen), 3), (236, 236, 240.0))
    if "corner_uv" in arrays and not prefix:
        u = (arrays["corner_uv"].reshape(-1, 3, 2)[:, :, 0][chosen] * weight).sum(1)
        striped = np.abs((u * stripes) % 1 - 0.5) < 0.25
        base[striped] = (214, 60, 60)
    if edges:
        corner = view.place(points)[triangles]
        height = np.abs(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])[:, 2])
        longest = np.max([np.linalg.norm((corner[:, k] - corner[:, k - 1])[:, :2], axis=1) for k in range(3)], 0)
        thin = (weight.min(1) * (height / np.maximum(longest, 1e-300))[chosen] * view.scale) < 0.6
        base[thin] = (150, 150, 165)
    colors = (base * shades(points, triangles, view, chosen)[:, None]).clip(0, 255).astype(np.uint8)
    canvas.put(np.einsum("ij,ijk->ik", weight, points[triangles[chosen]]), colors)
    size = np.ptp(points, axis=0).max()
    for name, color in leaves or ():
        if name + "leaf_points" in arrays:
            canvas.put(dense(arrays[name + "leaf_points"], arrays[name + "leaf_starts"].ravel(), 1 / view.scale),
                       np.array(color, np.uint8), 0.006 * size)
    marks = arrays.get(prefix + "singularities", np.zeros((0, 4)))
    for is_pole, color in ((False, (30, 60, 220)), (True, (250, 200, 0))):
        here = marks[(marks[:, 0] > 0) == is_pole]
        if len(here):
            canvas.put(here[:, 1:], np.array(color, np.uint8), size if is_pole else 0.02 * size, 6 if is_pole else 4)
    return canvas.png()


def dense(points, starts, step):
    """Points along polylines, closer than a pixel."""
    a, b = points[:-1], points[1:]
    joined = np.ones(len(a), bool)
    joined[[s - 1 for s in starts if 0 < s <= len(a)]] = False
    a, b = a[joined], b[joined]
    count = np.minimum(np.ceil(np.linalg.norm(b - a, axis=1) / (0.7 * step)).astype(int) + 1, 400)
    index = np.repeat(np.arange(len(a)), count)
    t = (np.arange(len(index)) - np.repeat(np.cumsum(count) - count, count)) / np.repeat(count, count)
    return a[index] + t[:, None] * (b - a)[index]


def measure(run):
    """Pictures as files, those of the gallery as long as there is time."""
    wanted = [("levels", curves.chosen(run, "kitten_29k"), ("--levels",))]
    if path := shapes.find("pegasus_42k_remesh"):
        wanted += [("failure", path, ("--paper", "--ratio", 0.75)), ("cure", path, ("--ratio", 0.75))]
    large = shapes.find("master-cylinder_1260k_remesh")
    wanted += [("large", large, ())] if large else []
    wanted += [(f"gallery_{path.stem}", path, ()) for _, path in paper_times.stand_ins(run)
               if path != large and (not run.quick or path.stat().st_size < 2e7)]
    rows = []
    for name, path, words in wanted:
        arrays = run.work / f"picture_{name}.bin"
        here = run.rows(f"picture-{name}", run.program("bench_pictures", path, arrays, *words), 120)
        if here and here[0]["row"] == "picture" and arrays.exists() and run.has_time(0.5):
            rows += [dict(here[0], picture=name, **image) for image in images(run, name, read_arrays(arrays), here[0])]
    return rows


def images(run, name, arrays, row):
    """Draws the pictures of a file of arrays; yields their group, file and caption."""
    def save(group, part, png, caption):
        path = run.work / f"picture_{part}.png"
        path.write_bytes(png)
        return {"group": group, "file": str(path), "caption": caption}
    if name == "failure":
        yield save("poles", name, draw(arrays), f"Figure 16: the method as printed, {row['poles']} pole(s), in yellow "
                   "on top of the surface; zeros are blue.")
    elif name == "cure":
        yield save("poles", name, draw(arrays), f"The same hierarchy and loops with the default method: {row['poles']} "
                   "poles.")
    elif name == "large":
        yield save("large", name, draw(arrays, stripes=12, count=3_000_000), "Figure 15: the parameterization of a "
                   f"mesh with {1.5e-6 * len(arrays['triangles']):.1f} million edges.")
    elif name != "levels":
        yield save("gallery", name, draw(arrays), f"{row['mesh']}, {row['loops']} loops")
    else:
        view = View(np.array(arrays["positions"]))
        if "initial_leaf_points" in arrays:
            yield save("levels", "initial", draw(arrays, view=view, stripes=1e-9, leaves=[("initial_", (200, 0, 0))]),
                       "Figure 3: leaves of the initial foliation: every leaf runs within its loop.")
        found = [int(key.split("_")[0]) for key in arrays if key[0].isdigit() and key.endswith("_positions")]
        for level in sorted(found, reverse=True):
            prefix = f"{level}_"
            yield save("levels", f"level_{level}", draw(arrays, prefix, view, edges=level > 0,
                                                        leaves=[(prefix, (200, 0, 0))]),
                       f"Figures 4 and 5: level {level}, {len(arrays[prefix + 'positions']):,} vertices: the harmonic "
                       "foliation of this level, its critical leaves and level sets.")


def write(document, rows):
    document.heading("Figures 3, 4, 5, 11, 15 and 16: pictures")
    for group, words in (("levels", "Foliations on the levels of a hierarchy."), ("poles", "Poles, and without them."),
                         ("large", "A large mesh; stripes of the function u."),
                         ("gallery", "Figure 11: shapes of Table 1; stripes of the function u, zeros blue.")):
        chosen = [row for row in rows if row["row"] == "picture" and row["group"] == group]
        if chosen:
            document.text(words)
            document.pictures([(pathlib.Path(row["file"]).stem, pathlib.Path(row["file"]).read_bytes(), row["caption"])
                               for row in chosen])
    poles = {row["picture"]: row["poles"] for row in rows if row.get("group") == "poles"}
    if len(poles) == 2:
        document.goal(poles["cure"] == 0 < poles["failure"], f"Figure 16 on pegasus: {poles['failure']} poles as "
                      f"printed, {poles['cure']} with the default method.")
