"""Conformality, cancellation, boundaries and even designs."""
import numpy as np

from . import jobs, shapes
from .runs import of


NAMES = ("kitten_29k", "fertility_28k", "botijo_24k", "joint_15k", "genus3_68k", "skull_100k", "kitten_106k",
         "rocker-arm_20k")


def with_holes(points, triangles, number):
    """Removes all triangles at some vertices that are far from each other."""
    holes = [int(np.argmax(points[:, 0]))]
    while len(holes) < number:
        far = np.min([np.linalg.norm(points - points[h], axis=1) for h in holes], 0)
        holes.append(int(far.argmax()))
    edges = np.unique(shapes.sides(triangles), axis=0)
    wide = np.isin(np.arange(len(points)), holes)
    near = np.unique(edges[wide[edges].any(1)])  # a disk of two rings
    keep = ~np.isin(triangles, np.array(near)).any(1) if number == 1 else ~np.isin(triangles, holes).any(1)
    return shapes.compact(points, triangles[keep])


def measure(run):
    rows = []
    paths = [path for name in NAMES[:4 if run.quick else None] if (path := shapes.find(name))]
    paths = paths or [path for _, path in jobs.meshes(run)[:1]]
    for path in paths:
        rows += run.rows(f"details-applications-{path.stem}", run.program("bench_job", "--applications", path), 120)
        rows += run.rows(f"details-design-{path.stem}", run.program("bench_job", "--design", path), 120)
        for holes in (1, 3, 10):
            cut = run.meshes / f"{path.stem}_holes_{holes}.obj"
            if not cut.exists():
                shapes.write_obj(cut, *with_holes(*shapes.read_obj(path), holes))
            rows += [dict(row, closed=path.stem, holes=holes) for row in run.rows(
                f"details-holes-{cut.stem}", run.program("bench_job", "-r", 3, cut), 120)]
    for _, path in jobs.meshes(run)[1:2] if run.quick else jobs.meshes(run):
        rows += run.rows(f"details-calls-{path.stem}",
                         run.program("bench_calls", "-r", 1 if run.quick else 3, path), 300)
    if not run.quick:
        for path in shapes.corpus(8e6):
            rows += run.rows(f"details-applications-{path.stem}", run.program("bench_job", "--applications", path), 200)
            rows += run.rows(f"details-design-{path.stem}", run.program("bench_job", "--design", path), 200)
    return rows


def least(rows, key):
    return min((row[key] for row in rows), default=None)


def write(document, rows):
    document.heading("Conformality")
    document.text("The dilatation of a triangle is the ratio of the singular values of its map to the plane; 1 is "
                  "conformal. Means are weighted by area. parameterize: seconds of the first call on a foliation, and "
                  "of later ones.")
    unique = {row["mesh"]: row for row in of(rows, "applications")}
    document.table("conformality", [
        ("mesh", "mesh"), ("mean", "dilatation_mean"), ("median", "dilatation_median"), ("99 %", "dilatation_p99"),
        ("flipped triangles", "flipped"), ("degenerate", "degenerate"), ("solve s", "solve"),
        ("parameterize s", "parameterize_first"), ("again s", "parameterize_again"), ("charts", "charts"),
        ("atlas s", "atlas")], list(unique.values()))
    document.heading("Even designs")
    document.text("Scale distortion: standard deviation of the logarithm of the conformal scale, estimated for the "
                  "loops of the cut system with weights 1, and measured for the even design.")
    document.table("designs", [("mesh", "mesh"), ("vertices", "vertices"), ("cut loops", "distortion_of_cut_loops"),
                               ("even design", "distortion"), ("marked", "marked"), ("loops", "loops"),
                               ("design s", "seconds"), ("solve s", "solve")],
                   list({row["mesh"]: row for row in of(rows, "design")}.values()))
    document.heading("Boundary")
    jobs_found = of(rows, "job")
    lines = []
    for mesh in dict.fromkeys(row["closed"] for row in jobs_found if "closed" in row):
        closed = [row for row in jobs_found if row["mesh"] == mesh and "closed" not in row]
        line = {"mesh": mesh, "closed": least(closed, "job")}
        for holes in (1, 3, 10):
            same = [row for row in jobs_found if row.get("closed") == mesh and row["holes"] == holes]
            if same and closed:
                line[f"holes_{holes}"] = least(same, "job") / line["closed"]
        lines.append(line)
    document.table("boundary", [("mesh", "mesh"), ("closed: job s", "closed"), ("1 hole", "holes_1"),
                                ("3 holes", "holes_3"), ("10 holes", "holes_10")], lines,
                   "Time of the job divided by that of the closed mesh; a surface with boundary is solved on its "
                   "double.")
    document.heading("Cancellation")
    document.text("The longest time between two progress reports, which bounds the delay of a cancellation (goal: 50 "
                  "ms on a million edges), and processor seconds of each call.")
    calls = of(rows, "call")
    document.table("calls", [("mesh", "mesh"), ("call", "call"), ("seconds", "seconds"),
                             ("longest gap, ms per million edges", "gap_ms_per_million_edges")], calls)
    late = [f"{row['call']} on {row['mesh']}" for row in calls if row["gap_ms_per_million_edges"] > 50
            and row["edges"] > 2e5]
    document.goal(not late, "More than 50 ms per million edges between two progress reports: " + ", ".join(late) + "."
                  if late else "Progress is reported at least every 50 ms per million edges.")
    for failure in of(rows, "failure"):
        document.text(f"Failure on {failure.get('mesh')}: {failure.get('stage')}: {failure.get('what')}")
