"""Meshes of the runs: OBJ files of the folder HMF_MESHES, and generated families.

A mesh is a pair of arrays: points (n x 3) and triangles (m x 3).  All generated surfaces are closed, oriented and
connected.  The same seed gives the same mesh.
"""
import os
import pathlib

import numpy as np

# The 20 shapes of the paper's tables and the meshes that stand for them, nearest in size first.
PAPER_SHAPES = {
    "block": "block_60k_remesh", "bob": "bob_11k", "botijo": "botijo_207k_remesh", "bumpy-torus": "bumpy-torus_31k",
    "cad": None, "dtorus": "dtorus_126k_remesh", "eight": "eight_179k_remesh", "fertility": "fertility_60k",
    "genus": "genus3_254k_remesh", "holes3": "holes3_197k_remesh", "joint": "joint_77k_remesh",
    "kitten": "kitten_106k", "master-cylinder": "master-cylinder_1260k_remesh", "pegasus": "pegasus_42k_remesh",
    "rocker-arm": "rocker-arm_1.2k", "sculpt": "sculpture_121k_remesh", "torus": "torus_4.6k",
    "trefoil-knot": "trefoil-knot_280k_remesh", "trimstar": "trim-star_524k_remesh", "tube": None}
MEASURED_SHAPES = ("fertility_60k", "botijo_207k_remesh", "trim-star_524k_remesh", "master-cylinder_1260k_remesh")


def folder():
    """The folder HMF_MESHES, or None."""
    name = os.environ.get("HMF_MESHES", "")
    return pathlib.Path(name) if name and pathlib.Path(name).is_dir() else None


def corpus(most_bytes=1 << 40):
    """Paths of the meshes of the folder, by size."""
    paths = [path for path in folder().glob("*.obj") if path.stat().st_size <= most_bytes] if folder() else []
    return sorted(paths, key=lambda path: (path.stat().st_size, path.name))


def find(name):
    """The path of a mesh of the folders HMF_MESHES and HMF_SURFACES, or None."""
    folders = [os.environ.get(variable, "") for variable in ("HMF_MESHES", "HMF_SURFACES")]
    paths = [pathlib.Path(place) / f"{name}.obj" for place in folders if place and name]
    return next((path for path in paths if path.is_file()), None)


def write_obj(path, points, triangles):
    with open(path, "w") as file:
        file.writelines("v %.17g %.17g %.17g\n" % tuple(p) for p in points.tolist())
        file.writelines("f %d %d %d\n" % tuple(t) for t in (triangles + 1).tolist())


def read_obj(path):
    points, faces = [], []
    with open(path) as lines:
        for line in lines:
            if line.startswith("v "):
                points.append(line.split()[1:4])
            elif line.startswith("f "):
                faces.append([int(word.partition("/")[0]) - 1 for word in line.split()[1:]])
    return np.array(points, float), np.array(faces, np.int64)


# --- Families ------------------------------------------------------------------

def torus(around, across, radius=3.0):
    """A torus of revolution; every second row is shifted by a third of a side."""
    i, j = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    u, v = 2 * np.pi * (i + 0.3 * (j % 2)) / around, 2 * np.pi * j / across
    r = radius + np.cos(v)
    points = np.stack([r * np.cos(u), r * np.sin(u), np.sin(v)], -1).reshape(-1, 3)
    a, b = i * across + j, (i + 1) % around * across + j
    c, d = (i + 1) % around * across + (j + 1) % across, i * across + (j + 1) % across
    return points, np.concatenate([np.stack(t, -1).reshape(-1, 3) for t in ((a, b, c), (a, c, d))])


def surface_of_cubes(full):
    """The boundary of the cubes of a 3D array of truth values, each side divided into two triangles."""
    full = np.pad(full, 1)
    quads = []
    for axis in range(3):
        one, two = (axis + 1) % 3, (axis + 2) % 3
        for sign in (1, -1):
            cells = np.argwhere(full & ~np.roll(full, -sign, axis))
            corner = cells.copy()
            corner[:, axis] += sign > 0
            steps = np.eye(3, dtype=int)
            order = (0, steps[one], steps[one] + steps[two], steps[two])
            quads.append(np.stack([corner + step for step in (order if sign > 0 else order[::-1])], 1))
    quads = np.concatenate(quads)
    points, index = np.unique(quads.reshape(-1, 3), axis=0, return_inverse=True)
    index = index.reshape(-1, 4)
    return points.astype(float), np.concatenate([index[:, [0, 1, 2]], index[:, [0, 2, 3]]])


def plate(rows, columns):
    """A plate of cubes with rows x columns holes: the genus is their product."""
    full = np.ones((2 * rows + 1, 2 * columns + 1, 1), bool)
    full[1::2, 1::2] = False
    return surface_of_cubes(full)


