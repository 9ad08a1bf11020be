#!/bin/bash
# The programs of bench can be read: nothing is measured.
#
#     tests/checks/check_bench.sh
cd "$(dirname "$0")/../.." || exit 1
failed=0
for script in bench/*.sh; do
    if bash -n "$script"; then echo "ok $script"; else echo "not ok $script" && failed=1; fi
done
python3 - bench/*.py bench/report/*.py <<'END' || failed=1
import ast, sys
failed = 0
for script in sys.argv[1:]:
    try:
        ast.parse(open(script).read(), script)
        print("ok", script)
    except SyntaxError as error:
        print("not ok", script, error)
        failed = 1
sys.exit(failed)
END
exit $failed
