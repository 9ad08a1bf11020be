#!/usr/bin/env python3
"""Counts the cases in the results of ctest, and prints what failed with the line that runs it alone.

    count_results.py JUNIT_FILE BUILD_FOLDER     the last line is PASSED FAILED SKIPPED

An entry of ctest has many cases: of GoogleTest, of Python's unittest, or lines ok, not ok, skip. One without any counts
as one case. What an entry printed is left beside the JUnit file, in entries/NAME.log: tables of campaigns and coverage.
"""
import pathlib
import re
import sys
from xml.etree import ElementTree

CASES = [  # passed, failed, skipped: what a line has at the end of a case
    (r"^\[       OK \] ", r"^\[  FAILED  \] \S+\.\S+.* \(\d+ ms\)$", r"^\[  SKIPPED \] .* \(\d+ ms\)$"),
    (r" \.\.\. ok$", r" \.\.\. (FAIL|ERROR)$", r" \.\.\. skipped "),
    (r"^ok ", r"^not ok ", r"^skip "),
]
SHOWN = 60  # lines of what failed


def counts_of(text):
    return [sum(len(re.findall(kind[i], text, re.M)) for kind in CASES) for i in range(3)]


def unfinished(text):
    """The case that ended the program."""
    begun = re.findall(r"^\[ RUN      \] (\S+)", text, re.M)
    ended = re.findall(r"^\[(?:       OK |  FAILED  |  SKIPPED )\] ([^\s,]+).* \(\d+ ms\)$", text, re.M)
    return begun[-1] if len(begun) > len(ended) else None


total, skips, logs = [0, 0, 0], set(), pathlib.Path(sys.argv[1]).parent / "entries"
logs.mkdir(exist_ok=True)
for entry in ElementTree.parse(sys.argv[1]).iter("testcase"):
    text, log = entry.findtext("system-out") or "", logs / f"{entry.get('name')}.log"
    log.write_text(text)
    bad, counts = entry.get("status") == "fail", counts_of(text)
    if bad and not counts[1]:
        counts[1] = 1
    if not sum(counts):
        counts = [0, 0, 1] if entry.get("status") in ("notrun", "disabled") or entry.find("skipped") is not None else [1, 0, 0]
        if "[==========] Running 0 tests" in text:
            counts = [0, 0, 0]  # a shard without a case
    total = [a + b for a, b in zip(total, counts)]
    skips.update(re.findall(r"^skip (.*)$|\b(skipped: .*)$", text, re.M))
    if bad:
        print(f"not ok {entry.get('name')}: {counts[0]} passed, {counts[1]} failed")
        case, lines = unfinished(text), text.strip().splitlines()
        marked = [i for i, line in enumerate(lines) if re.search(r"Failure$|^not ok |^run it alone|ERROR: |runtime error|^FAIL: |^ERROR: ", line)]
        shown = sorted({j for i in marked for j in range(i, min(len(lines), i + 8))} or range(max(0, len(lines) - 20), len(lines)))
        print(*("    " + lines[i] for i in shown[:SHOWN]), f"    all of it: {log}", sep="\n")
        if case:
            print(f"    the program ended in {case}")
            program = re.search(r"^program: (\S+)", text, re.M)
            if program:
                print(f"run it alone: {program[1]} --gtest_filter={case}")
        elif "run it alone: " not in text:
            print(f"run it alone: ctest --test-dir {sys.argv[2]} -R '^{entry.get('name')}$' --output-on-failure")
for skip in sorted({re.sub(r"\d+ vertices", "N vertices", "".join(skip)) for skip in skips}):
    print("skip", skip)
print(*total)
