#!/usr/bin/env python3
"""The reference site: static pages made from the headers, the docstrings, the gallery and the texts of the repository.

    build_site.py FOLDER      needs mkdocs; FOLDER/index.html is the start; with cargo and npm also the pages of
                              rustdoc and TypeDoc (HMF_SITE_API=0: without); with the tool, HMF_TOOL or of a build,
                              the page of its options
    build_site.py --check FOLDER   no dead link or picture in it

Nothing is written twice: every page is a text of the repository, or is read out of the sources.
"""

from __future__ import annotations

import ast
import html.parser
import os
import re
import shutil
import subprocess
import sys
import tempfile
import urllib.parse
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BINDINGS = ROOT / "bindings"

# Section, then title and page of each; a text of the repository with its path, other pages are generated.
SITE = {
    "": [("hmf", "index.md", "README.md")],
    "Guides": [
        ("Getting started", "getting-started.md", "docs/getting-started.md"),
        ("The tool", "tool.md", "docs/tool.md"),
        ("Loops and classes", "loops.md", "docs/loops.md"),
        ("Boundaries and marked vertices", "boundary.md", "docs/boundary.md"),
        ("Quads", "quads.md", "docs/quads.md"),
        ("Atlas", "atlas.md", "docs/atlas.md"),
        ("Threads", "threads.md", "docs/threads.md"),
        ("Embedding", "embedding.md", "docs/embedding.md"),
        ("Gallery", "gallery.md", None),
    ],
    "Reference": [
        ("All languages", "reference.md", None),
        ("The tool, every option", "tool_options.md", None),
        ("C", "c.md", None),
        ("C++", "cpp.md", None),
        ("Python", "python.md", "bindings/python/README.md"),
        ("Python, every function", "python_reference.md", None),
        ("JavaScript", "javascript.md", "bindings/javascript/README.md"),
        ("Rust", "rust.md", "bindings/rust/foliations/README.md"),
        ("Compatibility", "abi.md", "docs/abi.md"),
    ],
    "Background": [
        ("Mathematics", "mathematics.md", "docs/mathematics.md"),
        ("Architecture", "architecture.md", "docs/architecture.md"),
        ("Map of the source", "source.md", "src/README.md"),
        ("Reliability", "reliability.md", "docs/reliability.md"),
        ("Benchmarks", "benchmarks.md", "bench/README.md"),
        ("Constants of the solver", "steering.md", "bench/steering.md"),
    ],
    "Project": [
        ("Contributing", "contributing.md", "CONTRIBUTING.md"),
        ("Security", "security.md", "SECURITY.md"),
        ("Releases", "releasing.md", "docs/releasing.md"),
        ("Packages", "packages.md", "bindings/packaging/README.md"),
        ("Changes", "changes.md", "CHANGELOG.md"),
    ],
}
TEXTS = {page: text for pages in SITE.values() for _, page, text in pages if text}


def page_of(path: Path) -> str | None:
    return next((page for page, text in TEXTS.items() if (ROOT / text).resolve() == path), None)


def translated(text: str, home: Path, pages: Path) -> str:
    """Links of a text of the repository: to pages where there is one, pictures are copied, the rest are only named."""

    def link(match: re.Match[str]) -> str:
        bang, label, target = match.groups()
        address, _, part = target.partition("#")
        if re.match(r"[a-z]+:", target) or not address:
            return match[0]
        path = (home / address).resolve()
        part = "#" + part if part else ""
        if path.suffix in (".png", ".svg") and path.is_file():
            name = "_".join(path.relative_to(ROOT).parts)
            shutil.copy2(path, pages / name)
            return f"{bang}[{label}]({name})"
        if page := page_of(path / "README.md" if path.is_dir() else path):
            return f"[{label}]({page}{part})"
        if path == BINDINGS / "rust" or path.parent.name == "examples" and path.suffix == ".py":
            return f"[{label}]({'rust.md' if path.name == 'rust' else 'gallery.md#' + path.stem})"
        if path.name in ("hmf.h", "applications.h"):
            return f"[{label}](c.md)"
        if path.name in ("hmf.hpp", "applications.hpp"):
            return f"[{label}](cpp.md)"
        return label
    # A picture inside a link first becomes a picture.
    text = re.sub(r"(!)\[([^\]]*)\]\(([^)\s]+)\)", link, text)
    return re.sub(r"(?<!!)()\[([^\[\]]*)\]\(([^)\s]+)\)", link, text)


def comment_text(comment: str) -> str:
    return "\n".join(re.sub(r"^ \* ?", "", line) for line in comment.strip().splitlines()).strip()


