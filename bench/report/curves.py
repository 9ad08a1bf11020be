"""Energy over time of all methods (figures 1, 7 and 14 of the paper) and the share of each stage (figure 12)."""
from . import paper_times, shapes
from .runs import of

COLORS = {"newton": "#1b7837", "whitehead": "#2166ac", "single_level": "#b2182b"}


def chosen(run, name="pegasus_42k_remesh"):
    """The mesh of figures 7 and 14, and of the pictures of levels."""
    return shapes.find(name) or paper_times.stand_ins(run)[1][1]


def measure(run):
    path, limit = chosen(run), 3 if run.quick else 60
    words = ("--whitehead", limit, path)
    return (run.rows(f"levels-{path.stem}", run.program("bench_methods", "--levels", *words), 60 if run.quick else 900)
            + run.rows(f"loops-{path.stem}", run.program("bench_methods", "--loops", *words), 60 if run.quick else 900))


def excess(curve):
    """Time and energy / minimum - 1 on the given mesh."""
    least = curve["least_energy"]
    points = [(t, e / least - 1) for t, e, level in curve["points"] if level == 0]
    return [t for t, _ in points], [max(x, 1e-12) for _, x in points]


def draw_methods(curves, axes):
    for curve in curves:
        label = curve["method"] + (f" {100 * curve['ratio']:.0f} %" if curve["method"] == "whitehead" else "")
        style = {0.25: ":", 0.5: "-", 0.75: "--"}[curve["ratio"]]
        axes.plot(*excess(curve), style, color=COLORS[curve["method"]], label=label, lw=1.6,
                  marker="o" if curve["method"] == "newton" else None, ms=3)
    axes.set(xscale="log", yscale="log", xlabel="processor seconds", ylabel="energy / minimum - 1", ylim=(1e-11, None))
    axes.set_title(curves[0]["mesh"], fontsize=10)
    axes.legend(fontsize=7)


def write(document, times, rows):
    document.heading("Figures 1, 7, 12 and 14: convergence")
    curves = [curve for curve in of(times, "curve") if curve["experiment"] == "table1"]
    meshes = list(dict.fromkeys(curve["mesh"] for curve in curves))
    wanted = [mesh for mesh in ("pegasus_42k_remesh", "fertility_60k", "trim-star_524k_remesh") if mesh in meshes]
    wanted = wanted or meshes[-3:]

    def draw(figure):
        for k, mesh in enumerate(wanted):
            axes = figure.add_subplot(1, len(wanted), k + 1)
            draw_methods([curve for curve in curves if curve["mesh"] == mesh], axes)
    if wanted:
        document.plot("methods", "Figure 1: energy above the minimum on the given mesh over processor time, all "
                      "methods from the same loops. A curve starts when its method reaches the given mesh.", draw,
                      (5 * len(wanted), 4.2))
    draw_levels(document, [row for row in of(rows, "method") if row["experiment"] == "levels"])
    draw_stages(document, of(times, "method"))
    bound_cycles(document, of(times, "method"))
    draw_loops(document, rows)


def draw_levels(document, rows):
    if not rows:
        return

    def draw(figure):
        axes = figure.add_subplot()
        for method in ("whitehead", "newton"):
            same = [row for row in rows if row["method"] == method]
            seconds = [row["to_stop_rule"] or row["processor"] for row in same]
            axes.plot([row["coarsest_vertices"] for row in same], seconds, "o-", color=COLORS[method], label=method)
            for row, t in zip(same, seconds):
                axes.annotate(f"{row['levels']} levels", (row["coarsest_vertices"], t), fontsize=7,
                              textcoords="offset points", xytext=(0, 5))
        axes.set(xscale="log", yscale="log", xlabel="vertices of the coarsest level", ylabel="processor seconds")
        axes.set_title(rows[0]["mesh"], fontsize=10)
        axes.legend()
    document.plot("levels", "Figure 7: number of levels. Seconds of Whitehead moves to the paper's stop rule, and of "
                  "Newton's method to a residual of 1e-8.", draw, (7, 4))
    document.numbers("levels", rows)


def draw_stages(document, rows):
    rows = [row for row in rows if row["method"] in ("whitehead", "newton") and row["ratio"] == 0.5]
    names = list(dict.fromkeys(row["shape"] for row in rows))
    if not names:
        return

    def draw(figure):
        for k, method in enumerate(("whitehead", "newton")):
            axes = figure.add_subplot(1, 2, k + 1)
            same = {row["shape"]: row for row in rows if row["method"] == method}
            shown = [name for name in names if name in same]
            total = [same[n]["build"] + same[n]["processor"] for n in shown]
            bottom = [0.0] * len(shown)
            for part, color in (("build", "#7f7f7f"), ("interpolate", "#f4a582"), ("optimize", COLORS[method])):
                share = [100 * same[n][part] / t for n, t in zip(shown, total)]
                axes.bar(shown, share, bottom=bottom, color=color, label=part)
                bottom = [a + b for a, b in zip(bottom, share)]
            axes.set_title(f"{method}, 50 %", fontsize=10)
            axes.set_ylabel("% of build + solve")
            axes.tick_params(axis="x", rotation=90, labelsize=7)
            axes.legend(fontsize=7)
    document.plot("stages", "Figure 12: share of building the hierarchy, of interpolation and of optimization; the "
                  "rest is the start on the coarsest level, checks and the way back to the given triangles. Whitehead "
                  "moves up to the time limit of this run.", draw, (12, 4.4))


def bound_cycles(document, rows):
    """What a full-approximation scheme could gain at most over the cascade of Newton's method."""
    table = []
    for row in rows:
        if row["method"] == "newton" and row.get("level_solves"):
            solves = [int(word) for word in row["level_solves"].split()]
            scale = row["processor"] / row["wall"]
            seconds = [scale * float(word) for word in row["level_optimize"].split()]
            coarsest, finest = seconds[0] if len(seconds) > 1 else 0, seconds[-1]
            least = row["processor"] - row["optimize"] + coarsest + finest / max(solves[-1], 1)
            table.append({"shape": row["shape"], "edges": row["edges"], "solves": row["level_solves"],
                          "processor": row["processor"], "finest": finest / row["processor"], "least": least,
                          "gain": row["processor"] / least})
    document.text("A full-approximation V-cycle would start the given mesh from a better value than the cascade does. "
                  "It still needs the solution on the coarsest level and one linear solve on the given mesh. The last "
                  "column is the gain if it needed nothing else: no such scheme can gain more.")
    document.table("cycles", [
        ("shape", "shape"), ("edges", "edges"), ("linear solves, coarsest level first", "solves"),
        ("solve s", "processor"), ("share of the given mesh", "finest"), ("bound s", "least"),
        ("gain at most", "gain")], table)


def draw_loops(document, rows):
    curves = [curve for curve in of(rows, "curve") if curve["experiment"] == "loops"]
    kinds = list(dict.fromkeys(curve["loops"] for curve in curves))
    if not kinds:
        return

    def draw(figure):
        for k, kind in enumerate(kinds):
            axes = figure.add_subplot(1, len(kinds), k + 1)
            draw_methods([curve for curve in curves if curve["loops"] == kind], axes)
            axes.set_title(f"{curves[0]['mesh']}, {kind}", fontsize=10)
    document.plot("loops", "Figure 14: other loops.", draw, (5 * len(kinds), 4))
    document.numbers("loops", [row for row in of(rows, "method") if row["experiment"] == "loops"])
