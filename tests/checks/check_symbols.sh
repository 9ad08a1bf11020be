#!/bin/sh
# check_symbols.sh STATIC_LIBRARY [SHARED_LIBRARY]   default: a shared one linked of the objects of the static one
#
# The shared library exports exactly the functions of hmf.h and applications.h; the static one
# has no other C symbol; it needs only the C and C++ runtime, of libm no function whose
# last bit each system has of its own, and has no writable data, because there is no global state.
set -u
root=$(cd "$(dirname "$0")/../.." && pwd)
static=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0
shared=${2:-$work/libhmf.so}
if [ $# -lt 2 ] && ! c++ -shared -Wl,--whole-archive "$static" -Wl,--no-whole-archive -Wl,--version-script="$root/src/hmf.map" \
    -Wl,-soname,"libhmf.so.$(sed -n 's/^#define HMF_VERSION_MAJOR //p' "$root/include/hmf/hmf.h")" -o "$shared"; then
    echo "not ok symbols libraries-linkable"
    exit 1
fi

report() { # name, file that is empty when all is well
    if [ -s "$2" ]; then
        echo "not ok symbols $1"
        sed 's/^/    /' "$2"
        failed=1
    else
        echo "ok symbols $1"
    fi
}

# Declarations span lines, so comments and newlines go first.
cat "$root/include/hmf/hmf.h" "$root/include/hmf/applications.h" | tr '\n' ' ' | sed 's:/\*[^*]*\*\+\([^/*][^*]*\*\+\)*/: :g' | tr ';{}' '\n\n\n' |
    grep HMF_API | grep -o 'hmf_[a-z0-9_]* *(' | tr -d ' (' | sort -u > "$work/declared"
[ -s "$work/declared" ] || echo "no declaration found in the headers" > "$work/empty"
: >> "$work/empty"
report "header-has-functions" "$work/empty"

if ! nm -D --defined-only "$shared" > "$work/nm" || ! nm -g --defined-only "$static" > "$work/nm-static" 2> /dev/null; then
    echo "not ok symbols libraries-readable"
    exit 1
fi

# The version node itself is an absolute symbol.
awk '$2 != "A" { sub(/@.*/, "", $3); print $3 }' "$work/nm" | sort -u > "$work/exported"
comm -13 "$work/declared" "$work/exported" | sed 's/$/ is exported but in no header/' > "$work/extra"
report "nothing-but-the-headers-exported" "$work/extra"
comm -23 "$work/declared" "$work/exported" | sed 's/$/ is in a header but not exported/' > "$work/missing"
report "all-of-the-headers-exported" "$work/missing"

# Weak symbols are inline functions of the C++ library, shared by all users.
awk 'NF == 3 && $2 !~ /[WVu]/ && $3 !~ /^hmf_/ && $3 !~ /^_ZN?K?[TVSI]*[0-9]*.*3hmf|^_Z.*hmf_/ { print $3 " in the static library could clash" }' \
    "$work/nm-static" > "$work/clash"
report "static-library-names" "$work/clash"

nm -D --undefined-only -C "$shared" | grep hmf | sed 's/^ *U //; s/$/ is used but defined nowhere/' > "$work/undefined"
report "nothing-undefined" "$work/undefined"

objdump -p "$shared" | awk '$1 == "NEEDED" { print $2 }' |
    grep -vE '^(libc|libm|libstdc\+\+|libc\+\+|libgcc_s|libasan|libubsan|ld-linux[^.]*)\.so' |
    sed 's/$/ is needed/' > "$work/needed"
report "no-dependency" "$work/needed"

nm -u "$static" | awk '{ print $NF }' | sort -u |
    grep -xE '(pow|exp|exp2|expm1|log|log2|log10|log1p|a?(sin|cos|tan)h?|atan2|sincos|cbrt|hypot|erfc?|[lt]gamma)[fl]?' |
    sed 's/$/ is called: not the same bits everywhere/' > "$work/libm"
report "same-bits-of-libm" "$work/libm"

objdump -p "$shared" | awk '$1 == "SONAME" { print $2 }' > "$work/soname"
major=$(sed -n 's/^#define HMF_VERSION_MAJOR //p' "$root/include/hmf/hmf.h")
grep -qx "libhmf.so.$major" "$work/soname" && : > "$work/wrong" || echo "SONAME is '$(cat "$work/soname")'" > "$work/wrong"
report "soname" "$work/wrong"

size -A "$static" | awk '$1 ~ /^\.(data|bss)(\.|$)/ && $1 !~ /^\.data\.rel\.ro/ && $2 > 0 { print $1, $2, "bytes of writable data" }' > "$work/state"
report "no-global-state" "$work/state"
exit $failed
