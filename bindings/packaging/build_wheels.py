#!/usr/bin/env python3
"""Wheels of the Python package for other machines, by one cross compiler, and a source distribution.

    build_wheels.py [--out DIR] [TARGET ...]      without targets: all
    build_wheels.py --list

The module is made by cffi with the stable ABI, so one wheel serves every Python from 3.10 on; the tool, hmf, comes with
it.  The compiler is Zig (package ziglang), which carries the C and C++ libraries of all targets; the C++ library is
linked into both.
Needs: ziglang, cffi, build, scikit-build-core, wheel.

Tags are checked, not claimed: of a Linux wheel by the symbol versions that its module and tool ask for, of each by the
machine in their headers; what needs more than its tag promises is refused.
"""

from __future__ import annotations

import argparse
import base64
import concurrent.futures
import hashlib
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import tempfile
import zipfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
PYTHON = ROOT / "bindings" / "python"

# Name: (target of Zig, tag of the wheel, suffix of the module, machine in its header)
TARGETS = {
    "manylinux-x86_64": ("x86_64-linux-gnu.2.17", "manylinux_2_17_x86_64", ".abi3.so", b"\x7fELF 62"),
    "manylinux-aarch64": ("aarch64-linux-gnu.2.17", "manylinux_2_17_aarch64", ".abi3.so", b"\x7fELF 183"),
    "musllinux-x86_64": ("x86_64-linux-musl", "musllinux_1_1_x86_64", ".abi3.so", b"\x7fELF 62"),
    "musllinux-aarch64": ("aarch64-linux-musl", "musllinux_1_1_aarch64", ".abi3.so", b"\x7fELF 183"),
    "windows-amd64": ("x86_64-windows-gnu", "win_amd64", ".pyd", b"MZ 34404"),
    "macos-x86_64": ("x86_64-macos.11.0", "macosx_11_0_x86_64", ".abi3.so", b"MACH 16777223"),
    "macos-arm64": ("aarch64-macos.11.0", "macosx_11_0_arm64", ".abi3.so", b"MACH 16777228"),
}

# What Python.h asks of its pyconfig.h on 64-bit Windows, for modules of the stable ABI.
WINDOWS_CONFIG = """
#define MS_WIN64
#define MS_WINDOWS
#define MS_WIN32
#define NT_THREADS
#define WITH_THREAD
#define Py_ENABLE_SHARED
#define HAVE_DECLSPEC_DLL
#define HAVE_STDINT_H 1
#define HAVE_STDDEF_H 1
#define HAVE_SYS_TYPES_H 1
#define HAVE_SYS_STAT_H 1
#define HAVE_LONG_LONG 1
#define SIZEOF_INT 4
#define SIZEOF_LONG 4
#define SIZEOF_LONG_LONG 8
#define SIZEOF_SHORT 2
#define SIZEOF_VOID_P 8
#define SIZEOF_SIZE_T 8
#define SIZEOF_WCHAR_T 2
#define SIZEOF_DOUBLE 8
#define SIZEOF_FLOAT 4
#define SIZEOF_TIME_T 8
#define SIZEOF_PID_T 4
#define ALIGNOF_MAX_ALIGN_T 8
#define ALIGNOF_LONG 4
#define ALIGNOF_SIZE_T 8
#define PLATLIBDIR "lib"
"""


def run(command: list[str | Path]) -> str:
    done = subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode:
        raise SystemExit(f"{' '.join(map(str, command))[:400]}\n{done.stdout[-3000:]}")
    return done.stdout


def machine_of(module: bytes) -> bytes:
    if module[:4] == b"\x7fELF":
        return b"\x7fELF %d" % int.from_bytes(module[18:20], "little")
    if module[:2] == b"MZ":
        at = int.from_bytes(module[60:64], "little")
        return b"MZ %d" % int.from_bytes(module[at + 4 : at + 6], "little")
    if module[:4] == b"\xcf\xfa\xed\xfe":
        return b"MACH %d" % int.from_bytes(module[4:8], "little")
    return b"unknown"


