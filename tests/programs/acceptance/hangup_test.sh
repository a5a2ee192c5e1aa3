#!/bin/sh
# SIGHUP has a controller read its files again, whenever it comes: also while it starts.
# usage: hangup_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"

{
    server "$port" pki
    printf '[[endpoint]]\npolicy = "None"\nmode = "None"\n'
    machine
} > controller.toml
press 17 > press.st

# The first start makes a key, which takes its time.
"$controller" --config controller.toml > log 2>&1 < /dev/null &
pid=$!
await logged 'the OPC UA server starts'
kill -HUP "$pid"
await logged '^ready' || exit 1
await logged 'read again'
ended && fail "a SIGHUP during the start ended the controller"
run 0 endpoints "opc.tcp://127.0.0.1:$port"
kill "$pid"
wait "$pid" || fail "exit code $? at the end"

# Without security nothing is missing, at the first start and when files are read again.
{
    printf '[server]\naddress = "127.0.0.1"\nport = %s\n[certificates]\nfolder = "none"\n' "$port"
    printf '[[endpoint]]\npolicy = "None"\nmode = "None"\n[users]\nanonymous = "read"\n'
    machine | sed 's/"state"/"none-state"/'
} > none.toml
"$controller" --config none.toml > log 2>&1 < /dev/null &
pid=$!
await logged '^ready' || exit 1
kill -HUP "$pid"
await logged 'read again: .*no client needs a certificate'
if logged '^\(warning\|error\): '; then
    fail "a controller without security complains"
fi
kill "$pid"
wait "$pid" || fail "exit code $? at the end"
finish
