#!/bin/sh
# What is to be done about troubles: each row of the manuals' tables and of TROUBLESHOOTING.md is
# carried out by a script remedies_*_test.sh, or it is said why not; and whatever command that text
# or a message of the programs names is there.
# usage: remedies_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
. "$here/remedies.sh"

# count SECTION: the manual's rows of it.
count() {
    sed -n 's/^ *remedy //p' "$here"/remedies_*_test.sh | tr ' ' '\n' | sort -u |
        awk -v section="$1" '
            FILENAME == "-" { has[$1] = 1; next }
            index($0, section ".") != 1 { next }
            { ++rows }
            / \| / { ++without; if ($1 in has) { print "carried out and not: " $1; bad = 1 } next }
            !($1 in has) { print "in no script: " $0; bad = 1 }
            END {
                print section ": " rows " rows, " rows - without " carried out, " without " not"
                exit bad
            }' - "$here/remedies.txt" || fail "$1"
}
count 9-3
count 10.3

# Rows that no script can carry out, and why.
cat > untried << 'END'
| Bad_NoCommunication, with no event: the simulated PLC scans and answers while its controller runs
| `write` says that it is not known: a connection is lost after the last byte, before the answer
END
{
    # Scripts about something else, which read no table, have it in a comment.
    sed -n "s/^[ #]*told '\(.*\)'\$/| \1/p" "$here"/*_test.sh
    sed 's/: .*//' untried
} | awk '
    FILENAME == "-" { begin[++n] = $0; next }
    !/^\|/ || /^\| what is found/ || /^\|---/ { next }
    {
        ++rows
        for (i = 1; i <= n; ++i) {
            if (index($0, begin[i]) == 1) { next }
        }
        print "in no script: " $0
        bad = 1
    }
    END { print "TROUBLESHOOTING.md: " rows " rows, of which are not carried out:"; exit bad }
' - "$troubleshooting" || fail "TROUBLESHOOTING.md"
cat untried

# is_command WORD...: as the help says.
is_command() {
    "$busbar" "$@" --help > out 2>&1 < /dev/null && grep -q -e "busbar $* " out
}
{
    grep -o '`busbar [a-z][a-z ]*' "$troubleshooting"
    grep -a -o -h '`busbar [a-z][a-z ]*' "$busbar" "$controller"
} | tr -d '`' | sort -u > named
[ "$(wc -l < named)" -gt 20 ] || fail "few commands are named"
while read -r _ first second third _; do
    case "$first $second" in
        'admin trust' | 'admin user' | 'admin role' | 'admin setting' | 'admin file' | \
            'admin cert' | 'admin program') set -- "$first" "$second" $third ;;
        admin\ * | project\ * | cert\ *) set -- "$first" $second ;;
        *) set -- "$first" ;;
    esac
    is_command "$@" || fail "there is no command: busbar $*"
done < named
finish
