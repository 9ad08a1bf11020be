"""Time and memory per edge over the number of edges, the genus, and threads; figure 13, one shape in many sizes."""
import math
import statistics

from . import shapes
from .runs import of


def write_mesh(run, name, make):
    path = run.meshes / f"{name}.obj"
    if not path.exists():
        shapes.write_obj(path, *make())
    return path


def sized(run):
    """Meshes of two families from a thousand edges on, made one by one."""
    most = 7e5 if run.quick else 1.1e7
    level, mesh, rows = 0, shapes.frame(3, 1), 16
    while True:
        torus = 9 * rows * rows <= most and run.has_time(2e-5 * rows * rows)
        if torus:
            yield write_mesh(run, f"scale_torus_{rows}", lambda: shapes.torus(3 * rows, rows))
            rows *= 2
        frame = 1.5 * len(mesh[1]) <= most and run.has_time(1e-5 * len(mesh[1]))
        if frame:
            yield write_mesh(run, f"scale_frame_{level}", lambda: mesh)
            level, mesh = level + 1, shapes.divide(*mesh)
        if not torus and not frame:
            return


def genera(run):
    for side in (1, 2, 4, 8, 16) if run.quick else (1, 2, 4, 8, 16, 32):
        def make(side=side):
            mesh = shapes.plate(side, side)
            while len(mesh[1]) < (3e4 if run.quick else 2e5):
                mesh = shapes.divide(*mesh)
            return shapes.smooth(*mesh, 2)
        if run.has_time(3):
            yield write_mesh(run, f"genus_{side * side}", make)


def measure(run):
    # Generated meshes stand for the folder once they are made.
    steps = (measure_threads, measure_sizes) if shapes.folder() else (measure_sizes, measure_threads)
    return [row for step in steps for row in step(run)]


def measure_sizes(run):
    for kind, paths in (("genus", genera(run)), ("edges", sized(run))):
        for path in paths:
            large = path.stat().st_size > 3e7
            found = run.rows(f"{kind}-{path.stem}", run.program("bench_job", "-r", 1 if large else 3, path), 400)
            yield from (dict(row, experiment=kind) for row in found)


def measure_threads(run):
    for path in resolutions(run):
        found = run.rows(f"resolution-{path.stem}", run.program("bench_job", path), 200)
        yield from (dict(row, experiment="resolution") for row in found)
    large = [path for name in shapes.MEASURED_SHAPES[-2:] if (path := shapes.find(name))]
    for path in large or [run.meshes / "scale_torus_256.obj"]:
        for threads in (1, 2) if path.exists() else ():
            found = run.rows(f"threads-{path.stem}-{threads}", run.program(
                "bench_job", "-r", 1 if run.quick else 5, "--threads", threads, path), 400)
            yield from (dict(row, experiment="threads") for row in found)


def resolutions(run):
    """One shape in several sizes: the meshes of the folder whose names start alike, or a generated one, divided."""
    if shapes.folder():
        return [path for name in ("kitten", "fertility", "eight") for path in shapes.corpus()
                if path.stem.startswith(name + "_")]
    return [run.meshes / f"scale_frame_{level}.obj" for level in range(1, 5)
            if (run.meshes / f"scale_frame_{level}.obj").exists()]


def median_rows(rows):
    found = []
    for mesh, threads in dict.fromkeys((row["mesh"], row["threads"]) for row in rows):
        same = [row for row in rows if (row["mesh"], row["threads"]) == (mesh, threads)]
        line = dict(same[0])
        for key in ("build", "loops", "solve", "job", "job_wall"):
            line[key] = statistics.median(row[key] for row in same)
        line["job_us_per_edge"] = 1e6 * line["job"] / line["edges"]
        found.append(line)
    return found


def exponent(rows, x, y):
    """Slope of the least squares line through the logarithms."""
    points = [(math.log(row[x]), math.log(row[y])) for row in rows if row[x] and row[y]]
    if len(points) < 3:
        return None
    mx, my = (statistics.mean(p[k] for p in points) for k in (0, 1))
    return sum((a - mx) * (b - my) for a, b in points) / sum((a - mx)**2 for a, _ in points)


