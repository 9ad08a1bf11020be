#!/usr/bin/env python3
"""Runs the examples of the documentation.

    docs/run_examples.py HMF [LANGUAGE ...]     HMF is the tool; languages: sh, c, cpp, python (default: all)

In README.md, CONTRIBUTING.md and docs/*.md, every block marked with one of these languages is an example:

- sh: runs in a shell with the tool, in a folder with the meshes that the pages name.  Every output file that the
  commands name must be there in the end.
- c, cpp: compiles without a warning, as C99 and C++17.  With a main function it is linked with the libraries beside the
  tool and runs.  Left out if a header other than those of hmf and the standard library is missing.
- python: runs with this interpreter if it has the package foliations, and is compiled else.

The blocks of a page share a folder and run in their order.  Prints "ok" or "not ok" for each block.
"""

import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from example_meshes import plate, star

ROOT = Path(__file__).resolve().parents[1]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
LANGUAGES = ("sh", "c", "cpp", "python")
OUTPUT = re.compile(r"[\w./-]+\.(?:png|obj|glb|csv|npy|json|ndjson|txt)\b")


def blocks(page: Path) -> list:
    """Language, number of the line, text of each example of a page."""
    found, language, begin, lines = [], None, 0, []
    for number, line in enumerate(page.read_text().splitlines(), 1):
        if line.startswith("```"):
            if language:
                found.append((language, begin, "\n".join(lines) + "\n"))
                language = None
            elif line[3:] in LANGUAGES:
                language, begin, lines = line[3:], number, []
            elif line != "```":
                language = None
        elif language:
            lines.append(line)
    return found


def make_scan(path: Path, text: str) -> None:
    """A surface with a pinhole, and with a triangle without area: a vertex on the side of another triangle."""
    vertices = [tuple(map(float, v)) for v in re.findall(r"^v (\S+) (\S+) (\S+)", text, re.M)]
    faces = [tuple(map(int, f)) for f in re.findall(r"^f (\d+) (\d+) (\d+)", text, re.M)]
    gone = len(vertices)
    faces = [face for face in faces if gone not in face]
    a, b, c = faces[0]
    vertices[gone - 1] = tuple((p + q) / 2 for p, q in zip(vertices[b - 1], vertices[c - 1]))
    faces[0:1] = [(a, b, gone), (a, gone, c), (gone, b, c)]
    path.write_text("".join("v {:.9g} {:.9g} {:.9g}\n".format(*v) for v in vertices)
                    + "".join("f {} {} {}\n".format(*f) for f in faces))


def make_meshes(folder: Path, hmf: str) -> None:
    """What the pages call mesh.obj, animal.obj and so on."""
    subprocess.run([hmf, "demo", "demo"], cwd=folder, check=True, capture_output=True)
    (folder / "hmf-demo").mkdir()
    shutil.copy(folder / "demo/sample.obj", folder / "hmf-demo")
    (folder / "demo/sample.obj").rename(folder / "mesh.obj")
    shutil.rmtree(folder / "demo")
    moved = [f"v {float(x):.9g} {float(y):.9g} {1.1 * float(z):.9g}"
             for x, y, z in re.findall(r"^v (\S+) (\S+) (\S+)", (folder / "mesh.obj").read_text(), re.M)]
    faces = re.findall(r"^f .*", (folder / "mesh.obj").read_text(), re.M)
    (folder / "moved.obj").write_text("\n".join(moved + faces) + "\n")
    star(folder / "animal.obj", 40, 80)
    (folder / "arc.txt").write_text(" ".join(map(str, ["a:", *plate(folder / "plate.obj", 12, 96)])) + "\n")
    text = (folder / "plate.obj").read_text()
    (folder / "broken.obj").write_text(text + re.search(r"^f .*\n", text, re.M)[0])  # one triangle twice
    make_scan(folder / "scan.obj", (folder / "animal.obj").read_text())
    (folder / "meshes").mkdir()
    star(folder / "meshes/star.obj", 20, 40)
    plate(folder / "meshes/plate.obj", 8, 48)


def run(command: list, folder: Path, environment: dict) -> str:
    """What a failing command said, else nothing."""
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=600)
    return f"exit {done.returncode}\n{done.stdout}{done.stderr}" if done.returncode else ""


def run_shell(text: str, folder: Path, environment: dict) -> str:
    failed = run(["bash", "-eu", "-c", text], folder, environment)
    named = [folder / name for name in OUTPUT.findall(text)]
    missing = [path.name for path in named if not path.is_file() or not path.stat().st_size]
    return failed or (f"no {', '.join(missing)}" if missing else "")


def compile_and_run(language: str, text: str, folder: Path, libraries: Path, environment: dict) -> str:
    source = folder / f"example.{language}"
    source.write_text(text)
    compiler = ["cc", "-std=c99"] if language == "c" else ["c++", "-std=c++17"]
    command = [*compiler, "-Wall", "-Wextra", "-Werror", "-Wno-unknown-pragmas",
               "-Wno-missing-field-initializers", f"-I{ROOT / 'include'}"]
    for header in re.findall(r"#include <(tbb/.*)>", text):
        if run([*compiler, "-fsyntax-only", "-include", header, "-x", "c++", "/dev/null"], folder, environment):
            return "skipped: no " + header
    if "int main(" not in text:
        return run([*command, "-fsyntax-only", source.name], folder, environment)
    pool, hmf = libraries / "libhmf_pool.a", libraries / "libhmf.a"
    command += [source.name, pool, hmf, "-lstdc++", "-lm", "-pthread", "-o", "example"]
    failed = run(command, folder, environment)
    return failed or run(["./example"], folder, environment)


def run_python(text: str, folder: Path, environment: dict) -> str:
    if not importlib.util.find_spec("foliations"):
        compile(text, "example", "exec")
        return "skipped: foliations is not installed"
    return run([sys.executable, "-c", text], folder, environment)


def main() -> int:
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    hmf, languages = Path(sys.argv[1]).resolve(), sys.argv[2:] or LANGUAGES
    counts = {"ok": 0, "not ok": 0, "skipped": 0}
    with tempfile.TemporaryDirectory() as name:
        work = Path(name)
        (work / "bin").mkdir()
        (work / "bin/hmf").symlink_to(hmf)
        environment = {**os.environ, "PATH": f"{work / 'bin'}:{os.environ['PATH']}", "MPLBACKEND": "Agg"}
        (work / "meshes").mkdir()
        make_meshes(work / "meshes", str(hmf))
        for page in PAGES:
            examples = [block for block in blocks(page) if block[0] in languages]
            folder = work / page.stem
            if examples:
                shutil.copytree(work / "meshes", folder)
            for language, line, text in examples:
                if language == "sh":
                    told = run_shell(text, folder, environment)
                elif language == "python":
                    told = run_python(text, folder, environment)
                else:
                    told = compile_and_run(language, text, folder, hmf.parent, environment)
                state = "skipped" if told.startswith("skipped") else "not ok" if told else "ok"
                counts[state] += 1
                print(f"{state} {page.relative_to(ROOT)}:{line} {language}" + (f"\n{told}" if told else ""))
    print(", ".join(f"{count} {state}" for state, count in counts.items()))
    return 1 if counts["not ok"] or not counts["ok"] else 0


if __name__ == "__main__":
    sys.exit(main())
