#!/bin/bash
# Builds the tool and makes a picture of the built-in sample.
# Installs what is missing for it (Debian), or says the command (Fedora, Arch, Alpine, macOS).
#
#     ./demo.sh [FOLDER]      default hmf-demo
set -eu
folder=${1:-hmf-demo}
case $folder in /*) ;; *) folder=$PWD/$folder ;; esac
cd "$(dirname "$0")"

missing=()
need() { # package, command that succeeds when it is there
    package=$1
    shift
    "$@" > /dev/null 2>&1 || missing+=("$package")
}
need build-essential sh -c 'command -v c++ && command -v make'
need cmake command -v cmake
. bindings/packaging/system_packages.sh
[ ${#missing[@]} -eq 0 ] || install_packages "${missing[@]}"

cmake -B build -DCMAKE_BUILD_TYPE=Release
cmake --build build -j "$(getconf _NPROCESSORS_ONLN)"
build/hmf demo "$folder"
