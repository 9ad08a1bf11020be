#!/usr/bin/env python3
"""Runs a wheel with an interpreter of another machine or C library, without installing anything.

    try_wheel.py WHEEL INTERPRETER...

The interpreter is a command, such as `qemu-aarch64 -L /arm64 /arm64/usr/bin/python3.11`, or a Python linked with musl;
it needs nothing but the standard library, not even pip.  NumPy and cffi are taken from PyPI for its platform.  Prints
the lines of bindings/same_bits/README.md, to be compared with those of C, then what the tool of the wheel says of the
same interpreter's machine: both must work without a compiler.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
# Wheels of other packages may ask for more than ours.
NEWER = {"manylinux_2_17": ["manylinux2014", "manylinux_2_17", "manylinux_2_27", "manylinux_2_28"], "musllinux_1_1": ["musllinux_1_1", "musllinux_1_2"]}


def output_of(command: list[str], **options: object) -> str:
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options)  # type: ignore[call-overload]
    if done.returncode:
        raise SystemExit(f"{' '.join(command)[:300]}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return str(done.stdout)


def main() -> None:
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    wheel, interpreter = Path(sys.argv[1]), sys.argv[2:]
    library, machine = re.match(r".*-cp310-abi3-(m[a-z]+linux_\d+_\d+)_(\w+)\.whl$", wheel.name).groups()  # type: ignore[union-attr]
    version = output_of([*interpreter, "-c", "import sys; print('%d.%d' % sys.version_info[:2])"]).strip()
    with tempfile.TemporaryDirectory() as folder:
        download, site = Path(folder) / "download", Path(folder) / "site"
        platforms = [word for name in NEWER[library] for word in ("--platform", f"{name}_{machine}")]
        output_of([sys.executable, "-m", "pip", "download", "-q", "--only-binary", ":all:", *platforms, "--python-version", version, "--implementation", "cp",
                   "-d", str(download), "numpy", "cffi"])
        for archive in [wheel, *sorted(download.glob("*.whl"))]:
            zipfile.ZipFile(archive).extractall(site)
        environment = {**os.environ, "PYTHONPATH": str(site), "PYTHONHOME": "", "CC": "/bin/false", "CXX": "/bin/false"}
        del environment["PYTHONHOME"]
        print(output_of([*interpreter, str(HERE.parent / "python/tests/same_bits.py")], env=environment), end="")
        tool = next(site.glob("*.data/scripts/hmf"))
        tool.chmod(0o755)
        print(output_of([*interpreter[:-1], str(tool), "--version"]), end="")
        print(output_of([*interpreter[:-1], str(tool), "demo", str(Path(folder) / "demo")]).splitlines()[-1].rsplit("/", 1)[-1])


if __name__ == "__main__":
    main()
