"""Defects derived from the sources: is each of them noticed?

derived_mutations.py FOLDER [--count N] [--seed 1] [--reach FILE] [--only PATTERN] [--skip N] [--patience 40] [--resume]
                            [--write] [--named] [--fresh N]

Each changes one thing in one file of src: a comparison, a logical operator, a sign, a number, the answer of a condition, a
statement that is left out.  For each the file is compiled again, the core linked as a shared library, and the cases that
reach the line run, the quickest first, until one fails.  What survives that is tried once more with assertions and checks of
bounds in the file, as the debug and sanitizer builds have them.  FILE is reach.json of coverage.py (default: FOLDER/../coverage/reach.json).

Those of seed 1 are in tests/mutation/drawn_mutations.txt: a defect is known by its file, the text of its line and how many lines like
it come before, so that it stays the same when other lines change.  The last field is the case that noticed it last: it is
run alone, and only where it does not notice the defect any more FILE is needed (it is made if it is not there) and the other
cases are run.  A named defect is compiled, and run only with --named.  A line that has gone is replaced by the next one of the draw.  The draw goes through the files again and again, so
that a part of it is a sample of all of it; its order depends on the texts and the seed.

noticed      a case fails, crashes or does not end; without the defect it passes
same code    the object files are the same: nothing was changed
named        in tests/mutation/equivalent_mutations.txt with the reason why no result changes, or why only speed or memory does
open         named there as well, without a reason: a test is missing
not reached  no case below five seconds reaches the line
survives     must not be

The table is FOLDER/table.md, one line for each in FOLDER/results.txt: a run that was stopped goes on from there, if the
sources and tests are the same or with --resume, which runs only survivors again.  --write: what noticed them is written to
tests/mutation/drawn_mutations.txt; what is there and was not tried stays.  --fresh N: the first N of the draw of each file of which the
list has none.
"""

import argparse
import hashlib
import json
import re
import shutil
import subprocess
import sys
import tempfile
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from core_builds import ROOT, Core, build_release, files_of_cases, jobs, link_test, program_of, run, without_parameters

LONGEST_CASE = 5  # seconds, of those that are recorded
FIRST_DEPENDENTS = 12  # of a header, each a file to compile; the others only if the defect survives
# As the debug and sanitizer builds have it; what is found ends the program.
CHECKED = ["-UNDEBUG", "-fsanitize=bounds,signed-integer-overflow,shift,null,integer-divide-by-zero",
           "-fsanitize-undefined-trap-on-error"]
NAMED = ROOT / "tests/mutation/equivalent_mutations.txt"
DRAWN, DRAWN_SEED = ROOT / "tests/mutation/drawn_mutations.txt", 1
COLUMNS = ["noticed", "same code", "changes nothing", "speed or memory", "not reached", "open", "survives"]

SWAPS = [
    ("comparison", re.compile(r"(?<= )(<=|>=|==|!=|<|>)(?= )"),
     {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "=="}),
    ("logic", re.compile(r"(?<= )(&&|\|\|)(?= )"), {"&&": "||", "||": "&&"}),
    ("sign", re.compile(r"(?<=[\w)\]] )([+-])(?= [\w(])"), {"+": "-", "-": "+"}),
    ("sign", re.compile(r"(?<= )([+-]=)(?= )"), {"+=": "-=", "-=": "+="}),
    ("sign", re.compile(r"(?<=[(=,?:] )(-)(?=[\w(])"), {"-": ""}),
    ("factor", re.compile(r"(?<=[\w)\]] )([*/])(?= [\w(])"), {"*": "/", "/": "*"}),
]
NUMBER = re.compile(r"(?<![\w.{])(\d+)(?=u?\b)(?![\w]*\.|\.\d|x)")
STATEMENT = re.compile(r"^\s+(?![A-Z]\w*\(|return|else|if|for|while|do|delete|using|goto|case|break|continue|throw)"
                       r"[\w:.\[\]>*-]+(?:\(.*\)|\[.*\]|(?: [|&^+*/-]?= .*)|\+\+)?;$")


