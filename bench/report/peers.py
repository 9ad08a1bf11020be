"""One linear solve by other libraries beside the whole job of hmf; charts by xatlas beside hmf_atlas.

    python -m report.peers PEER MESH.obj     one solve, as a row

One linear solve is the cotangent Laplacian of the mesh to a relative residual of 1e-8: the least that any method for
such functions has to do.  All libraries run with their defaults, with conjugate gradients where they offer it.  One
diagonal entry is doubled, which makes the matrix definite; the right-hand side is the mass matrix times a coordinate
less its mean.  Setup and solving are processor time; reading, filling the matrix and finding neighbors are not counted.
The residual is computed here.
"""
import importlib.metadata
import json
import pathlib
import statistics
import sys
import time

from . import jobs, shapes
from .document import spread
from .runs import of

TOLERANCE = 1e-8
LINEAR = {  # what it is, package
    "gravo_mg": ("Gravo MG, geometric multigrid", "gravomg"),
    "pyamg_sa": ("PyAMG, smoothed aggregation + CG", "pyamg"),
    "pyamg_rs": ("PyAMG, Ruge-Stueben + CG", "pyamg"),
    "boomer_amg": ("hypre BoomerAMG by PETSc + CG", "petsc4py"),
    "gamg": ("PETSc GAMG + CG", "petsc4py"),
    "scipy_lu": ("SciPy SuperLU", "scipy"),
}
# Gravo MG needs numpy 1, PETSc of Debian its own Python.
BUILD = pathlib.Path(__file__).parents[2] / "build"
PYTHONS = {"gravomg": BUILD / "bench-python-numpy1/bin/python", "petsc4py": pathlib.Path("/usr/bin/python3")}
DEBIAN_PETSC = sorted(pathlib.Path("/usr/lib/petscdir").glob("*/*-real/lib/python3/dist-packages"))


def laplacian(points, faces):
    """Cotangent Laplacian and mass matrix (a third of the area of the triangles around)."""
    import numpy as np
    from scipy import sparse
    n, rows, columns, weights = len(points), [], [], []
    mass = np.zeros(n)
    for corner in range(3):
        i, j, k = faces[:, corner], faces[:, (corner + 1) % 3], faces[:, (corner + 2) % 3]
        e, f = points[j] - points[i], points[k] - points[i]
        area = np.linalg.norm(np.cross(e, f), axis=1)
        cotangent = np.einsum("ij,ij->i", e, f) / np.maximum(area, 1e-300) / 2
        rows += [j, k]
        columns += [k, j]
        weights += [cotangent, cotangent]
        np.add.at(mass, i, area / 6)
    ends = (np.concatenate(rows), np.concatenate(columns))
    off = sparse.coo_matrix((np.concatenate(weights), ends), shape=(n, n)).tocsr()
    diagonal = np.asarray(off.sum(axis=1)).ravel()
    diagonal[0] *= 2
    return (sparse.diags(diagonal) - off).tocsr(), mass


def timed(setup, solve):
    start = time.process_time()
    solver = setup()
    between = time.process_time()
    x = solve(solver)
    return x, between - start, time.process_time() - between


def solve_gravo_mg(points, faces, mass, a, b):
    import gravomg
    from scipy import sparse
    points = gravomg.normalize_area(points, faces)
    neighbors = gravomg.neighbors_from_stiffness(a.tocsc())
    mass, a = sparse.csr_matrix(sparse.diags(mass)), sparse.csr_matrix(a)
    return timed(lambda: gravomg.MultigridSolver(points, neighbors, mass, tolerance=TOLERANCE, max_iter=2000),
                 lambda solver: solver.solve(a, b.reshape(-1, 1)).ravel())


def solve_pyamg_sa(points, faces, mass, a, b):
    import pyamg
    return timed(lambda: pyamg.smoothed_aggregation_solver(a, symmetry="symmetric"),
                 lambda solver: solver.solve(b, tol=TOLERANCE, accel="cg", maxiter=2000))


def solve_pyamg_rs(points, faces, mass, a, b):
    import pyamg
    return timed(lambda: pyamg.ruge_stuben_solver(a),
                 lambda solver: solver.solve(b, tol=TOLERANCE, accel="cg", maxiter=2000))


def solve_scipy_lu(points, faces, mass, a, b):
    from scipy.sparse import linalg
    return timed(lambda: linalg.splu(a.tocsc()), lambda solver: solver.solve(b))


