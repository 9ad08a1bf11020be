#!/usr/bin/env python3
"""The map of the source against the source.

    tests/checks/check_map.py [BUILD_FOLDER]

- The tables of folders in src/README.md name each folder of src, and beside it the folders that it
  depends on: those that its files include, without those that follow.  There is no circle.
- No folder has more lines than its budget in these tables.
- The folders of the core (CMakeLists.txt) include no file of the applications, and not their header.
  With a build folder: the core library needs no symbol that only the applications have.
- A name in an anonymous namespace is that of one file, and hides no name of namespace hmf, so that all
  files can be compiled as one.
- Each file that a page names in backquotes is there, and so is each place that a link leads to.
- Each file of src begins with what it does, or belongs to a header that does.

Prints a line "ok" or "not ok" for each check, as all check_* do.
"""
import pathlib
import re
import subprocess
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


def folder_of(path):
    """core/NAME or applications/NAME"""
    return path.parent.relative_to(SRC).as_posix() if path.is_relative_to(SRC) else ""


def includes():
    """folder -> the other folders that its files include"""
    found = {}
    for path in sorted(SRC.glob("*/*/*.[ch]pp")):
        uses = found.setdefault(folder_of(path), set())
        for name in re.findall(r'#include "([^"]+)"', path.read_text()):
            to = (path.parent / name).resolve()
            if to.is_relative_to(SRC) and to.parent != path.parent:
                uses.add(folder_of(to))
    return found


def table():
    """folder, what it depends on, its budget of lines"""
    return re.findall(r"^\| `(\w+/\w+)` \|([^|]*)\|\s*(\d+)\s*\|", MAP.read_text(), re.M)


def folders(name):
    """A list of folders in CMakeLists.txt."""
    names = re.search(rf"set\(hmf_{name}_folders([^)]*)\)", (ROOT / "CMakeLists.txt").read_text()).group(1).split()
    return [f"{'core' if name == 'core' else 'applications'}/{folder}" for folder in names]


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
    rows = {name: uses for name, uses, _ in table()}
    for folder in sorted(set(graph) ^ set(rows)):
        yield f"{folder} is in the {'tree' if folder in graph else 'table'} only"
    for folder, uses in sorted(graph.items()):
        if folder in reachable(graph, folder):
            yield f"{folder} depends on itself, by {', '.join(sorted(uses))}"
            continue
        direct = {a for a in uses if not any(a in reachable(graph, b) for b in uses - {a})}
        named = set(re.findall(r"[\w/]+", rows.get(folder, "")))
        if folder in rows and named not in (direct, {"all"}):
            yield f"{folder} depends on {', '.join(sorted(direct))}; the table says {', '.join(sorted(named))}"


def budget_problems():
    for folder, _, budget in table():
        lines = sum(len(path.read_text().splitlines()) for path in (SRC / folder).glob("*.[ch]pp"))
        if lines > int(budget):
            yield f"{folder} has {lines} lines; its budget in src/README.md is {budget}"


def layer_problems():
    core, applications = folders("core"), folders("application")
    for folder in sorted({folder_of(path) for path in SRC.glob("*/*/*.cpp")} ^ {*core, *applications}):
        yield f"{folder} is in the tree or in CMakeLists.txt only"
    for path in (path for folder in core for path in sorted((SRC / folder).glob("*.[ch]pp"))):
        for name in re.findall(r'#include "([^"]+)"', path.read_text()):
            to = (path.parent / name).resolve()
            if folder_of(to) in applications or to.name == "applications.h":
                yield f"{path.relative_to(ROOT)} includes {to.relative_to(ROOT)}"


def link_closure_problems(build):
    def symbols(library):
        lines = subprocess.run(["nm", build / library], check=True, text=True, capture_output=True).stdout.splitlines()
        pairs = [line.split()[-2:] for line in lines if re.search(r" [A-Za-z] \S+$", line)]
        return {name for kind, name in pairs if kind != "U"}, {name for kind, name in pairs if kind == "U"}

    core, needed = symbols("libhmf_core.a")
    for name in sorted(needed - core & symbols("libhmf.a")[0]):
        yield f"the core needs {name}"


