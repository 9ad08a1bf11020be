#!/bin/bash
# test.sh             all tests; a line "ok ", "not ok " or "skip " for each group
# test.sh same-bits   the three lines of bindings/same_bits/README.md
#
# Installs what is missing: the compiler for WebAssembly and Chromium with
# apt-get, TypeScript and playwright-core with npm.
set -u
cd "$(dirname "$0")"
only=${1:-}
work=${HMF_BINDING_WORK:-$(mktemp -d)}
export HMF_BINDING_WORK=$work
# The clean clone and the package have the same sources: what is compiled of the same bytes is compiled once.
export HMF_WASM_OBJECTS=$work/objects

# Debian packages for the WebAssembly target of the clang that is installed.
ensure_debian() { # package ...
    command -v apt-get > /dev/null || return 1
    local sudo=
    [ "$(id -u)" -eq 0 ] || sudo=sudo
    echo "Installing: $*" >&2
    { $sudo apt-get update -q && DEBIAN_FRONTEND=noninteractive $sudo apt-get install -q -y --no-install-recommends "$@"; } > "$work/apt.log" 2>&1
}

can_build() {
    [ -n "${WASI_SDK_PATH:-}" ] && return 0
    echo 'int main() { return 0; }' | clang++ --target=wasm32-wasi -mexec-model=reactor -fno-exceptions -x c++ - -o "$work/probe.wasm" > /dev/null 2>&1
}

# The module is made again whenever the core, the glue or the build is newer.
build() {
    if ! can_build; then
        local version
        command -v clang++ > /dev/null || ensure_debian clang
        version=$(clang++ -dumpversion | cut -d. -f1)
        ensure_debian lld wasi-libc "libclang-rt-$version-dev-wasm32" "libc++-$version-dev-wasm32" "libc++abi-$version-dev-wasm32"
        can_build || return 2
    fi
    if [ -f dist/hmf.wasm ] && [ -f dist/layout.js ] &&
            [ -z "$(find ../../src ../../include src build.js -type f -newer dist/hmf.wasm -print -quit)" ]; then
        return 0
    fi
    node build.js > "$work/build.log" 2>&1
}

skip_all() {
    if [ "$only" = same-bits ]; then echo "skip $1"; else echo "skip javascript (skipped: $1)"; fi
    exit 0
}

if ! command -v node > /dev/null || [ "$(node -p 'process.versions.node.split(".")[0]')" -lt 20 ]; then
    skip_all "no Node 20 or later"
fi
build
case $? in
0) ;;
2) skip_all "no clang with wasi-libc, and it could not be installed" ;;
*)
    [ "$only" = same-bits ] && { cat "$work/build.log" >&2; exit 1; }
    echo "not ok javascript-build"
    tail -30 "$work/build.log"
    exit 1
    ;;
esac

if [ "$only" = same-bits ]; then
    exec node test/same_bits.js
fi

failed=0
group() { # name, seconds, command ...
    local name=$1 seconds=$2 log=$work/javascript-$1.log
    shift 2
    if timeout "$seconds" "$@" > "$log" 2>&1; then
        echo "ok javascript-$name"
    else
        echo "not ok javascript-$name"
        grep -E -A25 '^not ok|error|Error' "$log" | head -60
        echo "    all of it: $log"
        failed=1
    fi
}
skip() { echo "skip javascript-$1 (skipped: $2)"; }

echo "ok javascript-build"
group results 1200 node --test test/results.test.js
group errors 1200 node --test test/errors.test.js
group everyday 1200 node --test test/everyday.test.js
group every-error 1200 node --test test/every_error.test.js
group parameterize 1200 node --test test/parameterize.test.js
group trace 1200 node --test test/trace.test.js
group quads 1200 node --test test/quads.test.js
group memory 1200 node --test test/memory.test.js
group load 1200 node --test test/load.test.js
group drift 1200 node --test test/drift.test.js

if [ ! -d node_modules/typescript ] || [ ! -d node_modules/playwright-core ]; then
    npm ci --no-audit --no-fund > "$work/npm.log" 2>&1
fi
if [ -d node_modules/typescript ] && [ -d node_modules/playwright-core ]; then
    group types 1200 node_modules/.bin/tsc --project test/types/tsconfig.json
    group readme 2400 node --test test/readme.test.js
    find_chromium() { command -v chromium || command -v chromium-browser || command -v google-chrome; }
    find_chromium > /dev/null || ensure_debian chromium
    if HMF_CHROMIUM=$(find_chromium); then
        export HMF_CHROMIUM
        group browser 2400 node --test test/browser.test.js
    else
        skip browser "no Chromium, and it could not be installed"
    fi
else
    for name in types readme browser; do skip $name "npm could not install the development packages"; done
fi
exit $failed
