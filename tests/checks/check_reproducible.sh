#!/bin/bash
# check_reproducible.sh WORK_FOLDER
#
# Two builds, in folders with names of different length, with another number of jobs, locale, time zone and umask, give
# the same bytes: static and shared library, the pool beside it, with debug information.  Only that has names of folders;
# -ffile-prefix-map takes them out, as build tools of distributions do.
# Environment: HMF_REPRODUCIBLE_FLAGS  of the compiler (default: quick ones; a release has "-O3 -DNDEBUG -g")
set -u
root=$(cd "$(dirname "$0")/../.." && pwd)
rm -rf "$1"
mkdir -p "$1"
work=$(cd "$1" && pwd)
flags=${HMF_REPRODUCIBLE_FLAGS:--O0 -g}
failed=0

# Of one moment: the first build takes minutes, and somebody may go on working.
(cd "$root" && tar c CMakeLists.txt include src) > "$work/sources.tar" || exit 1

build() { # folder, jobs
    mkdir -p "$work/$1" && tar x -C "$work/$1" -f "$work/sources.tar" || return 1
    local kind
    for kind in OFF ON; do
        cmake -S "$work/$1" -B "$work/$1/out-$kind" -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS_RELEASE="$flags -ffile-prefix-map=$work/$1=." \
            -DBUILD_SHARED_LIBS=$kind -DHMF_BUILD_CLI=OFF -DHMF_INSTALL=OFF &&
            cmake --build "$work/$1/out-$kind" -j "$2" || return 1
    done > "$work/build.log" 2>&1
}

if ! (umask 022 && LC_ALL=C TZ=UTC build a "${JOBS:-$(nproc)}") ||
        ! (umask 077 && LC_ALL=C.UTF-8 TZ=Asia/Tokyo build another/place-with-a-longer-name 1); then
    echo "not ok reproducible: the build failed"
    tail -20 "$work/build.log"
    exit 1
fi
for file in out-OFF/libhmf.a out-OFF/libhmf_pool.a out-ON/libhmf.so out-ON/libhmf_pool.so; do
    one=$work/a/$file two=$work/another/place-with-a-longer-name/$file
    if [ ! -s "$one" ]; then
        echo "not ok reproducible $file: is not there"
        failed=1
    elif ! cmp "$one" "$two"; then
        echo "not ok reproducible $file"
        failed=1
    elif grep -qF -- "$work" "$one"; then
        echo "not ok reproducible $file: names the folder of the build"
        failed=1
    else
        echo "ok reproducible $file: $(wc -c < "$one") bytes, sha256 $(sha256sum < "$one" | cut -c 1-16)"
    fi
done

# What the comparison would see: without the map the folder shows.
for folder in a another/place-with-a-longer-name; do
    # shellcheck disable=SC2086
    c++ -std=c++17 $flags -g -I"$work/$folder/include" -c "$work/$folder/src/core/base/memory.cpp" -o "$work/$folder/plain.o" || failed=1
done
if cmp -s "$work/a/plain.o" "$work/another/place-with-a-longer-name/plain.o"; then
    echo "not ok reproducible seen: the comparison cannot fail"
    failed=1
else
    echo "ok reproducible seen"
fi
exit $failed
