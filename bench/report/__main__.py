"""python -m report quick|full WORK PROGRAMS START: measures, and writes WORK/report.html and WORK/report.md.

START is the time at which run.sh began, in seconds: the run ends 10 or 80 minutes after it.  Sections are measured in
the order of their importance; what no time was left for is listed.
"""
import sys
import time
import traceback

from . import (curves, details, forms, jobs, machine, paper_cases, paper_times, peers, pictures, quads, scaling, shapes,
               survey)
from .document import Document
from .runs import Run

LIMIT = {"quick": 600, "full": 4800}
TO_WRITE = {"quick": 45, "full": 120}
# Seconds that each section needs on a quiet machine, quick and full: its share of the time that is left.
SECONDS = {jobs: (60, 90), paper_times: (135, 1900), paper_cases: (40, 170), pictures: (35, 80), curves: (30, 450),
           scaling: (45, 330), peers: (60, 700), survey: (40, 150), forms: (10, 140), quads: (25, 170),
           details: (25, 300)}


def guarded(document, failed, name, action, *arguments):
    """One section that fails does not take the others with it; the report names it."""
    try:
        return action(*arguments) or []
    except Exception as error:  # whatever it is, it is printed and reported
        traceback.print_exc()
        failed.append(f"{name}: {type(error).__name__}: {error}")
        return []


def main(mode, work, programs, start):
    start = float(start)
    run = Run(mode, work, programs, start + LIMIT[mode] - TO_WRITE[mode])
    document, failed, rows = Document(run.work), [], {}
    sections = [(section.__name__.rpartition(".")[2], section) for section in SECONDS]
    planned = [seconds[mode == "full"] for seconds in SECONDS.values()]
    for index, (name, section) in enumerate(sections):
        run.say(f"measure {name}")
        run.share(planned[index] / sum(planned[index:]))
        rows[name] = guarded(document, failed, name, section.measure, run)
    run.say("write the report")
    everything = [row for found in rows.values() for row in found]
    for name, section in sections:
        given = (rows["paper_times"], rows[name]) if name == "curves" else (rows[name],)
        guarded(document, failed, name, section.write, document, *given)
    guarded(document, failed, "machine", machine.write, document, run, everything)
    seconds = time.time() - start
    document.goal(seconds <= LIMIT[mode], f"The run took {seconds / 60:.1f} of {LIMIT[mode] / 60:.0f} minutes, with "
                  "installation and build.")
    if run.left_out:
        document.goal(False, f"No time was left for {len(run.left_out)} measurements: "
                      + ", ".join(run.left_out[:8]) + (" and others." if len(run.left_out) > 8 else "."))
    if failed:
        document.goal(False, "Sections that failed: " + "; ".join(failed) + ".")
    opening = ["Harmonic measured foliations: the evaluation of Wang, Ma, Zhao, Wang (Computers & Graphics 2021), "
               "repeated and extended by one command, bench/run.sh. Each table names its CSV "
                "file; plots are SVG files."]
    if not shapes.folder():
        opening.append("Skipped: the meshes of HMF_MESHES; generated families stand for them.")
    document.save(f"hmf: {mode} evaluation", opening)
    print(f"report: {run.work / 'report.html'}")


if __name__ == "__main__":
    main(*sys.argv[1:])