def masked(text):
    """Comments, strings, asserts and directives as blanks, every other character where it is."""
    def blank(match):
        return re.sub(r"[^\n]", " ", match[0])
    text = re.sub(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\'', blank, text, flags=re.S)
    text = re.sub(r"^#[^\n]*(?:\\\n[^\n]*)*", blank, text, flags=re.M)
    return re.sub(r"\b(?:static_)?assert\([^;]*\);", blank, text)


def closing(text, start):
    depth = 0
    for i in range(start, len(text)):
        depth += {"(": 1, ")": -1}.get(text[i], 0)
        if depth == 0:
            return i
    return None


def defects(source, is_header=False):
    """[(position, length, what stands instead, kind)]"""
    text, found = masked(source), []
    for kind, pattern, other in SWAPS:
        found += [(m.start(1), len(m[1]), other[m[1]], kind) for m in pattern.finditer(text)]
    for m in NUMBER.finditer(text):
        line = text[text.rfind("\n", 0, m.start()) + 1:text.find("\n", m.start())]
        # Not sizes of arrays; not first values of members, which are set before they are read.
        if re.search(r"\w+\[\d+\][;,{ ]|uint\d*_t\{|int\d+_t\{", line) or "enum" in line:
            continue
        if not (is_header and re.match(r" +[\w:<>*]+ \w+ = \d+(, \w+ = \d+)*;", line)):
            number = int(m[1])
            found.append((m.start(1), len(m[1]), str(number + 1 if number < 10 else number // 2), "number"))
    for m in re.finditer(r"\bif \(", text):
        end = closing(text, m.end() - 1)
        if end and "\n" not in source[m.end():end] and "constexpr" not in source[m.start():end]:
            inside = source[m.end():end]
            found += [(m.end(), len(inside), f"{answer} {sign} ({inside})", "condition")
                      for answer, sign in (("false", "&&"), ("true", "||"))]
    for m in re.finditer(r"\breturn (true|false);", text):
        found.append((m.start(1), len(m[1]), "false" if m[1] == "true" else "true", "answer"))
    at = 0
    for line in text.split("\n"):
        if STATEMENT.match(line) and line.count("(") == line.count(")") and line.startswith("    "):
            indent = len(line) - len(line.lstrip())
            found.append((at + indent, len(line) - indent, ";", "statement"))
        at += len(line) + 1
    return sorted(set(found))


def members(text):
    """{1, 2, 5} of "1-2,5"."""
    numbers = set()
    for part in filter(None, text.split(",")):
        first, _, last = part.partition("-")
        numbers.update(range(int(first), int(last or first) + 1))
    return numbers


class Reach:
    def __init__(self, path, patience):
        self.patience = patience
        self.cases = json.loads(Path(path).read_text())
        self.lines, self.files = {}, {}
        for name, case in self.cases.items():
            for file, text in case["lines"].items():
                if text:
                    self.files.setdefault(file, set()).add(name)
                for n in members(text):
                    self.lines.setdefault((file, n), []).append(name)
        self.code = set(self.lines)
        for line in (Path(path).parent / "uncovered.txt").read_text().splitlines():
            file, number = line.split("\t")[0].split(":")
            self.code.add((file, int(number)))

    def keep(self, programs):
        """Only cases of programs that are there."""
        self.cases = {n: c for n, c in self.cases.items() if n.split(" ")[0] in programs}
        for entries in self.lines.values():
            entries[:] = [n for n in entries if n in self.cases]
        for entries in self.files.values():
            entries &= set(self.cases)

    def of(self, file, line, users):
        """Cases that reach it, the quickest first, within the patience.  What is no code, such as a constant: cases
        that reach anything in its file or, if nothing, in those that include it."""
        chosen, total, reached = [], 0.0, self.lines.get((file, line), ())
        if (file, line) not in self.code:
            reached = set().union(*(self.files.get(f, ()) for f in ([file] if file in self.files else users)))
        for name in sorted(reached, key=lambda n: (self.cases[n]["seconds"], n)):
            total += self.cases[name]["seconds"]
            if chosen and total > self.patience:
                break
            chosen.append(name)
        return chosen

    def batches(self, cases, first):
        """[(program, [case])]: the first few, then more and more at a time."""
        at, size = 0, first
        while at < len(cases):
            part = {}
            for name in cases[at:at + size]:
                program, _, case = name.partition(" ")
                part.setdefault(program, []).append(case)
            yield from part.items()
            at, size = at + size, max(6, 3 * size)


class Defect:
    def __init__(self, file, nth, was, now, by=""):
        self.file, self.nth, self.was, self.now, self.by = file, int(nth), was, now, by
        self.key = (file, str(nth), was, now)

    def applied(self):
        """(number of the line, text of the file with the defect), or None: the line has gone."""
        lines, seen = (ROOT / self.file).read_text().split("\n") if (ROOT / self.file).exists() else [], 0
        for i, line in enumerate(lines):
            if line.strip() == self.was:
                if seen == self.nth:
                    lines[i] = line[:len(line) - len(line.lstrip())] + self.now
                    return i + 1, "\n".join(lines)
                seen += 1
        return None


def of_file(file):
    """[(kind, Defect)]"""
    source, made = (ROOT / file).read_text(), []
    lines = [line.strip() for line in source.split("\n")]
    for position, length, instead, kind in defects(source, file.endswith(".hpp")):
        at = source.count("\n", 0, position)
        now = (source[:position] + instead + source[position + length:]).split("\n")[at].strip()
        made.append((kind, Defect(file, lines[:at].count(lines[at]), lines[at], now)))
    return made


def draw(seed):
    """All defects, file after file, again and again; as many of a kind of change as of the others."""
    def place(*texts):
        return hashlib.sha256("\t".join([str(seed), *texts]).encode()).hexdigest()
    rounds = []
    for path in [*ROOT.glob("src/*/*/*.cpp"), *ROOT.glob("src/*/*/*.hpp")]:
        file, kinds = str(path.relative_to(ROOT)), {}
        for kind, defect in sorted(of_file(file), key=lambda d: place(*d[1].key)):
            kinds.setdefault(kind, []).append(defect)
        mixed = sorted((i, place(file, kind), defect) for kind, of_kind in kinds.items() for i, defect in enumerate(of_kind))
        rounds += [(i, place(file), defect) for i, (_, _, defect) in enumerate(mixed)]
    return [defect for _, _, defect in sorted(rounds, key=lambda r: r[:2])]


def rows_of(path):
    """Fields of the lines of a table that are no comments."""
    text = path.read_text() if path.exists() else ""
    return [line.split("\t") for line in text.splitlines() if line and not line.startswith("#")]


def chosen(options):
    """Those to try, one after the other."""
    kept = [Defect(*row) for row in rows_of(DRAWN)] if options.seed == DRAWN_SEED else []
    known = {d.key for d in kept}
    if options.fresh:
        of, files = {}, {d.file for d in kept}
        for defect in draw(options.seed):
            if defect.file not in files and re.search(options.only, defect.file):
                of.setdefault(defect.file, []).append(defect)
        tasks = [d for all_of_file in of.values() for d in all_of_file[:options.fresh]][options.skip:]
        return tasks, options.count or len(tasks)
    there = [d for d in kept if d.applied()]
    if len(there) < len(kept):
        print(f"note: {len(kept) - len(there)} of {len(kept)} lines have gone, others are drawn")
    count = options.count or len(kept) or 300
    more = [d for d in draw(options.seed) if d.key not in known] if len(there) < options.skip + count else []
    return [d for d in [*there, *more] if re.search(options.only, d.file)][options.skip:], count


class MutableCore(Core):
    def dependents(self, header):
        if not hasattr(self, "needs"):
            self.needs = {}
            for source in self.sources:
                for path in self.object(source).with_suffix(".d").read_text().replace("\\\n", " ").split():
                    path = Path(path)
                    if path.suffix == ".hpp":
                        self.needs.setdefault(str(path.resolve().relative_to(self.tree.resolve())), {})[source] = True
        return list(self.needs.get(header, ()))


def nearest_first(header, users):
    return sorted(users, key=lambda u: (u[:-4] != header[:-4], Path(u).parent != Path(header).parent, u))


class Trial:
    """Tries defects, one at a time in each copy of the sources."""

    def __init__(self, core, programs, read_reach, named, folder, tries_named):
        self.core, self.programs, self.named, self.folder, self.tries_named = core, programs, named, folder, tries_named
        self.read_reach, self.reach = read_reach, None  # when it is needed
        self.trees, self.lock, self.passing = [], threading.Lock(), {}

    def tree(self):
        with self.lock:
            if self.trees:
                return self.trees.pop()
            made = Path(tempfile.mkdtemp(prefix="tree", dir=self.folder))
        for part in ("src", "include"):
            shutil.copytree(ROOT / part, made / part)
        return made

    def run_cases(self, program, names, library=None, made=None):
        known = self.reach.cases if self.reach else {}
        seconds = sum(known.get(f"{program} {n}".strip(), {"seconds": LONGEST_CASE})["seconds"] for n in names)
        command = [str(made or self.programs[program])]
        if names == [""]:
            corpus = ROOT / "fuzz/corpus" / program[:-len("_replay")]
            command += [*([str(corpus)] if corpus.is_dir() else []), "--random", "300", "1"]
        else:
            command += ["--gtest_fail_fast", "--gtest_filter=" + ":".join(names)]
        return run(command, 5 + 10 * seconds, library=library)

    def failing(self, program, names, library, made=None):
        """The case that fails with the library, and the program if it was made again, and passes without; or None."""
        names = list(names)
        while names:
            ended = self.run_cases(program, names, library, made)
            if not ended.code:
                return None
            by = re.findall(r"^\[  FAILED  \] ([^ ,]*\.[^ ,]*)|^\[ RUN      \] (\S+)", ended.output, flags=re.M)
            case = ([a for a, _ in by if a] or [b for _, b in by if b][-1:] or [""])[0]
            name = f"{program} {case}".strip()
            if name not in self.passing:
                self.passing[name] = not self.run_cases(program, [case]).code
                if not self.passing[name]:
                    print("note:", name, "fails without a defect and is left out", flush=True)
            if self.passing[name]:
                return name
            names.remove(case)
        return None

    def compiled(self, place, sources, checked=False):
        """[(source, object)] of those whose code changes; None: one does not compile.  checked: with CHECKED."""
        flags = self.core.flags + (CHECKED if checked else [])
        other, objects = Core(place, place / ("checked" if checked else "objects"), "g++", flags), []
        for source in sources:
            if other.compile(source):
                return None
            if checked or other.object(source).read_bytes() != self.core.object(source).read_bytes():
                objects.append((source, other.object(source)))
        return objects

    def noticed_by(self, objects, place, cases, first):
        """The first case that fails with these objects, or None."""
        self.core.link(place / "libcore.so", objects)
        for program, names in self.reach.batches(cases, first):
            by = self.failing(program, names, place)
            if by:
                return by
        return None

    def noticed_by_includers(self, header, objects, place, only="", cases=()):
        """The tests that include a header themselves, compiled with it.  only: this one, and these cases."""
        if objects:
            self.core.link(place / "libcore.so", objects)
        if not (place / "tests").exists():
            shutil.copytree(ROOT / "tests", place / "tests")
        files = files_of_cases(place)
        for source in sorted(set(files.values())):
            program = program_of(source)
            if f'#include "{header}"' in source.read_text() and program in self.programs and only in ("", program):
                made = place / source.stem
                names = [n for n in cases or [n.split(" ")[1] for n in self.reach.cases if n.split(" ")[0] == program]
                         if files.get(without_parameters(n)) == source]
                if names and link_test(source, place, made, self.core.library):
                    by = self.failing(program, names, place, made)
                    if by:
                        return by
        return None

    def users_of(self, file):
        if file.endswith(".cpp"):
            return [file]
        return nearest_first(file, self.core.dependents(file))

    def fate_as_recorded(self, defect, place, named):
        """By the case that noticed it last, alone; or None."""
        users, objects = self.users_of(defect.file), []
        program, _, case = defect.by.partition(" ")
        if named and not self.tries_named:
            objects = self.compiled(place, users[:FIRST_DEPENDENTS])
            if objects is None:
                return {"fate": "no compile"}
            return {"fate": named if objects or len(users) > FIRST_DEPENDENTS else "same code"}
        if program not in self.programs:
            objects = self.compiled(place, users) if defect.file.endswith(".cpp") else True
            return {"fate": "no compile"} if objects is None else {"fate": "same code"} if not objects else None
        for part in (users[:FIRST_DEPENDENTS], users[FIRST_DEPENDENTS:]):
            more = self.compiled(place, part)
            if more is None:
                return {"fate": "no compile"}
            objects += more
            if more:
                self.core.link(place / "libcore.so", objects)
                by = self.failing(program, [case], place)
                if by:
                    return {"fate": "noticed", "by": by}
        if defect.file.endswith(".hpp"):
            by = self.noticed_by_includers(defect.file, objects, place, program, [case])
            if by:
                return {"fate": "noticed", "by": by}
        return None

    def fate(self, defect, place, cases):
        users = self.users_of(defect.file)
        users.sort(key=lambda u: (-len(self.reach.files.get(u, ())), u))
        named = self.named.get((defect.file, defect.was, defect.now))
        objects, rest = [], users
        while rest and not (named and objects):
            part, rest = rest[:FIRST_DEPENDENTS] if rest is users else rest, rest[FIRST_DEPENDENTS:] if rest is users else []
            more = self.compiled(place, part)
            if more is None:
                return {"fate": "no compile"}
            objects += more
            by = self.noticed_by(objects, place, cases, 6) if more else None
            if by:
                return {"fate": "noticed", "by": by}
        if not named and defect.file.endswith(".hpp"):
            by = self.noticed_by_includers(defect.file, objects, place)
            if by:
                return {"fate": "noticed", "by": by}
        if not objects:
            return {"fate": "same code"}
        if not named:
            sources = [s for s, _ in objects]
            by = self.noticed_by(self.compiled(place, sources, True), place, cases, 6)
            if by:  # and not without the defect
                (place / defect.file).write_text((ROOT / defect.file).read_text())
                self.core.link(place / "libcore.so", self.compiled(place, sources, True))
                program, _, case = by.partition(" ")
                if not self.run_cases(program, [case], place).code:
                    return {"fate": "noticed", "by": by}
        return {"fate": named or "survives", "cases": len(cases)}

    def __call__(self, defect):
        line, changed = defect.applied()
        result = {"defect": defect, "line": line, "by": "", "cases": 0}
        named = self.named.get((defect.file, defect.was, defect.now))
        place = self.tree()
        original = (place / defect.file).read_text()
        try:
            (place / defect.file).write_text(changed)
            fate = self.fate_as_recorded(defect, place, named)
            if not fate:
                with self.lock:
                    self.reach = self.reach or self.read_reach()
                cases = self.reach.of(defect.file, line, self.core.dependents(defect.file))
                fate = self.fate(defect, place, cases) if cases else {"fate": named or "not reached"}
            return {**result, **fate}
        finally:
            (place / defect.file).write_text(original)
            with self.lock:
                self.trees.append(place)


class Results:
    """FOLDER/results.txt: fate, file, number among lines alike, line, line with the defect, case."""

    def __init__(self, folder, resume, named):
        self.path, digest = folder / "results.txt", hashlib.sha256()
        for path in sorted(p for part in ("src", "include", "tests", "fuzz") for p in (ROOT / part).rglob("*.[ch]*") if p.is_file()):
            digest.update(path.read_bytes())
        header = f"# sources and tests {digest.hexdigest()[:16]}"
        self.known = {}
        if self.path.exists() and (resume or self.path.read_text().startswith(header)):
            for fate, *key, by in rows_of(self.path):
                self.known[tuple(key)] = (fate, by)
            unknown = lambda k, fate: fate in ("survives", "not reached") and k[:1] + k[2:] not in named
            self.known = {k: v for k, v in self.known.items() if not (resume and unknown(k, v[0]))}
        else:
            self.path.write_text(header + "\n")

    def add(self, result):
        self.known[result["defect"].key] = (result["fate"], result["by"])
        with open(self.path, "a") as file:
            file.write("\t".join([result["fate"], *result["defect"].key, result["by"]]) + "\n")


def table_of(fates):
    """fates: {folder: {fate: count}}"""
    fates = {**dict(sorted(fates.items())), "all": {c: sum(f.get(c, 0) for f in fates.values()) for c in COLUMNS}}
    rows = [f"| folder | applied | {' | '.join(COLUMNS)} |", "|---|" + "--:|" * (len(COLUMNS) + 1)]
    for name, counts in fates.items():
        rows.append(f"| {name} | {sum(counts.values())} | " + " | ".join(str(counts.get(c, 0)) for c in COLUMNS) + " |")
    return "\n".join(rows)


def write_drawn(tried, known):
    comments = [line for line in DRAWN.read_text().splitlines() if line.startswith("#")] if DRAWN.exists() else []
    there = [d for d in (Defect(*row) for row in rows_of(DRAWN)) if d.applied()]
    listed, by = {d.key for d in there}, {d.key: known[d.key][1] for d in tried}
    there += [d for d in tried if d.key not in listed and known[d.key][0] != "no compile"]
    rows = ["\t".join([*d.key, by.get(d.key, d.by)]) for d in there]
    DRAWN.write_text("\n".join([*comments, *rows]) + "\n")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("folder")
    parser.add_argument("--count", type=int, default=0, help="0: all of the table of drawn ones, or 300")
    parser.add_argument("--skip", type=int, default=0)
    parser.add_argument("--seed", type=int, default=DRAWN_SEED)
    parser.add_argument("--only", default="")
    parser.add_argument("--reach")
    parser.add_argument("--patience", type=float, default=40, help="seconds of cases for each defect")
    parser.add_argument("--resume", action="store_true", help="keep results of other sources and tests, but of survivors")
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--fresh", type=int, default=0, help="so many of each file without any in the table of drawn ones")
    parser.add_argument("--named", action="store_true", help="run cases on named defects as well")
    parser.add_argument("--as-built", action="store_true", help="the core is as in the last run")
    options = parser.parse_args()
    folder = Path(options.folder).resolve()
    core = MutableCore(ROOT, folder / "core", "g++", ["-O1"])
    if not options.as_built:
        build_release()
        core.compile_all()
        core.link()
    programs = core.link_programs()

    def read_reach():
        path = Path(options.reach or folder.parent / "coverage/reach.json")
        if not path.exists():
            subprocess.run([sys.executable, ROOT / "tests/mutation/coverage.py", path.parent, "--quick"], check=True, stdout=subprocess.DEVNULL)
        reach = Reach(path, options.patience)
        reach.keep(programs)
        return reach
    kinds = {"speed": "speed or memory", "memory": "speed or memory", "open": "open"}
    named = {(file, was, now): kinds.get(reason.split(":")[0], "changes nothing") for file, was, now, reason in rows_of(NAMED)}
    for old in folder.glob("tree*"):
        shutil.rmtree(old)
    results, trial = Results(folder, options.resume, named), Trial(core, programs, read_reach, named, folder, options.named)
    fates, survivors, tried, (tasks, count) = {}, 0, [], chosen(options)

    def take(result):
        nonlocal survivors
        defect, fate = result["defect"], result["fate"]
        tried.append(defect)
        if fate == "no compile":
            return
        counts = fates.setdefault(defect.file.split("/")[1], {})
        counts[fate] = counts.get(fate, 0) + 1
        if fate == "survives":
            survivors += 1
            print(f"not ok mutation {defect.file}:{result['line']}: '{defect.now}' in place of '{defect.was}' survives {result['cases']} cases", flush=True)

    def try_one(defect):
        if defect.key in results.known:
            fate, by = results.known[defect.key]
            return {"defect": defect, "line": 0, "cases": 0, "fate": named.get(defect.key[:1] + defect.key[2:], fate) if fate != "noticed" else fate, "by": by}
        result = trial(defect)
        with trial.lock:
            results.add(result)
        return result

    def applied():
        return sum(sum(counts.values()) for counts in fates.values())
    with ThreadPoolExecutor(jobs()) as pool:
        at = 0
        while applied() < count and at < len(tasks):
            part = tasks[at:at + min(4 * jobs(), count - applied())]
            at += len(part)
            for result in pool.map(try_one, part):
                take(result)
    (folder / "table.md").write_text(table_of(fates) + "\n")
    print(table_of(fates))
    if options.write:
        write_drawn(tried, results.known)
    print(f"{'not ok' if survivors else 'ok'} derived mutations: {applied()} with seed {options.seed}, {survivors} survive, "
          f"{sum(f.get('open', 0) for f in fates.values())} are known and open")
    return 1 if survivors else 0


if __name__ == "__main__":
    sys.exit(main())
