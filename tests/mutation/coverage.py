"""Lines of the core that the tests and the fuzz corpora reach.

coverage.py FOLDER [--quick] [--resume]   prints a table; FOLDER/uncovered.txt has each line that is not reached

Source-based coverage of clang.  Fails below LINES.  The lines that are not reached are told apart by REASONS.  --quick: only
cases of less than two seconds; no gate.  --resume: what is older than its sources is compiled; cases that have been measured with this
core and this test program are not run again.  FOLDER/reach.json: for each case its processor time and the lines that it reaches,
for derived_mutations.py.
"""

import json
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from core_builds import ROOT, Core, Ended, build_release, cases_of, jobs, run

LINES = 97.5  # per cent
NAMED = ROOT / "tests/mutation/uncovered_lines.txt"
# Of lines that are not reached, by their text; for the others see uncovered_lines.txt, and what is not there is printed.
REASONS = [
    ("defect of the library itself, which must not happen", r"Please report|HMF_ERROR_INTERNAL"),
    ("way out of a call that has failed", r"out_of_memory|was_cancelled|stopped\(\)|call_?\.status\(\)|return false;|return nullptr;"
     r"|return status;|failed\(call_?\)|memory\.failure|free_block|free_part"),
    ("sentence of an error", r'^"|call_?\.fail\(|static_cast<(Long|int|unsigned|unsigned long long)>'),
    ("end of a block", r"^[})\];]*$|^default:$|^break;$|^continue;$"),
]


def lines_of(profile, core):
    """{file: {line: reached}}"""
    listed = subprocess.run(["llvm-cov", "export", "-format=lcov", f"-instr-profile={profile}", str(core.library)],
                            capture_output=True, text=True, check=True).stdout
    found, lines = {}, None
    for line in listed.splitlines():
        if line.startswith("SF:"):
            path = Path(line[3:])
            lines = found.setdefault(str(path.relative_to(ROOT)), {}) if path.is_relative_to(ROOT / "src") else {}
        elif line.startswith("DA:"):
            number, count = line[3:].split(",")[:2]
            lines[int(number)] = lines.get(int(number), 0) + int(count)
    return found


def profile_of(raw, to):
    subprocess.run(["llvm-profdata", "merge", "-sparse", *map(str, raw), "-o", str(to)], check=True, capture_output=True)
    return to


def ranges(numbers):
    """[3, 4, 5, 9] as "3-5,9"."""
    parts, numbers = [], sorted(numbers)
    for n in numbers:
        if parts and parts[-1][1] == n - 1:
            parts[-1][1] = n
        else:
            parts.append([n, n])
    return ",".join(str(a) if a == b else f"{a}-{b}" for a, b in parts)


def main():
    folder, quick, resume = Path(sys.argv[1]).resolve(), "--quick" in sys.argv, "--resume" in sys.argv
    build_release()
    core = Core(ROOT, folder / "core", "clang++", ["-O1", "-fprofile-instr-generate", "-fcoverage-mapping"])
    core.update()
    programs = core.link_programs()
    changed = {name: max(f.stat().st_mtime for f in [core.library, *core.objects_of(name)]) for name in programs}
    raw_folder = folder / "raw"
    raw_folder.mkdir(exist_ok=True)
    known = json.loads((folder / "reach.json").read_text()) if resume and (folder / "reach.json").exists() else {}
    reach = {}
    all_raw, failed = [], []
    tasks = []
    for name, program in programs.items():
        if name.endswith("_replay"):
            corpus = ROOT / "fuzz/corpus" / name[:-len("_replay")]
            tasks.append((name, [str(program), *([str(corpus)] if corpus.is_dir() else []), "--random", "300", "1"]))
        else:
            tasks += [(f"{name} {case}", [str(program), f"--gtest_filter={case}"]) for case in cases_of(program)]

    def raw_of(name):
        return raw_folder / (name.replace("/", "_").replace(" ", "__") + ".raw")

    def measure(task):
        name, command = task
        raw = raw_of(name)
        if resume and raw.exists() and raw.stat().st_size and raw.stat().st_mtime > changed[name.split()[0]]:
            if name in known:
                reach[name] = known[name]
            return name, raw, Ended(0, 0, ""), None
        raw.unlink(missing_ok=True)
        ended = run(command, 2 if quick and " " in name else 600, environment={"LLVM_PROFILE_FILE": str(raw)})
        if not raw.exists() or not raw.stat().st_size:
            return name, None, ended, None
        if ended.code or ended.seconds > 5:
            return name, raw, ended, None
        one = profile_of([raw], raw.with_suffix(".profdata"))
        lines = lines_of(one, core)
        one.unlink()
        return name, raw, ended, lines
    with ThreadPoolExecutor(jobs()) as pool:
        for name, raw, ended, lines in pool.map(measure, tasks):
            if ended.code and not quick:
                failed.append(name)
            if raw:
                all_raw.append(raw)
            if lines is not None:
                reach[name] = {"seconds": round(ended.seconds, 3),
                               "lines": {f: ranges(n for n, c in counts.items() if c) for f, counts in lines.items()}}
    (folder / "reach.json").write_text(json.dumps(reach))
    found = lines_of(profile_of(all_raw, folder / "all.profdata"), core)
    for name in failed:  # runs again with --resume
        raw_of(name).unlink(missing_ok=True)

    # --- Table and gate
    total, reached, folders, missing = 0, 0, {}, []
    for file, counts in sorted(found.items()):
        text = (ROOT / file).read_text().splitlines()
        part = folders.setdefault(file.split("/")[1], [0, 0])
        for number, count in sorted(counts.items()):
            total, part[1] = total + 1, part[1] + 1
            if count:
                reached, part[0] = reached + 1, part[0] + 1
            else:
                missing.append((file, number, text[number - 1].strip()))
    (folder / "uncovered.txt").write_text("".join(f"{f}:{n}\t{t}\n" for f, n, t in missing))
    print("| folder | lines | reached |\n|---|--:|--:|")
    for name, (have, of) in sorted(folders.items()):
        print(f"| {name} | {of} | {100 * have / of:.1f} % |")
    percent = 100 * reached / total
    if quick:
        print(f"quick: {percent:.2f} % of {total} lines by {len(reach)} cases")
        return 0
    for task in failed:
        print("not ok coverage", task, "fails")
    ok = percent >= LINES
    print(f"{'ok' if ok else 'not ok'} coverage: {reached} of {total} lines, {percent:.2f} %; at least {LINES} % are asked for")

    rest = list(missing)
    for name, pattern in REASONS:
        of, rest = [m for m in rest if re.search(pattern, m[2])], [m for m in rest if not re.search(pattern, m[2])]
        print(f"    {len(of)} lines: {name}")
    named = [line.split("\t") for line in NAMED.read_text().splitlines() if line and not line.startswith("#")]

    def is_named(line):
        return any(line[0] == file and re.search(pattern, line[2]) for file, pattern, _ in named)
    of, rest = [m for m in rest if is_named(m)], [m for m in rest if not is_named(m)]
    print(f"    {len(of)} lines: named in {NAMED.relative_to(ROOT)}")
    print(f"    {len(rest)} lines: other")
    for file, number, text in rest:
        print(f"        {file}:{number}: {text}")
    return 1 if failed or not ok else 0


sys.exit(main())
