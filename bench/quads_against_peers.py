#!/usr/bin/env python3
"""Quad meshes of hmf beside QuadriFlow and Instant Meshes: quads_against_peers.py HMF [--count N] [--pictures FOLDER] MESH.obj ...

pip install numpy scipy libigl pillow pyQuadriFlow pyinstantmeshes   (a peer that is not installed is left out)

Prints a table in Markdown, a row for each mesh and program, and with --pictures writes one PNG for each mesh, programs side
by side.  Closed triangle meshes of one component.  Columns:

  quads        their number
  sound        closed, oriented, manifold, one component, the genus of the input, four corners each
  irregular    vertices with another number of edges than 4
  inverted     quads with a corner of 180 degrees or more, seen along the cross product of the diagonals, and those for which
               that is opposite to the normals of the input at all of 8 points near the middle
  aspect       longest / shortest side of a quad, 95 % quantile
  angle        degrees by which a corner is off 90, 95 % quantile
  spread       area of the quads, 95 % quantile / 5 % quantile
  distance     greatest distance of the input (vertices, and 50000 points by area) from the quads, % of the diagonal
  covered      area of the quads / area of the input
  sharp        share of the length of edges sharper than 40 degrees that a side of a quad follows: a point of one lies within
               a quarter of the mean side, and the nearest such side is within 15 degrees of it; - without such edges
  seconds      processor time, of hmf with reading and writing the files
"""
import argparse
import os
import resource
import subprocess
import tempfile
import time

import igl
import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

SHARP, FOLLOWS = np.radians(40), np.cos(np.radians(15))


def read_obj(path):
    points, faces = [], []
    with open(path) as lines:
        for line in lines:
            if line.startswith("v "): points.append(line.split()[1:4])
            elif line.startswith("f "): faces.append([int(word.partition("/")[0]) - 1 for word in line.split()[1:]])
    return np.array(points, float), np.array(faces, np.int64)


def norm(x):
    return np.sqrt((x * x).sum(-1))


def half_edges(faces):
    return np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2)


def euler(faces, sides):
    return len(np.unique(faces)) - len(np.unique(np.sort(sides, axis=1), axis=0)) + len(faces)


