#!/bin/bash
# check_bindings.sh WORK_FOLDER
# check_bindings.sh WORK_FOLDER --quick   only C, and the Python module made of the library that the release build has
#
# Runs the tests of each binding, and compares the bits of its results with
# those of C (bindings/same_bits).
#
# A binding is a folder bindings/LANGUAGE with a script test.sh:
#   test.sh             runs its tests; each line beginning "ok ", "not ok " or "skip " is counted
#   test.sh same-bits   prints the lines of bindings/same_bits/README.md, or one line "skip REASON"
# It builds in the folder of the environment variable HMF_BINDING_WORK, made here.
set -u
root=$(cd "$(dirname "$0")/../.." && pwd)
work=$1
failed=0
mkdir -p "$work"
work=$(cd "$work" && pwd)

reference=$work/same_bits.txt
# The library of the release build, which the tests of that build use as well.
make_reference() {
    {
        cd "$root" && cmake --preset release && cmake --build build/release --target hmf hmf_pool -j "${JOBS:-$(nproc)}" &&
            cc -std=c99 -pedantic -Wall -Wextra -Werror -I"$root/include" "$root/bindings/same_bits/same_bits.c" \
                build/release/libhmf.a -lstdc++ -lm -o "$work/same_bits"
    } > "$work/core.log" 2>&1 && timeout 600 "$work/same_bits" > "$reference"
}

run_binding() { # language
    local script=$root/bindings/$1/test.sh lines=$work/same_bits-$1.txt log=$work/$1.log
    export HMF_BINDING_WORK=$work/$1
    mkdir -p "$HMF_BINDING_WORK"
    timeout 7200 "$script" 2>&1 | tee "$log"
    local code=${PIPESTATUS[0]}
    if [ "$code" -ne 0 ]; then
        failed=1
        grep -q '^not ok ' "$log" || echo "not ok bindings-$1 (exit code $code, nothing reported)"
    elif ! grep -q -E '^(ok|not ok|skip) ' "$log"; then
        failed=1
        echo "not ok bindings-$1 (nothing reported)"
    fi

    timeout 1800 "$script" same-bits > "$lines" 2> "$lines.err"
    code=$?
    if [ "$code" -eq 0 ] && grep -q '^skip ' "$lines"; then
        echo "skip bindings-same-bits $1 (skipped: $(sed -n 's/^skip //p' "$lines" | head -1))"
    elif [ "$code" -eq 0 ] && cmp -s "$reference" "$lines"; then
        echo "ok bindings-same-bits $1"
    else
        echo "not ok bindings-same-bits $1 (exit code $code)"
        diff "$reference" "$lines"
        tail -20 "$lines.err"
        failed=1
    fi
}

# --- One function for each language: what it needs, then its tests ---------

python() {
    if ! command -v python3 > /dev/null; then
        echo "skip bindings-python (skipped: no python3)"
        return
    fi
    run_binding python
}

# These scripts say themselves what is missing.
rust() { run_binding rust; }
javascript() { run_binding javascript; }

# --- Main ------------------------------------------------------------------

if make_reference && [ "$(wc -l < "$reference")" -eq 3 ]; then
    echo "ok bindings-same-bits c"
else
    echo "not ok bindings-same-bits c"
    tail -20 "$work/core.log"
    exit 1
fi
# The module compiled against the static library, beside the Python sources of the package: the same bits.
quick_python() {
    local python=$work/venv/bin/python packaging=$root/bindings/python/packaging headers=$root/include/hmf readers=$root/bindings/readers
    rm -rf "$work/package"
    { [ -x "$python" ] || python3 -m venv "$work/venv"; } && "$work/venv/bin/pip" install -q cffi numpy > "$work/pip.log" 2>&1 || {
        echo "skip bindings-same-bits python (skipped: no environment with numpy and cffi)"
        return 0
    }
    mkdir -p "$work/package" && cp -r "$root/bindings/python/src/foliations" "$work/package" &&
        "$python" "$packaging/declarations.py" "$headers/hmf.h" "$headers/applications.h" "$headers/pool.h" "$readers/readers.h" \
            "$packaging/progress.c" "$work/_native.c" &&
        cc -O1 -fPIC -shared -I"$("$python" -c 'import sysconfig; print(sysconfig.get_path("include"))')" -I"$root/include" -I"$readers" "$work/_native.c" \
            "$root/build/release/bindings/readers/libhmf_readers.a" "$root/build/release/libhmf.a" "$root/build/release/libhmf_pool.a" -lstdc++ -lm -lpthread \
            -o "$work/package/foliations/_native$("$python" -c 'import sysconfig; print(sysconfig.get_config_var("EXT_SUFFIX"))')" &&
        PYTHONPATH=$work/package "$python" "$root/bindings/python/tests/same_bits.py" > "$work/same_bits-python.txt" &&
        diff "$reference" "$work/same_bits-python.txt"
}
if [ "${2:-}" = --quick ]; then
    if quick_python > "$work/python.log" 2>&1; then
        grep '^skip ' "$work/python.log" || echo "ok bindings-same-bits python"
        exit 0
    fi
    echo "not ok bindings-same-bits python"
    tail -20 "$work/python.log"
    exit 1
fi

# Side by side: each has long stretches of one process.
languages=
for language in python rust javascript; do
    [ -x "$root/bindings/$language/test.sh" ] || continue
    languages="$languages $language"
    { "$language"; echo "$failed" > "$work/$language.failed"; } > "$work/$language.printed" 2>&1 &
done
wait
for language in $languages; do
    cat "$work/$language.printed"
    [ "$(cat "$work/$language.failed")" -eq 0 ] || failed=1
done
exit $failed