def check_binary(module: Path, name: str) -> None:
    """What the tag promises, against the module or the tool itself."""
    _, tag, _, machine = TARGETS[name]
    data = module.read_bytes()
    if machine_of(data) != machine:
        raise SystemExit(f"{name}: {module.name} is for {machine_of(data)!r}, not {machine!r}")
    versions = sorted({tuple(map(int, v.split(b"."))) for v in re.findall(rb"GLIBC_(\d+\.\d+)", data)})
    if glibc := re.match(r"manylinux_(\d+)_(\d+)", tag):
        promised = tuple(map(int, glibc.groups()))
        if not versions or versions[-1] > promised:
            raise SystemExit(f"{name}: {module.name} asks for glibc {versions[-1:]}, the tag promises {promised}")
        print(f"{name}: {module.name} asks for glibc {'.'.join(map(str, versions[-1]))}")
    elif versions:
        raise SystemExit(f"{name}: asks for glibc {versions}")
    # Only PyInit__native is exported, so a mangled name among the dynamic symbols is one that nobody has.
    undefined = module.name.startswith("_native") and data[:4] == b"\x7fELF" and re.search(rb"\0_Z[A-Z]", data)
    # Mach-O says what it loads; the C++ library in it also has the name of another one as a text.
    if machine.startswith(b"MACH"):
        needed = libraries_of_macos(data) - {b"/usr/lib/libSystem.B.dylib"}
    else:
        needed = set(re.findall(rb"libstdc\+\+|libc\+\+\.so", data))
    if needed or undefined:
        raise SystemExit(f"{name}: {module.name} asks for a C++ library {sorted(needed)}")


def libraries_of_macos(data: bytes) -> set[bytes]:
    """The libraries that a Mach-O file of 64 bits loads: the names in its commands LC_LOAD_DYLIB."""
    names, at = set(), 32
    for _ in range(int.from_bytes(data[16:20], "little")):
        command, size, name = (int.from_bytes(data[at + k : at + k + 4], "little") for k in (0, 4, 8))
        if command == 12:
            names.add(data[at + name : at + size].split(b"\0")[0])
        at += size
    return names


def compile_binaries(name: str, work: Path, jobs: int) -> tuple[Path, Path]:
    """The module and the tool."""
    target, _, suffix, _ = TARGETS[name]
    folder = work / name
    folder.mkdir(parents=True)
    zig = [sys.executable, "-m", "ziglang"]
    windows, macos = "windows" in target, "macos" in target
    common = ["-target", target, "-O2", "-DNDEBUG", "-fno-sanitize=all", "-ffp-contract=off", "-fvisibility=hidden", "-I", ROOT / "include"]
    if not windows:
        common.append("-fPIC")
    includes = ["-I", sysconfig.get_paths()["include"]]
    if windows:
        # The headers are the same on every system, but for one.
        shutil.copytree(sysconfig.get_paths()["include"], folder / "include", symlinks=False)
        (folder / "include" / "pyconfig.h").write_text(WINDOWS_CONFIG)
        includes = ["-I", folder / "include"]
    core = sorted((ROOT / "src").glob("*/*/*.cpp"))
    of_tool = [ROOT / "src" / "pool.cpp", *sorted((ROOT / "bindings").glob("cli/*.cpp")), *sorted((ROOT / "bindings").glob("readers/*.cpp"))]

    def one(source: Path) -> Path:
        target = folder / f"{source.parent.name}-{source.stem}.o"
        plain = ["-fno-exceptions", "-fno-rtti"] if source in core else []
        run([*zig, "c++", *common, "-std=c++17", *plain, "-c", source, "-o", target])
        return target

    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        compiled = list(pool.map(one, core + of_tool))
    objects, tool_objects = compiled[: len(core)], compiled[len(core) :]
    native = folder / "native.o"
    run([*zig, "cc", *common, *includes, "-DPy_LIMITED_API=0x030A0000", "-c", work / "_native.c", "-o", native])
    module = folder / f"_native{suffix}"
    # The C++ library goes into the module.
    link = [*zig, "c++", "-target", target, "-shared", "-s", "-o", module, native, *objects]
    if macos:
        link += ["-undefined", "dynamic_lookup"]
    if windows:
        # What the module takes from python3.dll, as an import library.
        text = native.read_bytes()
        names = sorted({n.decode() for n in re.findall(rb"(?:__imp_)?(_?Py[A-Za-z_]+)\x00", text)})
        (folder / "python3.def").write_text("LIBRARY python3.dll\nEXPORTS\n" + "".join(
            f"{n} DATA\n" if n.startswith("PyExc_") or n.endswith("_Type") or n == "_Py_NoneStruct" else f"{n}\n" for n in names))
        run([*zig, "dlltool", "-m", "i386:x86-64", "-d", folder / "python3.def", "-l", folder / "libpython3.a"])
        link += [folder / "libpython3.a"]
    run(link)
    tool = folder / ("hmf.exe" if windows else "hmf")
    run([*zig, "c++", "-target", target, "-s", "-o", tool, *objects, *tool_objects])
    for binary in (module, tool):
        check_binary(binary, name)
    return module, tool


