#!/bin/bash
# ./test.sh           all but the long variants at the end of the list; installs what is missing (Debian; on Fedora, Arch,
#                     Alpine and macOS it says the command)
# ./test.sh NAME...   only these variants
# ./test.sh list      the names
#
# The last line is "N passed, N failed, N skipped", summed over all variants;
# the exit code is 0 only if nothing failed.  Builds lie in build/<preset>.
#
# Environment: HMF_MESHES  folder of OBJ meshes (default ../shared/meshes)
#              HMF_SURFACES  folder of other OBJ meshes: holes, shells, spheres (default ../shared/surfaces)
#              HMF_CAMPAIGN_SEED  first seed of campaign (default 1)
#              JOBS        parallel jobs (default: number of cores)
set -u
cd "$(dirname "$0")"

default_variants="format header symbols abi plain install packages bindings release asan-ubsan fuzz valgrind corpus"
variants="$default_variants debug corpus-large campaign mutations machines static tsan coverage reproducible fuzzing"
jobs=${JOBS:-$(nproc 2> /dev/null || getconf _NPROCESSORS_ONLN)}
results=$PWD/build/results
passed=0 failed=0 skipped=0

describe() {
    cat <<'END'
format        layout of the C and C++ sources; src/README.md names what is there, folders depend on each other without a circle
header        hmf.h and uses.h in C89, C99, C11, C17 and C++17, hmf.hpp and uses.hpp, included twice
symbols       exported symbols, dependencies, no global state
abi           the interface against the recorded one; what breaks programs is seen (docs/abi.md)
plain         compiles without a build system; same bits with both compilers
install       consumers: find_package, add_subdirectory, pkg-config, cc; example of the README
packages      one version everywhere, manifests; with HMF_PACKAGES=1 wheels, Debian, Conan, vcpkg, conda
bindings      tests of the packages for other languages; the same bits from each
release       all tests, optimised
asan-ubsan    tests with assertions on, address and undefined behaviour sanitizers; fewer cases of one kind than in release
fuzz          replays the corpora and a short random run, with sanitizers
valgrind      the quick tests under valgrind, as optimised as they are shipped
corpus        real meshes up to 250 000 vertices, with a time limit for each
debug         all tests but UniqueLong, assertions on (not in the default run: asan-ubsan has them on for the same tests)
corpus-large  all real meshes (long; not in the default run)
campaign      2 000 random problems with three hierarchies each, 2 000 with marked vertices, 500 surfaces with random
              holes, 500 with random marked vertices (long; not in the default run; samples are in release)
machines      the same bits on other processors, systems and with other flags, and plain with each compiler and
              optimisation (long; not in the default run)
static        clang-tidy, cppcheck, gcc's analyzer, and the stack: frames, recursion, depth (not in the default run)
tsan          threads under the thread sanitizer (minutes; not in the default run)
coverage      lines of the core that tests and fuzz corpora reach: at least 97.5 % (long)
reproducible  two builds in different folders give the same bytes (not in the default run)
fuzzing       each fuzz target with libFuzzer and sanitizers, half an hour each (long; HMF_FUZZ_SECONDS)
mutations     defects that a test must notice: a table of them, and those derived from the sources that
              tests/mutation/drawn_mutations.txt lists (long; more or others: HMF_MUTATIONS, HMF_MUTATION_SEED)
END
}

# --- What is needed --------------------------------------------------------

