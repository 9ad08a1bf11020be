"""The machine, the compiler and BLAS; whether the machine was quiet."""
import os
import pathlib
import platform
import re
import statistics
import subprocess


def said(*command):
    try:
        return subprocess.run(command, check=False, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                              text=True).stdout.strip()
    except OSError:
        return ""


def describe(run, rows):
    """Facts as (name, text)."""
    info = pathlib.Path("/proc/cpuinfo")
    text = info.read_text() if info.exists() else ""
    model = re.search(r"model name\s*: (.*)", text)
    memory = re.search(r"MemTotal:\s*(\d+)", pathlib.Path("/proc/meminfo").read_text()) if info.exists() else None
    root = pathlib.Path(__file__).parents[2]
    cache = run.programs.parent / "CMakeCache.txt"
    compiler = re.search(r"CMAKE_CXX_COMPILER:\w+=(.*)", cache.read_text()) if cache.exists() else None
    changed = said("git", "-C", str(root), "status", "--porcelain", "--untracked-files=no")
    blas = next((row["path"] for row in rows if row["row"] == "blas"), "CHOLMOD is missing")
    package = said("dpkg-query", "-W", "-f", "${Version}", "libopenblas0-pthread") if "openblas" in blas else ""
    cholmod = said("dpkg-query", "-W", "-f", "${Version}", "libsuitesparse-dev")
    return [
        ("hmf", said("git", "-C", str(root), "rev-parse", "--short", "HEAD") + (" with changes" if changed else "")),
        ("run", run.mode), ("processor", model[1] if model else platform.processor()),
        ("cores", str(os.cpu_count())), ("memory", f"{int(memory[1]) / 2**20:.1f} GiB" if memory else "unknown"),
        ("system", platform.platform()),
        ("compiler", (said(compiler[1], "--version").splitlines() or ["unknown"])[0] + ", -O3" if compiler else "?"),
        ("BLAS of CHOLMOD", f"{blas} {package}".strip()), ("SuiteSparse", cholmod or "unknown"),
        ("Python", platform.python_version())]


def write(document, run, rows):
    document.heading("Machine")
    document.table("machine", [("fact", "fact"), ("value", "value")],
                   [{"fact": name, "value": value} for name, value in describe(run, rows)])
    samples = [row for row in rows if row.get("reference_wall")]
    if len(samples) < 3:
        return
    walls = [row["reference_wall"] for row in samples]
    shares = [row["reference_wall"] / row["reference_processor"] for row in samples]
    middle, late = statistics.median(walls), sorted(walls)[int(0.9 * len(walls))]
    busy = statistics.median(shares), sorted(shares)[int(0.9 * len(shares))]
    document.text(f"A fixed reference computation was timed {len(walls)} times, before each measured repetition: "
                  f"median {1e3 * middle:.1f} ms, smallest {1e3 * min(walls):.1f} ms, 90 % quantile {1e3 * late:.1f} "
                  f"ms, largest {1e3 * max(walls):.1f} ms. Wall time / processor time: median {busy[0]:.3f}, "
                  f"90 % quantile {busy[1]:.3f}.")
    document.goal(late <= 1.1 * middle and busy[1] <= 1.1, "Quietness of the machine: 90 % of the reference "
                  f"computations took at most {late / middle:.2f} times the median, and {busy[1]:.2f} times their "
                  "processor time (goal: 1.1).")
