#!/usr/bin/env python3
"""Lines of hand-written code of the bindings, without blank ones, comments and documentation.

    bench/binding_lines.py [REVISION]...      default: HEAD

Counted is what wraps the C interface.  Left out are tests, examples, generated files, and what works on results
without a call of the library: pictures, export, meshes of other packages, samples.
"""
import ast
import io
import re
import subprocess
import sys
import tokenize

ELSEWHERE = re.compile(r"/(_plot|_show|_texture|export|meshes|rows|sample)\.py$")
LANGUAGES = {
    "C++": r"include/hmf/\w+\.hpp$",
    "Python": r"bindings/python/src/\w+/\w+\.py$",
    "Rust": r"bindings/rust/\w+/src/(?!bindings\.rs)[\w/]+\.rs$|bindings/rust/[\w-]+-sys/(src/lib|build)\.rs$",
    "JavaScript": r"bindings/javascript/(lib/[\w/]+\.js|src/\w+\.cpp|build\.js)$",
    "TypeScript": r"bindings/javascript/lib/index\.d\.ts$",
}
NOT_CODE = {tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENDMARKER}


def git(*words):
    return subprocess.run(["git", *words], check=True, capture_output=True, text=True).stdout


def python_lines(text):
    documentation = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)) and ast.get_docstring(node):
            documentation.update(range(node.body[0].lineno, node.body[0].end_lineno + 1))
    lines = set()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type not in NOT_CODE:
            lines.update(range(token.start[0], token.end[0] + 1))
    return len(lines - documentation)


def other_lines(text):
    text = re.sub(r"/\*.*?\*/", "", text, flags=re.S)
    return sum(bool(re.sub(r"//.*", "", line).strip()) for line in text.splitlines())


for revision in sys.argv[1:] or ["HEAD"]:
    files = git("ls-tree", "-r", "--name-only", revision).split()
    functions = sum(git("show", f"{revision}:{file}").count("\nHMF_API")
                    for file in files if file in ("include/hmf/hmf.h", "include/hmf/applications.h"))
    print(f"{revision}: {functions} functions")
    for language, pattern in LANGUAGES.items():
        count = python_lines if language == "Python" else other_lines
        lines = sum(count(git("show", f"{revision}:{file}"))
                    for file in files if re.match(pattern, file) and not ELSEWHERE.search(file))
        print(f"  {language:12} {lines:5}  {lines / functions:5.1f} for each function")
