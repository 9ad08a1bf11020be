#!/bin/bash
# check_abi.sh WORK_FOLDER            compares the interface with the recorded one
# check_abi.sh WORK_FOLDER --record   records the interface as it is now (docs/abi.md says when)
# check_abi.sh WORK_FOLDER --exact    for a release: the record is the interface, with nothing beside
# check_abi.sh WORK_FOLDER --quick    only the comparison, without the changed headers that show what it sees
#
# The interface is what the headers declare: a library of empty functions is made of them and described by abidw;
# the compiler holds the real functions against the same headers, and check_symbols.sh their names.  Allowed
# without a new SONAME: new functions, new constants, new fields at the end of structures with struct_size.
# Then headers with one change each show that the comparison sees what breaks programs, and nothing else.
set -u
root=$(cd "$(dirname "$0")/../.." && pwd)
mkdir -p "$1"
work=$(cd "$1" && pwd)
mode=${2:-}
# The record is of one processor; sizes elsewhere follow from the same headers.
if [ "$(uname -sm)" != "Linux x86_64" ]; then
    echo "skip abi (skipped: the record is of Linux on x86_64)"
    exit 0
fi
major=$(sed -n 's/^#define HMF_VERSION_MAJOR //p' "$root/include/hmf/hmf.h")
soname=libhmf.so.$major
record=$root/tests/checks/abi/$soname
failed=0

for tool in cc abidw abidiff; do
    if ! command -v $tool > /dev/null; then
        echo "skip abi (skipped: no $tool; on Debian: apt-get install abigail-tools)"
        exit 0
    fi
done

without_comments() { sed 's:/\*.*\*/::; /\/\*/,/\*\//d' "$@"; }

# The interface that the headers in a folder declare: NAME.abi and NAME.constants.
describe() { # folder with hmf/, name
    local headers="$1/hmf/hmf.h $1/hmf/applications.h $1/hmf/pool.h" to=$2
    # shellcheck disable=SC2086
    {
        echo '#include <hmf/hmf.h>'
        echo '#include <hmf/applications.h>'
        echo '#include <hmf/pool.h>'
        cat $headers | tr '\n' ' ' | sed 's:/\*[^*]*\*\+\([^/*][^*]*\*\+\)*/: :g' | tr ';{}' '\n\n\n' |
            sed -n 's/.*HMF_API \(.*(.*)\) *$/\1 { __builtin_trap(); }/p'
    } > "$to.c"
    cc -std=c99 -g -O0 -fPIC -shared -Wl,-soname,"$soname" -I"$1" "$to.c" -o "$to.so" 2> "$to.log" || return 1
    abidw --no-corpus-path --no-comp-dir-path --no-show-locs "$to.so" --out-file "$to.abi" 2>> "$to.log" || return 1
    # shellcheck disable=SC2086
    {
        echo '#include <hmf/applications.h>' | cc -std=c99 -I"$1" -dM -E - | sed -n 's/^#define \(HMF_[A-Z0-9_]* .*\)/\1/p' |
            grep -vE '^HMF_(VERSION_[A-Z]*|API|[A-Z]*_H) '
        sed -n 's/^ *\(HMF_[A-Z0-9_]*\) = \(-*[0-9][0-9]*\).*/\1 \2/p' $headers
    } | sort > "$to.constants"
    [ -s "$to.constants" ]
}

# Structures that begin with struct_size may grow at the end.
growing() { # folder
    without_comments "$1"/hmf/hmf.h "$1"/hmf/applications.h |
        awk '/^typedef struct hmf_[a-z_]* \{/ { name = $3; next } name { if (/uint32_t struct_size;/) print name; name = "" }'
}

# What changed of a recorded interface that programs may rely on, as text; empty when nothing did.
compare() { # record, interface
    abidiff --harmless --no-added-syms --suppressions "$work/growing.suppr" "$1.abi" "$2.abi" > "$work/abidiff" 2>&1 ||
        cat "$work/abidiff"
    comm -23 "$1.constants" "$2.constants" | sed 's/$/ (recorded constant) is gone or another now/'
}

if ! describe "$root/include" "$work/now"; then
    echo "not ok abi: the headers give no library"
    cat "$work/now.log"
    exit 1
fi
if [ "$mode" = --record ]; then
    mkdir -p "$root/tests/checks/abi"
    sed "s|$work/||" "$work/now.abi" > "$record.abi" && cp "$work/now.constants" "$record.constants"
    echo "recorded: $record.abi"
    exit
