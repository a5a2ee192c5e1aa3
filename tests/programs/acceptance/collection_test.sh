#!/bin/sh
# Files in the forms that the tools of the field write (../collection): what is
# loaded of each, as ../collection/table.txt has it.
# usage: collection_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"

collection=$here/../collection
# table: of each file its encoding, how many variables are published, and how many declarations are
# not, with their reasons.
table() {
    for file in "$collection"/*; do
        name=$(basename "$file")
        [ "$name" != table.txt ] || continue
        if "$busbar" program check "$file" > out 2>&1 || grep -q '^  encoding' out; then
            printf '%s: %s, %s published, %s left out\n' "$name" \
                "$(sed -n 's/^  encoding *//p' out)" "$(grep -c '^  published ' out)" \
                "$(grep -c '^  \(not published\|left out\) ' out)"
            sed -n 's/^  \(not published\|left out\)  */  /p' out
        else
            printf '%s: refused\n' "$name"
            sed -n "s|^.* is refused: .*/$name:|  |p" out
        fi
    done
}
table > table.txt
last="$collection/table.txt"
diff "$collection/table.txt" table.txt > out || fail "another table: $(cat out)"
finish
