"""The whole job beside one linear solve by CHOLMOD: the table of README.md."""
import statistics

from . import shapes
from .document import spread
from .runs import of

PARTS = ("build", "loops", "solve", "job", "cholmod", "ratio")


def meshes(run):
    """(name, path) of the four measured shapes; without them generated ones of similar sizes."""
    found = [(path.stem, path) for name in shapes.MEASURED_SHAPES if (path := shapes.find(name))]
    if found:
        return found
    made = []
    for name, make in (("torus_90k", lambda: shapes.torus(300, 100)),
                       ("plate_240k", lambda: shapes.smooth(*times(shapes.divide, shapes.plate(2, 2), 5), 3)),
                       ("torus_750k", lambda: shapes.torus(1000, 250)),
                       ("frame_1800k", lambda: times(shapes.divide, shapes.frame(3, 1), 5))):
        path = run.meshes / f"{name}.obj"
        if not path.exists():
            shapes.write_obj(path, *make())
        made.append((name, path))
    return made


def times(change, mesh, number):
    for _ in range(number):
        mesh = change(*mesh)
    return mesh


def measure(run):
    rows, repetitions = [], 5
    for repetition in range(repetitions):
        for name, path in meshes(run):
            if run.quick and repetition >= 3 and path.stat().st_size > 4e7:
                continue
            found = run.rows(f"job-{name}-{repetition}", run.program("bench_job", "--cholmod", path))
            rows += [dict(row, repetition=repetition) if row["row"] == "job" else row for row in found]
    for row in of(rows, "job"):
        row["ratio"] = row["job"] / row["cholmod"] if row.get("cholmod") else None
    return rows


def write(document, rows):
    document.heading("The whole job beside one linear solve")
    document.text("The job is build, loops and solve to a residual of 1e-8. CHOLMOD analyses, factorizes and solves "
                  "one cotangent Laplacian of the same mesh (METIS order). Processor seconds of one thread: median "
                  "[smallest, largest]. The two alternate, and a ratio is taken within one repetition.")
    jobs = of(rows, "job")
    table = []
    for mesh in dict.fromkeys(row["mesh"] for row in jobs):
        same = [row for row in jobs if row["mesh"] == mesh]
        line = {"mesh": mesh, "edges": same[0]["edges"], "genus": same[0]["genus"], "repetitions": len(same)}
        for part in PARTS:
            values = [row[part] for row in same if row.get(part) is not None]
            line[f"{part}_text"] = spread(values)
            if values:
                line.update({part: statistics.median(values), f"{part}_min": min(values), f"{part}_max": max(values)})
        line["residual"] = max(row["residual"] for row in same)
        line["solve_bytes_per_edge"] = same[0]["solve_bytes_per_edge"]
        table.append(line)
    document.table("performance", [
        ("mesh", "mesh"), ("edges", "edges"), ("genus", "genus"), ("runs", "repetitions"), ("build s", "build"),
        ("loops s", "loops"), ("solve s", "solve"), ("job s", "job_text"), ("CHOLMOD s", "cholmod_text"),
        ("job / CHOLMOD", "ratio_text"), ("bytes per edge", "solve_bytes_per_edge")], table)
    slow = [line["mesh"] for line in table if line.get("ratio", 0) > 1]
    if table and any("ratio" in line for line in table):
        document.goal(not slow, "The whole job takes longer than one solve by CHOLMOD on " + ", ".join(slow) + "."
                      if slow else "The whole job is faster than one linear solve by CHOLMOD on every mesh.")
    unsolved = [row["mesh"] for row in jobs if row["status"]] + [row["mesh"] for row in of(rows, "failure")]
    if jobs or unsolved:
        document.goal(not unsolved, "Not solved: " + ", ".join(unsolved) + "." if unsolved
                      else "Every measured job is solved to 1e-8 in its class.")
