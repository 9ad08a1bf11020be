#!/usr/bin/env python3
"""sbom.py [FILE]   the parts of a release as CycloneDX 1.5 JSON, to FILE or standard output.

Everything is read from where it is kept: the version from include/hmf/hmf.h, what each package needs from its own
manifest.  The same tree gives the same bytes: the time is that of the last commit (or SOURCE_DATE_EPOCH), the serial
number is made of the content.
"""
import json
import os
import re
import subprocess
import sys
import uuid
from datetime import datetime, timezone
from pathlib import Path

import tomllib

ROOT = Path(__file__).resolve().parents[2]
CORE = "pkg:generic/hmf"


def version() -> str:
    script = ROOT / "bindings/packaging/check_versions.py"
    return subprocess.run([sys.executable, script, "--print"], check=True, capture_output=True, text=True).stdout.strip()


def timestamp() -> str:
    seconds = os.environ.get("SOURCE_DATE_EPOCH") or subprocess.run(
        ["git", "-C", str(ROOT), "log", "-1", "--format=%ct"], check=True, capture_output=True, text=True).stdout
    return datetime.fromtimestamp(int(seconds), timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")


def component(purl: str, description: str = "", scope: str = "required", range_: str = "", license: str = "") -> dict:
    """One part; a manifest that allows a range has no version but the property "range"."""
    name, _, number = purl.rpartition("/")[2].partition("@")
    made = {"type": "library", "bom-ref": purl, "name": name, "scope": scope, "purl": purl}
    if number:
        made["version"] = number
    if description:
        made["description"] = description
    if license:
        made["licenses"] = [{"license": {"id": license}}]
    if range_:
        made["properties"] = [{"name": "range", "value": range_}]
    return made


def python_needs() -> list:
    """(purl, range, scope) of each requirement of the wheel."""
    manifest = tomllib.loads((ROOT / "bindings/python/pyproject.toml").read_text())

    def one(requirement: str, scope: str) -> tuple:
        name, range_ = re.fullmatch(r"([A-Za-z0-9_.-]+)(.*)", requirement).groups()
        return f"pkg:pypi/{name.lower()}", range_, scope
    needs = [one(r, "required") for r in manifest["project"]["dependencies"]]
    optional = manifest["project"]["optional-dependencies"]
    return needs + [one(r, "optional") for group, rs in optional.items() if group != "test" for r in rs]


def rust_needs() -> list:
    """What builds the crates: the closure of the build dependencies in Cargo.lock; there is nothing at run time."""
    lock = tomllib.loads((ROOT / "bindings/rust/Cargo.lock").read_text())["package"]
    manifest = tomllib.loads((ROOT / "bindings/rust/foliations-sys/Cargo.toml").read_text())
    assert "dependencies" not in manifest, "foliations-sys needs something at run time: name it here"
    packages = {p["name"] + " " + p["version"]: p for p in lock}

    def find(need: str) -> str:
        found = [k for k in packages if k == need or k.split()[0] == need]
        assert len(found) == 1, (need, found)
        return found[0]
    todo, done = [find(n) for n in manifest["build-dependencies"]], set()
    while todo:
        name = todo.pop()
        if name not in done:
            done.add(name)
            todo += [find(n) for n in packages[name].get("dependencies", [])]
    return ["pkg:cargo/" + name.replace(" ", "@") for name in sorted(done)]


def bill() -> dict:
    number = version()
    manifest = json.loads((ROOT / "bindings/javascript/package.json").read_text())
    assert "dependencies" not in manifest, "the npm package needs something at run time: name it here"
    core = component(f"{CORE}@{number}", "C library and command line tool, with its readers of mesh files", license="MIT")
    wheel, npm = f"pkg:pypi/foliations@{number}", f"pkg:npm/foliations@{number}"
    raw, crate = f"pkg:cargo/foliations-sys@{number}", f"pkg:cargo/foliations@{number}"
    parts = [
        component(wheel, "Python; holds the library", license="MIT"),
        component(raw, "Rust, raw; compiles the library", license="MIT"),
        component(crate, "Rust", license="MIT"),
        component(npm, "JavaScript; the library as WebAssembly", license="MIT"),
        component("pkg:generic/c%2B%2B-runtime", "the C and C++ standard libraries of the system; nothing else"),
    ]
    python, rust = python_needs(), rust_needs()
    parts += [component(purl, scope=scope, range_=range_) for purl, range_, scope in python]
    parts += [component(purl, "build only", "excluded") for purl in rust]
    needs = {
        core["bom-ref"]: ["pkg:generic/c%2B%2B-runtime"],
        wheel: [core["bom-ref"]] + [purl for purl, _, _ in python],
        raw: [core["bom-ref"]] + rust,
        crate: [raw],
        npm: [core["bom-ref"]],
    }
    made = {
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": {"timestamp": timestamp(), "component": core},
        "components": parts,
        "dependencies": [{"ref": ref, "dependsOn": sorted(of)} for ref, of in sorted(needs.items())],
    }
    made["serialNumber"] = "urn:uuid:" + str(uuid.uuid5(uuid.NAMESPACE_URL, json.dumps(made, sort_keys=True)))
    return made


text = json.dumps(bill(), indent=2) + "\n"
if len(sys.argv) > 1:
    Path(sys.argv[1]).write_text(text)
else:
    sys.stdout.write(text)
