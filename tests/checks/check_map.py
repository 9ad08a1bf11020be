#!/usr/bin/env python3
"""The map of the source against the source.

    tests/checks/check_map.py

- The table of folders in src/README.md names each folder of src, and beside it the folders that it
  depends on: those that its files include, without those that follow.  There is no circle.
- Each file that a page names in backquotes is there, and so is each place that a link leads to.
- Each file of src begins with what it does, or belongs to a header that does.

Prints a line "ok" or "not ok" for each check, as all check_* do.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
SRC = ROOT / "src"
MAP = SRC / "README.md"
PAGES = [MAP, ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "SECURITY.md", ROOT / "bench/README.md",
         *sorted((ROOT / "docs").glob("*.md"))]
failed = False


def report(name, problems):
    global failed
    problems = list(problems)
    failed = failed or bool(problems)
    print(f"not ok {name}:" if problems else f"ok {name}", *problems, sep="\n    " if problems else "")


def includes():
    """folder -> the other folders that its files include"""
    found = {}
    for path in sorted(SRC.glob("*/*.[ch]pp")):
        uses = found.setdefault(path.parent.name, set())
        for name in re.findall(r'#include "([^"]+)"', path.read_text()):
            folder = (path.parent / name).resolve().parent
            if folder.parent == SRC and folder != path.parent:
                uses.add(folder.name)
    return found


def reachable(graph, start):
    seen, rest = set(), [start]
    while rest:
        for folder in graph.get(rest.pop(), ()):
            if folder not in seen:
                seen.add(folder)
                rest.append(folder)
    return seen


def folder_problems():
    graph = includes()
    rows = dict(re.findall(r"^\| `(\w+)` \|([^|]*)\|", MAP.read_text(), re.M))
    for folder in sorted(set(graph) ^ set(rows)):
        yield f"{folder} is in the {'tree' if folder in graph else 'table'} only"
    for folder, uses in sorted(graph.items()):
        if folder in reachable(graph, folder):
            yield f"{folder} depends on itself, by {', '.join(sorted(uses))}"
            continue
        direct = {a for a in uses if not any(a in reachable(graph, b) for b in uses - {a})}
        named = set(re.findall(r"\w+", rows.get(folder, "")))
        if folder in rows and named not in (direct, {"all"}):
            yield f"{folder} depends on {', '.join(sorted(direct))}; the table says {', '.join(sorted(named))}"


def name_problems():
    files = [path.relative_to(ROOT).as_posix() for top in ("src", "include", "tests", "fuzz", "bench", "docs", "bindings")
             for path in (ROOT / top).rglob("*.*") if "node_modules" not in path.parts]
    for page in PAGES:
        for name in re.findall(r"`([\w/.-]+\.(?:cpp|hpp|h|py|md))`", page.read_text()):
            if not any(("/" + file).endswith("/" + name) for file in files) and not (ROOT / name).exists():
                yield f"{page.relative_to(ROOT)}: there is no {name}"
    picture = re.search(r"## Data flow\n((?: {4}.*\n|\n)+)", MAP.read_text()).group(1)
    for folder, name in re.findall(r"\b(\w+)/([a-z]\w*)\b", picture):
        if folder != "include" and not any(SRC.glob(f"{folder}/{name}.*")):
            yield f"src/README.md: there is no {folder}/{name}"
    for folder in re.findall(r"\b(\w+)/(?=\s)", picture):
        if not (SRC / folder).is_dir():
            yield f"src/README.md: there is no folder {folder}"


def anchor(heading):
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


def link_problems():
    for page in PAGES:
        for target in re.findall(r"\]\(([^)\s]+)\)", page.read_text()):
            if re.match(r"[a-z]+:", target):
                continue
            path, _, place = target.partition("#")
            to = (page.parent / path).resolve() if path else page
            if not to.exists():
                yield f"{page.relative_to(ROOT)}: there is no {target}"
            elif place and place not in map(anchor, re.findall(r"^#+ (.*)$", to.read_text(), re.M)):
                yield f"{page.relative_to(ROOT)}: no heading {target}"


def head_problems():
    def says(path):
        return path.read_text().startswith("//")

    for path in sorted(SRC.glob("*/*.[ch]pp")):
        header = re.match(r'(?://.*\n)*#include "([\w.]+)"', path.read_text())
        if not says(path) and not (header and says(path.parent / header.group(1))):
            yield f"{path.relative_to(ROOT)}: no head comment"


report("folders", folder_problems())
report("names", name_problems())
report("links", link_problems())
report("heads", head_problems())
sys.exit(failed)
