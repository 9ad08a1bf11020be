#!/usr/bin/env python3
"""The library as one source file, to be added to any project.

    src/packaging/amalgamate.py DIR

Writes

    hmf.h  hmf_core.cpp        the core: build, levels, solve, interpolate, measures
    hmf.h  applications.h  hmf.cpp     the core and the applications

into DIR.  Each source is compiled by one command, without other files:

    c++ -std=c++17 -O2 -c hmf_core.cpp
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
INCLUDE = re.compile(r'\s*#include "([^"]+)"')


def folders(layer, which):
    """The folders of a layer, in the order of CMakeLists.txt."""
    names = re.search(rf"set\({which}([^)]*)\)", (ROOT / "CMakeLists.txt").read_text()).group(1).split()
    return [f"{layer}/{name}" for name in names]


def header(name):
    text = (ROOT / "include/hmf" / name).read_text()
    return re.sub(r"#(\s*)include <hmf/(\w+\.h)>", r'#\1include "\2"', text)


def expand(path, seen, out):
    """The file with its own headers in place, each at its first use."""
    if path in seen:
        return
    seen.add(path)
    if path.parent == ROOT / "include/hmf":
        out.append(f'#include "{path.name}"')
        return
    out.append(f"/* {path.relative_to(ROOT).as_posix()} */")
    for line in path.read_text().splitlines():
        included = INCLUDE.match(line)
        if included:
            expand((path.parent / included.group(1)).resolve(), seen, out)
        elif line.strip() != "#pragma once":
            out.append(line)


def write_source(path, names):
    seen, out = set(), [f"/* Made by src/packaging/amalgamate.py from the sources of hmf; see {header_note(path)}. */"]
    for name in names:
        for source in sorted((ROOT / "src" / name).glob("*.cpp")):
            expand(source.resolve(), seen, out)
    path.write_text("\n".join(out) + "\n")


def header_note(path):
    return "hmf.h for the interface" if path.name == "hmf_core.cpp" else "hmf.h and applications.h for the interface"


def main(directory):
    directory.mkdir(parents=True, exist_ok=True)
    for name in ("hmf.h", "applications.h"):
        (directory / name).write_text(header(name))
    core = folders("core", "hmf_core_folders")
    write_source(directory / "hmf_core.cpp", core)
    write_source(directory / "hmf.cpp", core + folders("applications", "hmf_application_folders"))


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(pathlib.Path(sys.argv[1]))
