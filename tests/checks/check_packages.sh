#!/bin/bash
# check_packages.sh WORK_FOLDER [--quick]   quick: only what needs nothing installed
#
# The recipes and manifests of packages: one version, license, authors and keywords in each; and what can be built here.
# Environment: HMF_PACKAGES=1  also what takes minutes: wheels by the cross compiler, Ray and Dask, npm, Debian, Conan, vcpkg, conda
#              HMF_PACKAGE_TARGETS  of the wheels (default: that of this machine); all: manylinux-aarch64 is run under qemu
#              HMF_MUSL_PYTHON  a Python linked with musl, for the wheel of musllinux
set -u
root=$(cd "$(dirname "$0")/../.." && pwd)
mkdir -p "$1"
work=$(cd "$1" && pwd)
packaging=$root/bindings/packaging
failed=0

check() { # name, then the command
    local name=$1
    shift
    if "$@" > "$work/$name.log" 2>&1; then
        echo "ok packages-$name"
    else
        echo "not ok packages-$name"
        tail -25 "$work/$name.log"
        failed=1
    fi
}
skip() { echo "skip packages-$1 (skipped: $2)"; }

if ! command -v python3 > /dev/null; then
    skip all "no python3"
    exit 0
fi
python3 "$packaging/check_versions.py" || failed=1

# A wrong version is found.
a_wrong_version() {
    rm -rf "$work/wrong"
    mkdir "$work/wrong"
    (cd "$root" && tar c CITATION.cff CHANGELOG.md CMakeLists.txt include bindings/packaging bindings/python/packaging bindings/rust/Cargo.* \
        bindings/rust/foliations/Cargo.toml bindings/javascript/package*.json) | tar x -C "$work/wrong"
    python3 "$work/wrong/bindings/packaging/check_versions.py" || return 1
    sed -i 's/^version: .*/version: 9.9.9/' "$work/wrong/CITATION.cff"
    ! python3 "$work/wrong/bindings/packaging/check_versions.py"
}
check a-wrong-version-is-found a_wrong_version

manifests() {
    python3 - "$root" <<'END'
import json, re, sys
from pathlib import Path
root = Path(sys.argv[1])
texts = {p: (root / p).read_text() for p in ("bindings/rust/Cargo.toml", "bindings/python/pyproject.toml", "bindings/packaging/conan/conanfile.py", "CITATION.cff")}
package = json.loads((root / "bindings/javascript/package.json").read_text())
names = [package["name"]] + [re.search('^name = "(.*)"', (root / "bindings" / p).read_text(), re.M)[1] for p in
                             ("python/pyproject.toml", "rust/foliations/Cargo.toml", "rust/foliations-sys/Cargo.toml")]
assert names == ["foliations"] * 3 + ["foliations-sys"], names  # one name on every registry; hmf is another project there
assert package["license"] == "MIT" and package["author"] == "hmf contributors" and len(package["keywords"]) > 3
for path, text in texts.items():
    for word in ("MIT", "hmf contributors", "foliation"):
        assert word in text, (path, word)
    assert re.search("keywords|topics", text), path
assert json.loads((root / "bindings/packaging/vcpkg/ports/hmf/vcpkg.json").read_text())["license"] == "MIT"
assert "license: MIT" in (root / "bindings/packaging/conda/meta.yaml").read_text()
for line in (root / "LICENSE").read_text().split("\n\n")[2].split("\n"):  # the permission, in the words of the license
    assert " ".join(line.split()[:6]) in " ".join((root / "bindings/packaging/debian/copyright").read_text().split()), line
END
}
check manifests manifests
# Where there is no apt-get, the command of the system with its own names.
system_names() {
    local manager expected
    while read -r manager expected; do
        rm -rf "$work/system"
        mkdir "$work/system"
        printf '#!/bin/sh\n' > "$work/system/$manager"
        chmod +x "$work/system/$manager"
        printed=$(PATH=$work/system "$BASH" -c '. "$1"; install_packages build-essential clang-format python3-venv libgtest-dev libeigen3-dev pkg-config' - \
            "$packaging/system_packages.sh") && return 1
        [ "${printed##*: }" = "$expected" ] || { echo "$printed"; echo "expected: $expected"; return 1; }
    done <<'END'
dnf sudo dnf install gcc-c++ make clang-tools-extra python3 gtest-devel eigen3-devel pkgconf-pkg-config
pacman sudo pacman -S --needed base-devel clang python gtest eigen pkgconf
apk sudo apk add build-base clang-extra-tools python3 gtest-dev eigen-dev pkgconf
brew xcode-select --install; brew install clang-format python3 googletest eigen pkgconf
none build-essential clang-format python3-venv libgtest-dev libeigen3-dev pkg-config.  Please install them.
END
}
check system-names system_names
check release-script bash -n "$packaging/release.sh"