fi
if [ ! -s "$record.abi" ]; then
    echo "not ok abi: there is no record of $soname; see docs/abi.md"
    exit 1
fi
growing "$root/include" > "$work/growing"
printf '[suppress_type]\n  type_kind = struct\n  name_regexp = ^(%s)$\n  has_data_member_inserted_at = end\n' \
    "$(paste -sd'|' "$work/growing")" > "$work/growing.suppr"

compare "$record" "$work/now" > "$work/changes"
if [ -s "$work/changes" ]; then
    echo "not ok abi $soname: programs that were compiled before would break"
    cat "$work/changes"
    echo "    If that is meant, and the version is not released: tests/checks/check_abi.sh FOLDER --record; see docs/abi.md"
    failed=1
else
    functions=$(grep -c '<elf-symbol ' "$record.abi")
    echo "ok abi $soname: $functions functions, $(wc -l < "$record.constants") constants as recorded; $(wc -l < "$work/growing") structures may grow"
fi
if [ "$mode" = --exact ]; then
    abidiff --harmless "$record.abi" "$work/now.abi" > "$work/added" && : > "$work/added"
    comm -3 "$record.constants" "$work/now.constants" >> "$work/added"
    if [ -s "$work/added" ]; then
        echo "not ok abi exact: record the interface before a release"
        cat "$work/added"
        failed=1
    else
        echo "ok abi exact"
    fi
fi
[ "$mode" != --quick ] || exit $failed

# --- The comparison itself ---------------------------------------------------

changed() { # name, "breaks" or "allowed", file, sed expression
    local folder=$work/$1
    rm -rf "$folder" && mkdir -p "$folder" && cp -r "$root/include/hmf" "$folder"
    sed -i "$4" "$folder/hmf/$3"
    if cmp -s "$root/include/hmf/$3" "$folder/hmf/$3"; then
        echo "not ok abi $1: the change is of another header"
        failed=1
    elif ! describe "$folder" "$folder/interface"; then
        echo "not ok abi $1: does not compile"
        failed=1
    else
        compare "$work/now" "$folder/interface" > "$folder/changes"
        if [ "$2" = breaks ] && [ ! -s "$folder/changes" ] || [ "$2" = allowed ] && [ -s "$folder/changes" ]; then
            echo "not ok abi $1: should be $2"
            cat "$folder/changes"
            failed=1
        else
            echo "ok abi $1 $2"
        fi
    fi
}

changed function-removed breaks hmf.h '/^HMF_API size_t hmf_foliation_level/d'
changed parameter-type breaks applications.h 's/^HMF_API hmf_status hmf_quads(const hmf_foliation \*foliation,/HMF_API hmf_status hmf_quads(const hmf_hierarchy *foliation,/'
changed parameter-narrower breaks hmf.h 's/^HMF_API size_t hmf_foliation_level/HMF_API uint32_t hmf_foliation_level/'
changed field-in-the-middle breaks hmf.h 's/^    double time_limit;/    double another;\n&/'
changed fields-exchanged breaks hmf.h 's/^    uint64_t sweep_count; /    uint64_t SOLVES; /; s/^    uint64_t linear_solve_count;/    uint64_t sweep_count;/; s/SOLVES/linear_solve_count/'
changed field-type breaks hmf.h 's/^    uint64_t stop_level;/    int64_t stop_level;/'
changed field-removed breaks applications.h '/^    double used_area; /d'
changed element-grows breaks hmf.h 's/^} hmf_level_info;/    double another;\n&/'
changed constant-value breaks hmf.h 's/HMF_ERROR_MESH_GENUS = 311/HMF_ERROR_MESH_GENUS = 315/'
changed constant-removed breaks hmf.h '/^ *HMF_COLLAPSE_ENDPOINT/d'
changed function-added allowed hmf.h 's/^HMF_API size_t hmf_foliation_level/HMF_API size_t hmf_another(const hmf_hierarchy *hierarchy);\n&/'
changed options-grow allowed hmf.h 's/^} hmf_solve_options;/    double another;\n&/'
changed result-grows allowed applications.h 's/^} hmf_quad_mesh;/    double another;\n&/'
changed constant-added allowed hmf.h 's/^ *HMF_ERROR_INTERNAL = 900/    HMF_ERROR_ANOTHER = 901,\n&/'
exit $failed
