"""Table 1 of the paper: Whitehead moves at three ratios, without a hierarchy, and Newton's method."""
from . import shapes
from .runs import of

# edges; seconds of the original method (None: more than an hour); (build, solve) at 25, 50 and 75 %.
PAPER = {
    "block": ("78k", 103.55, (0.19, 17.30), (0.21, 12.05), (0.23, 14.28)),
    "bob": ("15k", 15.47, (0.03, 4.12), (0.03, 4.00), (0.03, 13.01)),
    "botijo": ("280k", None, (1.08, 35.49), (1.11, 34.79), (1.27, 36.73)),
    "bumpy-torus": ("36k", 73.56, (0.08, 7.67), (0.09, 4.38), (0.09, 29.23)),
    "cad": ("222k", 3372.10, (0.73, 29.43), (0.80, 28.87), (0.84, 32.11)),
    "dtorus": ("197k", None, (0.62, 19.65), (0.63, 15.82), (0.81, 24.93)),
    "eight": ("301k", None, (1.25, 26.06), (1.63, 26.86), (1.35, 32.54)),
    "fertility": ("90k", 940.53, (0.23, 25.28), (0.24, 25.24), (0.28, 22.13)),
    "genus": ("312k", None, (1.16, 51.82), (1.22, 43.99), (1.43, 60.13)),
    "holes3": ("288k", 2985.67, (1.08, 44.38), (1.15, 45.05), (1.26, 48.58)),
    "joint": ("108k", 2024.21, (0.27, 23.34), (0.29, 15.38), (0.33, 18.11)),
    "kitten": ("150k", 1610.22, (0.41, 23.65), (0.56, 13.38), (0.47, 16.24)),
    "master-cylinder": ("1625k", None, (12.84, 192.00), (13.78, 185.25), (13.90, 256.78)),
    "pegasus": ("60k", 395.29, (0.13, 19.62), (0.14, 20.89), (0.16, 21.10)),
    "rocker-arm": ("3k", 1.06, (0.00, 1.00), (0.00, 1.02), (0.00, 0.83)),
    "sculpt": ("175k", 570.58, (0.48, 25.27), (0.55, 25.29), (0.61, 26.82)),
    "torus": ("9k", 7.83, (0.02, 3.43), (0.03, 2.61), (0.03, 1.58)),
    "trefoil-knot": ("442k", None, (2.31, 34.47), (2.36, 23.36), (2.73, 28.71)),
    "trimstar": ("737k", None, (4.30, 67.20), (4.58, 53.43), (4.99, 61.62)),
    "tube": ("126k", 3216.15, (0.33, 43.86), (0.35, 15.90), (0.41, 13.15)),
}
HARDWARE = "AMD 3950X at 3.5 GHz, gcc 11 -O3, ArchLinux"
COLUMNS = (("whitehead", 0.25), ("whitehead", 0.5), ("whitehead", 0.75), ("single_level", 0.5), ("newton", 0.5))


def stand_ins(run):
    """(name of the paper, path): the corpus, or generated meshes without it."""
    found = [(shape, path) for shape, name in shapes.PAPER_SHAPES.items() if (path := shapes.find(name))]
    if found:
        return found
    made = []
    for name, make in (("torus", lambda: shapes.torus(96, 48)), ("plate-genus-6", lambda: shapes.smooth(
            *shapes.divide(*shapes.divide(*shapes.divide(*shapes.plate(2, 3)))), 2)),
                       ("frame", lambda: shapes.divide(*shapes.frame(4, 1))),
                       ("blobs", lambda: shapes.blobs(60, 1))):
        path = run.meshes / f"{name}.obj"
        if not path.exists():
            shapes.write_obj(path, *make())
        made.append((name, path))
    return made


def measure(run):
    rows = []
    for shape, path in sorted(stand_ins(run), key=lambda pair: pair[1].stat().st_size):
        edges = path.stat().st_size / 26
        limit = 1 + 1.3e-6 * edges if run.quick else 5 + 2.5e-5 * edges
        # Without a hierarchy a large mesh is nowhere near the minimum in a quick run.
        single = 2 * limit if not run.quick else 1.5 if edges < 2e5 else 0
        found = run.rows(f"times-{path.stem}", run.program("bench_methods", "--times", "--whitehead", f"{limit:.1f}",
                                                           "--single-level", f"{single:.1f}", path),
                         seconds=30 + 8 * (limit + single))
        rows += [dict(row, shape=shape) for row in found]
    return rows


def cell(row, key):
    """Seconds, or "> limit" if the time was over before."""
    if row is None:
        return "-"
    if row.get(key) is not None:
        return "%.3g" % row[key]
    return "> %.2g" % row["processor"] if row["out_of_time"] else "-"


