#!/bin/bash
# ./test.sh           the default tier: what a change can break, in about ten minutes on two cores
# ./test.sh full      before a merge into main, and what a release must pass
# ./test.sh nightly   campaigns, other machines, mutations, coverage, libFuzzer, valgrind
# ./test.sh NAME...   only these variants
# ./test.sh list      the names
#
# Installs what is missing on Debian; on Fedora, Arch, Alpine and macOS it prints the command. Builds lie in
# build/<preset>. A case that fails is printed with the line that runs it alone. The last line is "N passed, N failed,
# N skipped", summed over all variants; the exit code is 0 only if nothing failed.
#
# Environment: HMF_MESHES  folder of OBJ meshes (default ../shared/meshes)
#              HMF_SURFACES  folder of other OBJ meshes: holes, shells, spheres (default ../shared/surfaces)
#              JOBS        parallel jobs (default: number of cores)
set -uf
cd "$(dirname "$0")" || exit 1
default="sanitizers optimized"
full="asan-ubsan release"
nightly="$full tsan nightly"

# name | preset | targets, or - for none | entries of ctest | what
variants() {
    cat <<'END_OF_TABLE'
sanitizers   | asan-ubsan | hmf_tests hmf_replays | -L ^default$ | the cases of the library once, with assertions, address and undefined behavior sanitizers; fuzz corpora
optimized    | release | hmf hmf_core hmf_pool hmf_cli hmf_tests_default | -L ^default$ | long and numeric cases, a sample of real meshes, the tool, examples of the documentation, short checks
asan-ubsan   | asan-ubsan | all | -L default|full | as sanitizers, with the long cases, the tool, and longer runs of the fuzz targets
release      | release | all | -L default|full | every case, real meshes up to 250 000 vertices, checks, packages, bindings
tsan         | tsan | test_solve | -L full | threads under the thread sanitizer
debug        | debug | hmf_tests hmf_cli | -L default|full -E ^check | every case, with assertions and without sanitizers
nightly      | release | all | -L nightly | campaigns, machines, static analysis, mutations, coverage, libFuzzer, valgrind, all real meshes
corpus       | release | test_corpus | -R ^corpus\.[0-9] | real meshes up to 250 000 vertices
corpus-large | release | test_corpus | -R ^corpus-large | all real meshes
campaign     | release | test_solve test_applications | -R ^campaign | random problems with three hierarchies each, random marked vertices, random holes
valgrind     | release | hmf_tests | -R ^valgrind | the cases of the sanitizer build under valgrind
fuzz         | asan-ubsan | all | -R ^fuzz | the corpora of the fuzz targets, and random inputs
format       | release | hmf hmf_core | -R ^check.(format|map|tiers)$ | layout of the sources, src/README.md, tests/tiers.txt
header       | release | - | -R ^check.header$ | the headers in C89 to C17 and C++17, included twice
symbols      | release | hmf | -R ^check.symbols$ | exported symbols, dependencies, no global state
dropin       | release | hmf hmf_core | -R ^check.dropin$ | the core, and all, as one file: compiles by one command, the same bits
abi          | release | - | -R ^check.abi$ | the interface against the recorded one; what breaks programs is seen (docs/abi.md)
plain        | release | - | -R ^check.plain$ | compiles without a build system; same bits with both compilers
install      | release | hmf hmf_core hmf_pool hmf_cli | -R ^check.install$ | consumers: find_package, add_subdirectory, pkg-config, cc; example of the README
packages     | release | - | -R ^check.packages$ | one version everywhere, manifests; with HMF_PACKAGES=1 wheels, Debian, Conan, vcpkg, conda
bindings     | release | hmf hmf_pool | -R ^check.bindings$ | tests of the packages for other languages; the same bits from each
static       | release | - | -R ^check.static$ | clang-tidy, cppcheck, gcc's analyzer, and the stack: frames, recursion, depth
reproducible | release | - | -R ^check.reproducible$ | two builds in different folders give the same bytes
machines     | release | - | -R ^check.(machines|plain-all)$ | the same bits on other processors, systems and with other flags
coverage     | release | hmf_tests | -R ^check.coverage$ | lines of the core that tests and fuzz corpora reach: at least 97.5 %
mutations    | release | hmf_tests | -R ^check.(derived-)?mutations$ | defects that a test must notice: a table of them, and those derived from the sources
fuzzing      | release | - | -R ^check.fuzzing$ | each fuzz target with libFuzzer, half an hour each (HMF_FUZZ_SECONDS)
END_OF_TABLE
}

# --- What is needed ------------------------------------------------------------

. bindings/packaging/system_packages.sh
ensure_packages() {
    local missing=() include=/usr/include
    need() { # package, command that succeeds when it is there
        local package=$1
        shift
        "$@" > /dev/null 2>&1 || missing+=("$package")
    }
    need build-essential sh -c 'command -v c++ && command -v make'
    need cmake command -v cmake
    need ninja-build command -v ninja
    need clang command -v clang++
    need clang-format command -v clang-format
    need clang-tidy command -v clang-tidy
    need pkg-config command -v pkg-config
    need python3 command -v python3
    need python3-venv python3 -c 'import venv, ensurepip'
    need libgtest-dev test -e $include/gtest/gtest.h
    need libeigen3-dev test -e $include/eigen3/Eigen/Core
    case " $* " in *valgrind* | *nightly*) need valgrind command -v valgrind ;; esac
    [ ${#missing[@]} -eq 0 ] || install_packages "${missing[@]}"
}

# What cannot be installed is skipped where it is used.
install_if_possible() { # package ...
    local package sudo=
    command -v apt-get > /dev/null || return 0
    [ "$(id -u)" -eq 0 ] || sudo=sudo
    for package in "$@"; do
        dpkg -s "$package" > /dev/null 2>&1 ||
            DEBIAN_FRONTEND=noninteractive $sudo apt-get install -q -y --no-install-recommends "$package" > /dev/null 2>&1
    done
}
helpful_packages() { # name of a variant
    case $1 in
    optimized | abi) echo abigail-tools ;;
    release) echo abigail-tools ;;
    static) echo cppcheck ;;
    coverage | mutations) echo llvm ;;
    fuzzing) echo libclang-rt-14-dev zip ;;
    machines) echo qemu-user g++-{aarch64,s390x,riscv64,i686}-linux-gnu g++-mingw-w64-x86-64-posix wine wine64 ;;
    nightly) for name in static coverage fuzzing machines; do helpful_packages $name; done ;;
    esac
}

