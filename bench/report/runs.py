"""Runs measuring programs with a deadline, and keeps what they printed, so that a second start continues the first."""
import concurrent.futures
import hashlib
import json
import os
import pathlib
import signal
import subprocess
import sys
import time

# Programs that measure run with one thread unless they are told otherwise.
ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}


class Run:
    """mode: quick or full; work: a folder for results; programs: the folder of bench_*; end: of time.time()."""

    def __init__(self, mode, work, programs, end):
        self.mode, self.work, self.programs, self.end = mode, pathlib.Path(work), pathlib.Path(programs), end
        self.cache = self.work / "rows"
        self.meshes = self.work / "meshes"
        for folder in (self.cache, self.meshes):
            folder.mkdir(parents=True, exist_ok=True)
        self.section_end = end
        self.left_out = []
        state = hashlib.sha256()
        for path in sorted(self.programs.glob("bench_*")):
            if path.is_file():
                state.update(path.read_bytes())
        self.state = state.hexdigest()[:12]

    @property
    def quick(self):
        return self.mode == "quick"

    def seconds_left(self):
        return self.end - time.time()

    def share(self, part):
        """Gives the next section this part of the time that is left."""
        self.section_end = time.time() + part * self.seconds_left()

    def has_time(self, seconds):
        """Whether that much is left for the section: for what is made, not run, such as a mesh."""
        return self.section_end - time.time() > seconds

    def program(self, name, *words):
        return [str(self.programs / name), *map(str, words)]

    def script(self, module, *words):
        return [sys.executable, "-m", f"report.{module}", *map(str, words)]

    def rows(self, name, command, seconds=600, environment=ONE_THREAD):
        """The rows that a command prints.  One that fails or takes longer than seconds leaves what it has printed,
        and a row "failure"; one that the end of the section stops, or leaves no time to start, is in left_out."""
        key = hashlib.sha256("\n".join([self.state, self.mode, *command]).encode()).hexdigest()[:16]
        kept = self.cache / f"{name.replace('/', '_')}-{key}.jsonl"
        if kept.exists():
            return parse(kept.read_text())
        own, seconds = seconds, min(seconds, self.section_end - time.time())
        if seconds < 1:
            self.left_out.append(name)
            return []
        part = kept.with_suffix(".part")
        with open(part, "w") as output, open(kept.with_suffix(".log"), "w") as errors:
            reason = finish(command, seconds, {**os.environ, **environment}, output, errors)
        rows = parse(part.read_text())
        if not reason:
            kept.with_suffix(".log").unlink()
        elif reason.startswith("stopped") and seconds < own:
            self.left_out.append(name)
        elif not any(row["row"] == "failure" for row in rows):
            said = (kept.with_suffix(".log").read_text(errors="replace").strip().splitlines() or [""])[-1]
            rows.append({"row": "failure", "mesh": name, "stage": "run", "what": f"{reason} {said[:200]}".strip()})
        part.unlink()
        if not reason.startswith("stopped"):
            kept.write_text("".join(json.dumps(row) + "\n" for row in rows))
        return rows

    def many(self, tasks):
        """rows() of several (name, command, seconds), two at a time: for what is counted, not timed."""
        with concurrent.futures.ThreadPoolExecutor(max_workers=min(2, os.cpu_count() or 1)) as pool:
            return [row for rows in pool.map(lambda task: self.rows(*task), tasks) for row in rows]

    def say(self, text):
        print(f"[{max(0, self.seconds_left()):5.0f} s left] {text}", flush=True)


def finish(command, seconds, environment, output, errors):
    """Runs a command; a text if it did not end well.  One that takes too long is ended with what it has started."""
    try:
        child = subprocess.Popen(command, stdout=output, stderr=errors, env=environment, start_new_session=True,
                                 cwd=pathlib.Path(__file__).parents[1])
    except OSError as error:
        return str(error)
    try:
        code = child.wait(seconds)
    except subprocess.TimeoutExpired:
        os.killpg(child.pid, signal.SIGKILL)
        child.wait()
        return f"stopped after {seconds:.0f} s"
    return "" if code == 0 else f"ended with {code}"


def parse(text):
    rows = []
    for line in text.splitlines():
        try:
            rows.append(json.loads(line))
        except ValueError:
            pass  # the last line of a program that was stopped, or a peer that prints
    return [row for row in rows if isinstance(row, dict) and "row" in row]


def of(rows, kind):
    return [row for row in rows if row["row"] == kind]
