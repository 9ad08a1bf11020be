#!/usr/bin/env python3
"""The whole nonlinear job of hmf beside one linear solve of others: linear_peers.py BENCH_PIPELINE [-r N] [--only NAME,...] MESH.obj ...

One linear solve is the cotangent Laplacian of the mesh, to a relative residual of 1e-8: the least that any method for such
functions has to do.  The job of hmf is build + loops + solve to 1e-8, as bench_pipeline measures it, which also gives CHOLMOD
(METIS order, BLAS with one thread).  Peers, each left out where it is not installed:

  gravo_mg       Gravo MG (pip install gravomg), a geometric multigrid made for surfaces
  pyamg_sa       PyAMG (pip install pyamg), smoothed aggregation, preconditioned conjugate gradients
  pyamg_rs       PyAMG, Ruge-Stueben, the same
  boomer_amg     hypre's BoomerAMG by PETSc (Debian: python3-petsc4py), preconditioned conjugate gradients
  gamg           PETSc's own multigrid, the same

Each solve is a process of its own with one thread; processor time of setup and of solving, without reading, filling the matrix,
or finding neighbors.  One diagonal entry is doubled, which makes the matrix definite; the right-hand side is the mass
matrix times a coordinate less its mean.  The residual in the table is computed here, not told by the peer.  Repetitions are
the outer loop; ratios are taken inside one, and the table has their medians.
"""
import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np
import scipy.sparse as sparse

TOLERANCE = 1e-8
PEERS = ["gravo_mg", "pyamg_sa", "pyamg_rs", "boomer_amg", "gamg"]
PETSC = "/usr/lib/petscdir/petsc3.18/x86_64-linux-gnu-real/lib/python3/dist-packages"


def read_obj(path):
    points, faces = [], []
    with open(path) as lines:
        for line in lines:
            if line.startswith("v "): points.append(line.split()[1:4])
            elif line.startswith("f "): faces.append([int(word.partition("/")[0]) - 1 for word in line.split()[1:4]])
    return np.array(points, float), np.array(faces, np.int32)


def laplacian(points, faces):
    """Cotangent Laplacian and mass matrix (a third of the area of the triangles around)."""
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
    off = sparse.coo_matrix((np.concatenate(weights), (np.concatenate(rows), np.concatenate(columns))), shape=(n, n)).tocsr()
    diagonal = np.asarray(off.sum(axis=1)).ravel()
    diagonal[0] *= 2
    return (sparse.diags(diagonal) - off).tocsr(), mass


def solve_gravo_mg(problem, a, b):
    import gravomg
    points = gravomg.normalize_area(problem["points"], problem["faces"])
    neighbors = gravomg.neighbors_from_stiffness(a.tocsc())
    mass = sparse.diags(problem["mass"]).tocsr()
    start = time.process_time()
    solver = gravomg.MultigridSolver(points, neighbors, mass, tolerance=TOLERANCE, max_iter=2000)
    between = time.process_time()
    x = solver.solve(a, b.reshape(-1, 1))
    return np.asarray(x).ravel(), between - start, time.process_time() - between


def solve_pyamg(make, a, b):
    start = time.process_time()
    solver = make(a)
    between = time.process_time()
    x = solver.solve(b, tol=TOLERANCE, accel="cg", maxiter=2000)
    return x, between - start, time.process_time() - between


def solve_pyamg_sa(problem, a, b):
    import pyamg
    return solve_pyamg(lambda a: pyamg.smoothed_aggregation_solver(a, symmetry="symmetric"), a, b)


def solve_pyamg_rs(problem, a, b):
    import pyamg
    return solve_pyamg(pyamg.ruge_stuben_solver, a, b)


def solve_petsc(options, a, b):
    sys.path.insert(0, PETSC)
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
    start = time.process_time()
    solver.setUp()
    between = time.process_time()
    solver.solve(right, x)
    return x.getArray(), between - start, time.process_time() - between


def solve_boomer_amg(problem, a, b):
    return solve_petsc(["-pc_type", "hypre", "-pc_hypre_type", "boomeramg"], a, b)


def solve_gamg(problem, a, b):
    return solve_petsc(["-pc_type", "gamg"], a, b)