def frame(size, seed):
    """Beams along random edges of a cubic lattice: one connected part with many handles."""
    random = np.random.default_rng(seed)
    n = 2 * size - 1
    full = np.zeros((n, n, n), bool)
    node, count = random.integers(0, size, 3), int(2.2 * size**3)
    full[tuple(2 * node)] = True
    for _ in range(count):
        axis, sign = random.integers(3), random.choice([-1, 1])
        after = node.copy()
        after[axis] += sign
        if not 0 <= after[axis] < size:
            continue
        full[tuple(node + after)] = full[tuple(2 * after)] = True
        node = after
    return smooth(*divide(*surface_of_cubes(full)), 4)


def blobs(resolution, seed, tori=3):
    """A level set of random tori, joined smoothly; marching tetrahedra, so many triangles are thin."""
    random = np.random.default_rng(seed)
    centers = np.cumsum(random.uniform(-0.55, 0.55, (tori, 3)), 0)
    centers -= centers.mean(0)
    axes = random.normal(size=(tori, 3))
    axes /= np.linalg.norm(axes, axis=1)[:, None]

    def value(x):
        total = 0
        for center, axis in zip(centers, axes):
            along = (x - center) @ axis
            away = np.sqrt(np.maximum(((x - center)**2).sum(-1) - along**2, 0))
            total = total + np.exp(-12 * (np.sqrt((away - 0.6)**2 + along**2) - 0.2))
        return np.log(total) + 1.234567e-4
    return largest_part(*level_set(value, resolution, np.abs(centers).max() + 1.05))


def level_set(value, resolution, half):
    """Marching tetrahedra on the cube from -half to half; inside, value is positive."""
    line = np.linspace(-half, half, resolution)
    grid = np.stack(np.meshgrid(line, line, line, indexing="ij"), -1).reshape(-1, 3)
    f = value(grid)
    i = np.arange(resolution - 1)
    cube = ((i[:, None, None] * resolution + i[:, None]) * resolution + i).ravel()
    step = [resolution**2, resolution, 1]
    triangles = []
    for a, b, c in ((0, 1, 2), (1, 2, 0), (2, 0, 1), (1, 0, 2), (0, 2, 1), (2, 1, 0)):
        even = (a, b, c) in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
        tets = cube[:, None] + np.cumsum([0, step[a], step[b], step[c]])
        triangles += [side if even else side[:, ::-1] for side in sides_of_tets(tets, f > 0)]
    ends = np.concatenate(triangles)  # m x 3 corners x 2 grid points
    ends = np.sort(ends, -1)
    keys, index = np.unique(ends.reshape(-1, 2), axis=0, return_inverse=True)
    t = f[keys[:, 0]] / (f[keys[:, 0]] - f[keys[:, 1]])
    points = grid[keys[:, 0]] + t[:, None] * (grid[keys[:, 1]] - grid[keys[:, 0]])
    return points, index.reshape(-1, 3)


def sides_of_tets(tets, inside):
    """Triangles between inside and outside, as pairs of grid points, of positively oriented tetrahedra."""
    signs = inside[tets]
    found = []
    for apex in range(4):
        b, c, d = [(1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1)][apex]
        for side in (True, False):
            chosen = tets[(signs[:, apex] == side) & (signs == side).sum(1).__eq__(1)]
            corners = [np.stack([chosen[:, apex], chosen[:, k]], -1) for k in (b, c, d)]
            found.append(np.stack(corners if side else corners[::-1], 1))
    for p, q, r, s in ((0, 1, 2, 3), (0, 2, 3, 1), (0, 3, 1, 2), (2, 3, 0, 1), (3, 1, 0, 2), (1, 2, 0, 3)):
        chosen = tets[signs[:, p] & signs[:, q] & ~signs[:, r] & ~signs[:, s]]
        quad = [np.stack([chosen[:, k], chosen[:, l]], -1) for k, l in ((p, r), (p, s), (q, s), (q, r))]
        found += [np.stack([quad[0], quad[1], quad[2]], 1), np.stack([quad[0], quad[2], quad[3]], 1)]
    return found


def largest_part(points, triangles):
    """The component with the most triangles, without unused points."""
    label = np.arange(len(points))
    while True:
        least = label[triangles].min(1)
        before = label.copy()
        for corner in range(3):
            np.minimum.at(label, triangles[:, corner], least)
        label = label[label]
        if (label == before).all():
            break
    parts, count = np.unique(label[triangles[:, 0]], return_counts=True)
    return compact(points, triangles[label[triangles[:, 0]] == parts[count.argmax()]])


def compact(points, triangles):
    used, index = np.unique(triangles, return_inverse=True)
    return points[used], index.reshape(-1, 3)


# --- Changes of a mesh -----------------------------------------------------------

