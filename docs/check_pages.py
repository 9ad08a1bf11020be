#!/usr/bin/env python3
"""Figures that appear on two pages agree, short pages stay short, answers are near, and the spelling is American.

- Measured numbers are those of bench/recorded (measured.py).
- docs/reliability.md names variants that exist, all fuzz targets, the gate of coverage and the number of defects.
- README.md has at most 1000 words, docs/reliability.md 1500; a version in CHANGELOG.md at most 20 lines.
- What a newcomer asks first is answered at most two links from README.md.
- No page has a British spelling outside of code.

Prints "ok" or "not ok" for each.
"""

import re
import sys
from pathlib import Path

import measured

ROOT = Path(__file__).resolve().parents[1]
FOLDERS = ("*.md", ".github/**/*.md", "docs/*.md", "bench/*.md", "src/*.md", "bindings/**/*.md")
PAGES = [page for pattern in FOLDERS for page in sorted(ROOT.glob(pattern)) if "node_modules" not in page.parts]
BRITISH = re.compile(
    r"\b(?:(?:optim|parameter|initial|discret|normal|symmetr|factor|general|minim|maxim|recogn|summar|organ|visual)is"
    r"(?:e|es|ed|ing|ation|ations)|neighbour\w*|colour\w*|behaviour\w*|favour\w*|cent(?:re|res|red)|"
    r"(?:cancel|label|model|travel)l(?:ed|ing)|licences?|artefacts?|round (?:the|it|them|a|an)|any more)\b", re.I)
ANSWERS = {
    "solve my mesh in Python": "foliations.Hierarchy(",
    "solve my mesh in C": "hmf_solve(h",
    "solve my mesh with the tool": "hmf solve mesh.obj",
    "draw a loop": "Loops.through(hierarchy",
    "make quads": "hmf quads mesh.obj",
    "mark vertices": "--marks marks.txt",
    "reverse a flip without a pole": "**a flip makes no pole**",
    "cite": "family-names: Wang",
    "ask a question": "template \"Question\"",
}


def text(name: str) -> str:
    return (ROOT / name).read_text()


def tables(name: str) -> list:
    """The tables of a page, each a list of rows of cells, the head first."""
    found = re.findall(r"(?:^\|.*\n)+", text(name), re.M)
    return [[[cell.strip() for cell in row.strip("|").split("|")] for row in table.splitlines()] for table in found]


def table_with(name: str, *titles: str) -> list:
    return next(table for table in tables(name) if set(titles) <= set(table[0]))


def numbers() -> list:
    """Numbers on the pages that bench/recorded has otherwise."""
    return measured.wrong()


def reliability() -> list:
    """What docs/reliability.md says otherwise than the tests."""
    page = text("docs/reliability.md")
    variants = set(re.findall(r"^(\w[\w-]*) +\|", text("test.sh"), re.M))
    named = {name for row in table_with("docs/reliability.md", "promise", "variant")[2:]
             for name in re.findall(r"`([\w-]+)`", row[-1])} | set(re.findall(r"`\./test\.sh ([\w-]+)`", page))
    wrong = [f"no variant {name}" for name in sorted(named - variants - {"list"})]
    targets = {path.stem for path in (ROOT / "fuzz").glob("*.cpp")} - {"driver"}
    shown = {name for row in table_with("docs/reliability.md", "target", "input")[2:]
             for name in re.findall(r"`(\w+)`", row[0])}
    wrong += [f"fuzz target {name} on one side only" for name in sorted(targets ^ shown)]
    rows = [line for line in text("tests/mutation/table_mutations.txt").splitlines() if line and line[0] != "#"]
    gate = re.search(r"^LINES = ([\d.]+)", text("tests/mutation/coverage.py"), re.M)[1]
    for said in (f"has {len(rows)} defects", f"The gate is {gate} %"):
        if said not in page:
            wrong.append(f"not said: {said}")
    return wrong


def lengths() -> list:
    wrong = [f"{name} has {len(text(name).split())} words, more than {most}"
             for name, most in (("README.md", 1000), ("docs/reliability.md", 1500)) if len(text(name).split()) > most]
    for version in re.split(r"^## ", text("CHANGELOG.md"), flags=re.M)[1:]:
        if len([line for line in version.splitlines()[1:] if line.strip()]) > 20:
            wrong.append(f"CHANGELOG.md has more than 20 lines for {version.splitlines()[0]}")
    return wrong


def answers() -> list:
    """What cannot be found within two links."""
    near = {ROOT / "README.md"}
    for _ in range(2):
        for page in [page for page in near if page.suffix == ".md"]:
            targets = re.findall(r"\]\(([^)\s#]+)[^)]*\)", page.read_text())
            near |= {path for target in targets if (path := (page.parent / target).resolve()).is_file()}
    told = "\n".join(page.read_text() for page in near if page.suffix in (".md", ".cff", ".h", ".hpp", ".cpp"))
    return [f"{question}: {words}" for question, words in ANSWERS.items() if words not in told]


def spelling() -> list:
    wrong = []
    for page in PAGES:
        plain = re.sub(r"```.*?```|`[^`]*`", lambda match: re.sub(r"\S", "_", match[0]), page.read_text(), flags=re.S)
        wrong += [f"{page.relative_to(ROOT)}:{number}: {match[0]}" for number, line in enumerate(plain.splitlines(), 1)
                  for match in BRITISH.finditer(line)]
    return wrong


failed = 0
for check in (numbers, reliability, lengths, answers, spelling):
    told = check()
    failed |= bool(told)
    print(f"{'not ok' if told else 'ok'} {check.__name__}", *told, sep="\n    ")
sys.exit(failed)
