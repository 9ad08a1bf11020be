"""Defects derived from the sources: is each of them noticed?

derived_mutations.py FOLDER [--count 300] [--seed 1] [--reach FILE] [--only PATTERN] [--skip N] [--patience 40]

Each changes one thing in one file of src: a comparison, a logical operator, a sign, a number, the answer of a condition, a
statement that is left out.  They are drawn by seed, from every file, and taken in an order that goes through the
files again and again, so that a part of the run is a sample of all of it.  For each the file is compiled again, the core
linked as a shared library, and the cases that reach the line run, the quickest first, until one fails.  FILE is
reach.json of coverage.py (default: FOLDER/../coverage/reach.json).

noticed      a case fails, crashes or does not end
same code    the object file is the same: nothing was changed
named        in tests/equivalent_mutations.txt with the reason why no test can notice it
not reached  no case below five seconds reaches the line
survives     must not be

The table is FOLDER/table.md, one line for each in FOLDER/log.txt.
"""

import argparse
import json
import random
import re
import shutil
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from core_builds import ROOT, Core, build_release, jobs, run

MOST_DEPENDENTS = 12  # of a header: it takes a file each to compile
NAMED = ROOT / "tests/equivalent_mutations.txt"

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
STATEMENT = re.compile(r"^\s+(?!return|else|if|for|while|do|delete|using|goto|case|break|continue|throw)"
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

    def batches(self, cases):
        """[(program, [case])]: the quickest few first, then more and more at a time."""
        at, size = 0, 6
        while at < len(cases):
            part = {}
            for name in cases[at:at + size]:
                program, _, case = name.partition(" ")
                part.setdefault(program, []).append(case)
            yield from part.items()
            at, size = at + size, 3 * size


def draw(core, seed, only):
    """Defects as (file, defect), file after file, again and again."""
    files = sorted(str(p.relative_to(ROOT)) for p in [*ROOT.glob("src/*/*.cpp"), *ROOT.glob("src/*/*.hpp")])
    lists = []
    for file in files:
        if not re.search(only, file):
            continue
        if file.endswith(".hpp") and not 0 < len(core.dependents(file)) <= MOST_DEPENDENTS:
            continue
        found = defects((ROOT / file).read_text(), file.endswith(".hpp"))
        random.Random(f"{seed} {file}").shuffle(found)
        # As many of a kind of change as of the others: there are most numbers and comparisons.
        kinds = {}
        for defect in found:
            kinds.setdefault(defect[3], []).append(defect)
        order = sorted(kinds, key=lambda k: random.Random(f"{seed} {file} {k}").random())
        mixed = [kinds[k][i] for i in range(max(map(len, kinds.values()), default=0)) for k in order if i < len(kinds[k])]
        lists.append([(file, d) for d in mixed])
    random.Random(str(seed)).shuffle(lists)
    return [entries[i] for i in range(max(map(len, lists), default=0)) for entries in lists if i < len(entries)]


class MutableCore(Core):
    def dependents(self, header):
        if not hasattr(self, "needs"):
            self.needs = {}
            for source in self.sources:
                for path in self.object(source).with_suffix(".d").read_text().replace("\\\n", " ").split():
                    path = Path(path)
                    if path.suffix == ".hpp":
                        self.needs.setdefault(str(path.resolve().relative_to(self.tree.resolve())), []).append(source)
        return self.needs.get(header, [])


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("folder")
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--skip", type=int, default=0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="")
    parser.add_argument("--reach")
    parser.add_argument("--patience", type=float, default=40, help="seconds of cases for each defect")
    parser.add_argument("--as-built", action="store_true", help="the core, and the passing cases, are as in the last run")
    options = parser.parse_args()
    folder = Path(options.folder).resolve()
    if not options.as_built:
        build_release()
    reach = Reach(options.reach or folder.parent / "coverage/reach.json", options.patience)
    core = MutableCore(ROOT, folder / "core", "g++", ["-O1"])
    if not options.as_built:
        core.compile_all()
        core.link()
    programs = core.link_programs()
    reach.keep(programs)
    named = set()
    for line in NAMED.read_text().splitlines() if NAMED.exists() else ():
        if line and not line.startswith("#"):
            named.add(tuple(line.split("\t")[:3]))
    trees, free = [], threading.Lock()

    def tree():
        """A copy of src and include for one worker."""
        with free:
            if trees:
                return trees.pop()
        made = folder / f"tree{threading.get_ident()}"
        shutil.rmtree(made, ignore_errors=True)
        for part in ("src", "include"):
            shutil.copytree(ROOT / part, made / part)
        return made

    def try_one(task):
        file, (position, length, instead, kind) = task
        source = (ROOT / file).read_text()
        line = source.count("\n", 0, position) + 1
        changed = source[:position] + instead + source[position + length:]
        was, now = (text.split("\n")[line - 1].strip() for text in (source, changed))
        result = {"file": file, "line": line, "kind": kind, "was": was, "now": now}
        cases = reach.of(file, line, core.dependents(file))
        if not cases:
            return {**result, "fate": "not reached"}
        place = tree()
        try:
            (place / file).write_text(changed)
            other = Core(place, place / "objects", "g++", core.flags)
            objects = []
            for source_file in [file] if file.endswith(".cpp") else core.dependents(file):
                if other.compile(source_file):
                    return {**result, "fate": "no compile"}
                made = other.object(source_file)
                if made.read_bytes() != core.object(source_file).read_bytes():
                    objects.append((source_file, made))
            if not objects:
                return {**result, "fate": "same code"}
            core.link(place / "libcore.so", objects)
            for program, names in reach.batches(cases):
                seconds = sum(reach.cases[f"{program} {n}".strip()]["seconds"] for n in names)
                command = [str(programs[program])]
                if names == [""]:
                    corpus = ROOT / "fuzz/corpus" / program[:-len("_replay")]
                    command += [*([str(corpus)] if corpus.is_dir() else []), "--random", "300", "1"]
                else:
                    command += ["--gtest_fail_fast", "--gtest_filter=" + ":".join(names)]
                ended = run(command, 5 + 10 * seconds, library=place)
                if ended.code:
                    by = re.findall(r"^\[  FAILED  \] ([^ ,]*\.[^ ,]*)|^\[ RUN      \] (\S+)", ended.output, flags=re.M)
                    failed = [a for a, _ in by if a] or [b for _, b in by if b][-1:] or [program]
                    return {**result, "fate": "noticed", "by": failed[0]}
            return {**result, "fate": "named" if (file, was, now) in named else "survives", "cases": len(cases)}
        finally:
            (place / file).write_text(source)
            with free:
                trees.append(place)

    # Without a defect the cases pass.
    for program, names in () if options.as_built else reach.batches(sorted(reach.cases)):
        if names != [""]:
            ended = run([str(programs[program]), "--gtest_filter=" + ":".join(names)], 600)
            for bad in set(re.findall(r"^\[  FAILED  \] ([^ ,]*\.[^ ,]*)", ended.output, flags=re.M)):
                print("note:", program, bad, "fails without a defect and is left out")
                reach.cases.pop(f"{program} {bad}", None)
                for entries in reach.lines.values():
                    entries[:] = [e for e in entries if e != f"{program} {bad}"]

    log = open(folder / "log.txt", "w")
    fates, survivors, done = {}, [], 0
    tasks = draw(core, options.seed, options.only)[options.skip:]
    with ThreadPoolExecutor(jobs()) as pool:
        at = 0
        while done < options.count and at < len(tasks):
            part = tasks[at:at + min(4 * jobs(), options.count - done)]
            at += len(part)
            for result in pool.map(try_one, part):
                text = f"{result['fate']}\t{result['file']}:{result['line']}\t{result['kind']}\t{result['was']}\t{result['now']}\t{result.get('by', '')}"
                log.write(text + "\n")
                log.flush()
                if result["fate"] == "no compile":
                    continue
                done += 1
                counts = fates.setdefault(result["file"].split("/")[1], {})
                counts[result["fate"]] = counts.get(result["fate"], 0) + 1
                if result["fate"] == "survives":
                    survivors.append(result)
                    print(f"not ok mutation {result['file']}:{result['line']}: '{result['now']}' in place of '{result['was']}' survives {result['cases']} cases", flush=True)
    columns = ["noticed", "same code", "named", "not reached", "survives"]
    rows = [f"| folder | applied | {' | '.join(columns)} |", "|---|" + "--:|" * (len(columns) + 1)]
    fates["all"] = {c: sum(f.get(c, 0) for f in fates.values()) for c in columns}
    for name in [*sorted(n for n in fates if n != "all"), "all"]:
        rows.append(f"| {name} | {sum(fates[name].values())} | " + " | ".join(str(fates[name].get(c, 0)) for c in columns) + " |")
    (folder / "table.md").write_text("\n".join(rows) + "\n")
    print("\n".join(rows))
    print(f"{'not ok' if survivors else 'ok'} derived mutations: {done} with seed {options.seed}, {len(survivors)} survive")
    return 1 if survivors else 0


sys.exit(main())