def header_pages(pages: Path) -> list[str]:
    """Contract and declaration of each function, structure and constant, in the order of the headers."""
    functions = []
    out = ["# C\n\nThe public headers, as they are. `hmf.h` is the core, `applications.h` what one does with a foliation.\n"]
    for name in ("hmf.h", "applications.h"):
        text = (ROOT / "include" / "hmf" / name).read_text()
        out.append(f"## {name}\n")
        at = 0
        for match in re.finditer(r"/\*(.*?)\*/\s*((?:typedef [^{;]*\{.*?\} \w+;|HMF_API[^;]*;|typedef [^;{]*;)(?:\s*HMF_API[^;]*;)*)?", text, re.S):
            declaration = match[2]
            if not declaration:
                continue
            title = re.findall(r"\b(hmf_\w+)\s*\(", declaration) or re.findall(r"(\w+);\s*$", declaration)
            functions += re.findall(r"HMF_API[^;(]*?\b(hmf_\w+)\s*\(", declaration)
            out.append(f"### {', '.join(title[:1])}\n\n```text\n{comment_text(match[1])}\n```\n\n```c\n{declaration.strip()}\n```\n")
            at = match.end()
        for function in re.findall(r"HMF_API[^;(]*?\b(hmf_\w+)\s*\(", text):
            if function not in functions:
                functions.append(function)
                declaration = re.search(rf"HMF_API[^;]*\b{function}\s*\([^;]*;", text)[0]
                out.append(f"### {function}\n\n```c\n{declaration}\n```\n")
        assert at
    (pages / "c.md").write_text("\n".join(out))
    cpp = ["# C++\n\nHeader only; classes that free themselves, vectors, exceptions.\n"]
    for name in ("hmf.hpp", "applications.hpp"):
        cpp.append(f"## {name}\n\n```cpp\n{(ROOT / 'include' / 'hmf' / name).read_text()}\n```\n")
    (pages / "cpp.md").write_text("\n".join(cpp))
    return functions


# What each language calls it; "-": nothing of its own.  Every name must be in the sources.
SOURCES = {
    "C++": [ROOT / "include/hmf/hmf.hpp", ROOT / "include/hmf/applications.hpp"],
    "Python": sorted((BINDINGS / "python/src/foliations").glob("*.py")),
    "JavaScript": [BINDINGS / "javascript/lib/index.d.ts"],
    "Rust": sorted((BINDINGS / "rust/foliations/src").glob("**/*.rs")),
}
NAMES = """
hmf_version                    -                          __version__              version                  version
hmf_status_string              Error                      Error                    statusText               Error
hmf_free                       -                          -                        -                        -
hmf_hierarchy_create           Hierarchy                  Hierarchy                Hierarchy                Hierarchy.build
hmf_suggest_marks              suggest_marks              suggest_marks            suggestMarks             suggest_marks
hmf_hierarchy_destroy          -                          -                        Hierarchy.dispose        -
hmf_hierarchy_memory_estimate  Hierarchy.memory_estimate  memory_estimate          memoryEstimate           memory_estimate
hmf_hierarchy_describe         Hierarchy.level            Hierarchy.levels         Hierarchy.levels         Hierarchy.level
hmf_level                      Hierarchy.mesh             Level                    Level                    Hierarchy.edge_vertices
hmf_loops                      loops                      Hierarchy.loops          Hierarchy.loops          Hierarchy.loops
hmf_foliation_from_loops       Hierarchy.initialize       Hierarchy.initialize     Hierarchy.initialize     Hierarchy.initialize
hmf_foliation_from_values      Hierarchy.foliation        Hierarchy.foliation      Hierarchy.foliation      Hierarchy.foliation
hmf_foliation_destroy          -                          -                        Foliation.dispose        -
hmf_foliation_report           Solution.report            Foliation.report         Foliation.report         Foliation.report
hmf_solve                      Hierarchy.solve            Hierarchy.solve          Hierarchy.solve          Hierarchy.solve
hmf_relax                      Foliation.relax            Foliation.relax          Foliation.relax          Foliation.relax
hmf_interpolate                Foliation.to_level         Foliation.interpolate    Foliation.interpolate    Foliation.interpolate
hmf_energy                     Foliation.energy           Foliation.energy         Foliation.energy         Foliation.energy
hmf_residuals                  Foliation.residuals        Foliation.residuals      Foliation.residuals      Foliation.residuals
hmf_singularities              Foliation.singularities    Foliation.singularities  Foliation.singularities  Foliation.singularities
hmf_parameterize               parameterize               Foliation.parameterize   Foliation.parameterize   Foliation.parameterize
hmf_trace                      trace                      Foliation.trace          Foliation.trace          Foliation.trace
hmf_cylinders                  cylinders                  Foliation.cylinders      Foliation.cylinders      Foliation.cylinders
hmf_quads                      quads                      Foliation.quads          Foliation.quads          Foliation.quads
hmf_atlas                      atlas                      Foliation.atlas          Foliation.atlas          Foliation.atlas
"""