def write(document, rows):
    document.heading("Table 1 of the paper: time of every method")
    methods = of(rows, "method")
    document.text("All methods start from the same loops (handle loops, weights 1) on the same mesh. Seconds are "
                  "processor seconds of one thread. \"stop\" is the paper's rule: a sweep on the given mesh lowers the "
                  "energy by less than 1e-6 of it. It is not convergence: \"excess\" is the relative difference to the "
                  f"minimum at that moment. The paper's columns are from its Table 1 ({HARDWARE}); its meshes of the "
                  "same names have other triangulations. \"> 5\" means that the time limit of this run was reached.")
    table = []
    for shape in dict.fromkeys(row["shape"] for row in methods):
        mine = {(row["method"], row["ratio"]): row for row in methods if row["shape"] == shape}
        newton = mine.get(("newton", 0.5))
        if not newton:
            continue
        line = {"shape": shape, "mesh": newton["mesh"], "edges": newton["edges"], "genus": newton["genus"],
                "loops": newton["loops"], "newton": newton["processor"], "newton_build": newton["build"],
                "newton_residual": newton["residual"], "newton_status": newton["status"]}
        if shape in PAPER:
            edges, original, *ours = PAPER[shape]
            line.update(paper_edges=edges, paper_original="> 3600" if original is None else original,
                        paper_25=ours[0][1], paper_50=ours[1][1], paper_75=ours[2][1], paper_build_50=ours[1][0])
        for method, ratio in COLUMNS:
            row = mine.get((method, ratio))
            name = "single" if method == "single_level" else f"{method}_{int(100 * ratio)}"
            for key in ("to_stop_rule", "to_1e-3", "to_1e-4", "to_1e-6", "to_residual"):
                line[f"{name}_{key}"] = cell(row, key)
            if row:
                line[f"{name}_excess_at_stop"], line[f"{name}_build"] = row["excess_at_stop"], row["build"]
                line[f"{name}_levels"], line[f"{name}_poles"] = row["levels"], row["poles"]
        if (row := mine.get(("whitehead", 0.5))) and row["to_stop_rule"]:
            line["gain"] = row["to_stop_rule"] / newton["processor"]
        table.append(line)
    document.table("paper_times", [
        ("shape", "shape"), ("edges in the paper", "paper_edges"), ("edges", "edges"), ("genus", "genus"),
        ("paper: original s", "paper_original"), ("paper: 25 % s", "paper_25"), ("50 % s", "paper_50"),
        ("75 % s", "paper_75"), ("whitehead 25 %: stop s", "whitehead_25_to_stop_rule"),
        ("50 %: stop s", "whitehead_50_to_stop_rule"), ("75 %: stop s", "whitehead_75_to_stop_rule"),
        ("50 %: excess", "whitehead_50_excess_at_stop"), ("single level: stop s", "single_to_stop_rule"),
        ("newton to 1e-8 s", "newton"), ("whitehead 50 % / newton", "gain")], table)
    document.text("The same runs to equal energy: processor seconds until the energy is within the given fraction of "
                  "the minimum, and until the largest residual is 1e-8.")
    equal = [("shape", "shape")]
    for title, name in (("single level", "single"), ("whitehead 50 %", "whitehead_50"), ("newton", "newton_50")):
        equal += [(f"{title}: {key.removeprefix('to_')}", f"{name}_{key}")
                  for key in ("to_1e-3", "to_1e-4", "to_1e-6", "to_residual")]
    document.table("paper_times_equal_energy", equal, table)
    document.text("Time to build the hierarchy, in seconds.")
    document.table("paper_build", [
        ("shape", "shape"), ("paper, 50 %", "paper_build_50"), ("25 %", "whitehead_25_build"),
        ("50 %", "whitehead_50_build"), ("75 %", "whitehead_75_build"), ("levels at 50 %", "whitehead_50_levels")],
        table)
    for failure in of(rows, "failure"):
        document.text(f"Failure on {failure.get('mesh')}: {failure.get('what')}")
    wrong = [line["shape"] for line in table if line["newton_status"] != 0 or line["newton_residual"] > 1e-8]
    missing = [shape for shape in shapes.PAPER_SHAPES if shape not in {line["shape"] for line in table}]
    if shapes.folder():
        document.goal(len(missing) <= 2, f"{20 - len(missing)} of the paper's 20 shapes are measured; without: "
                      + ", ".join(missing) + ".")
    else:
        document.goal(False, "The paper's shapes are skipped: HMF_MESHES names no folder of meshes.")
    document.goal(not wrong, "Newton's method does not converge on " + ", ".join(wrong) + "." if wrong
                  else "Newton's method reaches 1e-8 on every shape of Table 1.")
