#!/usr/bin/env python3
"""The tiers of the tests against the sources and against the mutation tables.

    tests/checks/check_tiers.py          prints "ok" or "not ok" for each check
    tests/checks/check_tiers.py --list   also the cases that the default tier leaves to full, with the reason

- Each row of tests/tiers.txt selects a case of its program, and has a reason.
- Each case that the mutation tables name as the one that notices a defect is there. The default tier runs those of at
  least 95 % of the defects.
- Each defect of tests/mutation/table_mutations.txt still changes its file.
- Each test file has its names in a namespace of its own.
- A case that takes fewer inputs with sanitizers (tests/support/sample.hpp) runs in the optimized build as well.
"""
import fnmatch
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/mutation"))
from core_builds import files_of_cases, program_of, without_parameters  # noqa: E402

TIERS = ROOT / "tests/tiers.txt"
POWER = 0.95  # of the defects, noticed by the default tier
failed = False


def report(name, problems):
    global failed
    problems = list(problems)
    failed = failed or bool(problems)
    print(f"not ok {name}:" if problems else f"ok {name}", *problems, sep="\n    " if problems else "")


def selects(pattern, case):
    """Whether a filter of GoogleTest selects the case; both may have parameters."""
    positive, _, negative = pattern.partition("-")
    def matches(patterns, name):
        return any(fnmatch.fnmatchcase(name, p) or fnmatch.fnmatchcase(without_parameters(name), without_parameters(p))
                   for p in patterns.split(":") if p)
    return matches(positive, case) and not matches(negative, case)


def sampled():
    """The cases whose own text asks for fewer inputs with sanitizers."""
    for path in sorted(set(CASES.values())):
        for part in re.split(r"^(?=TEST)", path.read_text(), flags=re.M)[1:]:
            name = re.match(r"TEST(?:_[FP])?\((\w+), (\w+)", part)
            if name and re.search(r"\bsample\(|with_sanitizers", part):
                yield program_of(path), f"{name[1]}.{name[2]}"


CASES = files_of_cases()
ROWS = []  # (tier, program, pattern, reason)
for line in TIERS.read_text().splitlines():
    if line and not line.startswith("#"):
        fields = re.fullmatch(r"(both|optimized|full) +(test_\w+) +(\S+)  +(\S.*)", line)
        ROWS.append(fields.groups() if fields else ("", "", line, ""))


def tier_of(program, case):
    """full, optimized, both, or default: the sanitizer build alone."""
    tiers = {tier for tier, of, pattern, _ in ROWS if of == program and selects(pattern, case)}
    return next((tier for tier in ("full", "optimized", "both") if tier in tiers), "default")


def row_problems():
    for tier, program, pattern, _ in ROWS:
        if not tier:
            yield f"tests/tiers.txt: {pattern}"
        elif not any(program_of(path) == program and selects(pattern, case) for case, path in CASES.items()):
            yield f"{program} has no case {pattern}"


def namespace_problems():
    for path in sorted((ROOT / "tests").rglob("test_*.cpp")):
        if f"\nnamespace {path.stem} {{\n" not in path.read_text():
            yield f"{path.relative_to(ROOT)} is compiled with others: put it into namespace {path.stem}"


def sample_problems():
    for program, case in sampled():
        if tier_of(program, case) == "default":
            yield f"{program} {case} has fewer inputs with sanitizers; it needs a row in tests/tiers.txt"


def killers():
    """[(table, program, [case])] of each defect that a test notices"""
    found = []
    for line in (ROOT / "tests/mutation/table_mutations.txt").read_text().splitlines():
        fields = re.fullmatch(r"\S+  .*  (\S+)  (\S+)", line)
        if fields and not line.startswith("#"):
            program, pattern = fields.groups()
            cases = [c for c, path in CASES.items() if program_of(path) == program and selects(pattern, c)]
            found.append(("table", program, cases or [pattern]))
    for line in (ROOT / "tests/mutation/drawn_mutations.txt").read_text().splitlines():
        program, _, case = line.split("\t")[-1].partition(" ")
        if not line.startswith("#") and case:
            found.append(("derived", program, [case]))
    return found


def defect_problems():
    for line in (ROOT / "tests/mutation/table_mutations.txt").read_text().splitlines():
        fields = re.fullmatch(r"(\S+)  (.*)  \S+  \S+", line)
        if not fields or line.startswith("#"):
            continue
        path = ROOT / fields[1]
        text = path.read_text() if path.is_file() else ""
        if subprocess.run(["sed", fields[2]], input=text, capture_output=True, text=True).stdout == text:
            yield f"{fields[1]}: '{fields[2]}' changes nothing"


def power_problems():
    for table in ("table", "derived"):
        of_table = [(program, cases) for name, program, cases in killers() if name == table]
        kept = 0
        for program, cases in of_table:
            for case in cases:
                path = CASES.get(without_parameters(case))
                if not path or program_of(path) != program:
                    yield f"{table}: {program} has no case {case}"
            kept += any(tier_of(program, case) != "full" for case in cases)
        print(f"{table}: the default tier runs the case of {kept} of {len(of_table)} defects")
        if kept < POWER * len(of_table):
            yield f"{table}: fewer than {POWER:.0%}"


report("tiers", row_problems())
report("namespaces", namespace_problems())
report("samples", sample_problems())
report("defects", defect_problems())
report("power-of-the-default-tier", power_problems())
if "--list" in sys.argv:
    for tier, program, pattern, reason in ROWS:
        if tier == "full":
            print(f"full: {program} {pattern}: {reason}")
sys.exit(failed)
