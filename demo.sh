#!/bin/bash
# Builds the tool and makes a picture of the built-in sample.
# Installs what is missing for it (Debian).
#
#     ./demo.sh [FOLDER]      default hmf-demo
set -eu
folder=$(realpath -m "${1:-hmf-demo}")
cd "$(dirname "$0")"

missing=()
need() { # package, command that succeeds when it is there
    package=$1
    shift
    "$@" > /dev/null 2>&1 || missing+=("$package")
}
need build-essential sh -c 'command -v c++ && command -v make'
need cmake command -v cmake
if [ ${#missing[@]} -gt 0 ]; then
    if ! command -v apt-get > /dev/null; then
        echo "Missing, with the names of Debian: ${missing[*]}.  Please install them."
        exit 1
    fi
    sudo=
    [ "$(id -u)" -eq 0 ] || sudo=sudo
    echo "Installing: ${missing[*]}"
    $sudo apt-get update -q
    DEBIAN_FRONTEND=noninteractive $sudo apt-get install -q -y --no-install-recommends "${missing[@]}"
fi

cmake -B build -DCMAKE_BUILD_TYPE=Release
cmake --build build -j "$(nproc)"
build/hmf demo "$folder"
