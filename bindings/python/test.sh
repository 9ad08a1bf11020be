#!/bin/bash
# bindings/python/test.sh             tests of the Python package
# bindings/python/test.sh same-bits   the lines of bindings/same_bits/README.md
#
# Makes a source distribution, installs the package from it into an
# environment of its own, and runs pytest there; then the README, verbatim, with
# the wheel alone.  Lines begin with ok, not ok, skip.
#
# Environment: HMF_BINDING_WORK  folder for all of it (default build/python of the repository)
#              HMF_PYTHON_OTHERS  packages to try it with (default "trimesh meshio"; "": none).  Large ones too:
#                                 pyvista polyscope libigl dask distributed ray[data].  Without it, its tests skip.
set -u
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
work=${HMF_BINDING_WORK:-$root/build/python}
mkdir -p "$work"
work=$(cd "$work" && pwd)
venv=$work/venv
python=$venv/bin/python
log=$work/log
failed=0
others=${HMF_PYTHON_OTHERS-trimesh meshio}

# What is not ours: without a network there is nothing to test.
make_environment() {
    { [ -x "$python" ] || python3 -m venv "$venv"; } &&
        "$venv/bin/pip" install -q build scikit-build-core cffi numpy pytest hypothesis mypy matplotlib tqdm
}

# Each by itself: where there is no wheel, the tests of that package skip.
install_others() {
    local name
    for name in $others; do
        timeout 200 "$venv/bin/pip" install -q --only-binary :all: "$name" > "$work/others.log" 2>&1 ||
            echo "skip python with-$name (skipped: no wheel)"
    done
}

install_package() {
    rm -rf "$work/dist"
    "$python" -m build --sdist --no-isolation -o "$work/dist" "$here" &&
        "$venv/bin/pip" wheel -q --no-build-isolation --no-deps -w "$work/dist" "$work"/dist/*.tar.gz &&
        "$venv/bin/pip" install -q --no-deps --force-reinstall "$work"/dist/*.whl
}

prepare() {
    if ! make_environment > "$log" 2>&1; then
        reason="no environment with numpy, cffi, pytest, ...: $(grep -E -m1 'ERROR|Error' "$log" | cut -c 1-120)"
        return 1
    fi
    install_package > "$log" 2>&1
}

# One line for each test, from the JUnit file of pytest.
print_results() {
    "$python" - "$1" <<'END_OF_PROGRAM'
import sys
from xml.etree import ElementTree

for case in ElementTree.parse(sys.argv[1]).iter("testcase"):
    name = case.get("classname", "").rsplit(".", 1)[-1] + "::" + case.get("name", "")
    if case.find("failure") is not None or case.find("error") is not None:
        print("not ok python", name)
    elif (skipped := case.find("skipped")) is not None:
        print(f"skip python {name} (skipped: {skipped.get('message')})")
    else:
        print("ok python", name)
END_OF_PROGRAM
}

run_pytest() {
    # Away from the sources: the installed package is tested.  The limit ends what hangs: it takes a minute or two alone,
    # many times that on a busy machine.
    (cd "$work" && timeout 5400 "$python" -m pytest -q -c "$here/pyproject.toml" --rootdir "$here" -p no:cacheprovider \
        --junit-xml "$work/results.xml" "$here/tests") > "$work/pytest.log" 2>&1
    local code=$?
    if [ -s "$work/results.xml" ]; then print_results "$work/results.xml"; fi
    if [ $code -ne 0 ]; then
        failed=1
        echo "not ok python pytest (exit code $code; 124 = out of time)"
        tail -60 "$work/pytest.log"
    fi
}

# The first hour: the first sh and python blocks of the README as they are, in an empty folder with the wheel in dist,
# in an environment of their own where nothing can be compiled.
run_readme() {
    local clean=$work/clean kind lines
    rm -rf "$clean"
    mkdir -p "$clean/dist"
    cp "$work"/dist/*.whl "$clean/dist"
    for kind in sh python; do
        awk -v begin="^\`\`\`$kind\$" '$0 ~ begin { on = 1; next } /^```/ { if (on) exit } on' "$here/README.md" > "$clean/readme.$kind"
    done
    lines="$(wc -l < "$clean/readme.sh") $(wc -l < "$clean/readme.python")"
    if cmp "$clean/readme.python" "$here/examples/first.py" && [ "${lines% *}" -le 5 ] && [ "${lines#* }" -le 10 ]; then
        echo "ok python readme-shows-the-example"
    else
        echo "not ok python readme-shows-the-example ($lines lines)"
        failed=1
    fi
    if python3 -m venv "$clean/venv" && (cd "$clean" && export PATH="$clean/venv/bin:$PATH" CC=/bin/false CXX=/bin/false PIP_ONLY_BINARY=:all: &&
        timeout 1800 bash -eux readme.sh && timeout 600 python readme.python) > "$work/readme.log" 2>&1 &&
        [ -s "$clean/look.glb" ] && [ -s "$clean/look.npy" ] && [ -s "$clean/first.glb" ] && [ -s "$clean/first.npz" ] &&
        [ "$(head -c 4 "$clean/look.png" | tail -c 3)$(head -c 4 "$clean/first.png" | tail -c 3)" = PNGPNG ]; then
        echo "ok python readme"
    else
        echo "not ok python readme"
        tail -20 "$work/readme.log"
        failed=1
    fi
}

case ${1:-} in
same-bits)
    reason=
    if [ ! -f "$work/installed" ] && ! prepare; then
        [ -n "$reason" ] || { tail -20 "$log" >&2; exit 1; }
        echo "skip $reason"
        exit 0
    fi
    "$python" "$here/tests/same_bits.py"
    exit $?
    ;;
"") ;;
*)
    sed -n '2,3p' "$0"
    exit 2
    ;;
esac

rm -f "$work/installed" "$work/results.xml"
reason=
if ! prepare; then
    if [ -n "$reason" ]; then
        echo "skip python (skipped: $reason)"
        exit 0
    fi
    echo "not ok python install"
    tail -30 "$log"
    exit 1
fi
touch "$work/installed"
echo "ok python install"
install_others
run_pytest
if [ -f "$here/examples/first.py" ]; then run_readme; fi
exit $failed
