#!/bin/sh
# What a failing test of each framework shows.
# usage: adapters_test.sh PROGRAM, which has four tests that fail, and nothing else
set -u
out=$(mktemp)
trap 'rm -f "$out"' EXIT
failures=0
says() {
    grep -q -- "$1" "$out" || {
        echo "FAILED: the program does not say: $1"
        failures=$((failures + 1))
    }
}
if BUSBAR_SEED=77 "$1" > "$out" 2>&1; then
    echo "FAILED: all of its tests have passed"
    failures=1
fi
# A value: found, wanted, and how it came to it.
says 'Double 1.5'
says 'Double 2.5'
says 'seed 77, which BUSBAR_SEED=77 repeats'
says '0.009 s client -> ReadRequest ns=1;s=Level'
says '0.010 s server -> ReadResponse Double 1.5'
says 'server: session: "Busbar" activated'
# A result that a test needs.
says 'the test needs has failed: Bad_NodeIdExists'
# A value that a test waits for; frameworks break long lines.
says 'had no value that holds'
# A fault.
says 'faults that have never acted'
says 'cut at WriteRequest 1'
[ "$failures" -eq 0 ] || cat "$out"
exit $failures
