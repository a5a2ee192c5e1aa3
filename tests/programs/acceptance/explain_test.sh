#!/bin/sh
# What a controller says of each key of its configuration: its value, what says so, and what it
# would be without that.
# usage: explain_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"

# explain CODE ARGUMENTS...
explain() {
    wanted=$1
    shift
    last="busbar-controller $*"
    "$controller" "$@" > out 2>&1 < /dev/null
    code=$?
    [ $code -eq "$wanted" ] || fail "$last: exit code $code instead of $wanted"
}

explain 0 --explain limits.sessions
says '^limits.sessions = 100$'
says '^  from  *built-in$'
explain 0 --explain endpoint
says 'line [0-9]* of --print-config'

{
    server "$port" pki
    printf '[[plc.variable]]\nname = "Speed"\ntype = "Int16"\n'
} > controller.toml
sed -i 's/^\[limits\]/[limits]\npreset = "nj501"\nsessions = 4/' controller.toml

# Before it ever ran: nothing is made by asking.
explain 0 --config controller.toml --explain limits.sessions
says '^limits.sessions = 4$'
says '^  from  *file controller.toml:11$'
says '^  otherwise  *5, preset nj501$'
says '^  default  *100$'
says '^  least  *1$'
says '^  most  *100000$'
says '^  a change  *counts at once$'
explain 0 --config controller.toml --port 4900 --explain server.port
says '^server.port = 4900$'
says '^  from  *command line --port$'
says "^  otherwise  *$port, file controller.toml:3\$"
says 'counts after a restart'
explain 0 --config controller.toml --explain plc.variable
says 'file controller.toml:2[0-9]$'
explain 0 --config controller.toml --explain users.account
says '^users.account = \["chief"\]$'
grep -q -e "$hash" out && fail "a hash is shown"
explain 0 --config controller.toml --preset rd81opc96 --explain limits.subscriptions.items
says '= 15000$'
says '^  from  *preset rd81opc96$'
[ -e pki ] && fail "--explain made a folder"

# A line for each, without a key as with "all".
explain 0 --config controller.toml --explain
[ "$(wc -l < out)" -gt 150 ] || fail "there are few keys"
says '^limits.sessions = 4  (file controller.toml:11)$'
cp out lines
explain 0 --explain all --config controller.toml
cmp -s out lines || fail "all is something else than no key"

explain 2 --config controller.toml --explain limits.sesions
says 'found no key "limits.sesions"'
says 'did you mean limits.sessions'
explain 2 --config controller.toml --explain port
says 'did you mean server.port'
echo "nonsense = 1" > bad.toml
explain 1 --config bad.toml --explain server.port
says 'bad.toml:1'

# Beside the controller that runs, changed online.
begin pki --config controller.toml
chief 0 admin setting set "$url" limits.sessions 3
explain 0 --config controller.toml --explain limits.sessions
says '^limits.sessions = 3$'
says '^  from  *changed online by chief at 20'
says '^  otherwise  *4, file controller.toml:11$'
ended && fail "the controller ended"

shut_down
finish
