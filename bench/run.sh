#!/bin/bash
# Measures hmf, and writes one report: tables, plots, every number as CSV.
#
#     bench/run.sh [quick|full]       at most 10 or 80 minutes on two cores, with installation and build
#
# HMF_MESHES is a folder of OBJ meshes; without it generated families are measured.  The report is
# build/report-MODE/report.html (and report.md).  A run that was stopped continues where it was; delete
# build/report-MODE to measure again.  Packages are installed by name where apt-get and pip can; what cannot be installed
# is named as missing in the report.
set -u
cd "$(dirname "$0")/.." || exit 1
start=$(date +%s)
mode=${1:-quick}
case $mode in
    quick) patience=60 ;;
    full) patience=400 ;;
    *) echo "usage: bench/run.sh [quick|full]" >&2 && exit 2 ;;
esac
work=$PWD/build/report-$mode build=$PWD/build/bench venv=$PWD/build/bench-python
mkdir -p "$work"
log=$work/install.log

try() { # seconds, command: its output goes to the log, its failure is no failure of the run
    timeout "$@" >> "$log" 2>&1 || echo "not installed: ${*:2}" | tee -a "$log"
}

# Debian packages that are not there yet.
wanted=(cmake ninja-build g++ libsuitesparse-dev libopenblas-dev python3-venv)
[ "$mode" = full ] && wanted+=(python3-petsc4py python3-scipy)
missing=()
for package in "${wanted[@]}"; do
    dpkg -s "$package" > /dev/null 2>&1 || missing+=("$package")
done
if [ ${#missing[@]} -gt 0 ] && command -v apt-get > /dev/null && [ "$(id -u)" = 0 ]; then
    export DEBIAN_FRONTEND=noninteractive
    try "$patience" apt-get update -qq
    try "$((3 * patience))" apt-get install -y -qq --no-install-recommends "${missing[@]}"
fi

# Packages of Python, while the programs are built.
(
    [ -x "$venv/bin/python" ] || try 60 python3 -m venv --system-site-packages "$venv"
    for packages in "numpy scipy matplotlib" pyamg xatlas "libigl pyQuadriFlow" pyinstantmeshes; do
        # shellcheck disable=SC2086
        "$venv/bin/pip" show -q $packages > /dev/null 2>&1 ||
            try "$((2 * patience))" "$venv/bin/pip" install -q --only-binary :all: $packages
    done
    # Gravo MG needs numpy 1, in an environment of its own.
    if [ ! -e "$venv-numpy1/done" ]; then
        try 60 python3 -m venv "$venv-numpy1"
        timeout "$patience" "$venv-numpy1/bin/pip" install -q --only-binary :all: gravomg 'numpy<2' 'scipy<1.13' \
            >> "$log" 2>&1 && touch "$venv-numpy1/done"
    fi
) &
command -v ccache > /dev/null && export CMAKE_CXX_COMPILER_LAUNCHER=ccache
generator=$(command -v ninja > /dev/null && echo Ninja || echo "Unix Makefiles")
{
    cmake -S . -B "$build" -G "$generator" -DCMAKE_BUILD_TYPE=Release -DHMF_BUILD_BENCH=ON -DHMF_BUILD_CLI=OFF &&
        cmake --build "$build" -j "$(nproc)"
} > "$work/build.log" 2>&1 || { tail -20 "$work/build.log" && exit 1; }
wait

cd bench || exit 1
for python in "$venv/bin/python" python3 /usr/bin/python3; do
    if "$python" -c "import numpy" 2> /dev/null; then
        exec "$python" -m report "$mode" "$work" "$build/bench" "$start"
    fi
done
echo "numpy is needed and could not be installed, see $log" >&2
exit 1
