"""A thousand meshes: how many are solved to 1e-8, and every failure by name.

    python -m report.survey FIRST COUNT     generated meshes, as rows
"""
import pathlib
import subprocess
import sys
import tempfile

from . import shapes
from .runs import of

BATCH = 25


def measure(run):
    number = 180 if run.quick else 940
    tasks = [(f"survey-{path.stem}", run.program("bench_job", path), 300)
             for path in shapes.corpus(6e6 if run.quick else 1 << 40)]
    tasks += [(f"survey-{first}", run.script("survey", run.programs, first, min(BATCH, number - first)), 600)
              for first in range(0, number, BATCH)]
    return [dict(row, corpus=row.get("corpus", 1)) for row in run.many(tasks)]


def main(programs, first, count):
    """Each mesh is solved as it is.  If it is refused because of triangles without area, it is solved once more with
    the remedy that the error names, mollify."""
    for name in shapes.survey_names(first + count)[first:]:
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / f"{name}.obj"
            shapes.write_obj(path, *shapes.survey_mesh(name))
            for words in ([], ["--mollify", "1e-5"]):
                done = subprocess.run([str(pathlib.Path(programs) / "bench_job"), *words, str(path)], check=False,
                                      stdout=subprocess.PIPE, text=True, timeout=120)
                mollified = int(bool(words))
                for line in done.stdout.splitlines():
                    print(f'{line[:-1]}, "corpus": 0, "mollified": {mollified}}}', flush=True)
                if '"status": 304' not in done.stdout:
                    break
            if not done.stdout:
                print(f'{{"row": "failure", "mesh": "{name}", "corpus": 0, "stage": "program", '
                      f'"what": "ended with {done.returncode}"}}', flush=True)


def family(row):
    return "corpus" if row["corpus"] else "-".join(row["mesh"].split("-")[:2])


def write(document, rows):
    document.heading("A thousand meshes")
    meshes = {}
    for row in of(rows, "job") + of(rows, "failure"):
        meshes.setdefault((family(row), row["mesh"]), []).append(row)
    table, failures = [], []
    for name in dict.fromkeys(key[0] for key in meshes):
        line = {"family": name, "meshes": 0, "solved": 0, "mollified": 0, "poles": 0, "wrong_classes": 0, "failed": 0}
        for (other, mesh), found in meshes.items():
            if other != name:
                continue
            line["meshes"] += 1
            jobs = of(found, "job")
            good = [row for row in jobs if row["status"] == 0 and row["residual"] <= 1e-8]
            line["poles"] += sum(row["poles"] for row in jobs)
            line["wrong_classes"] += sum(row["class"] == "lost" for row in good)
            if good:
                line["mollified" if good[0].get("mollified") else "solved"] += 1
            else:
                line["failed"] += 1
                failures.append({"mesh": mesh, **{key: found[-1].get(key) for key in (
                    "stage", "status", "residual", "what", "edges", "genus")}})
        table.append(line)
    if not table:
        document.text("Not measured.")
        return
    total = {"family": "all", **{key: sum(line[key] for line in table) for key in table[0] if key != "family"}}
    document.text("Corpus: the meshes of HMF_MESHES. Generated: tori, plates with holes, frames of beams, level sets "
                  "of random tori by marching tetrahedra; each as made, stretched by 10 to 1000, jittered by 0.3 of a "
                  "side, with needles down to 1e-6 in a fifth of the triangles, and with 30 % of the edges flipped at "
                  "random. \"mollified\": refused for triangles of zero area, and solved with the remedy that the "
                  "error names.")
    document.table("survey", [("family", "family"), ("meshes", "meshes"), ("solved to 1e-8", "solved"),
                              ("solved, mollified", "mollified"), ("failed", "failed"), ("poles", "poles"),
                              ("wrong classes with OK", "wrong_classes")], table + [total])
    if failures:
        document.text("Every mesh that is not solved:")
        document.table("survey_failures", [("mesh", "mesh"), ("stage", "stage"), ("status", "status"),
                                           ("residual", "residual"), ("what the library says", "what")], failures)
    solved = total["solved"] + total["mollified"]
    document.goal(solved == total["meshes"], f"{solved} of {total['meshes']} meshes of the survey are solved to 1e-8.")
    document.goal(not total["poles"] and not total["wrong_classes"],
                  f"{total['poles']} poles and {total['wrong_classes']} wrong classes in the survey.")


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))