def declared_names(path):
    """The names that a file declares in anonymous namespaces, and outside of them."""
    text = re.sub(r'//.*|"(\\.|[^"\\])*"|^\s*#(.*\\\n)*.*$|\[\[\w+\]\]', "", path.read_text(), flags=re.M)
    found, scopes, declaration, braces, parentheses = (set(), set()), [], "", 0, 0
    for c in text:
        at_end = c in "{};" and braces == 0 and parentheses == 0
        if at_end and c == "{" and re.match(r"\s*(namespace\b|extern\s*$)", declaration):
            scopes.append(re.fullmatch(r"\s*namespace\s*", declaration) is not None)
        elif at_end and c == "}" and scopes:
            scopes.pop()
        elif at_end:
            found[0 if any(scopes) else 1].update(names_declared_by(" ".join(declaration.split())))
            braces = c == "{"
        elif braces:
            braces += {"{": 1, "}": -1}.get(c, 0)
        else:
            parentheses += {"(": 1, ")": -1}.get(c, 0)
            declaration += c
            continue
        declaration = ""
    return found


def names_declared_by(text):
    text = re.sub(r"^template ?<.*?> (?=\w)", "", text)
    for pattern in (r"(?:struct|class|enum class|enum) (?:HMF_\w+ )?(\w+)(?: final)?(?: :.*)?$", r"using (\w+) =",
                    r"(?!using\b)[^(=]*?[\w>&*] ?(?<!operator)[ &*](\w+)(?: ?\(| ?\[| ?=| ?$)"):
        match = re.match(pattern, text)
        if match:
            constants = re.findall(r", (\w+) =", text) if text[match.end() - 1] == "=" else []
            return [match.group(1), *constants]
    return []


def unity_problems():
    local, shared = {}, {}
    for path in sorted(SRC.glob("*/*/*.[ch]pp")):
        for names, into in zip(declared_names(path), (local, shared)):
            for name in names:
                into.setdefault(name, []).append(path.relative_to(SRC).as_posix())
    for name, files in sorted(local.items()):
        others = files[1:] or shared.get(name, [])
        if others:
            yield f"{name} of {files[0]} is also a name of {', '.join(others)}"


def name_problems():
    files = [path.relative_to(ROOT).as_posix() for top in ("src", "include", "tests", "fuzz", "bench", "docs", "bindings")
             for path in (ROOT / top).rglob("*.*") if "node_modules" not in path.parts]
    for page in PAGES:
        for name in re.findall(r"`([\w/.-]+\.(?:cpp|hpp|h|py|md))`", page.read_text()):
            if not any(("/" + file).endswith("/" + name) for file in files) and not (ROOT / name).exists():
                yield f"{page.relative_to(ROOT)}: there is no {name}"
    picture = re.search(r"## Data flow\n((?: {4}.*\n|\n)+)", MAP.read_text()).group(1)
    for folder, name in re.findall(r"\b(\w+)/([a-z]\w*)\b", picture):
        if folder != "include" and not any(SRC.glob(f"*/{folder}/{name}.*")):
            yield f"src/README.md: there is no {folder}/{name}"
    for folder in re.findall(r"\b(\w+)/(?=\s)", picture):
        if not any(SRC.glob(f"*/{folder}")):
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

    for path in sorted(SRC.glob("*/*/*.[ch]pp")):
        header = re.match(r'(?://.*\n)*#include "([\w.]+)"', path.read_text())
        if not says(path) and not (header and says(path.parent / header.group(1))):
            yield f"{path.relative_to(ROOT)}: no head comment"


report("folders", folder_problems())
report("budgets", budget_problems())
report("layers", layer_problems())
if len(sys.argv) > 1:
    report("link closure", link_closure_problems(pathlib.Path(sys.argv[1])))
report("unity names", unity_problems())
report("names", name_problems())
report("links", link_problems())
report("heads", head_problems())
sys.exit(failed)