def solve_petsc(options, a, b):
    import numpy as np
    import petsc4py
    petsc4py.init(options)
    from petsc4py import PETSc
    matrix = PETSc.Mat().createAIJ(size=a.shape, csr=(a.indptr.astype(np.int32), a.indices.astype(np.int32), a.data))
    matrix.assemble()
    right, x = matrix.createVecs()
    right.setArray(b)
    solver = PETSc.KSP().create()
    solver.setOperators(matrix)
    solver.setType("cg")
    solver.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
    solver.setTolerances(rtol=TOLERANCE, max_it=2000)
    solver.setFromOptions()
    return timed(lambda: solver.setUp() or solver, lambda ready: ready.solve(right, x) or x.getArray())


def solve_boomer_amg(points, faces, mass, a, b):
    return solve_petsc(["-pc_type", "hypre", "-pc_hypre_type", "boomeramg"], a, b)


def solve_gamg(points, faces, mass, a, b):
    return solve_petsc(["-pc_type", "gamg"], a, b)


def linear(peer, path):
    import numpy as np
    points, faces = shapes.read_obj(path)
    a, mass = laplacian(points, faces)
    a.sort_indices()
    b = mass * (points[:, 0] - np.average(points[:, 0], weights=mass))
    x, setup, solving = globals()["solve_" + peer](points, faces.astype(np.int32), mass, a, b)
    return {"setup": setup, "solve": solving, "residual": float(np.linalg.norm(b - a @ x) / np.linalg.norm(b))}


def charts(path):
    """xatlas with its defaults, on one thread."""
    import numpy as np
    import xatlas
    points, faces = shapes.read_obj(path)
    start = time.process_time()
    mapping, index, uv = xatlas.parametrize(points.astype(np.float32), faces.astype(np.uint32))
    seconds = time.process_time() - start
    p, q = uv[index].astype(float), points[mapping][index]
    flat = np.abs(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])) / 2
    area = np.linalg.norm(np.cross(q[:, 1] - q[:, 0], q[:, 2] - q[:, 0]), axis=1) / 2
    seam = len(np.unique(shapes.sides(index), axis=0)) - len(np.unique(shapes.sides(faces), axis=0))
    good = (flat > 1e-14) & (area > 0)
    scale = np.log(np.sqrt(flat[good] / area[good]))
    weights = area[good] / area[good].sum()
    mean = (weights * scale).sum()
    return {"seconds": seconds, "charts": int(components(index)), "used_area": float(flat.sum()),
            "seam_edges": seam, "unevenness": float(np.sqrt((weights * (scale - mean)**2).sum()))}


def components(triangles):
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components
    edges = shapes.sides(triangles)
    n = triangles.max() + 1
    return connected_components(coo_matrix((edges[:, 0] * 0 + 1, edges.T), shape=(n, n)), directed=False)[0]


def main(peer, path):
    package = "xatlas" if peer == "xatlas" else LINEAR[peer][1]
    if package == "petsc4py" and DEBIAN_PETSC:
        sys.path.insert(0, str(DEBIAN_PETSC[-1]))
    row = charts(path) if peer == "xatlas" else linear(peer, path)
    try:
        version = importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        version = getattr(sys.modules[package], "__version__", "unknown")
    print(json.dumps({"row": "peer", "mesh": pathlib.Path(path).stem, "peer": peer, "version": version, **row}))


def measure(run):
    rows = []
    repetitions = 3
    measured = jobs.meshes(run)[:2] if run.quick else jobs.meshes(run)
    for repetition in range(repetitions):
        for name, path in measured:
            found = run.rows(f"peer-hmf-{name}-{repetition}", run.program("bench_job", "--cholmod", path))
            rows += [dict(row, repetition=repetition) for row in found]
            for peer, (_, package) in LINEAR.items():
                if peer == "scipy_lu" and (run.quick or path.stat().st_size > 3e7):
                    continue
                command = run.script("peers", peer, path)
                if PYTHONS.get(package, BUILD / "none").exists():
                    command[0] = str(PYTHONS[package])
                found = run.rows(f"peer-{peer}-{name}-{repetition}", command, 120 if run.quick else 400)
                rows += [dict(row, repetition=repetition, peer=peer) for row in found]
                if of(found, "failure"):
                    break_peer(rows, peer)
    for name, path in measured[:1] if run.quick else measured[:2]:
        found = run.rows(f"peer-xatlas-{name}", run.script("peers", "xatlas", path), 90 if run.quick else 900)
        rows += [dict(row, peer="xatlas") for row in found]
        rows += run.rows(f"peer-atlas-{name}", run.program("bench_job", "--applications", path), 200)
    return rows


