"""Quad meshes beside QuadriFlow and Instant Meshes.

    python -m report.quads PROGRAM BENCH_JOB COUNT MESH.obj     one mesh by one program, as a row
"""
import importlib.metadata
import json
import os
import subprocess
import sys
import tempfile
import time

import numpy as np

from . import paper_times, shapes
from .runs import of
from .shapes import read_obj

SHARP, FOLLOWS = np.radians(40), np.cos(np.radians(15))


def norm(x):
    return np.sqrt((x * x).sum(-1))


def half_edges(faces):
    return np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2)


def euler(faces, sides):
    return len(np.unique(faces)) - len(np.unique(np.sort(sides, axis=1), axis=0)) + len(faces)


def is_sound(quads, chi):
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components
    if (np.diff(np.sort(quads, axis=1), axis=1) == 0).any(): return False
    sides = half_edges(quads)
    there = {(a, b): i for i, (a, b) in enumerate(sides.tolist())}
    if len(there) != len(sides) or any(a == b or (b, a) not in there for a, b in there): return False
    if euler(quads, sides) != chi: return False
    # Corners joined around their vertices: as many classes as vertices; quads joined over their sides: one class.
    twin = np.array([there[(b, a)] for a, b in sides.tolist()])
    corner = np.arange(len(sides))
    after = twin // 4 * 4 + (twin + 1) % 4

    def classes(number, one, two):
        return connected_components(coo_matrix((one * 0 + 1, (one, two)), shape=(number, number)), directed=False)[0]
    fans, parts = classes(len(corner), corner, after), classes(len(quads), corner // 4, twin // 4)
    return fans == len(np.unique(quads)) and parts == 1


def figures(points, triangles, vertices, quads):
    import igl
    from scipy.spatial import cKDTree
    corner = vertices[quads]
    ahead, back = np.roll(corner, -1, axis=1) - corner, np.roll(corner, 1, axis=1) - corner
    sides, normal = norm(ahead), np.cross(corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1])
    area = norm(normal) / 2
    cosine = (ahead * back).sum(2) / np.maximum(norm(ahead) * norm(back), 1e-300)
    a, b, c = points[triangles].transpose(1, 0, 2)
    ends = np.cross(b - a, c - a)
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
    from scipy.spatial import cKDTree
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


def by_hmf(program):
    def make(path, points, triangles, count):
        with tempfile.TemporaryDirectory() as folder:
            out = os.path.join(folder, "quads.obj")
            done = subprocess.run([program, "--quads", out, "--count", str(count), path], check=True,
                                  stdout=subprocess.PIPE, text=True)
            rows = {row["row"]: row for row in map(json.loads, done.stdout.splitlines())}
            if "quads" not in rows:
                raise RuntimeError(rows["failure"]["what"])
            return read_obj(out) + (rows["quads"]["seconds"],)
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


HEADS = ("quads", "sound", "irregular", "inverted", "aspect", "angle", "spread", "distance", "covered", "sharp",
         "seconds")
PACKAGES = {"QuadriFlow": "pyQuadriFlow", "Instant Meshes": "pyinstantmeshes"}


def main(name, program, count, path):
    points, triangles = read_obj(path)
    make = {"hmf": by_hmf(program), "QuadriFlow": by_quadriflow, "Instant Meshes": by_instant_meshes}[name]
    vertices, quads, seconds = make(path, points, triangles, int(count))
    row = {"row": "quads", "mesh": os.path.basename(path)[:-4], "program": name, "seconds": seconds,
           "version": importlib.metadata.version(PACKAGES[name]) if name in PACKAGES else "this"}
    print(json.dumps({**row, **{key: value.item() if hasattr(value, "item") else value
                                for key, value in figures(points, triangles, vertices, quads).items()}}))


SHAPES = ("bob_11k", "kitten_29k", "rocker-arm_20k", "eight_11k", "joint_42k", "holes3_29k", "master-cylinder_27k",
          "fertility_28k", "botijo_24k", "pegasus_42k_remesh", "dancing-children_24k", "casting_37k", "spot_5.9k",
          "cow_5.5k", "horse_40k")


def measure(run):
    paths = [path for name in SHAPES if (path := shapes.find(name))] or [
        path for _, path in paper_times.stand_ins(run)]
    if run.quick:
        paths = paths[:2]
    rows = []
    for path in paths:
        for name in ("hmf", "QuadriFlow", "Instant Meshes"):
            rows += [dict(row, program=name) for row in run.rows(f"quads-{name}-{path.stem}", run.script(
                "quads", name, run.programs / "bench_job", 5000, path), 60)]
    return rows


def write(document, rows):
    document.heading("Quads")
    document.text("5000 quads requested, defaults of every program, no mesh tuned by hand. sound: closed, oriented, "
                  "manifold, the genus of the input, four corners each. irregular: vertices with another number of "
                  "edges than 4. inverted: quads with a corner of 180 degrees or more, or opposite to the surface. "
                  "aspect: longest / shortest side, 95 % quantile. angle: degrees by which a corner is off 90, 95 % "
                  "quantile. spread: area, 95 % / 5 % quantile. distance: greatest distance of the input from the "
                  "quads, % of the diagonal. sharp: share of the length of edges sharper than 40 degrees that sides of "
                  "quads follow. seconds: processor time, of hmf with the even design, build and solve.")
    document.table("quads", [("mesh", "mesh"), ("program", "program"), ("version", "version")]
                   + [(head, head) for head in HEADS], of(rows, "quads"))
    missing = sorted({f"{row.get('program')} on {row.get('mesh')} ({row.get('what')})" for row in of(rows, "failure")})
    if missing:
        document.text("Missing or failed: " + "; ".join(missing) + ".")
    ours = [row for row in of(rows, "quads") if row["program"] == "hmf"]
    if ours:
        bad = [row["mesh"] for row in ours if row["sound"] != "yes" or row["inverted"]]
        document.goal(not bad, "Quads of hmf are unsound or inverted on " + ", ".join(bad) + "." if bad
                      else f"All quad meshes of hmf are sound without inverted quads ({len(ours)} meshes).")


if __name__ == "__main__":
    main(*sys.argv[1:])
