#!/usr/bin/env python3
"""How conformal the parameterization is: conformality.py HMF MESH.obj ...

Prints a table in Markdown, one row a mesh, meshes whose smallest angle exceeds
15 degrees first.  Mean: of the dilatation (ratio of the singular values), weighted by area.
"""
import json
import os
import subprocess
import sys
import tempfile


def row(tool, mesh):
    info = json.loads(subprocess.run([tool, "info", mesh, "--json"], check=True, stdout=subprocess.PIPE).stdout.decode())
    with tempfile.TemporaryDirectory() as folder:
        report = os.path.join(folder, "report.json")
        # Without a parameterization the status is not 0, but there is a report.
        subprocess.run([tool, "solve", mesh, "--report", report, "--conformality"], stdout=subprocess.DEVNULL)
        with open(report) as f:
            numbers = json.load(f)
    return info, numbers


def main():
    tool, meshes = sys.argv[1], sys.argv[2:]
    rows = [row(tool, mesh) + (mesh,) for mesh in meshes]
    rows.sort(key=lambda r: (r[0]["min_angle"] <= 15, os.path.basename(r[2])))
    print("| mesh | triangles | genus | least angle | mean | median | 99% | flipped | degenerate | unfold / foliation |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for info, r, mesh in rows:
        if "dilatation_mean" not in r:
            print("| %s | %d | %d | %.1f | not parameterized |" % (os.path.basename(mesh), info["triangles"], info["genus"], info["min_angle"]))
            continue
        p99 = "%.3f" % r["dilatation_p99"] if r["dilatation_p99"] is not None else "-"
        job = r["build_seconds"] + r["loops_seconds"] + r["solve_seconds"]
        print("| %s | %d | %d | %.1f | %.4f | %.4f | %s | %d | %d | %.2f |" % (
            os.path.basename(mesh), info["triangles"], info["genus"], info["min_angle"], r["dilatation_mean"], r["dilatation_median"], p99,
            r["flipped_count"], r["degenerate_count"], r["parameterize_seconds"] / job))


main()
