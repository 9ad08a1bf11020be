#!/bin/sh
# check_install.sh WORK_FOLDER [STATIC]
# check_install.sh WORK_FOLDER STATIC --quick   only the static library, without the builds that take long
#
# Installs the library, moves the tree, and uses it from there in each way:
# find_package, pkg-config, cc alone, and add_subdirectory; static and shared.
# The examples of the README and of bindings/ are built and run as well.
# STATIC: folder where the static library has been built (default: it is built in WORK_FOLDER).
set -u
root=$(cd "$(dirname "$0")/../.." && pwd)
mkdir -p "$1"
work=$(cd "$1" && pwd)
failed=0
rm -rf "${work:?}"/*
built_static=${2:-} mode=${3:-}

check() { # name, then the command
    name=$1
    shift
    if "$@" > "$work/log" 2>&1; then
        echo "ok install $name"
    else
        echo "not ok install $name"
        tail -25 "$work/log"
        failed=1
    fi
}

install_and_move() { # ON or OFF, target folder
    built=$built_static
    if [ -z "$built" ] || [ "$1" = ON ]; then
        built=$work/build-$1
        cmake -S "$root" -B "$built" -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS_RELEASE="-O1 -DNDEBUG" -DBUILD_SHARED_LIBS="$1" -DHMF_BUILD_CLI=OFF &&
            cmake --build "$built" -j "${JOBS:-2}" || return 1
    fi
    cmake --install "$built" --prefix "$work/first" &&
        ! grep -rqF -e "$work" -e "$root" "$work/first/lib"*/cmake "$work/first/lib"*/pkgconfig "$work/first/include" &&
        mv "$work/first" "$2"
}

use_find_package() { # prefix, build folder
    cmake -S "$root/tests/checks/consumers/find_package" -B "$2" -DCMAKE_PREFIX_PATH="$1" -DCMAKE_BUILD_TYPE=Release &&
        cmake --build "$2" && "$2/consumer" && "$2/core"
}

use_add_subdirectory() { # ON or OFF, build folder
    cmake -S "$root/tests/checks/consumers/add_subdirectory" -B "$2" -DHMF_SOURCE="$root" -DBUILD_SHARED_LIBS="$1" -DCMAKE_BUILD_TYPE=None \
        -DCMAKE_UNITY_BUILD=ON &&
        cmake --build "$2" -j "${JOBS:-2}" && "$2/consumer"
}

build_with_pkg_config() { # prefix, standard, source, program, warnings
    pc=$(dirname "$(find "$1" -name hmf.pc)")
    flags=$(PKG_CONFIG_PATH=$pc pkg-config --cflags --libs hmf) || return 1
    # The flags come last: a static library follows the object that needs it.
    cc "-std=$2" -Wall -Wextra -Werror ${5:-} "$3" -o "$4" $flags
}

use_pkg_config() { # prefix, source, program
    build_with_pkg_config "$1" c99 "$2" "$3" && LD_LIBRARY_PATH=$(dirname "$pc") "$3"
}

use_cc() { # prefix, program
    lib=$(dirname "$(dirname "$(find "$1" -name hmf.pc)")")
    cc "$root/tests/checks/consumers/main.c" -I"$1/include" -L"$lib" -lhmf -lstdc++ -lm -o "$2" && LD_LIBRARY_PATH=$lib "$2"
}

use_hpp() { # prefix, build folder
    cmake -S "$root/tests/checks/consumers/cpp" -B "$2" -DCMAKE_PREFIX_PATH="$1" -DHMF_EXAMPLE="$root/bindings/cpp/torus.cpp" &&
        cmake --build "$2" && "$2/consumer" && "$2/torus" | tee "$2/torus.txt"
}

# The C example on the same torus as the C++ example: the same values.
use_c_example() { # prefix, folder, output of the C++ example
    mkdir -p "$2" && cat > "$2/torus.obj" << 'END' &&
v 3 -3 0
v -3 3 0
v -3 -3 1
v 3 3 1
v -1 -2 3
v 1 2 3
v 0 0 15
f 1 2 4
f 1//1 4//1 3//1
f 2/1 3/1 5/1
f 2/1/1 5/1/1 4/1/1
f 3 4 6
f 3 6 5
f 4 5 7
f 4 7 6
f 5 6 1
f 5 1 7
f 6 7 2
f 6 2 1
f 7 1 3
f 7 3 2
END
        build_with_pkg_config "$1" c89 "$root/bindings/c/solve_obj.c" "$2/solve_obj" -Wpedantic &&
        "$2/solve_obj" "$2/torus.obj" "$2/values.csv" && cut -d, -f3 "$2/values.csv" > "$2/values.txt" &&
        tail -n +2 "$3" | cmp - "$2/values.txt" && [ "$(wc -l < "$2/values.txt")" -eq 21 ] &&
        ! "$2/solve_obj" "$2/no.obj" "$2/no.csv" && refuses_others "$2"
}

# Faces that the C example does not read.
refuses_others() { # folder
    for face in 'f 1 2 3 4' 'f 1/1 2/1 3/1 4/1' 'f -1 -2 -3' 'f 1 2'; do
        printf 'v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n%s\n' "$face" > "$1/other.obj"
        "$1/solve_obj" "$1/other.obj" "$1/other.csv"
        [ $? -eq 3 ] || return 1
    done
}

version_matches() { # prefix
    pc=$(dirname "$(find "$1" -name hmf.pc)")
    header=$(sed -n 's/^#define HMF_VERSION_[MP][A-Z]* //p' "$1/include/hmf/hmf.h" | paste -sd.)
    [ "$(PKG_CONFIG_PATH=$pc pkg-config --modversion hmf)" = "$header" ]
}

kinds="OFF ON"
[ "$mode" != --quick ] || kinds=OFF
for shared in $kinds; do
    kind=static
    [ $shared = ON ] && kind=shared
    prefix=$work/moved-$kind
    check "$kind-installs-relocatable" install_and_move $shared "$prefix"
    check "$kind-version" version_matches "$prefix"
    check "$kind-find_package" use_find_package "$prefix" "$work/find_package-$kind"
    [ "$mode" = --quick ] || check "$kind-add_subdirectory" use_add_subdirectory $shared "$work/add_subdirectory-$kind"
    check "$kind-pkg-config" use_pkg_config "$prefix" "$root/tests/checks/consumers/main.c" "$work/pkg-config-$kind"
    check "$kind-cc" use_cc "$prefix" "$work/cc-$kind"
    check "$kind-hpp" use_hpp "$prefix" "$work/hpp-$kind"
done

# The first C block of the README.
awk '/^```c$/ { on = 1; next } /^```/ { if (on) exit } on' "$root/README.md" > "$work/readme.c"
check "readme-has-example" grep -q hmf_solve "$work/readme.c"
check "readme-example" use_pkg_config "$work/moved-static" "$work/readme.c" "$work/readme"
check "c-example" use_c_example "$work/moved-static" "$work/c-example" "$work/hpp-static/torus.txt"
if [ "$mode" != --quick ]; then
    "$root/tests/checks/check_symbols.sh" "${built_static:-$work/build-OFF}/libhmf.a" "$work/build-ON/libhmf.so" || failed=1
fi
exit $failed
