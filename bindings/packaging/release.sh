#!/bin/bash
# release.sh FOLDER   checks the tree, then makes every package of this version into FOLDER; publishes nothing.
#
# Before: set the version in include/hmf/hmf.h and where check_versions.py says, date the section in CHANGELOG.md.
# After: git tag v$(bindings/packaging/check_versions.py --print), then upload what is in FOLDER.
set -eu
cd "$(dirname "$0")/../.."
[ $# -eq 1 ] || { sed -n 2,5p bindings/packaging/release.sh; exit 2; }
mkdir -p "$1"
out=$(cd "$1" && pwd)
version=$(python3 bindings/packaging/check_versions.py --print)
fail() { echo "release: $*" >&2; exit 1; }

[ -z "$(git status --porcelain)" ] || fail "there are changes that are not committed"
python3 bindings/packaging/check_versions.py
! git rev-parse -q --verify "refs/tags/v$version" > /dev/null || fail "v$version is tagged already"
! grep -q "^## $version (not released)" CHANGELOG.md || fail "CHANGELOG.md says that $version is not released"
[ -n "${HMF_RELEASE_UNTESTED:-}" ] || ./test.sh full
tests/checks/check_abi.sh build/abi --exact || fail "the interface is not as recorded in tests/checks/abi"

git archive --prefix="hmf-$version/" -o "$out/hmf-$version.tar.gz" HEAD
python3 bindings/packaging/sbom.py "$out/hmf-$version.cdx.json"
python3 -m venv "$out/.venv"
"$out/.venv/bin/pip" install -q ziglang cffi build scikit-build-core
"$out/.venv/bin/python" bindings/packaging/build_wheels.py --out "$out"
(cd bindings/rust && cargo package --locked --workspace --no-verify && cp target/package/*.crate "$out")
(cd bindings/javascript && npm pack --pack-destination "$out")
rm -r "$out/.venv"
(cd "$out" && sha256sum ./*.* > SHA256SUMS)
echo "version $version is in $out"
