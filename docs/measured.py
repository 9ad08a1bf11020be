#!/usr/bin/env python3
"""Measured numbers on the pages are those of bench/recorded, which bench/run.sh measured.

    docs/measured.py                   prints what differs
    docs/measured.py --from FOLDER     copies the tables of a run (build/report-full) that have at least as many rows,
                                       and writes the pages
"""

import csv
import re
import shutil
import statistics
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
RECORDED = ROOT / "bench" / "recorded"
PROGRAMS = ("hmf", "QuadriFlow", "Instant Meshes")
# A line of the table of docs/quads.md: how it follows from the column of bench/recorded/quads.csv, and its digits.
QUADS = (("irregular", statistics.median, 0), ("inverted", sum, 0), ("sound", None, 0), ("angle", statistics.median, 1),
         ("aspect", statistics.median, 2), ("spread", statistics.median, 1), ("distance", statistics.median, 2),
         ("seconds", statistics.median, 1))


def rows(name: str) -> list[dict[str, str]]:
    with open(RECORDED / f"{name}.csv", newline="") as file:
        return list(csv.DictReader(file))


def performance() -> list[str]:
    """Lines of the table in README.md."""
    return ["| {} | {:,} | {} | {:.3f} s | {:.3f} s | {:.2f} |".format(
        re.sub(r"_\d+k(_remesh)?$", "", row["mesh"]), int(row["edges"]), row["genus"], float(row["job"]),
        float(row["cholmod"]), float(row["ratio"])) for row in rows("performance")]


def quads() -> list[list[str]]:
    """Cells of the table in docs/quads.md, without their names."""
    by = {program: [row for row in rows("quads") if row["program"] == program] for program in PROGRAMS}

    def cell(program: str, title: str, how, digits: int) -> str:
        if how is None:
            return str(sum(row[title] != "yes" for row in by[program]))
        return f"{how([float(row[title]) for row in by[program] if row[title]]):.{digits}f}"
    return [[cell(program, *line) for program in PROGRAMS] for line in QUADS]


def readme(text: str) -> str:
    table = re.compile(r"(\| mesh \| edges \| genus \| hmf \|.*\n\|[-:|]*\|\n)(?:\|.*\n)+")
    return table.sub(lambda match: match[1] + "\n".join(performance()) + "\n", text)


def quads_page(text: str) -> str:
    table = re.compile(r"(\| \| hmf \| QuadriFlow \| Instant Meshes \|\n\|[-:|]*\|\n)((?:\|.*\n)+)")

    def filled(match: re.Match[str]) -> str:
        names = [line.strip("|\n").split("|")[0].strip() for line in match[2].splitlines()]
        lines = [f"| {name} | {' | '.join(cells)} |" for name, cells in zip(names, quads())]
        return match[1] + "\n".join(lines) + "\n"
    number = len({row["mesh"] for row in rows("quads")})
    text = re.sub(r"(Medians|sums) over (?:the )?\d+ meshes",
                  lambda match: match[0].replace(re.search(r"\d+", match[0])[0], str(number)), text)
    return table.sub(filled, text)


PAGES = {"README.md": readme, "docs/quads.md": quads_page}


def sentences() -> list[str]:
    """Sentences that state a number: what the recorded table says, if it is something else."""
    wrong = []
    boundary = [float(value) for row in rows("boundary") for key, value in row.items() if key.startswith("holes") and value]
    if "about three times as long as on a closed mesh" not in (ROOT / "docs/boundary.md").read_text() or not (
            2.5 <= statistics.median(boundary) < 3.5):
        wrong.append(f"docs/boundary.md: a solve takes {statistics.median(boundary):.1f} times as long")
    said = re.search(r"a solve ([\d.]+) to ([\d.]+) times as fast", (ROOT / "docs/threads.md").read_text())
    solves = [float(row["solve"]) for row in rows("threads")]
    if not said or not float(said[1]) - 0.05 <= min(solves) or not max(solves) < float(said[2]) + 0.05:
        wrong.append(f"docs/threads.md: a solve is {min(solves):.2f} to {max(solves):.2f} times as fast")
    return wrong


def wrong() -> list[str]:
    """Pages that say something else than the recorded tables."""
    differ = [f"{page} differs from bench/recorded: run docs/measured.py --from FOLDER, or restore the tables"
              for page, fill in PAGES.items() if fill((ROOT / page).read_text()) != (ROOT / page).read_text()]
    return differ + sentences() + ([] if len(performance()) > 2 and len(quads()) == len(QUADS) else ["no rows"])


def record(folder: Path) -> None:
    for path in sorted(RECORDED.glob("*.csv")):
        found = folder / "tables" / path.name
        if found.is_file() and len(found.read_text().splitlines()) >= len(path.read_text().splitlines()):
            shutil.copyfile(found, path)
        else:
            print(f"kept: {path.name}, the run has fewer rows")
    for page, fill in PAGES.items():
        (ROOT / page).write_text(fill((ROOT / page).read_text()))


if __name__ == "__main__":
    if sys.argv[1:2] == ["--from"]:
        record(Path(sys.argv[2]))
    told = wrong()
    print("\n".join(told) or "ok")
    sys.exit(bool(told))