# clang builds with sanitizers in half the time of gcc, and sees numbers that do not fit into an integer as well.
can_sanitize() {
    echo 'int main() { return 0; }' | clang++ -fsanitize=address,undefined -x c++ - -o "$results/sanitized" > /dev/null 2>&1 &&
        "$results/sanitized"
}
compiler_of() { # preset: the setting of the compiler, if it is not the default one
    [ "$1" = asan-ubsan ] && [ ! -e build/asan-ubsan/CMakeCache.txt ] || return
    can_sanitize || install_if_possible libclang-rt-14-dev libclang-rt-dev
    can_sanitize && echo "-DCMAKE_CXX_COMPILER=clang++"
}

# --- Variants ------------------------------------------------------------------

build() { # preset, targets
    local preset=$1 log=$results/$1-build.log
    shift
    # shellcheck disable=SC2046
    cmake --preset "$preset" $(compiler_of "$preset") > "$log" 2>&1 &&
        { [ "$*" = - ] || cmake --build "build/$preset" -j "$jobs" --target "$@" >> "$log" 2>&1; } && return
    echo "not ok $preset: the build failed"
    grep -E -A3 'error|Error' "$log" | head -40
    echo "    all of it: $log"
    return 1
}

# Seconds of processor time of all commands that have ended.
processor_time() {
    times > "$results/times"
    awk -F '[ms ]' 'NR == 2 { printf "%d", 60 * $1 + $2 + 60 * $4 + $5 }' "$results/times"
}

run_variant() { # name, preset, targets, entries
    local name=$1 xml=$results/$1.xml counts="0 1 0" started=$SECONDS before p f s
    processor_time > "$results/before" # not in a subshell, which counts its own commands
    before=$(cat "$results/before")
    echo "=== $name"
    # shellcheck disable=SC2046
    install_if_possible $(helpful_packages "$name")
    # A failed build is one failure; what it would have run is not counted.
    # shellcheck disable=SC2086
    if build "$2" $3; then
        processor_time > "$results/built"
        echo "    built after $((SECONDS - started)) s, $(($(cat "$results/built") - before)) s of processor time"
        rm -f "$xml"
        # shellcheck disable=SC2086
        ctest --test-dir "build/$2" -j "$jobs" --no-tests=error --output-junit "$xml" --test-output-size-passed 100000000 \
            --test-output-size-failed 100000000 $4 > "$results/$name.log" 2>&1
        if counts=$(python3 tests/support/count_results.py "$xml" "build/$2" 2> "$results/$name.count"); then
            sed '$d' <<< "$counts"
            counts=$(tail -n 1 <<< "$counts")
        else
            counts="0 1 0"
            echo "not ok $name: no results"
            tail -20 "$results/$name.log" "$results/$name.count"
        fi
    fi
    read -r p f s <<< "$counts"
    passed=$((passed + p)) failed=$((failed + f)) skipped=$((skipped + s))
    processor_time > "$results/ended"
    echo "--- $name: $p passed, $f failed, $s skipped, $((SECONDS - started)) s," \
        "$(($(cat "$results/ended") - before)) s of processor time"
}

# --- Main ------------------------------------------------------------------------

row_of() { variants | sed -n "s/^$1 *| //p"; }
if [ "${1:-}" = list ]; then
    printf '%-12s %s\n' default "$default" full "$full" nightly "$nightly"
    variants | awk -F ' *[|] ' '{ printf "%-12s %s\n", $1, $NF }'
    exit 0
fi
case ${*:-default} in
default) chosen=$default ;;
full) chosen=$full ;;
nightly) chosen=$nightly ;;
*) chosen=$* ;;
esac
for name in $chosen; do
    if [ -z "$(row_of "$name")" ]; then
        echo "no variant '$name'; ./test.sh list prints them"
        exit 2
    fi
done

jobs=${JOBS:-$(nproc 2> /dev/null || getconf _NPROCESSORS_ONLN)}
results=$PWD/build/results
passed=0 failed=0 skipped=0
mkdir -p "$results"
# shellcheck disable=SC2086
ensure_packages $chosen || exit 1
if [ -z "${HMF_MESHES:-}" ] && [ -d ../shared/meshes ]; then export HMF_MESHES=$PWD/../shared/meshes; fi
if [ -z "${HMF_SURFACES:-}" ] && [ -d ../shared/surfaces ]; then export HMF_SURFACES=$PWD/../shared/surfaces; fi
# Several programs are built at the same time; a build folder that is there keeps its generator.
if command -v ninja > /dev/null; then export CMAKE_GENERATOR=Ninja; fi
for name in $chosen; do
    # Fields end with " | "; the entries of ctest have bars without blanks.
    row=$(row_of "$name")
    preset=${row%% | *} row=${row#* | }
    targets=${row%% | *} row=${row#* | }
    run_variant "$name" "$preset" "$targets" "${row%% | *}"
done
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