def worker(peer, path):
    problem = np.load(path)
    a = sparse.csr_matrix((problem["data"], problem["indices"], problem["indptr"]))
    a.sort_indices()
    b = problem["mass"] * (problem["points"][:, 0] - np.average(problem["points"][:, 0], weights=problem["mass"]))
    x, setup, solving = globals()["solve_" + peer](problem, a, b)
    print(json.dumps({"setup": setup, "solve": solving, "residual": float(np.linalg.norm(b - a @ x) / np.linalg.norm(b))}))


def run_peer(peer, path, options):
    python = options.petsc_python if peer in ("boomer_amg", "gamg") else sys.executable
    one_thread = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", MKL_NUM_THREADS="1")
    done = subprocess.run([python, __file__, "--solve", peer, path], env=one_thread, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    lines = [line for line in done.stdout.decode(errors="replace").splitlines() if line.startswith("{")]
    if done.returncode or not lines:
        reason = (done.stderr.decode(errors="replace").strip().splitlines() or ["no result"])[-1]
        print(f"{peer} left out: {reason}", file=sys.stderr)
        return None
    return json.loads(lines[-1])


def run_pipeline(bench, mesh):
    text = subprocess.run([bench, "--cpu", "-r", "1", "--whitehead", "0", mesh], check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout.decode()
    cells, head = {}, []
    for line in text.splitlines():
        if not line.startswith("| ") or line.startswith("| stage"): head = head if line.startswith("|---") else []
        elif not head: head = [cell.strip() for cell in line.strip("|").split("|")]
        else: cells.update({name: cell.strip() for name, cell in zip(head, line.strip("|").split("|"))})
    number = lambda name: float(cells[name].split()[0])
    return {"job": number("job s"), "newton": number("newton s"), "cholmod": number("Cholesky s"), "residual": number("residual")}


def main():
    if sys.argv[1:2] == ["--solve"]: return worker(*sys.argv[2:4])
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("bench")
    arguments.add_argument("meshes", nargs="+", metavar="MESH.obj")
    arguments.add_argument("-r", type=int, default=3, metavar="N", help="repetitions")
    arguments.add_argument("--only", default=",".join(PEERS), help="peers, by commas")
    arguments.add_argument("--petsc-python", default="/usr/bin/python3", help="Python that belongs to python3-petsc4py")
    options = arguments.parse_args()
    peers = options.only.split(",")
    hmf = {mesh: [] for mesh in options.meshes}
    times = {(mesh, peer): [] for mesh in options.meshes for peer in peers}
    with tempfile.TemporaryDirectory() as folder:
        paths = {}
        for number, mesh in enumerate(options.meshes):
            points, faces = read_obj(mesh)
            a, mass = laplacian(points, faces)
            paths[mesh] = os.path.join(folder, f"{number}.npz")
            np.savez(paths[mesh], points=points, faces=faces, mass=mass, data=a.data, indices=a.indices, indptr=a.indptr)
        for _ in range(options.r):
            for mesh in options.meshes:
                hmf[mesh].append(run_pipeline(options.bench, mesh))
                for peer in peers:
                    times[mesh, peer].append(run_peer(peer, paths[mesh], options))
    print("| mesh | program | what | setup s | solve s | all s | job of hmf / all | residual |\n|---|---|---|--:|--:|--:|--:|--:|")
    for mesh in options.meshes:
        name, runs = os.path.splitext(os.path.basename(mesh))[0], hmf[mesh]
        middle = lambda key: statistics.median(run[key] for run in runs)
        print(f"| {name} | hmf | whole job | | | {middle('job'):.3f} | 1 | {middle('residual'):.1e} |")
        ratio = statistics.median(run["job"] / run["cholmod"] for run in runs)
        print(f"| | CHOLMOD | one solve | | | {middle('cholmod'):.3f} | {ratio:.2f} | |")
        for peer in peers:
            both = [(run, one) for run, one in zip(runs, times[mesh, peer]) if one]
            if not both: continue
            middle_of = lambda key: statistics.median(one[key] for _, one in both)
            ratio = statistics.median(run["job"] / (one["setup"] + one["solve"]) for run, one in both)
            total = statistics.median(one["setup"] + one["solve"] for _, one in both)
            print(f"| | {peer} | one solve | {middle_of('setup'):.3f} | {middle_of('solve'):.3f} | {total:.3f} | {ratio:.2f} | {middle_of('residual'):.1e} |")


if __name__ == "__main__":
    main()