. bindings/packaging/system_packages.sh
ensure_packages() {
    local missing=()
    need() { # package, command that succeeds when it is there
        local package=$1
        shift
        "$@" > /dev/null 2>&1 || missing+=("$package")
    }
    local include=/usr/include
    need build-essential sh -c 'command -v c++ && command -v make'
    need cmake command -v cmake
    need clang command -v clang++
    need clang-format command -v clang-format
    need valgrind command -v valgrind
    need pkg-config command -v pkg-config
    need python3 command -v python3
    need python3-venv python3 -c 'import venv, ensurepip'
    need libgtest-dev test -e $include/gtest/gtest.h
    need libeigen3-dev test -e $include/eigen3/Eigen/Core
    [ ${#missing[@]} -eq 0 ] && return 0

    install_packages "${missing[@]}"
}

# --- Counting --------------------------------------------------------------

add() { # passed failed skipped
    passed=$((passed + $1)) failed=$((failed + $2)) skipped=$((skipped + $3))
}

# Counts of a JUnit file (ctest, GoogleTest): one testcase element each.
count_junit() {
    awk '
        /<testcase / { if (open) total(); open = 1; bad = skip = 0 }
        open && /<failure|status="fail"/ { bad = 1 }
        open && /<skipped|result="skipped"|status="notrun"|status="disabled"/ { skip = 1 }
        function total() { if (bad) f++; else if (skip) s++; else p++ }
        END { if (open) total(); print p + 0, f + 0, s + 0 }' "$1"
}

# Runs a check_*.sh, whose lines begin with ok, not ok, skip.
run_check() {
    local log=$results/$1.log
    shift
    "$@" 2>&1 | tee "$log"
    local code=${PIPESTATUS[0]}
    local p f s
    p=$(grep -c '^ok ' "$log") f=$(grep -c '^not ok ' "$log") s=$(grep -c '^skip ' "$log")
    # A check that dies without saying why has failed too.
    if [ "$code" -ne 0 ] && [ "$f" -eq 0 ] || [ $((p + f + s)) -eq 0 ]; then
        f=$((f + 1))
        echo "not ok: exit code $code, nothing reported"
    fi
    add "$p" "$f" "$s"
}

# A GoogleTest program on its own; its report is the count.
run_gtest() { # name, seconds, command ...
    start_gtest "$@"
    count_gtest "$1"
}
start_gtest() { # name, seconds, command ...
    local name=$1 seconds=$2
    shift 2
    rm -f "$results/$name.xml"
    GTEST_OUTPUT=xml:$results/$name.xml timeout "$seconds" "$@" > "$results/$name.log" 2>&1
    echo $? > "$results/$name.code"
}
count_gtest() { # name
    local name=$1 xml=$results/$1.xml code p=0 f=0 s=0
    code=$(cat "$results/$name.code")
    [ -s "$xml" ] && read -r p f s < <(count_junit "$xml")
    if [ $code -ne 0 ]; then
        [ "$f" -gt 0 ] || f=1
        echo "not ok $name (exit code $code, 124 = out of time)"
        grep -E '^\[  FAILED|Failure$|ERROR SUMMARY|^==[0-9]+== [A-Z]|runtime error' "$results/$name.log" | head -20
        echo "    all of it: $results/$name.log"
    elif [ $((p + f + s)) -eq 0 ]; then
        echo "skip $name (skipped: no test selected)"
    else
        echo "ok $name: $p passed, $s skipped"
    fi
    add "$p" "$f" "$s"
}

# Until fewer run in the background than there are cores.
wait_for_a_core() {
    while [ "$(jobs -r | wc -l)" -ge "$jobs" ]; do sleep 0.1; done
}

# --- Variants --------------------------------------------------------------

build() { # preset, targets or all of them
    local preset=$1
    shift
    echo "building $preset"
    # The failed build is one failure; what it would have run is not counted.
    if { cmake --preset "$preset" && cmake --build "build/$preset" -j "$jobs" --target "${@:-all}"; } > "$results/$preset-build.log" 2>&1; then
        return 0
    fi
    echo "not ok $preset: the build failed"
    grep -E -A3 'error|Error' "$results/$preset-build.log" | head -40
    echo "    all of it: $results/$preset-build.log"
    add 0 1 0
    return 1
}

run_ctest() { # preset, options of ctest ...
    build "$1" || return
    local preset=$1 xml=$results/$1.xml code p f s
    shift
    rm -f "$xml"
    ctest --test-dir "build/$preset" -LE corpus -j "$jobs" --output-on-failure --output-junit "$xml" "$@" > "$results/$preset.log" 2>&1
    code=$?
    p=0 f=0 s=0
    [ -s "$xml" ] && read -r p f s < <(count_junit "$xml")
    if [ $code -ne 0 ] && [ "$f" -eq 0 ]; then f=1; fi
    if [ $((p + f)) -eq 0 ]; then
        echo "not ok $preset: no test was run"
        f=1
    fi
    [ "$f" -eq 0 ] || { tail -60 "$results/$preset.log"; echo "    all of it: $results/$preset.log"; }
    add "$p" "$f" "$s"
}

variant_format() {
    run_check format tests/checks/check_format.sh
    run_check map tests/checks/check_map.py
}
variant_header() { run_check header tests/checks/check_header.sh; }
variant_abi() {
    install_if_possible abigail-tools
    run_check abi tests/checks/check_abi.sh build/abi
}
variant_plain() { run_check plain tests/checks/check_plain.sh build/plain; }
variant_install() { run_check install tests/checks/check_install.sh build/install build/release build/library-ON; }
variant_packages() { run_check packages tests/checks/check_packages.sh build/packages; }
variant_bindings() { run_check bindings tests/checks/check_bindings.sh build/bindings; }
variant_release() { run_ctest release; }
# UniqueLong takes a minute in the release build, several without optimisation.
variant_debug() { GTEST_FILTER='-UniqueLong*' run_ctest debug; }
variant_asan-ubsan() {
    choose_sanitizing_compiler
    # The large meshes of these reach what the small ones do, of the same tests or of others of the loops; those of the second
    # list compare numbers of solves and loops like the ones of other tests.
    GTEST_FILTER='-UniqueLong*:*_3?k*:*ZerosDeepInLimbs*:*RealMeshesSettle*:*OrderDoesNotMatter*:*BelongToTheSurface*:'\
'Unique.Across*:Unique.Interpolated*:Unique.Genus2F*:Unique.Genus9*:Unique.Genus10*:Unique.LoopsOfAny*:Unique.NewtonAgrees*:'\
'Scaling.*:*PillowIsSolvedExactly*:*TheMapIsAsLarge*:*AreSolved/sf129110*:Units.ChangeNoBit*' run_ctest asan-ubsan
}

# clang builds with sanitizers in half the time of gcc, and sees numbers that do not fit into an integer as well.
choose_sanitizing_compiler() {
    [ -e build/asan-ubsan/CMakeCache.txt ] && return
    can_sanitize || install_if_possible libclang-rt-14-dev libclang-rt-dev
    if can_sanitize; then CC=clang CXX=clang++ cmake --preset asan-ubsan > "$results/asan-ubsan-build.log" 2>&1; fi
}
can_sanitize() {
    echo 'int main() { return 0; }' | clang++ -fsanitize=address,undefined -x c++ - -o "$results/sanitized" > /dev/null 2>&1 &&
        "$results/sanitized"
}

# The static library and the tool are those of the release build, the shared library has a build of its own, which is
# looked at and linked, and need not be fast.
build_libraries() {
    echo "building the libraries"
    { cmake --preset release && cmake --build build/release -j "$jobs" --target hmf hmf_pool hmf_cli &&
        cmake -S . -B build/library-ON -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS_RELEASE='-O1 -DNDEBUG' \
            -DBUILD_SHARED_LIBS=ON -DHMF_BUILD_CLI=OFF &&
        cmake --build build/library-ON -j "$jobs"; } > "$results/libraries-build.log" 2>&1
    echo $? > "$results/libraries.code"
}
variant_symbols() {
    if [ "$(cat "$results/libraries.code")" -ne 0 ]; then
        echo "not ok symbols: the build failed"
        tail -20 "$results/libraries-build.log"
        add 0 1 0
        return
    fi
    run_check symbols tests/checks/check_symbols.sh build/library-ON/libhmf.so build/release/libhmf.a
}

variant_fuzz() {
    local program name names=
    choose_sanitizing_compiler
    build asan-ubsan || return
    for program in build/asan-ubsan/fuzz/*_replay; do
        [ -x "$program" ] || continue
        name=$(basename "$program" _replay)
        names="$names $name"
        local inputs=() runs=2000
        case $name in boundary | differential | faults) runs=200 ;; design) runs=20 ;; esac # whole solves, several for each input
        [ -d "fuzz/corpus/$name" ] && inputs=("fuzz/corpus/$name")
        wait_for_a_core
        { timeout 600 "$program" "${inputs[@]}" --random $runs 1 > "$results/fuzz-$name.log" 2>&1; echo $? > "$results/fuzz-$name.code"; } &
    done
    wait
    for name in $names; do
        if [ "$(cat "$results/fuzz-$name.code")" -eq 0 ]; then
            echo "ok fuzz $name: $(tail -1 "$results/fuzz-$name.log")"
            add 1 0 0
        else
            echo "not ok fuzz $name"
            tail -20 "$results/fuzz-$name.log"
            add 0 1 0
        fi
    done
    if [ -z "$names" ]; then
        echo "skip fuzz (skipped: there is no fuzz target)"
        add 0 0 1
    fi
}

# Many threads on one hierarchy and one foliation, and tasks that run at once.
variant_tsan() {
    build tsan test_solve || return
    run_gtest tsan-parallel 900 build/tsan/tests/test_solve '--gtest_filter=Parallel.*:Pool.*-*SameBitsOfEveryFunction*'
    run_gtest tsan-resources 900 build/tsan/tests/test_solve '--gtest_filter=*Thread*'
}
# Valgrind is some thirty times slower: only the cases that are quick without it.  The tests are those of the release build;
# the preset valgrind has numbers of lines, to find out more.
variant_valgrind() {
    build release || return
    local program name filter names= chosen=
    # The times of the variant release, if it ran these programs; else they run once more.
    for program in build/release/tests/test_*; do
        name=$(basename "$program")
        if ! { [ -f "$program" ] && [ -x "$program" ]; } || [ "$name" = test_corpus ]; then continue; fi
        names="$names $name"
        rm -f "$results/native-$name.code"
        if [ -s "$results/release.xml" ] && [ "$results/release.xml" -nt "$program" ]; then continue; fi
        wait_for_a_core
        start_gtest "native-$name" 600 "$program" '--gtest_filter=-UniqueLong*' &
    done
    wait
    for name in $names; do
        if [ ! -e "$results/native-$name.code" ]; then
            filter=$(quick_cases_of_release "build/release/tests/$name")
        elif [ "$(cat "$results/native-$name.code")" -ne 0 ]; then
            echo "not ok valgrind-$name: fails even without valgrind"
            grep -E '^\[  FAILED|Failure$' "$results/native-$name.log" | head
            add 0 1 0
            continue
        else
            filter=$(quick_cases "$results/native-$name.xml")
        fi
        [ -n "$filter" ] || continue
        chosen="$chosen $name"
        wait_for_a_core
        start_gtest "valgrind-$name" 900 valgrind -q --error-exitcode=9 --leak-check=full --show-leak-kinds=definite,indirect \
            --errors-for-leak-kinds=definite,indirect "build/release/tests/$name" "--gtest_filter=$filter" &
    done
    wait
    for name in $chosen; do count_gtest "valgrind-$name"; done
    if [ -z "$chosen" ]; then
        echo "not ok valgrind: no case was chosen"
        add 0 1 0
    fi
}
# Those of the program that the variant release ran, by the same measure as below.
quick_cases_of_release() { # program
    "$1" --gtest_list_tests | awk '
        FNR == NR { if (/^[^ ].*\./) suite = $1; else if (/^  /) listed[suite $1] = 1; next }
        /<testcase / && /status="run"/ {
            match($0, / name="[^" ]*/); n = substr($0, RSTART + 7, RLENGTH - 7)
            match($0, / time="[^"]*"/); t = substr($0, RSTART + 7, RLENGTH - 8) + 0
            if (n in listed && t <= 0.1 && (sum += t) <= 1) printf "%s%s", (k++ ? ":" : ""), n }' - "$results/release.xml"
}
# Those of at most a tenth of a second, and of a second together.
quick_cases() { # JUnit file
    awk '/<testcase / && /status="run"/ {
            match($0, / name="[^"]*"/); n = substr($0, RSTART + 7, RLENGTH - 8)
            match($0, / time="[^"]*"/); t = substr($0, RSTART + 7, RLENGTH - 8) + 0
            match($0, / classname="[^"]*"/); c = substr($0, RSTART + 12, RLENGTH - 13)
            if (t <= 0.1 && (sum += t) <= 1) printf "%s%s.%s", (k++ ? ":" : ""), c, n }' "$1"
}