def reference_page(pages: Path, functions: list[str]) -> None:
    names = {row.split()[0]: row.split()[1:] for row in NAMES.strip().splitlines()}
    texts = {language: "\n".join(p.read_text() for p in files) for language, files in SOURCES.items()}
    missing = [f"{f} is not in the headers" for f in names if f not in functions]
    for function in functions:
        if function in names:
            continue
        # A new one: by its own name, of its object, where a language has that.
        owner, name = re.fullmatch(r"hmf_(foliation_|hierarchy_|)(\w+)", function).groups()
        prefix = f"{owner[:-1].capitalize()}." if owner else ""
        camel = re.sub(r"_(\w)", lambda m: m[1].upper(), name)
        guesses = {language: camel if language == "JavaScript" else name for language in SOURCES}
        names[function] = [prefix + g if re.search(rf"\b{g}\b", texts[language]) else "-"
                           for language, g in guesses.items()]
    rows = ["# Reference, side by side\n\nEach function of the C interface and what the other languages call it. "
            "The contracts are on the page [C](c.md).\n", "| C | " + " | ".join(SOURCES) + " |", "|---|" + "---|" * len(SOURCES)]
    contracts = (pages / "c.md").read_text()
    for function, own in names.items():
        for language, name in zip(SOURCES, own):
            if name != "-" and not re.search(rf"\b{re.escape(name.split('.')[-1])}\b", texts[language]):
                missing.append(f"{function}: {language} has no {name}")
        cells = ["" if name == "-" else f"`{name}`" for name in own]
        anchor = f"[`{function}`](c.md#{function})" if f"\n### {function}\n" in contracts else f"`{function}`"
        rows.append(f"| {anchor} | " + " | ".join(cells) + " |")
    if missing:
        sys.exit("The table NAMES does not fit the sources:\n" + "\n".join(missing))
    (pages / "reference.md").write_text("\n".join(rows) + "\n")


def python_page(pages: Path) -> None:
    package = BINDINGS / "python/src/foliations"
    public = set(re.findall(r'"(\w+)"', (package / "__init__.py").read_text().split("__all__", 1)[1].split("]", 1)[0]))
    out = ["# Python, every function\n\nFrom the docstrings; `help` shows the same.\n"]

    # As _options.takes puts them into the documentation.
    options = [node for node in ast.parse((package / "_options.py").read_text()).body
               if isinstance(node, ast.ClassDef) and node.name.endswith("Options")]
    words = "\n".join(ast.get_docstring(node).split("\n\n", 1)[1] for node in options)

    def fields(node: ast.ClassDef, lines: list[str]) -> str:
        """A table of the fields of a class, with the words behind or above each."""
        rows = []
        for child in node.body:
            if not isinstance(child, ast.AnnAssign) or ast.unparse(child.target).startswith("_"):
                continue
            words = re.findall(r"#: ?(.*)", lines[child.end_lineno - 1])
            for line in reversed(lines[:child.lineno - 1] if not words else []):
                if not (above := re.match(r"\s*#: ?(.*)", line)):
                    break
                words.insert(0, above[1])
            cells = (f"`{ast.unparse(child.target)}`", f"`{ast.unparse(child.annotation)}`", " ".join(words))
            rows.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |\n")
        return "| field | type | |\n|---|---|---|\n" + "".join(rows) + "\n" if rows else ""

    def entry(level: int, node: ast.AST, prefix: str = "") -> None:
        doc = (ast.get_docstring(node) or "").replace("{options}", words)
        title = node.name if isinstance(node, ast.ClassDef) else f"{node.name}({ast.unparse(node.args)})"
        out.append(f"{'#' * level} {prefix}{node.name}\n\n```python\n{prefix}{title}\n```\n\n" + (f"```text\n{doc}\n```\n" if doc else ""))
        if isinstance(node, ast.ClassDef):
            out.append(fields(node, lines))
            for child in node.body:
                if isinstance(child, ast.FunctionDef) and not child.name.startswith("_") and ast.get_docstring(child):
                    entry(level + 1, child, f"{node.name}.")
    for path in sorted(package.glob("*.py")):
        lines = path.read_text().splitlines()
        for node in ast.parse(path.read_text()).body:
            if isinstance(node, (ast.ClassDef, ast.FunctionDef)) and node.name in public:
                entry(2, node)
    (pages / "python_reference.md").write_text("\n".join(out))


