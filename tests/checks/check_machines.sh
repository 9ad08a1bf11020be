#!/bin/sh
# check_machines.sh WORK_FOLDER [PATTERN]
#
# The library is built for other machines and with other flags, and must give
# the same hashes as here (tests/checks/consumers/hashes.c): other processors run under
# qemu, Windows under wine.  No flag of the project's own build is given, such
# as -ffp-contract=off: what keeps the bits must be in the sources.
# Only rows that match PATTERN.  The table of hashes is WORK_FOLDER/table.
set -u
root=$(cd "$(dirname "$0")/../.." && pwd)
mkdir -p "$1"
work=$(cd "$1" && pwd)
pattern=${2:-.}
failed=0
export WINEPREFIX="$work/wine" WINEDEBUG=-all

build() { # folder, compiler and flags: core and program, one folder for each row
    folder=$1
    shift
    rm -rf "$folder"
    mkdir -p "$folder" && cd "$folder" || return 1
    # shellcheck disable=SC2086
    { printf '%s\n' "$root"/src/*/*/*.cpp | xargs -P "${JOBS:-$(nproc)}" -n 4 $1 -std=c++17 -I"$root/include" -c &&
            $1 -x c++ -std=c++17 -I"$root/include" -c "$root/tests/checks/consumers/hashes.c" -o hashes_program.o &&
            $1 ./*.o $2 -o program; } > log 2>&1
    code=$?
    cd "$root" || return 1
    return $code
}

matches() { printf '%s\n' "$1" | grep -qE -- "$pattern"; }

compare() { # name, command ...
    name=$1
    shift
    if ! "$@" > "$work/$name.hashes" 2> "$work/$name.errors"; then
        echo "not ok machines $name: the program failed"
        tail -3 "$work/$name.hashes" "$work/$name.errors"
        failed=1
        return
    fi
    tr -d '\r' < "$work/$name.hashes" > "$work/$name.table"
    sed "s/^/$name /" "$work/$name.table" >> "$work/table"
    if cmp -s "$work/$name.table" "$work/reference.table"; then
        echo "ok machines $name"
    else
        echo "not ok machines $name: other bits"
        diff "$work/reference.table" "$work/$name.table"
        failed=1
    fi
}

row() { # name, "compiler and flags", "flags of the linker", command that runs the program ...
    name=$1 compiler=$2 link=$3
    shift 3
    matches "$name" || return 0
    if ! command -v "${compiler%% *}" > /dev/null; then
        echo "skip machines $name (skipped: no ${compiler%% *})"
        return 0
    fi
    if [ $# -gt 0 ] && ! command -v "$1" > /dev/null; then
        echo "skip machines $name (skipped: no $1)"
        return 0
    fi
    if ! build "$work/$name" "$compiler" "$link"; then
        echo "not ok machines $name: the build failed"
        grep -E 'error|undefined' "$work/$name/log" | cut -c 1-200 | head -8
        failed=1
        return 0
    fi
    program=$work/$name/program
    [ -e "$program.exe" ] && program=$program.exe
    compare "$name" "$@" "$program"
}

links() { # name, "compiler and flags", "flags of the linker": a program that cannot run here
    matches "$1" || return 0
    if ! command -v "${2%% *}" > /dev/null; then
        echo "skip machines $1 (skipped: no ${2%% *})"
    elif build "$work/$1" "$2" "$3"; then
        echo "ok machines $1: links"
    else
        echo "not ok machines $1: the build failed"
        grep -E 'error|undefined' "$work/$1/log" | cut -c 1-200 | head -8
        failed=1
    fi
}

refused() { # name, "compiler and flags": one file does not compile, with a sentence of ours
    matches "$1" || return 0
    if ! command -v "${2%% *}" > /dev/null; then
        echo "skip machines $1 (skipped: no ${2%% *})"
        return 0
    fi
    # shellcheck disable=SC2086
    if $2 -std=c++17 -I"$root/include" -c "$root/src/core/base/memory.cpp" -o "$work/refused.o" > "$work/refused.log" 2>&1; then
        echo "not ok machines $1: compiles"
        failed=1
    elif grep -q 'error.*hmf needs' "$work/refused.log"; then
        echo "ok machines $1"
    else
        echo "not ok machines $1: no sentence of ours"
        head -3 "$work/refused.log"
        failed=1
    fi
}

# The package ziglang of PyPI as a command, if it is there or can be installed into an own environment.
if ! command -v zigc++ > /dev/null && matches 'musl macos'; then
    { [ -x "$work/zig/bin/python" ] || python3 -m venv "$work/zig"; } > /dev/null 2>&1 &&
        "$work/zig/bin/pip" -q install ziglang > /dev/null 2>&1 &&
        printf '#!/bin/sh\nexec "%s" -m ziglang c++ "$@"\n' "$work/zig/bin/python" > "$work/zig/bin/zigc++" &&
        chmod +x "$work/zig/bin/zigc++"
    PATH=$PATH:$work/zig/bin
fi

rm -f "$work/table"
if ! build "$work/reference" "c++ -O2" "" || ! "$work/reference/program" > "$work/reference.table"; then
    echo "not ok machines reference"
    tail -5 "$work/reference/log"
    exit 1
fi
echo "ok machines reference"
sed 's/^/reference /' "$work/reference.table" >> "$work/table"

refused fast-math "g++ -O2 -ffast-math"
refused Ofast "g++ -Ofast"
refused clang-fast-math "clang++ -O2 -ffast-math"
refused x87 "i686-linux-gnu-g++ -O2"

if grep -qw fma /proc/cpuinfo 2> /dev/null; then
    row haswell "g++ -O3 -march=haswell" ""
    row native-clang "clang++ -O3 -march=native" ""
fi
row lto "g++ -O2 -flto" ""
row aarch64 "aarch64-linux-gnu-g++ -O2" -static qemu-aarch64
row s390x "s390x-linux-gnu-g++ -O2" -static qemu-s390x
row riscv64 "riscv64-linux-gnu-g++ -O2" -static qemu-riscv64
row i386 "i686-linux-gnu-g++ -O2 -msse2 -mfpmath=sse" -static qemu-i386
row windows "x86_64-w64-mingw32-g++-posix -O2" -static wine
# zig is a cross compiler for all of these; macOS cannot run here and is only linked.
row musl "zigc++ -O2 -target x86_64-linux-musl" ""
links macos-arm64 "zigc++ -O2 -target aarch64-macos" ""
exit $failed