run_corpus() { # name, largest mesh in vertices, seconds
    local meshes=${HMF_MESHES:-$PWD/../shared/meshes}
    if [ ! -d "$meshes" ]; then
        echo "skip $1 (skipped: no folder $meshes)"
        add 0 0 1
        return
    fi
    build release || return
    if [ ! -x build/release/tests/test_corpus ]; then
        echo "skip $1 (skipped: there is no tests/core/corpus/test_corpus.cpp)"
        add 0 0 1
        return
    fi
    # Each process a part of the meshes.
    local part parts=$((jobs < 4 ? jobs : 4))
    for ((part = 0; part < parts; ++part)); do
        HMF_MESHES=$meshes HMF_CORPUS_MAX_VERTICES=$2 GTEST_TOTAL_SHARDS=$parts GTEST_SHARD_INDEX=$part \
            start_gtest "$1-$part" "$3" build/release/tests/test_corpus &
    done
    wait
    for ((part = 0; part < parts; ++part)); do count_gtest "$1-$part"; done
}
# HMF_CAMPAIGN_SEED: of the first problem; HMF_CAMPAIGN_PROBLEMS: how many.  The table is in results/campaign.log.
variant_campaign() {
    build release || return
    HMF_CAMPAIGN_PROBLEMS=${HMF_CAMPAIGN_PROBLEMS:-2000} run_gtest campaign 14400 build/release/tests/test_solve '--gtest_filter=Campaign.*'
    grep -A14 ' problems, seeds ' "$results/campaign.log"
    HMF_MARKED_CASES=${HMF_MARKED_CASES:-500} run_gtest campaign-marks 7200 build/release/tests/test_solve \
        --gtest_filter=Marked.RandomMarks
    HMF_HOLES=${HMF_HOLES:-500} HMF_HOLES_MAX_VERTICES=${HMF_HOLES_MAX_VERTICES:-300000} \
        run_gtest campaign-holes 14400 build/release/tests/test_applications '--gtest_filter=BoundaryCampaign.*'
    grep -A3 ' cases, ' "$results/campaign-holes.log"
}
# What cannot be installed is skipped there.
install_if_possible() { # package ...
    local package sudo=
    command -v apt-get > /dev/null || return 0
    [ "$(id -u)" -eq 0 ] || sudo=sudo
    for package in "$@"; do
        dpkg -s "$package" > /dev/null 2>&1 ||
            DEBIAN_FRONTEND=noninteractive $sudo apt-get install -q -y --no-install-recommends "$package" > /dev/null 2>&1
    done
}
variant_static() {
    install_if_possible clang-tidy cppcheck
    run_check static tests/checks/check_static.sh build/static
}
variant_machines() {
    install_if_possible qemu-user g++-aarch64-linux-gnu g++-s390x-linux-gnu g++-riscv64-linux-gnu g++-i686-linux-gnu \
        g++-mingw-w64-x86-64-posix wine wine64
    run_check machines tests/checks/check_machines.sh build/machines
    HMF_PLAIN_ALL=1 run_check plain-all tests/checks/check_plain.sh build/plain
}
variant_coverage() {
    install_if_possible clang llvm
    run_check coverage python3 tests/mutation/coverage.py build/coverage
}
variant_reproducible() { run_check reproducible tests/checks/check_reproducible.sh build/reproducible; }
# HMF_FUZZ_SECONDS: for each target; HMF_FUZZ_TARGETS: which, in this order.  Findings and the grown corpora stay in build/fuzzing.
# libFuzzer measures a timeout on the clock: packing of charts, 13 s with sanitizers, is no finding on a busy machine.
variant_fuzzing() {
    install_if_possible clang libclang-rt-14-dev zip
    local work=$PWD/build/fuzzing name seconds=${HMF_FUZZ_SECONDS:-1800}
    mkdir -p "$work/out" "$work/work" "$work/src"
    ln -sfn "$PWD" "$work/src/hmf"
    if ! CC=clang CXX=clang++ CFLAGS='' SRC=$work/src WORK=$work/work OUT=$work/out LIB_FUZZING_ENGINE=-fsanitize=fuzzer \
            CXXFLAGS="-O1 -gline-tables-only -fsanitize=address,undefined,fuzzer-no-link -fno-sanitize-recover=all" \
            bash -eu fuzz/oss-fuzz/build.sh > "$results/fuzzing-build.log" 2>&1; then
        echo "not ok fuzzing: the build failed, see $results/fuzzing-build.log"
        add 0 1 0
        return
    fi
    for name in ${HMF_FUZZ_TARGETS:-$(cd fuzz && ls ./*.cpp | sed 's|^./||; s|\.cpp$||; /^driver$/d')}; do
        mkdir -p "$work/corpus/$name" "$work/found/$name"
        if "$work/out/$name" -max_total_time="$seconds" -timeout=600 -rss_limit_mb=4000 -print_final_stats=1 \
                -artifact_prefix="$work/found/$name/" "$work/corpus/$name" $([ -d "fuzz/corpus/$name" ] && echo "fuzz/corpus/$name") > "$results/fuzzing-$name.log" 2>&1; then
            echo "ok fuzzing $name: $(sed -n 's/^stat::number_of_executed_units: *//p' "$results/fuzzing-$name.log") inputs, \
$(grep -o 'cov: [0-9]*' "$results/fuzzing-$name.log" | tail -1 | cut -c 6-) edges reached"
            add 1 0 0
        else
            echo "not ok fuzzing $name: see $results/fuzzing-$name.log; the input is in $work/found/$name"
            tail -5 "$results/fuzzing-$name.log"
            add 0 1 0
        fi
    done
}
variant_mutations() {
    install_if_possible clang llvm # where a recorded case does not notice its defect any more: which cases reach it
    run_check mutations python3 tests/mutation/table_mutations.py build/derived
    run_check derived-mutations python3 tests/mutation/derived_mutations.py build/derived --as-built \
        --count "${HMF_MUTATIONS:-0}" --seed "${HMF_MUTATION_SEED:-1}"
}
variant_corpus() { run_corpus corpus 250000 900; }
variant_corpus-large() { HMF_CORPUS_ALL_RATIOS=1 run_corpus corpus-large 2000000 14400; }

# --- Main ------------------------------------------------------------------

if [ "${1:-}" = list ]; then
    describe
    exit 0
fi
for name in "$@"; do
    case " $variants " in
    *" $name "*) ;;
    *)
        echo "no variant '$name'; there are:"
        describe
        exit 2
        ;;
    esac