def gallery_pages(pages: Path) -> None:
    out = ["# Gallery\n\nThe tests run each of these programs.\n"]
    # As the README has them, the simplest first; none is left out.
    shown = dict(re.findall(r"\]\(examples/(\w+\.py)\): ([^|\n]+?) *\|", (BINDINGS / "python/README.md").read_text()))
    examples = sorted((BINDINGS / "python/examples").glob("*.py"), key=lambda path: list(shown).index(path.name))
    for path in examples:
        source, picture = path.read_text(), path.with_suffix(".png")
        doc = ast.get_docstring(ast.parse(source)) or shown[path.name].capitalize() + "."
        if picture.is_file():
            shutil.copy2(picture, pages / f"gallery_{picture.name}")
        image = f"![{doc.splitlines()[0]}](gallery_{picture.name})\n\n" if picture.is_file() else ""
        out.append(f"## {path.stem}\n\n{doc}\n\n{image}```python\n{source}```\n")
    (pages / "gallery.md").write_text("\n".join(out))


def tool_page(pages: Path) -> None:
    """The help of each command, from the tool itself."""
    built = sorted((path for path in (ROOT / "build").glob("*/hmf") if path.is_file()), key=lambda path: path.stat().st_mtime)
    tool = os.environ.get("HMF_TOOL") or (str(built[-1]) if built else shutil.which("hmf"))
    out = ["# The tool, every option\n\n`hmf COMMAND --help` prints the same. How the options work together: [the tool](tool.md).\n"]
    if not tool:
        out.append("(The tool was not built for this copy of the site.)\n")
    commands = re.findall(r"^  (\w+) ", subprocess.run([tool, "--help"], capture_output=True, text=True, check=True).stdout, re.M) if tool else []
    for command in commands:
        text = subprocess.run([tool, command, "--help"], capture_output=True, text=True, check=True).stdout
        out.append(f"## hmf {command}\n\n```text\n{text}```\n")
    (pages / "tool_options.md").write_text("\n".join(out))


class NotMade(Exception):
    """A tool has not what it needs here, such as a network."""


def rustdoc(pages: Path, work: Path) -> None:
    """Pages of both crates; nothing of C++ is compiled for them."""
    environment = {**os.environ, "DOCS_RS": "1", "CARGO_TARGET_DIR": str(work / "target"), "CARGO_TERM_COLOR": "never"}
    if subprocess.run(["cargo", "doc", "--quiet", "--locked", "--no-deps"], cwd=BINDINGS / "rust", env=environment).returncode:
        raise NotMade("cargo doc failed")
    shutil.copytree(work / "target" / "doc", pages / "rustdoc", ignore=shutil.ignore_patterns(".lock"))
    (pages / "rustdoc" / "index.html").write_text('<!DOCTYPE html><meta http-equiv="refresh" content="0; url=foliations/index.html"><a href="foliations/index.html">foliations</a>')


def typedoc(pages: Path, work: Path) -> None:
    """Pages of the types of the npm package, by a copy of it."""
    package = work / "javascript"
    package.mkdir()
    for name in ("lib", "package.json", "README.md"):
        source = BINDINGS / "javascript" / name
        (shutil.copytree if source.is_dir() else shutil.copy2)(source, package / name)
    (package / "tsconfig.json").write_text('{"compilerOptions": {"target": "es2022", "module": "nodenext", "strict": true}, "include": ["lib/*.d.ts"]}')
    (package / "dist").mkdir()
    subprocess.run(["node", BINDINGS / "javascript/build.js", "types", package / "dist" / "options.d.ts"], check=True)
    packages = ["--silent", "--no-save", "--no-audit", "--no-fund", "typedoc@0.28", "typescript@5.8"]
    if subprocess.run(["npm", "install", *packages], cwd=package, stdout=subprocess.DEVNULL).returncode:
        raise NotMade("npm install failed")
    subprocess.run([package / "node_modules/.bin/typedoc", "--readme", "none", "--logLevel", "Error", "--disableGit", "--sourceLinkTemplate", "hmf:{path}",
                    "--disableSources", "--out", pages / "typedoc", "lib/index.d.ts"], cwd=package, check=True)