# The bill of materials names every run-time need of the manifests once, refers to nothing that is not there, and is
# the same twice.
bill_of_materials() {
    python3 "$packaging/sbom.py" "$work/bill.json" && python3 "$packaging/sbom.py" | cmp - "$work/bill.json" && python3 - "$root" "$work/bill.json" <<'END'
import json, re, sys, tomllib
from pathlib import Path
root = Path(sys.argv[1])
bill = json.loads(Path(sys.argv[2]).read_text())
assert bill["bomFormat"] == "CycloneDX" and bill["specVersion"] == "1.5" and re.fullmatch(r"urn:uuid:[0-9a-f-]{36}", bill["serialNumber"])
parts = [bill["metadata"]["component"]] + bill["components"]
refs = [p["bom-ref"] for p in parts]
assert len(refs) == len(set(refs)) and all(p["name"] and p["type"] == "library" for p in parts)
for of in bill["dependencies"]:
    assert of["ref"] in refs and set(of["dependsOn"]) <= set(refs), of
python = tomllib.loads((root / "bindings/python/pyproject.toml").read_text())["project"]["dependencies"]
assert python
for need in python:
    name = re.match("[A-Za-z0-9_.-]+", need)[0]
    assert [p["scope"] for p in parts if p["purl"] == "pkg:pypi/" + name] == ["required"], need
lock = tomllib.loads((root / "bindings/rust/Cargo.lock").read_text())["package"]
cc = next(p for p in lock if p["name"] == "cc")
assert f"pkg:cargo/cc@{cc['version']}" in refs and all("pkg:cargo/" + n.split()[0] in " ".join(refs) for n in cc["dependencies"])
END
}
if python3 -c 'import tomllib' 2> /dev/null; then check bill-of-materials bill_of_materials; else skip bill-of-materials "python3 is older than 3.11"; fi

[ "${2:-}" != --quick ] || exit $failed

# npm: what would be in the package.
npm_package() {
    (cd "$root/bindings/javascript" && npm pack --dry-run --ignore-scripts --json) > "$work/npm.json" &&
        python3 -c 'import json, sys
files = {f["path"] for f in json.load(open(sys.argv[1]))[0]["files"]}
assert {"package.json", "README.md", "lib/index.js", "lib/index.d.ts"} <= files, files' "$work/npm.json"
}
if command -v npm > /dev/null; then check npm npm_package; else skip npm "no npm"; fi

# The reference site: every page is made from the sources, every link leads somewhere.
site() {
    "$work/site-venv/bin/python" "$root/docs/site/build_site.py" "$work/site" && "$work/site-venv/bin/python" "$root/docs/site/build_site.py" --check "$work/site" &&
        grep -q '<td><code>class_state</code></td>' "$work/site/python_reference.html" &&
        { [ ! -x "$root/build/release/hmf" ] || grep -q -e '--fill-holes' "$work/site/tool_options.html"; }
}
a_dead_link() {
    rm -rf "$work/dead"
    cp -r "$work/site" "$work/dead" && rm "$work/dead/c.html" && ! "$work/site-venv/bin/python" "$root/docs/site/build_site.py" --check "$work/dead"
}
if { python3 -m venv "$work/site-venv" && "$work/site-venv/bin/pip" install -q mkdocs; } > "$work/mkdocs.log" 2>&1; then
    check site site
    check a-dead-link-is-found a_dead_link
else
    skip site "mkdocs cannot be installed"
fi

if [ "${HMF_PACKAGES:-}" != 1 ]; then
    for name in wheel ray-and-dask npm-install debian conan vcpkg conda; do skip $name "takes minutes; HMF_PACKAGES=1 runs it"; done
    exit $failed
fi

