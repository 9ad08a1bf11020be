"""Tests of the tests: each defect of a table is put into a copy of the sources, and the test named beside it must fail.

table_mutations.py FOLDER [PATTERN]     only lines of tests/mutation/table_mutations.txt that match PATTERN

As in derived_mutations.py, in the same FOLDER, the file is compiled, the core linked as a shared library, and the objects of the
tests are those of the release build; of a header, the file beside it and those of its folder come first.
"""

import argparse
import fnmatch
import re
import shutil
import subprocess
import sys
from pathlib import Path

from core_builds import ROOT, Core, build_release, files_of_cases, link_test, program_of, run
from derived_mutations import FIRST_DEPENDENTS, MutableCore, nearest_first

TABLE = ROOT / "tests/mutation/table_mutations.txt"
SECONDS = 60  # of processor time: a defect may let a case run on and on, or wait


def rows(pattern):
    """[(file, expression, program, cases)]"""
    lines = [line for line in TABLE.read_text().splitlines() if line and not line.startswith("#") and re.search(pattern, line)]
    return [re.fullmatch(r"(\S+)  (.*)  (\S+)  (\S+)", line).groups() for line in lines]


class Place:
    """A copy of the sources with one defect."""

    def __init__(self, core, programs, folder):
        self.core, self.programs, self.place = core, programs, folder / "table"
        shutil.rmtree(self.place, ignore_errors=True)
        for part in ("src", "include", "tests"):
            shutil.copytree(ROOT / part, self.place / part)
        self.other = Core(self.place, self.place / "objects", "g++", core.flags)
        self.files = files_of_cases(self.place)

    def ends_well(self, program, cases, library=None):
        """(whether, the case that failed or was the last to run)"""
        ended = run([str(program), "--gtest_fail_fast", f"--gtest_filter={cases}"], SECONDS, library=library)
        said = re.findall(r"^\[  FAILED  \] ([^ ,]*\.[^ ,]*)", ended.output, flags=re.M) \
            or re.findall(r"^\[ RUN      \] (\S+)", ended.output, flags=re.M)[-1:]
        return not ended.code and re.search(r"^\[  PASSED  \] [1-9]", ended.output, flags=re.M), "".join(said[:1])

    def noticed_by(self, file, program, cases):
        """The case, or None; a text that begins with a blank says what went wrong."""
        if file.startswith("include/") or not file.startswith("src/"):
            users = []
        elif file.endswith(".cpp"):
            users = [file]
        else:
            users = nearest_first(file, self.core.dependents(file))
        objects = []
        for part in (users[:FIRST_DEPENDENTS], users[FIRST_DEPENDENTS:]):
            for source in part:
                if self.other.compile(source):
                    return " it does not compile"
                objects.append((source, self.other.object(source)))
            if part:
                self.core.link(self.place / "libcore.so", objects)
                well, by = self.ends_well(self.programs[program], cases, self.place)
                if not well:
                    return by
        if file.endswith(".hpp"):  # the test has it as well
            for source in self.files_with(program, cases):
                made = self.place / source.stem
                if not link_test(source, self.place, made, self.core.library):
                    return " it does not compile"
                well, by = self.ends_well(made, cases, self.place if objects else None)
                if not well:
                    return by
        return None

    def files_with(self, program, cases):
        """The test files that a filter selects cases of."""
        patterns = [re.sub(r"^\w+/|(?<=\w)/[\w*]+$", "", part) for part in cases.split("-")[0].split(":")]
        return sorted({path for case, path in self.files.items() if program_of(path) == program
                       and any(fnmatch.fnmatchcase(case, pattern) for pattern in patterns)})

    def report(self, row):
        file, expression, program, cases = row
        original, path = (self.place / file).read_text(), self.place / file
        changed = subprocess.run(["sed", expression], input=original, capture_output=True, text=True)
        if changed.returncode or changed.stdout == original:
            return False, f"{file}: '{expression}' changes nothing {changed.stderr.strip()}"
        try:
            path.write_text(changed.stdout)
            by = self.noticed_by(file, program, cases)
        finally:
            path.write_text(original)
        if by is None:
            return False, f"{file}: '{expression}' survives {program} {cases}"
        return not by.startswith(" "), f"{file}: '{expression}' " + (f"with{by}" if by.startswith(" ") else f"is noticed by {by}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, metavar="FOLDER")
    parser.add_argument("pattern", nargs="?", default=".", metavar="PATTERN")
    asked = parser.parse_args()
    folder, pattern = asked.folder.resolve(), asked.pattern
    core = MutableCore(ROOT, folder / "core", "g++", ["-O1"])
    build_release()
    core.compile_all()
    core.link()
    programs, failed = core.link_programs(), 0
    place, table = Place(core, programs, folder), rows(pattern)

    def say(ok, text):
        nonlocal failed
        failed += not ok
        print("ok" if ok else "not ok", text, flush=True)
    for program, cases in dict.fromkeys((program, cases) for _, _, program, cases in table):
        if not place.ends_well(programs[program], cases)[0]:
            say(False, f"{program} {cases} fails without a defect, or selects no test")
    for row in table:
        say(*place.report(row))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