def sides(triangles):
    """Sorted ends of the three sides of each triangle, 3 m x 2."""
    return np.sort(np.stack([triangles, np.roll(triangles, -1, 1)], -1).reshape(-1, 2), -1)


def divide(points, triangles):
    """Each triangle into four, at the midpoints of its sides."""
    edges, index = np.unique(sides(triangles), axis=0, return_inverse=True)
    m = index.reshape(-1, 3) + len(points)
    a, b, c = triangles.T
    x, y, z = m.T
    fine = np.concatenate([np.stack(t, -1) for t in ((a, x, z), (b, y, x), (c, z, y), (x, y, z))])
    return np.concatenate([points, points[edges].mean(1)]), fine


def smooth(points, triangles, rounds):
    """Each point towards the mean of its neighbors."""
    edges = np.unique(sides(triangles), axis=0)
    degree = np.bincount(edges.ravel(), minlength=len(points))[:, None]
    for _ in range(rounds):
        total = np.zeros_like(points)
        np.add.at(total, edges[:, 0], points[edges[:, 1]])
        np.add.at(total, edges[:, 1], points[edges[:, 0]])
        points = 0.5 * points + 0.5 * total / degree
    return points, triangles


def stretch(points, triangles, factor):
    return points * [1, 1, factor], triangles


def jitter(points, triangles, amount, seed):
    """Each point moves by up to amount times the mean length of a side."""
    edges = sides(triangles)
    mean = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1).mean()
    return points + np.random.default_rng(seed).uniform(-amount, amount, points.shape) * mean, triangles


def needles(points, triangles, share, thinness, seed):
    """New points in a share of the triangles, very near to a corner or to a side."""
    random = np.random.default_rng(seed)
    chosen = random.choice(len(triangles), max(1, int(share * len(triangles))), replace=False)
    weight = np.where(random.random((len(chosen), 1)) < 0.5, [[thinness, thinness, 1 - 2 * thinness]],
                      [[0.5, 0.5 - thinness, thinness]])
    new = np.einsum("ij,ijk->ik", weight, points[triangles[chosen]])
    index = len(points) + np.arange(len(chosen))
    a, b, c = triangles[chosen].T
    fans = np.concatenate([np.stack(t, -1) for t in ((a, b, index), (b, c, index), (c, a, index))])
    return np.concatenate([points, new]), np.concatenate([np.delete(triangles, chosen, 0), fans])


def random_flips(points, triangles, share, seed):
    """Flips a share of the edges whatever the angles, where no edge would be double."""
    random = np.random.default_rng(seed)
    faces = [list(map(int, t)) for t in triangles]
    where = {(t[s], t[(s + 1) % 3]): f for f, t in enumerate(faces) for s in range(3)}
    keys = list(where)
    for k in random.integers(0, len(keys), int(share * len(keys) / 2)):
        a, b = keys[k]
        if (a, b) not in where or (b, a) not in where:
            continue
        f, g = where[a, b], where[b, a]
        c, d = sum(faces[f]) - a - b, sum(faces[g]) - a - b
        if c == d or (c, d) in where or (d, c) in where:
            continue
        del where[a, b], where[b, a]
        faces[f], faces[g] = [c, a, d], [d, b, c]
        for face in (f, g):
            for s in range(3):
                where[faces[face][s], faces[face][(s + 1) % 3]] = face
    return points, np.array(faces)


# --- A thousand meshes -------------------------------------------------------------

BASES = {
    "torus": lambda seed: torus(24 + seed % 40, 10 + seed % 13, 1.3 + 0.1 * (seed % 20)),
    "plate": lambda seed: smooth(*divide(*plate(1 + seed % 5, 1 + seed % 7)), 2),
    "frame": lambda seed: frame(3 + seed % 3, seed),
    "blobs": lambda seed: blobs(24 + seed % 12, seed, 2 + seed % 4),
}
CHANGES = {
    "as_made": lambda mesh, seed: mesh,
    "stretched": lambda mesh, seed: stretch(*mesh, 10 ** (1 + seed % 3)),
    "jittered": lambda mesh, seed: jitter(*mesh, 0.3, seed),
    "needles": lambda mesh, seed: needles(*mesh, 0.2, 10.0 ** -(2 + seed % 5), seed),
    "flipped": lambda mesh, seed: random_flips(*mesh, 0.3, seed),
}


def survey_names(number):
    """Names of generated meshes, every combination in turn: base-change-seed."""
    combinations = [(base, change) for base in BASES for change in CHANGES]
    return ["%s-%s-%d" % (*combinations[k % len(combinations)], k // len(combinations)) for k in range(number)]


def survey_mesh(name):
    base, change, seed = name.split("-")
    return CHANGES[change](BASES[base](int(seed)), int(seed))
