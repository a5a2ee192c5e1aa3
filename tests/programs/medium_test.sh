#!/bin/sh
# The medium of a machine's execution log, a folder that is taken out and put in while the machine
# runs (W588, 7-4-3), and what of it is an event (9-2-1, 15000000).
# usage: medium_test.sh CONTROLLER BUSBAR PROGRAM
set -u
controller=$1 busbar=$2 program=$3
. "$(dirname "$0")/functions.sh"

# The records of sessions, of which each reading makes some.
records() {
    cat "$1"/packages/OPCUA_Server/ExecutionLog/*.log | grep -c AUTH
}
has_records() { [ "$(records "$1")" -gt "$2" ]; }
is_logged() { [ "$(grep -c -e "$2" log)" -eq "$1" ]; }
event() { grep -q -s -e 15000000 state/events/events.log; }
look() { run 0 --insecure read "$url" i=2259; }

cat > machine.toml << END
[server]
port = 0
[certificates]
folder = "pki"
[machine]
program = "$program"
state = "state"
medium = "medium"
execution_log = true
[[endpoint]]
policy = "None"
[users]
anonymous = "write"
END
serve --config machine.toml
look
await has_records medium 0

# While it is away nothing is written, lost or put anywhere else.
mv medium pulled
await logged 'medium: the medium is away, and records wait for it'
before=$(records pulled)
look
look
event && fail "what waits is told as lost"
mv pulled medium
await logged 'medium: the medium is in again, and records are saved'
await has_records medium $((before + 3))
[ "$(cut -f 1 medium/packages/OPCUA_Server/ExecutionLog/*.log | sort -n | uniq -d | wc -l)" -eq 0 ] ||
    fail "a record was written twice"
event && fail "what was saved in time is told as lost"

# Another one, empty: the records go on there.
mv medium first
await is_logged 2 'the medium is away'
look
mkdir medium
await is_logged 2 'the medium is in again'
await has_records medium 0

# What waits when power goes is lost, and an event says so.
mv medium second
await is_logged 3 'the medium is away'
look
kill "$pid"
await ended && wait "$pid"
event || fail "lost records are no event"
grep -e 15000000 state/events/events.log | grep -q -e 0001 || fail "the event has no code 0001"
[ -e medium ] && fail "a medium was made by who writes to it"
pid=""
exit $((failures > 0))
