#!/usr/bin/env python3
"""The version has one home, include/hmf/hmf.h.  Compares every file that repeats it; --print prints it."""
import json
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
header = (ROOT / "include/hmf/hmf.h").read_text()
VERSION = ".".join(re.search(rf"^#define HMF_VERSION_{part} (\d+)$", header, re.M)[1] for part in ("MAJOR", "MINOR", "PATCH"))


def search(path: str, pattern: str) -> list:
    return re.findall(pattern, (ROOT / path).read_text(), re.M)


def places() -> list:
    """(file, versions in it); each must have at least one."""
    package = json.loads((ROOT / "bindings/javascript/package.json").read_text())
    lock = json.loads((ROOT / "bindings/javascript/package-lock.json").read_text())
    vcpkg = json.loads((ROOT / "bindings/packaging/vcpkg/ports/hmf/vcpkg.json").read_text())
    return [
        ("bindings/rust/Cargo.toml", search("bindings/rust/Cargo.toml", r'^version = "(.+)"')),
        ("bindings/rust/Cargo.lock", search("bindings/rust/Cargo.lock", r'name = "foliations(?:-sys)?"\nversion = "(.+)"')),
        ("bindings/rust/foliations/Cargo.toml", search("bindings/rust/foliations/Cargo.toml", r'foliations-sys = .*version = "(.+)"')),
        ("bindings/javascript/package.json", [package["version"]]),
        ("bindings/javascript/package-lock.json", [lock["version"], lock["packages"][""]["version"]]),
        ("bindings/packaging/vcpkg/ports/hmf/vcpkg.json", [vcpkg["version-semver"]]),
        ("bindings/packaging/debian/changelog", search("bindings/packaging/debian/changelog", r"^hmf \((.+?)(?:-\d+)?\)")[:1]),
        ("CITATION.cff", search("CITATION.cff", r"^version: (.+)$")),
        ("CHANGELOG.md", search("CHANGELOG.md", r"^## ([0-9.]+)")[:1]),
    ]


def main() -> int:
    if "--print" in sys.argv:
        print(VERSION)
        return 0
    failed = 0
    for path, versions in places():
        good = bool(versions) and set(versions) == {VERSION}
        failed += not good
        print(("ok" if good else "not ok"), "version", path, "" if good else f"has {versions}, the header {VERSION}")
    # These read it from the header; nothing is repeated there.
    for path in ("CMakeLists.txt", "bindings/python/packaging/version.py", "bindings/packaging/conan/conanfile.py", "bindings/packaging/conda/meta.yaml"):
        good = "HMF_VERSION_" in (ROOT / path).read_text() and VERSION not in (ROOT / path).read_text()
        failed += not good
        print(("ok" if good else "not ok"), "version-is-read", path)
    return 1 if failed else 0


sys.exit(main())
