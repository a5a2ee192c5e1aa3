#!/bin/sh
# The commands that pages show and do not run: each is one that the programs have, with options that
# its help has. And the project that the page about its format shows is one that busbar makes.
# usage: page_options_test.sh BUSBAR CONTROLLER PAGE...
set -u
busbar=$1 controller=$2
shift 2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0
count=0

# help_of WORDS: the file with the help of that command of busbar, empty if there is none.
help_of() {
    file=$work/$(echo "$1" | tr ' ' _)
    if [ ! -e "$file" ]; then
        # What is no command gets the help of the one above it.
        # shellcheck disable=SC2086
        "$busbar" $1 --help 2> "$work/errors" | grep -q "^Usage: .*busbar $1 \[" &&
            "$busbar" $1 --help > "$file" 2>&1
        [ -e "$file" ] || : > "$file"
    fi
    echo "$file"
}
wrong() {
    failures=$((failures + 1))
    echo "$1: $2"
}
# check PAGE LINE: a command without its comment.
check() {
    count=$((count + 1))
    case $2 in
        busbar-controller*)
            help=$work/controller
            [ -e "$help" ] || "$controller" --help > "$help" 2>&1
            ;;
        *)
            words=$(echo "$2" | sed 's/^busbar//; s/ --pki [^ ]*//' |
                sed -n 's/^\(\( [a-z][a-z]*\)\{1,3\}\).*/\1/p')
            help=""
            while [ -n "$words" ]; do
                help=$(help_of "${words# }")
                [ -s "$help" ] && break
                words=${words% *}
            done
            if [ -z "$words" ] || grep -q '^Usage: .* SUBCOMMAND' "$help"; then
                wrong "$1" "no such command: $2"
                return
            fi
            ;;
    esac
    for option in $(echo "$2" | grep -o -e ' --[a-z][a-z-]*'); do
        grep -q -e "$option\b" "$help" ||
            "$busbar" --help | grep -q -e "$option\b" || wrong "$1" "no $option: $2"
    done
}

for page; do
    awk '/^```(sh|console)$/ { is_code = 1; next } /^```$/ { is_code = 0 }
        is_code && /<< .END.$/ { text = 1 } text { if ($0 == "END") { text = 0 } next }
        is_code && /^busbar(-controller)? /' "$page" | sed 's/ *#.*//; s/ [>|].*//' > "$work/commands"
    while read -r line; do
        check "$page" "$line"
    done < "$work/commands"
done
format=$(dirname "$0")/../../lib/controller/project/FORMAT.md
"$busbar" project new "$work/line.busbar" --preset rd81opc96 > "$work/errors" 2>&1
awk '/^```text$/ { ++n; next } /^```$/ { if (n) exit } n == 1' "$format" |
    cmp - "$work/line.busbar" || wrong "$format" "busbar project new makes another file"
[ "$count" -gt 40 ] || wrong pages "only $count commands"
echo "$count commands"
[ "$failures" -eq 0 ]
