#!/bin/bash
# The programs of bench can be read: nothing is measured.
#
#     tests/checks/check_bench.sh
cd "$(dirname "$0")/../.." || exit 1
failed=0
for script in bench/*.sh; do
    if bash -n "$script"; then echo "ok $script"; else echo "not ok $script" && failed=1; fi
done
for script in bench/*.py bench/report/*.py; do
    if python3 -c 'import ast, sys; ast.parse(open(sys.argv[1]).read(), sys.argv[1])' "$script"; then
        echo "ok $script"
    else
        echo "not ok $script" && failed=1
    fi
done
exit $failed