def is_sound(quads, chi):
    if (np.diff(np.sort(quads, axis=1), axis=1) == 0).any(): return False
    sides = half_edges(quads)
    there = {(a, b): i for i, (a, b) in enumerate(sides.tolist())}
    if len(there) != len(sides) or any(a == b or (b, a) not in there for a, b in there): return False
    if euler(quads, sides) != chi: return False
    # Corners joined around their vertices: as many classes as vertices; quads joined over their sides: one class.
    twin = np.array([there[(b, a)] for a, b in sides.tolist()])
    corner = np.arange(len(sides))
    after = twin // 4 * 4 + (twin + 1) % 4
    fans = connected_components(coo_matrix((corner * 0 + 1, (corner, after)), shape=(len(corner),) * 2), directed=False)[0]
    parts = connected_components(coo_matrix((corner * 0 + 1, (corner // 4, twin // 4)), shape=(len(quads),) * 2), directed=False)[0]
    return fans == len(np.unique(quads)) and parts == 1


def figures(points, triangles, vertices, quads):
    corner = vertices[quads]
    ahead, back = np.roll(corner, -1, axis=1) - corner, np.roll(corner, 1, axis=1) - corner
    sides, normal = norm(ahead), np.cross(corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1])
    area = norm(normal) / 2
    cosine = (ahead * back).sum(2) / np.maximum(norm(ahead) * norm(back), 1e-300)
    ends = np.cross(points[triangles[:, 1]] - points[triangles[:, 0]], points[triangles[:, 2]] - points[triangles[:, 0]])
    areas = norm(ends) / 2
    degree = np.bincount(quads.ravel())
    random = np.random.default_rng(1)
    chosen = random.choice(len(triangles), 50000, p=areas / areas.sum())
    weights = random.dirichlet([1, 1, 1], len(chosen))
    samples = np.concatenate([points[np.unique(triangles)], (points[triangles[chosen]] * weights[:, :, None]).sum(1)])
    upright = ends / np.maximum(2 * areas, 1e-300)[:, None]
    near = cKDTree(samples[-len(chosen):]).query(corner.mean(1), k=8)[1]
    agree = (upright[chosen][near] * (normal / np.maximum(2 * area, 1e-300)[:, None])[:, None]).sum(2).max(1) > 0
    is_inverted = ((np.cross(ahead, back) * normal[:, None]).sum(2) <= 0).any(1) | ~agree
    short = norm(corner[:, 0] - corner[:, 2]) > norm(corner[:, 1] - corner[:, 3])
    turned = np.where(short[:, None], np.roll(quads, -1, axis=1), quads)
    halves = np.concatenate([turned[:, [0, 1, 2]], turned[:, [0, 2, 3]]])
    distance = np.sqrt(igl.point_mesh_squared_distance(samples, vertices, halves)[0].max())
    return {
        "quads": len(quads),
        "sound": "yes" if is_sound(quads, euler(triangles, half_edges(triangles))) else "no",
        "irregular": int((degree[degree > 0] != 4).sum()),
        "inverted": int(is_inverted.sum()),
        "aspect": np.quantile(sides.max(1) / np.maximum(sides.min(1), 1e-300), 0.95),
        "angle": np.quantile(np.abs(np.degrees(np.arccos(np.clip(cosine, -1, 1))) - 90), 0.95),
        "spread": np.quantile(area, 0.95) / max(np.quantile(area, 0.05), 1e-300),
        "distance": 100 * distance / norm(np.ptp(points, axis=0)),
        "covered": area.sum() / areas.sum(),
        "sharp": sharp_share(points, triangles, upright, vertices, quads, sides.mean()),
    }


def sharp_share(points, triangles, normal, vertices, quads, mean):
    sides = np.sort(half_edges(triangles), axis=1)
    order = np.lexsort(sides.T)
    face = order // 3
    turn = np.arccos(np.clip((normal[face[::2]] * normal[face[1::2]]).sum(1), -1, 1))
    edges = sides[order[::2]][turn > SHARP]
    if len(edges) < 50: return None
    lines = np.unique(np.sort(half_edges(quads), axis=1), axis=0)
    a, b = vertices[lines[:, 0]], vertices[lines[:, 1]]
    t = (np.arange(5) + 0.5) / 5
    on = (a[:, None] + t[None, :, None] * (b - a)[:, None]).reshape(-1, 3)
    far, nearest = cKDTree(on).query(points[edges].mean(1))
    along, side = points[edges[:, 1]] - points[edges[:, 0]], (b - a)[nearest // 5]
    length = norm(along)
    follows = np.abs((along * side).sum(1)) >= FOLLOWS * length * norm(side)
    return float((length * (follows & (far < mean / 4))).sum() / length.sum())


def by_hmf(tool):
    def make(path, points, triangles, count):
        with tempfile.TemporaryDirectory() as folder:
            out = os.path.join(folder, "quads.obj")
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            subprocess.run([tool, "quads", path, out, "--count", str(count)], check=True, stdout=subprocess.DEVNULL)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            return read_obj(out) + (after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime,)
    return make


def by_quadriflow(path, points, triangles, count):
    from pyQuadriFlow.pyQuadriFlow import pyquadriflow
    begin = time.process_time()
    made = pyquadriflow(count, 0, points.tolist(), triangles.tolist(), False, False, False, False, False)
    return np.array(made["vertices"], float), np.array(made["faces"], np.int64), time.process_time() - begin


def by_instant_meshes(path, points, triangles, count):
    import pyinstantmeshes
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "quads.obj")
        # It tells what it does on the standard output of the process.
        kept, nothing = os.dup(1), os.open(os.devnull, os.O_WRONLY)
        os.dup2(nothing, 1)
        begin = time.process_time()
        try:  # pure quads split each face in four
            pyinstantmeshes.remesh_file(path, out, target_face_count=count // 4, pure_quad=True, deterministic=True)
        finally:
            os.dup2(kept, 1)
        return read_obj(out) + (time.process_time() - begin,)


def picture(points, made, size=700):
    """Quads with their sides, seen along the direction in which the shape is widest; nearer ones over farther ones."""
    from PIL import Image, ImageDraw
    middle = points.mean(0)
    axes = np.linalg.svd(points[:: max(1, len(points) // 5000)] - middle, full_matrices=False)[2]
    turn = np.stack([axes[0], axes[1], np.cross(axes[0], axes[1])])
    flat = (points - middle) @ turn.T
    scale = 2 * 0.94 * size / np.ptp(flat[:, :2], axis=0).max()
    tiles = []
    for vertices, quads in made:
        place = (vertices - middle) @ turn.T
        p = place[quads]
        normal = np.cross(p[:, 2] - p[:, 0], p[:, 3] - p[:, 1])
        light = normal @ [0.3, 0.4, 0.87] / np.maximum(norm(normal), 1e-300)
        tile = Image.new("RGB", (2 * size, 2 * size), "white")
        draw = ImageDraw.Draw(tile)
        center = (flat[:, :2].max(0) + flat[:, :2].min(0)) / 2
        for q in np.argsort(p[:, :, 2].mean(1)):
            if normal[q, 2] <= 0: continue
            shade = int(120 + 130 * max(light[q], 0))
            at = [(size + scale * (x - center[0]), size - scale * (y - center[1])) for x, y in p[q, :, :2]]
            draw.polygon(at, fill=(shade, shade, min(255, shade + 8)), outline=(40, 40, 60))
        tiles.append(tile.resize((size, size), Image.LANCZOS))
    whole = Image.new("RGB", (size * len(tiles), size), "white")
    for k, tile in enumerate(tiles): whole.paste(tile, (k * size, 0))
    return whole


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("hmf")
    parser.add_argument("meshes", nargs="+")
    parser.add_argument("--count", type=int, default=5000)
    parser.add_argument("--pictures")
    given = parser.parse_args()
    programs = {"hmf": by_hmf(given.hmf), "QuadriFlow": by_quadriflow, "Instant Meshes": by_instant_meshes}
    heads = "quads sound irregular inverted aspect angle spread distance covered sharp seconds".split()
    print("| mesh | program | " + " | ".join(heads) + " |\n|---|---|" + "--:|" * len(heads))
    for path in given.meshes:
        points, triangles = read_obj(path)
        made = []
        for name, program in list(programs.items()):
            try:
                vertices, quads, seconds = program(path, points, triangles, given.count)
            except ImportError as missing:
                print("(%s is left out: %s)" % (name, missing))
                del programs[name]
                continue
            except subprocess.CalledProcessError:
                print("| %s | %s | failed |" % (os.path.basename(path)[:-4], name))
                continue
            found = figures(points, triangles, vertices, quads)
            found["seconds"] = seconds
            made.append((vertices, quads))
            cells = ["-" if x is None else "%.3f" % x if h == "covered" else "%.2f" % x if isinstance(x, float) else str(x)
                     for h, x in ((h, found[h]) for h in heads)]
            print("| %s | %s | %s |" % (os.path.basename(path)[:-4], name, " | ".join(cells)), flush=True)
        if given.pictures:
            os.makedirs(given.pictures, exist_ok=True)
            picture(points, made).save(os.path.join(given.pictures, os.path.basename(path)[:-4] + ".png"))


if __name__ == "__main__":
    main()