# A wheel of the cross compiler, in an environment of its own, without a compiler: the first example.
case $(uname -s)-$(uname -m) in
Linux-x86_64) native=manylinux-x86_64 ;;
Linux-aarch64) native=manylinux-aarch64 ;;
Darwin-arm64) native=macos-arm64 ;;
Darwin-x86_64) native=macos-x86_64 ;;
*) native= ;;
esac
make_wheels() {
    rm -rf "$work/dist"
    # shellcheck disable=SC2086
    "$work/venv/bin/python" "$packaging/build_wheels.py" --out "$work/dist" ${HMF_PACKAGE_TARGETS:-$native}
}
# The first sh and python blocks of the README of Python, verbatim, with the wheel in dist.
use_wheel() {
    rm -rf "$work/clean"
    mkdir -p "$work/clean/dist"
    cp "$work"/dist/*manylinux*"$(uname -m)".whl "$work/clean/dist"
    for kind in sh python; do
        awk -v begin="^\`\`\`$kind\$" '$0 ~ begin { on = 1; next } /^```/ { if (on) exit } on' "$root/bindings/python/README.md" > "$work/clean/readme.$kind"
    done
    python3 -m venv "$work/clean/venv" && cd "$work/clean" &&
        PATH=$work/clean/venv/bin:/usr/bin:/bin CC=/bin/false CXX=/bin/false PIP_ONLY_BINARY=:all: bash -eux readme.sh &&
        PATH=$work/clean/venv/bin python readme.python && [ -s look.png ] && [ -s look.glb ] && [ -s first.png ] && [ -s first.glb ] && [ -s first.npz ]
}
# Ray Data and Dask with clusters on this machine; a test that skips is a failure here.
many_machines() {
    (cd "$work" && "$work/clean/venv/bin/python" -m pytest -q -c "$root/bindings/python/pyproject.toml" --rootdir "$root/bindings/python" \
        -p no:cacheprovider "$root/bindings/python/tests/test_rows.py") > "$work/rows.log" 2>&1
    local code=$?
    cat "$work/rows.log"
    [ $code -eq 0 ] && ! grep -q skipped "$work/rows.log"
}
# A wheel of another machine, run by an interpreter for it: the same bits as C.
other_wheel() { # pattern of the wheel, interpreter ...
    local wheel
    wheel=$(echo "$work"/dist/$1)
    shift
    mkdir -p "$work/bits"
    cd "$work/bits" || return 1
    "$work/venv/bin/python" "$packaging/try_wheel.py" "$wheel" "$@" > "$work/other_wheel.txt" && cat "$work/other_wheel.txt" &&
        c++ -std=c++17 -O2 -ffp-contract=off -I"$root/include" -c "$root"/src/*/*/*.cpp && cc -std=c99 -I"$root/include" "$root/bindings/same_bits/same_bits.c" ./*.o -lstdc++ -lm -o same_bits &&
        ./same_bits | diff - <(head -3 "$work/other_wheel.txt") && grep -q image.png "$work/other_wheel.txt"
}
# The Python of Debian for arm64, unpacked, for qemu.
arm64_python() {
    local apt=$work/arm64/apt options version
    rm -rf "$work/arm64"
    mkdir -p "$apt/lists/partial" "$apt/archives/partial" "$apt/none"
    touch "$apt/status"
    echo "deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] http://deb.debian.org/debian stable main" > "$apt/sources.list"
    options=(-o Dir::State="$apt" -o Dir::State::lists="$apt/lists" -o Dir::Cache="$apt" -o Dir::Etc::sourcelist="$apt/sources.list" -o Dir::Etc::sourceparts="$apt/none"
        -o Dir::State::status="$apt/status" -o APT::Architectures::=arm64 -o APT::Sandbox::User=root)
    cd "$work/arm64" && apt-get "${options[@]}" update || return 1
    version=$(apt-cache "${options[@]}" show python3-minimal:arm64 | sed -n 's/^Depends:.*python\(3\.[0-9]*\)-minimal.*/\1/p' | head -1)
    apt-get "${options[@]}" download "python$version-minimal:arm64" "libpython$version-minimal:arm64" "libpython$version-stdlib:arm64" libc6:arm64 libgcc-s1:arm64 \
        libstdc++6:arm64 libexpat1:arm64 zlib1g:arm64 libffi8:arm64 || return 1
    for package in *.deb; do dpkg-deb -x "$package" system || return 1; done
    printf '%s\n' "$work/arm64/system/usr/bin/python$version" > "$work/arm64/interpreter"
}
if [ -z "$native" ] || ! { python3 -m venv "$work/venv" && "$work/venv/bin/pip" install -q ziglang cffi build scikit-build-core; } > "$work/venv.log" 2>&1; then
    skip wheel "no environment with ziglang, cffi, build"
