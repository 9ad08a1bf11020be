# To be sourced: install_packages NAME...
#
# Takes the names of Debian.  With apt-get it installs the packages; elsewhere it prints the command of the system,
# with its own names, and fails.

# The packages of a system for one of Debian.
package_of() { # dnf, pacman, apk or brew; name
    case $1-$2 in
    dnf-build-essential) echo gcc-c++ make ;;
    pacman-build-essential) echo base-devel ;;
    apk-build-essential) echo build-base ;;
    brew-build-essential) ;; # xcode-select --install
    dnf-clang-format) echo clang-tools-extra ;;
    pacman-clang-format) echo clang ;;
    apk-clang-format) echo clang-extra-tools ;;
    brew-clang) echo llvm ;;
    pacman-ninja-build | brew-ninja-build) echo ninja ;;
    dnf-pkg-config) echo pkgconf-pkg-config ;;
    *-pkg-config) echo pkgconf ;;
    pacman-python3 | pacman-python3-venv) echo python ;;
    *-python3-venv) echo python3 ;;
    dnf-libgtest-dev) echo gtest-devel ;;
    apk-libgtest-dev) echo gtest-dev ;;
    brew-libgtest-dev) echo googletest ;;
    *-libgtest-dev) echo gtest ;;
    dnf-libeigen3-dev) echo eigen3-devel ;;
    apk-libeigen3-dev) echo eigen-dev ;;
    *-libeigen3-dev) echo eigen ;;
    *) echo "$2" ;;
    esac
}

install_packages() {
    local manager name names=() sudo=
    if command -v apt-get > /dev/null; then
        [ "$(id -u)" -eq 0 ] || sudo=sudo
        echo "Installing: $*"
        $sudo apt-get update -q && DEBIAN_FRONTEND=noninteractive $sudo apt-get install -q -y --no-install-recommends "$@"
        return
    fi
    for manager in dnf pacman apk brew; do
        command -v $manager > /dev/null || continue
        for name in "$@"; do
            # shellcheck disable=SC2207
            names+=($(package_of $manager "$name"))
        done
        case $manager in
        dnf) echo "Missing.  Please run: sudo dnf install ${names[*]}" ;;
        pacman) echo "Missing.  Please run: sudo pacman -S --needed ${names[*]}" ;;
        apk) echo "Missing.  Please run: sudo apk add ${names[*]}" ;;
        brew) echo "Missing.  Please run: xcode-select --install; brew install ${names[*]}" ;;
        esac
        return 1
    done
    echo "Missing, with the names of Debian: $*.  Please install them."
    return 1
}