def write(document, rows):
    document.heading("Scaling")
    jobs = of(rows, "job")
    table = []
    for kind in ("edges", "genus"):
        lines = median_rows([row for row in jobs if row["experiment"] == kind])
        for line in lines:
            line["family"] = line["mesh"].rsplit("_", 1)[0] if kind == "edges" else "genus"
        table += lines
    exponents = {}
    for family in dict.fromkeys(line["family"] for line in table):
        same = [line for line in table if line["family"] == family and (family == "genus" or line["edges"] > 2e4)]
        exponents[family] = exponent(same, "genus" if family == "genus" else "edges", "job")
    document.table("scaling", [
        ("mesh", "mesh"), ("edges", "edges"), ("genus", "genus"), ("build s", "build"), ("loops s", "loops"),
        ("solve s", "solve"), ("job s", "job"), ("µs per edge", "job_us_per_edge"),
        ("peak bytes per edge", "solve_bytes_per_edge"), ("linear solves", "linear_solves"), ("status", "status"),
        ("residual", "residual")], table, "Medians of up to three runs, processor time of one thread.")
    said = "; ".join(f"{family}: {value:.2f}" for family, value in exponents.items() if value is not None)
    if said:
        document.text(f"Fitted exponents of the time of the job, over the number of edges (above 20,000) or the genus ("
                      f"at about equal numbers of edges): {said}.")

        def draw(figure):
            for k, (kind, x) in enumerate((("edges", "edges"), ("genus", "genus"))):
                axes = figure.add_subplot(1, 2, k + 1)
                for family in exponents:
                    if (family == "genus") == (kind == "genus"):
                        same = [line for line in table if line["family"] == family]
                        axes.plot([line[x] for line in same], [line["job_us_per_edge"] for line in same], "o-",
                                  label=family)
                axes.set(xscale="log", xlabel=x, ylabel="µs of a job per edge", ylim=(0, None))
                if axes.lines:
                    axes.legend(fontsize=8)
        document.plot("scaling", "Time of a job per edge.", draw)
        grown = [value for family, value in exponents.items() if family != "genus" and value is not None]
        document.goal(not grown or max(grown) <= 1.15, f"Time grows as edges to the power {max(grown, default=1):.2f} "
                      "at most (goal: 1.15).")
    unsolved = [line["mesh"] for line in table if line["status"]] + [row["mesh"] for row in of(rows, "failure")]
    if table or unsolved:
        document.goal(not unsolved, "Not solved while scaling: " + ", ".join(unsolved) + "." if unsolved
                      else "All meshes of the scaling tables are solved.")
    threads = median_rows([row for row in jobs if row["experiment"] == "threads"])
    lines = []
    for mesh in dict.fromkeys(line["mesh"] for line in threads):
        by = {line["threads"]: line for line in threads if line["mesh"] == mesh}
        if set(by) == {1, 2}:
            lines.append({"mesh": mesh, "edges": by[1]["edges"], "one": by[1]["job_wall"], "two": by[2]["job_wall"],
                          "build": by[1]["build"] / by[2]["build"], "solve": by[1]["solve"] / by[2]["solve"],
                          "gain": by[1]["job_wall"] / by[2]["job_wall"]})
    document.table("threads", [("mesh", "mesh"), ("edges", "edges"), ("1 thread s", "one"), ("2 threads s", "two"),
                               ("gain: build", "build"), ("solve", "solve"), ("job", "gain")], lines,
                   "Wall time.")
    same = median_rows([row for row in jobs if row["experiment"] == "resolution"])
    document.heading("Figure 13: one shape in many sizes")
    document.text("The energy is a conformal invariant of the shape and its loops, so meshes of one shape should agree "
                  "when the loops chosen are the same.")
    document.table("resolutions", [("mesh", "mesh"), ("edges", "edges"), ("energy", "energy"), ("job s", "job"),
                                   ("µs per edge", "job_us_per_edge"), ("linear solves", "linear_solves")], same)
