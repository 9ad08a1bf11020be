#!/bin/bash
# test.sh             the tests of the Rust crates, a line "ok", "not ok" or "skip" for each group
# test.sh same-bits   the lines of bindings/same_bits/README.md
#
# Builds in $HMF_BINDING_WORK (default build/bindings/rust of the repository).
set -u
cd "$(dirname "$0")"
root=$(cd ../.. && pwd)
work=${HMF_BINDING_WORK:-$root/build/bindings/rust}
mkdir -p "$work"
work=$(cd "$work" && pwd)
export CARGO_TARGET_DIR=$work/target CARGO_TERM_COLOR=never CARGO_BUILD_JOBS=${JOBS:-$(nproc)}
failed=0

same_bits() { cargo run --quiet --release --locked -p foliations --example same_bits; }

why_not() { # prints why the tests cannot run
    local minor
    command -v cargo > /dev/null || { echo "cargo is not installed; see https://rustup.rs"; return; }
    minor=$(cargo --version | sed -n 's/^cargo 1\.\([0-9]*\)\..*/\1/p')
    [ "${minor:-0}" -ge 78 ] || { echo "$(cargo --version) is too old, 1.78 is needed; see https://rustup.rs"; return; }
    cargo fetch --locked --quiet > "$work/fetch.log" 2>&1 || cargo fetch --locked --quiet --offline > "$work/fetch.log" 2>&1 ||
        echo "crates cannot be fetched: $(tail -1 "$work/fetch.log")"
}

check() { # group, then the command
    local name=$1
    shift
    if "$@" > "$work/$name.log" 2>&1; then
        if grep -q '^skipped: ' "$work/$name.log"; then
            echo "skip rust-$name ($(grep -m1 '^skipped: ' "$work/$name.log"))"
        else
            echo "ok rust-$name"
        fi
    else
        echo "not ok rust-$name"
        tail -40 "$work/$name.log"
        failed=1
    fi
}

has() { # component, command
    cargo "$1" --version > /dev/null 2>&1 || { echo "skip rust-$1 (skipped: rustup component add $2)"; return 1; }
}

# All in one profile, so that the library is compiled once.
documentation() { RUSTDOCFLAGS="-D warnings" cargo doc --quiet --release --locked --no-deps; }

# The package of foliations-sys holds the sources of the library; a program builds from the two packages alone, and runs.
packages() {
    local files crates=$work/crates
    cargo package --list --allow-dirty --locked -p foliations > "$work/foliations.list" &&
        cargo package --list --allow-dirty --locked -p foliations-sys > "$work/foliations-sys.list" || return 1
    for files in "$root"/src/*/*/*.[ch]pp "$root"/include/hmf/hmf.h "$root"/include/hmf/applications.h; do
        grep -qxF "core/${files#"$root"/}" "$work/foliations-sys.list" || { echo "the package lacks $files"; return 1; }
    done
    grep -qx LICENSE "$work/foliations-sys.list" && grep -qx LICENSE "$work/foliations.list" && grep -qx README.md "$work/foliations.list" || return 1
    # Both at once since 1.90; the second needs the first in a registry before.
    if ! cargo package --help | grep -q -- --workspace || [ "$(cargo --version | sed 's/^cargo 1\.\([0-9]*\).*/\1/')" -lt 90 ]; then
        cargo package --allow-dirty --locked -p foliations-sys
        return
    fi
    cargo package --workspace --no-verify --allow-dirty --locked || return 1
    rm -rf "$crates"
    mkdir -p "$crates/program/src"
    for files in "$CARGO_TARGET_DIR"/package/*.crate; do tar xzf "$files" -C "$crates" || return 1; done
    cp "$crates"/foliations-[0-9]*/examples/plate.rs "$crates/program/src/main.rs"
    cat > "$crates/program/Cargo.toml" <<END
[package]
name = "program"
version = "0.1.0"
edition = "2021"
[dependencies]
foliations = { path = "$(echo "$crates"/foliations-[0-9]*)" }
[patch.crates-io]
foliations-sys = { path = "$(echo "$crates"/foliations-sys-*)" }
[workspace]
END
    cp Cargo.lock "$crates/program"
    # Optimized it would take twice as long to build.
    (cd "$crates/program" && CARGO_TARGET_DIR=$crates/target CXXFLAGS="${CXXFLAGS:-} -O0" cargo run --quiet --offline) | grep '^energy '
}

# The first sh block of the README, beside what a clean clone would hold.
readme() {
    local folder=$work/readme
    rm -rf "$folder"
    mkdir -p "$folder/hmf"
    if git -C "$root" rev-parse > /dev/null 2>&1; then
        (cd "$root" && git ls-files -z --cached --others --exclude-standard |
            while IFS= read -r -d '' file; do [ -e "$file" ] && printf '%s\0' "$file"; done |
            tar -c --null -T -) | tar -x -C "$folder/hmf"
    else
        (cd "$root" && tar -c --exclude=./build .) | tar -x -C "$folder/hmf"
    fi
    awk '/^```sh$/ { on = 1; next } /^```/ { if (on) exit } on' foliations/README.md > "$folder/steps.sh"
    # The foliation of genus 2 has zeros of orders that add up to 4; where they
    # lie depends on the loops.
    grep -q 'cargo run' "$folder/steps.sh" && (cd "$folder" && CXXFLAGS="${CXXFLAGS:-} -O0" sh -e steps.sh) > "$folder/printed.txt" &&
        cat "$folder/printed.txt" && head -1 "$folder/printed.txt" | grep -qE '^energy [0-9]+\.[0-9]{6}$' &&
        [ "$(awk '{ sum += $4 } END { print sum }' "$folder/printed.txt")" -eq 4 ]
}

reason=$(why_not)
if [ -n "$reason" ]; then
    if [ "${1:-}" = same-bits ]; then echo "skip $reason"; else echo "skip rust (skipped: $reason)"; fi
    exit 0
fi
if [ "${1:-}" = same-bits ]; then
    same_bits
    exit
fi

has fmt rustfmt && check fmt cargo fmt --check
# What clippy looks at is a build of its own; it needs no library.
has clippy clippy && check clippy env DOCS_RS=1 cargo clippy --quiet --release --locked --all-targets -- -D warnings
check bindings-match-header cargo test --quiet --release --locked -p foliations-sys -- --nocapture
check tests cargo test --quiet --locked --release -p foliations --lib --tests --examples -- --nocapture
check doc-tests cargo test --quiet --locked --release -p foliations --doc
check documentation documentation
check packages packages
check readme readme
check same-bits-builds same_bits
exit $failed