done

ensure_packages || exit 1
mkdir -p "$results"
if [ -z "${HMF_MESHES:-}" ] && [ -d ../shared/meshes ]; then
    HMF_MESHES=$(cd ../shared/meshes && pwd)
    export HMF_MESHES
fi
if [ -z "${HMF_SURFACES:-}" ] && [ -d ../shared/surfaces ]; then
    HMF_SURFACES=$(cd ../shared/surfaces && pwd)
    export HMF_SURFACES
fi
# A variant between its two lines.
run_variant() { # name
    local p f s started=$SECONDS
    echo "=== $1"
    p=$passed f=$failed s=$skipped
    "variant_$1"
    echo "--- $1: $((passed - p)) passed, $((failed - f)) failed, $((skipped - s)) skipped, $((SECONDS - started)) s"
}
# Some, one after the other, in a process of its own; what they print and count is left in results.
run_lane() { # names
    local name
    for name in "$@"; do
        passed=0 failed=0 skipped=0
        run_variant "$name" > "$results/$name.out" 2>&1
        echo "$passed $failed $skipped" > "$results/$name.counts"
    done
}
chosen=${*:-$default_variants}
# Mostly one process at a time: two lanes, one beside the other.  Only the first one installs packages.
first_lane="abi bindings" second_lane="format header symbols plain install packages"
of_lane() { # names of a lane: those that are chosen
    local name
    for name in $1; do case " $chosen " in *" $name "*) printf '%s ' "$name" ;; esac done
}
first=$(of_lane "$first_lane") second=$(of_lane "$second_lane")
case "$first$second" in *bindings* | *symbols* | *install*) build_libraries ;; esac # those of both lanes
beside=
if [ "$jobs" -gt 1 ] && [ -n "$first" ] && [ -n "$second" ]; then
    beside="$first$second"
    for name in $beside; do rm -f "$results/$name.counts" "$results/$name.out"; done
    case " $chosen " in *" asan-ubsan "*) choose_sanitizing_compiler ;; esac # may install packages
    echo "at the same time: $first| $second"
    # shellcheck disable=SC2086
    run_lane $first &
    # shellcheck disable=SC2086
    (run_lane $second)
    # Processes of the first lane wait for each other most of its time.
    case " $chosen " in *" asan-ubsan "*) (build asan-ubsan > /dev/null) ;; esac
    wait
fi
for name in $chosen; do
    case " $beside " in
    *" $name "*)
        cat "$results/$name.out"
        if read -r p f s < "$results/$name.counts"; then add "$p" "$f" "$s"; else
            echo "not ok $name: it did not come to its end"
            add 0 1 0
        fi
        ;;
    *) run_variant "$name" ;;
    esac
done
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