def break_peer(rows, peer):
    """Keeps one failure of a peer, not one for each repetition."""
    seen = [row for row in rows if row["row"] == "failure" and row.get("peer") == peer]
    for row in seen[1:]:
        rows.remove(row)


def write(document, rows):
    document.heading("Peers")
    document.text("One linear solve of the cotangent Laplacian by other libraries beside the whole nonlinear job of "
                  "hmf, both to 1e-8; processor seconds of one thread. Ratios are taken within one repetition. A basis "
                  "of harmonic 1-forms, the usual basis of global parameterization, is one factorization and a solve for "
                  "each of 2 * genus forms; its integer start is not counted.")
    hmf = {(row["mesh"], row["repetition"]): row for row in of(rows, "job") if "repetition" in row}
    table, ratios = [], []
    for mesh in dict.fromkeys(key[0] for key in hmf):
        runs = [row for key, row in hmf.items() if key[0] == mesh]
        table.append({"mesh": mesh, "program": "hmf, whole job", "all": spread([row["job"] for row in runs]),
                      "residual": runs[0]["residual"]})
        cholmod = [row for row in runs if row.get("cholmod")]
        if cholmod:
            table.append({"mesh": mesh, "program": "CHOLMOD, METIS", "setup": statistics.median(
                row["cholmod_factor"] for row in cholmod), "solve": statistics.median(
                    row["cholmod_solve"] for row in cholmod), "all": spread([row["cholmod"] for row in cholmod]),
                    "ratio": spread([row["job"] / row["cholmod"] for row in cholmod])})
            forms = [row["cholmod_factor"] + 2 * row["genus"] * row["cholmod_solve"] for row in cholmod]
            table.append({"mesh": mesh, "program": f"CHOLMOD, {2 * cholmod[0]['genus']} harmonic 1-forms",
                          "all": spread(forms), "ratio": spread([row["job"] / t for row, t in zip(cholmod, forms)])})
        for peer, (what, _) in LINEAR.items():
            same = [row for row in of(rows, "peer") if (row["mesh"], row["peer"]) == (mesh, peer)]
            if not same:
                continue
            total = [row["setup"] + row["solve"] for row in same]
            ratio = [hmf[mesh, row["repetition"]]["job"] / t for row, t in zip(same, total)
                     if (mesh, row["repetition"]) in hmf]
            ratios.append((statistics.median(ratio) if ratio else 0, f"{what} on {mesh}"))
            table.append({"mesh": mesh, "program": what, "version": same[0]["version"],
                          "setup": statistics.median(row["setup"] for row in same),
                          "solve": statistics.median(row["solve"] for row in same), "all": spread(total),
                          "ratio": spread(ratio), "residual": max(row["residual"] for row in same)})
    document.table("peers", [("mesh", "mesh"), ("program", "program"), ("version", "version"), ("setup s", "setup"),
                             ("solve s", "solve"), ("both s", "all"), ("job of hmf / both", "ratio"),
                             ("residual", "residual")], table)
    slower = [f"{name} ({ratio:.2f})" for ratio, name in ratios if ratio > 1]
    if ratios:
        document.goal(not slower, "One linear solve is faster than the whole job of hmf with " + ", ".join(slower) + "."
                      if slower else "The whole job is faster than one linear solve by every peer measured.")
    atlas(document, rows)
    missing = sorted({f"{row['peer']} ({row['what']})" for row in of(rows, "failure") if "peer" in row})
    if missing:
        document.text("Not measured, missing or failed: " + "; ".join(missing) + ".")


def atlas(document, rows):
    table = []
    for row in of(rows, "peer"):
        if row["peer"] == "xatlas":
            table.append({"mesh": row["mesh"], "program": f"xatlas {row['version']}", **{key: row[key] for key in (
                "seconds", "charts", "used_area", "unevenness")}})
    for row in of(rows, "applications"):
        table.append({"mesh": row["mesh"], "program": "hmf_atlas, after the solve", "seconds": row["atlas"],
                      "charts": row.get("charts"), "used_area": row.get("used_area"),
                      "unevenness": row.get("unevenness"), "solve": row["solve"]})
    if table:
        document.text("Charts in the unit square, defaults of both programs. Unevenness is the standard deviation of "
                      "the logarithm of the scale over the surface: 0 for equal areas.")
        document.table("atlases", [
            ("mesh", "mesh"), ("program", "program"), ("seconds", "seconds"), ("charts", "charts"),
            ("used area", "used_area"), ("unevenness", "unevenness")],
                       sorted(table, key=lambda line: line["mesh"]))


if __name__ == "__main__":
    main(*sys.argv[1:])
