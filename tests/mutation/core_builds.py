"""The core compiled with other flags, as a shared library under the test programs.

The objects of the test programs and of the fuzz drivers are those of the release build (build/release); they are linked
again, with a shared core in place of its objects.  So the core can be measured, or changed in one file, and no test is
compiled again.
"""

import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
RELEASE = ROOT / "build/release"
# Of the readers, which are no part of the core; and the corpus, which is not there everywhere.
OTHERS = {"test_corpus", "readers_replay"}
# Of what is no part of the core: programs take of them what they need.
ARCHIVES = ["bindings/readers/libhmf_readers.a", "libhmf_pool.a"]
COMMON = ["-std=c++17", "-DNDEBUG", "-fPIC", "-fno-exceptions", "-fno-rtti", "-ffp-contract=off"]


def jobs():
    return int(os.environ.get("JOBS") or os.cpu_count() or 1)


class Core:
    """Sources in `tree`, objects and the library in `folder`."""

    def __init__(self, tree, folder, compiler, flags):
        self.tree, self.folder, self.flags = Path(tree), Path(folder), list(flags)
        self.compiler = ([shutil.which("ccache")] if shutil.which("ccache") else []) + [compiler]
        self.linker = compiler
        self.library = self.folder / "libcore.so"
        self.programs_folder = self.folder / "programs"
        self.sources = sorted(str(p.relative_to(self.tree)) for p in self.tree.glob("src/*/*/*.cpp"))
        self.folder.mkdir(parents=True, exist_ok=True)

    def object(self, source):
        return self.folder / (source.replace("/", "_")[:-4] + ".o")

    def compile(self, source, to=None):
        """None, or what the compiler said."""
        to = to or self.object(source)
        run = subprocess.run([*self.compiler, *COMMON, *self.flags, f"-I{self.tree}/include", "-MMD", "-c", str(self.tree / source),
                              "-o", str(to)], capture_output=True, text=True)
        return run.stderr if run.returncode else None

    def outdated(self, source):
        """Without an object, or with one older than a file that it was made of."""
        made, listed = self.object(source), self.object(source).with_suffix(".d")
        if not made.exists() or not listed.exists():
            return True
        files = listed.read_text().replace("\\\n", " ").split(":", 1)[1].split()
        return any(not Path(f).exists() or Path(f).stat().st_mtime > made.stat().st_mtime for f in [*files, __file__, sys.argv[0]])

    def update(self):
        """Compiles what is outdated; the library stays as it is where nothing was, and no source came or went."""
        sources = [s for s in self.sources if self.outdated(s)]
        list_of_all = self.folder / "linked.txt"
        if not sources and self.library.exists() and list_of_all.exists() and list_of_all.read_text().split() == self.sources:
            return
        self.library.unlink(missing_ok=True)
        self.compile_all(sources)
        self.link()
        list_of_all.write_text("\n".join(self.sources))

    def compile_all(self, sources=None):
        sources = self.sources if sources is None else sources
        with ThreadPoolExecutor(jobs()) as pool:
            for source, said in zip(sources, pool.map(self.compile, sources)):
                if said:
                    raise SystemExit(f"{source} does not compile:\n{said}")

    def link(self, to=None, instead=()):
        """instead: (source, object) that take the place of others."""
        instead = dict(instead)  # first: of inline functions the linker takes theirs
        objects = {**instead, **{s: self.object(s) for s in self.sources if s not in instead}}
        run = subprocess.run([self.linker, *self.flags, "-shared", "-Wl,-Bsymbolic", "-Wl,-soname,libcore.so", "-o", str(to or self.library),
                              *map(str, objects.values())], capture_output=True, text=True)
        if run.returncode:
            raise SystemExit(f"the core cannot be linked:\n{run.stderr}")

    @staticmethod
    def objects_of(program):
        return sorted(o for folder in RELEASE.glob(f"*/CMakeFiles/{program}.dir") for o in folder.rglob("*.o"))

    def link_programs(self):
        """{name: path} of the test programs and fuzz drivers of build/release."""
        self.programs_folder.mkdir(exist_ok=True)
        made = {}
        for objects in sorted(RELEASE.glob("tests/CMakeFiles/test_*.dir")) + sorted(RELEASE.glob("fuzz/CMakeFiles/*_replay.dir")):
            name = objects.name[:-4]
            files = self.objects_of(name)
            if name in OTHERS or not files:
                continue
            archives, libraries = [str(RELEASE / a) for a in ARCHIVES], ["-lpthread"]
            if name.startswith("test_"):
                archives, libraries = [str(RELEASE / "tests/libhmf_test_meshes.a"), *archives], [*libraries, "-lgtest"]
            made[name] = self.programs_folder / name
            parts = [Path(p) for p in [*files, *archives]]
            if made[name].exists() and made[name].stat().st_mtime > max(p.stat().st_mtime for p in parts):
                continue  # the core is found when it is started
            run = subprocess.run([self.linker, "-o", str(made[name]), *map(str, files), *archives, str(self.library),
                                  f"-Wl,-rpath,{self.folder}", *libraries], capture_output=True, text=True)
            if run.returncode:
                raise SystemExit(f"{name} cannot be linked; build the preset release first:\n{run.stderr[-2000:]}")
        if "test_solve" not in made:
            raise SystemExit("build the preset release first: cmake --preset release && cmake --build build/release")
        return made