def pack(name: str, module: Path, tool: Path, source: Path, out: Path) -> Path:
    """A wheel (PEP 427) of the Python files, the module, the tool and the metadata of the source distribution."""
    tag = f"cp310-abi3-{TARGETS[name][1]}"
    metadata = (source / "PKG-INFO").read_bytes()
    version = re.search(rb"^Version: (.+)$", metadata, re.M)[1].decode().strip()
    info = f"foliations-{version}.dist-info"
    files = {f"foliations/{p.name}": p.read_bytes() for p in sorted((source / "src" / "foliations").iterdir()) if p.is_file()}
    files[f"foliations/{module.name}"] = module.read_bytes()
    files[f"foliations-{version}.data/scripts/{tool.name}"] = tool.read_bytes()
    files[f"{info}/METADATA"] = metadata
    files[f"{info}/licenses/LICENSE"] = (source / "core" / "LICENSE").read_bytes()
    files[f"{info}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: hmf build_wheels\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()
    record = ""
    for path, data in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        record += f"{path},sha256={digest},{len(data)}\n"
    files[f"{info}/RECORD"] = (record + f"{info}/RECORD,,\n").encode()
    wheel = out / f"foliations-{version}-{tag}.whl"
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as archive:
        for path, data in files.items():
            # The same bytes each time.
            entry = zipfile.ZipInfo(path, (1980, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            # A regular file: else pip does not make the tool executable.
            entry.external_attr = (0o100755 if path.endswith((".so", ".pyd")) or "/scripts/" in path else 0o100644) << 16
            archive.writestr(entry, data)
    return wheel


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("targets", nargs="*", metavar="TARGET")
    parser.add_argument("--out", type=Path, default=Path("dist"))
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--list", action="store_true", help="print the targets")
    given = parser.parse_args()
    if given.list:
        print("\n".join(TARGETS))
        return
    if unknown := set(given.targets) - set(TARGETS):
        parser.error(f"no such target: {', '.join(sorted(unknown))}; there are {', '.join(TARGETS)}")
    given.out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as temporary:
        work = Path(temporary)
        run([sys.executable, "-m", "build", "--sdist", "--no-isolation", "-o", work / "sdist", PYTHON])
        archive = next((work / "sdist").glob("*.tar.gz"))
        shutil.copy2(archive, given.out)
        with tarfile.open(archive) as tar:
            tar.extractall(work / "unpacked", filter="data")
        source = next((work / "unpacked").iterdir())
        packaging = PYTHON / "packaging"
        headers = [ROOT / "include" / "hmf" / h for h in ("hmf.h", "applications.h")]
        run([sys.executable, packaging / "declarations.py", *headers, packaging / "progress.c", work / "_native.c"])
        for name in given.targets or TARGETS:
            wheel = pack(name, *compile_binaries(name, work, given.jobs), source, given.out)
            print(f"{wheel.name}: {wheel.stat().st_size / 1e6:.2f} MB", flush=True)


if __name__ == "__main__":
    main()