def generated_pages(pages: Path, work: Path) -> None:
    """What other tools make, linked from the page of the language; what cannot be made here is said there."""
    for language, tools, make, start in (("rust", ["cargo"], rustdoc, "rustdoc/foliations/index.html"), ("javascript", ["node", "npm", "clang++"], typedoc, "typedoc/index.html")):
        made = os.environ.get("HMF_SITE_API") != "0" and all(map(shutil.which, tools))
        if made:
            try:
                make(pages, work)
            except NotMade as error:
                print(f"{make.__name__}: {error}", file=sys.stderr)
                made = False
        page = pages / f"{language}.md"
        first, rest = page.read_text().split("\n", 1)
        note = f"[Every item of the interface, by {make.__name__}]({start})" if made else f"(The pages of {make.__name__} were not made for this copy of the site.)"
        page.write_text(f"{first}\n\n{note}\n{rest}")


def build(out: Path) -> None:
    with tempfile.TemporaryDirectory() as folder:
        pages = Path(folder) / "docs"
        pages.mkdir()
        for page, text in TEXTS.items():
            path = ROOT / text
            (pages / page).write_text(translated(path.read_text(), path.parent, pages))
        functions = header_pages(pages)
        reference_page(pages, functions)
        python_page(pages)
        gallery_pages(pages)
        tool_page(pages)
        generated_pages(pages, Path(folder))
        (pages / "wide.css").write_text(".wy-nav-content { max-width: 1200px; }\n.rst-content table.docutils td, .wy-table-responsive table td, table code { font-size: 12px; padding: 4px 8px; }\n"
                                        # Pictures side by side have the same width.
                                        ".rst-content table:has(img) { table-layout: fixed; width: 100%; display: table !important; }\n"
                                        ".rst-content table:has(img) td { white-space: normal !important; }\n")
        navigation = "\n".join(
            (f'  - "{section}":\n' if section else "") + "\n".join(f'{"      " if section else "  "}- "{title}": {page}' for title, page, _ in entries)
            for section, entries in SITE.items())
        (Path(folder) / "mkdocs.yml").write_text(
            "site_name: hmf\nsite_description: Harmonic measured foliations on triangle meshes\nuse_directory_urls: false\nextra_css: [wide.css]\n"
            "theme:\n  name: readthedocs\n  highlightjs: false\nplugins: [search]\nmarkdown_extensions: [tables, fenced_code, {toc: {permalink: false}}]\n"
            f"validation: {{links: {{anchors: warn}}}}\nnav:\n{navigation}\n")
        # Below an item a list needs no blank line in the repository's texts, but here.
        for path in pages.glob("*.md"):
            path.write_text(re.sub(r"^([^\n|#>\s-][^\n]*)\n(?=- |1\. )", r"\1\n\n", path.read_text(), flags=re.M))
        subprocess.run([sys.executable, "-m", "mkdocs", "build", "--strict", "-q", "-f", Path(folder) / "mkdocs.yml", "-d", out.resolve()], check=True)


class Links(html.parser.HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.links: list[str] = []
        self.names: set[str] = set()

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        for key, value in attributes:
            if key in ("href", "src") and value:
                self.links.append(value)
            if key in ("id", "name") and value:
                self.names.add(value)


def check(out: Path) -> int:
    parsed = {}
    for path in sorted(out.rglob("*.html")):
        parsed[path.resolve()] = links = Links()
        links.feed(path.read_text())
    dead = []
    for path, page in parsed.items():
        if path.name in ("404.html", "search.html"):  # addresses from the root of a server
            continue
        for link in page.links:
            address, _, part = link.partition("#")
            if re.match(r"[a-z]+:", link) or link.startswith("//"):
                continue
            target = (path.parent / urllib.parse.unquote(address.split("?")[0])).resolve() if address else path
            if target.is_dir():
                target = target / "index.html"
            # rustdoc makes names of lines while the page is shown.
            ours = path.relative_to(out.resolve()).parts[0] not in ("rustdoc", "typedoc")
            if not target.is_file() or ours and part and target in parsed and urllib.parse.unquote(part) not in parsed[target].names:
                dead.append(f"{os.path.relpath(path, out)}: {link}")
    print("\n".join(dead) if dead else f"{len(parsed)} pages, {sum(len(p.links) for p in parsed.values())} links, none is dead")
    return 1 if dead or len(parsed) < sum(map(len, SITE.values())) else 0


if __name__ == "__main__":
    if len(sys.argv) == 3 and sys.argv[1] == "--check":
        sys.exit(check(Path(sys.argv[2])))
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    build(Path(sys.argv[1]))