def link_test(source, tree, to, core):
    """A program of one test file, compiled from a copy of the sources, with a shared core; false: it does not compile."""
    eigen = [f"-isystem{p}" for p in ("/usr/include/eigen3", "/usr/local/include/eigen3") if Path(p).is_dir()]
    compiler = ([shutil.which("ccache")] if shutil.which("ccache") else []) + ["g++"]
    run = subprocess.run([*compiler, "-std=c++17", "-O1", "-DNDEBUG", "-ffp-contract=off", f"-I{tree}/include", f"-I{tree}",
                          f"-I{tree}/tests", *eigen, "-c", str(source), "-o", f"{to}.o"], capture_output=True, text=True)
    if run.returncode == 0:
        run = subprocess.run(["g++", "-o", str(to), f"{to}.o", str(RELEASE / "tests/libhmf_test_meshes.a"), str(core),
                              f"-Wl,-rpath,{core.parent}", *(str(RELEASE / a) for a in ARCHIVES), "-lpthread", "-lgtest_main",
                              "-lgtest"], capture_output=True, text=True)
    return run.returncode == 0


def build_release():
    """The objects of the tests, as they are now."""
    for command in (["cmake", "--preset", "release"], ["cmake", "--build", str(RELEASE), "-j", str(jobs()), "--target", "hmf_tests", "hmf_replays"]):
        run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
        if run.returncode:
            raise SystemExit(run.stdout[-3000:] + run.stderr[-3000:])


class Ended:
    def __init__(self, code, seconds, output):
        self.code, self.seconds, self.output = code, seconds, output


def run(command, processor_seconds, library=None, environment=None, memory=6 << 30):
    """The program within so many seconds of processor time (and twenty times as long on the clock); memory in bytes."""
    def limits():
        resource.setrlimit(resource.RLIMIT_CPU, (max(1, int(processor_seconds)), int(processor_seconds) + 2))
        resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    env = dict(os.environ, **(environment or {}))
    if library:
        env["LD_LIBRARY_PATH"] = str(library)
    with tempfile.TemporaryFile() as output:
        process = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT, env=env, preexec_fn=limits, cwd=ROOT)
        # Not process.kill, which may take the status that wait4 is for.
        clock = threading.Timer(max(60, 20 * processor_seconds), os.kill, (process.pid, signal.SIGKILL))
        clock.start()
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        clock.cancel()
        output.seek(0)
        return Ended(process.returncode, used.ru_utime + used.ru_stime, output.read().decode(errors="replace"))


def cases_of(program):
    """The names of the cases of a test program."""
    listed = subprocess.run([str(program), "--gtest_list_tests"], capture_output=True, text=True,
                            env=dict(os.environ, LLVM_PROFILE_FILE="/dev/null")).stdout
    names, suite = [], ""
    for line in listed.splitlines():
        line = line.split("#")[0].rstrip()
        if line and not line.startswith(" ") and line.endswith("."):
            suite = line
        elif re.match(r"  \S", line):
            names.append(suite + line.strip())
    return names


def files_of_cases(tree=ROOT):
    """{"Suite.Name": path of the test file}"""
    return {f"{suite}.{name}": path for path in sorted((Path(tree) / "tests").rglob("test_*.cpp"))
            for suite, name in re.findall(r"^TEST(?:_[FP])?\((\w+), (\w+)", path.read_text(), re.M)}


def without_parameters(case):
    """Suite.Name of Prefix/Suite.Name/3."""
    return re.sub(r"^\w+/", "", re.sub(r"/[\w*?]+$", "", case))


def program_of(path):
    """The test program that a test file is a part of: the folder has its name."""
    return "test_" + path.parent.name