else
    check wheel make_wheels
    case $native in
    manylinux*)
        check wheel-in-clean-environment use_wheel
        if "$work/clean/venv/bin/pip" install -q --only-binary :all: pytest dask distributed 'ray[data]' > "$work/ray.log" 2>&1; then
            check ray-and-dask many_machines
        else skip ray-and-dask "they cannot be installed"; fi
        ;;
    *) skip wheel-in-clean-environment "written for Linux" ;;
    esac
    if ! ls "$work"/dist/*manylinux*aarch64.whl > /dev/null 2>&1; then skip wheel-aarch64 "HMF_PACKAGE_TARGETS does not name it"
    elif [ "$(uname -m)" != x86_64 ] || ! command -v qemu-aarch64 > /dev/null; then skip wheel-aarch64 "no qemu-aarch64, or another machine"
    elif ! arm64_python > "$work/arm64.log" 2>&1; then skip wheel-aarch64 "no Python for arm64 can be had"
    else check wheel-aarch64 other_wheel '*manylinux*aarch64.whl' qemu-aarch64 -L "$work/arm64/system" "$(cat "$work/arm64/interpreter")"; fi
    if ! ls "$work"/dist/*musllinux*"$(uname -m)".whl > /dev/null 2>&1; then skip wheel-musl "HMF_PACKAGE_TARGETS does not name it"
    elif [ -z "${HMF_MUSL_PYTHON:-}" ]; then skip wheel-musl "HMF_MUSL_PYTHON is not set"
    else check wheel-musl other_wheel "*musllinux*$(uname -m).whl" "$HMF_MUSL_PYTHON"; fi
fi

# What npm packs, installed in an empty folder: the program of the README.
npm_install() {
    rm -rf "$work/npm"
    mkdir -p "$work/npm"
    (cd "$root/bindings/javascript" && npm pack --silent --pack-destination "$work/npm") && cd "$work/npm" && npm init -y > /dev/null &&
        npm install --silent --no-audit --no-fund ./foliations-*.tgz && awk '/^```js$/ { on = 1; next } /^```/ { if (on) exit } on' "$root/bindings/javascript/README.md" > example.mjs &&
        node example.mjs | tee printed && grep -q 'genus 1' printed
}
if command -v npm > /dev/null && echo 'int main() { return 0; }' | clang++ --target=wasm32-wasi -mexec-model=reactor -fno-exceptions -x c++ - -o "$work/probe.wasm" > /dev/null 2>&1; then
    check npm-install npm_install
else skip npm-install "no npm, or no clang for WebAssembly"; fi

debian_package() {
    rm -rf "$work/debian"
    mkdir -p "$work/debian/hmf"
    (cd "$root" && git ls-files -z | tar c --null -T -) | tar x -C "$work/debian/hmf"
    cp -r "$packaging/debian" "$work/debian/hmf/debian"
    cd "$work/debian/hmf" && dpkg-buildpackage -us -uc -b && dpkg -c ../hmf_*.deb | grep -q man1/hmf.1 &&
        dpkg -c ../libhmf-dev_*.deb | grep -q 'include/hmf/hmf.h' && dpkg-deb -x ../hmf_*.deb ../system && ../system/usr/bin/hmf --version
}
if command -v dpkg-buildpackage > /dev/null && dpkg -s debhelper > /dev/null 2>&1; then check debian debian_package
else skip debian "no debhelper"; fi

if { "$work/venv/bin/pip" install -q conan && "$work/venv/bin/conan" --version; } > "$work/conan-install.log" 2>&1; then
    export CONAN_HOME=$work/conan
    "$work/venv/bin/conan" profile detect --force > /dev/null 2>&1
    # With the program that uses it built here, not in the sources.
    check conan "$work/venv/bin/conan" create -c "tools.cmake.cmake_layout:test_folder=$work/conan-test" "$packaging/conan"
else skip conan "it cannot be installed"; fi
if command -v vcpkg > /dev/null; then check vcpkg vcpkg install hmf --overlay-ports="$packaging/vcpkg/ports" --x-install-root="$work/vcpkg"
else skip vcpkg "no vcpkg"; fi
if command -v conda-build > /dev/null; then check conda conda build "$packaging/conda"; else skip conda "no conda-build"; fi
exit $failed
