"""A basis of the harmonic 1-forms beside sparse Cholesky, the usual basis of global parameterization."""
from . import jobs, shapes
from .runs import of

# One shape in several sizes, and high genus.
NAMES = ("eight_1.5k", "eight_11k", "eight_179k_remesh", "kitten_16k", "kitten_106k", "fertility_60k", "heptoroid_36k",
         "botijo_207k_remesh", "trim-star_524k_remesh", "heptoroid_527k_remesh", "master-cylinder_1260k_remesh")


def measure(run):
    paths = [path for name in NAMES if (path := shapes.find(name))] or [path for _, path in jobs.meshes(run)]
    rows = []
    for path in paths:
        if not run.quick or path.stat().st_size < 3e7:
            rows += run.rows(f"forms-{path.stem}", run.program("bench_job", "--forms", path), 300)
    return rows


def write(document, rows):
    document.heading("Harmonic 1-forms")
    document.text("A basis of 2 * genus closed and coclosed forms with integer periods. Cholesky: one factorization by "
                  "CHOLMOD and a solve for each form; the integer start is not counted. Conjugation error: largest "
                  "entry of J^2 + 1, which falls with the size of the triangles. Processor seconds of one thread, "
                  "one run.")
    table = []
    for row in of(rows, "forms"):
        line = dict(row)
        if row.get("cholmod_factor"):
            line["cholesky"] = row["cholmod_factor"] + row["forms"] * row["cholmod_solve"]
            line["ratio"] = row["seconds"] / line["cholesky"]
            line["goal"] = (0.3 + 0.05 * row["forms"]) * row["cholmod_factor"]
        table.append(line)
    document.table("forms", [
        ("mesh", "mesh"), ("edges", "edges"), ("genus", "genus"), ("forms", "forms"), ("hmf s", "seconds"),
        ("Cholesky s", "cholesky"), ("hmf / Cholesky", "ratio"), ("factorization s", "cholmod_factor"),
        ("goal s", "goal"), ("residual", "residual"), ("conjugation error", "conjugation_error")], table)
    for failure in of(rows, "failure"):
        document.text(f"Failure on {failure.get('mesh')}: {failure.get('what')}")
    slow = [f"{line['mesh']} ({line['seconds'] / line['goal']:.1f})" for line in table if line.get("goal")
            and line["edges"] > 5e4 and line["seconds"] > line["goal"]]
    if table:
        goal = "0.3 + 0.05 per form of one factorization (above 50,000 edges)"
        document.goal(not slow, f"A basis of harmonic 1-forms takes longer than {goal}: " + ", ".join(slow) + "."
                      if slow else f"A basis of harmonic 1-forms takes at most {goal}.")
