#!/bin/sh
# The instruction OPCUA_Shutdown, as the user program executes it (seed 000, A-2): the server is shut
# down and the program goes on, what fails is an event, and a restart brings the server back.
# usage: instruction_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/../functions.sh"

says() { grep -q -s -e "$1" out || fail "\"$1\" is not in the output of: $last"; }
chief() {
    wanted=$1
    shift
    run "$wanted" --user chief --password-file password --trust "$@"
}
status_is() {
    chief 0 admin status "$url"
    says "^Server operating status: *$1\$"
}
is_running() {
    ends_with 0 --user chief --password-file password --trust admin status "$url" &&
        grep -q 'operating status: *Running$' out && grep -q '^state: *Running$' out
}
variable="nsu=urn:busbar:machine;s="

echo "patience is all" > password
hash=$(quick_hash password)
port=$((20000 + $$ % 12000))
# configure PROGRAMS: the configuration with these tables.
configure() {
    cat > controller.toml << END
[server]
address = "127.0.0.1"
port = $port
[certificates]
folder = "pki"
[[endpoint]]
policy = "Basic256Sha256"
mode = "SignAndEncrypt"
[machine]
program = "press.st"
name = "Controller"
use = ${use:-true}
state = "state"
medium = "medium"
execution_log = true
$1
$quick_logins
[[users.account]]
name = "chief"
password = "$hash"
roles = ["SecurityAdmin", "ConfigureAdmin", "Operator"]
END
}
once='[[plc.program]]
kind = "shutdown"
target = "Trigger"
sets = "Outcome"'
again='[[plc.program]]
kind = "toggle"
target = "Trigger"
period_ms = 400'
cat > press.st << 'END'
VAR_GLOBAL
    {attribute 'publish' := 'publish only'}
    Trigger : BOOL;
    {attribute 'publish' := 'publish only'}
    Outcome : UINT;
END_VAR
END
configure "$once"
run 0 cert create
serve --config controller.toml
chief 4 admin status "$url"
mv pki/rejected/certs/* pki/trusted/certs/
status_is Running

chief 0 write "$url" "${variable}Trigger" true
await logged 'the OPC UA server is shut down'
status_is Shutdown
says '^Restart due: *the OPC UA server was shut down$'
chief 0 admin events "$url" --code 95D10000
says '95D10000 OPC UA Server Stopped'
kill -0 "$pid" || fail "the program ended with the server"
chief 0 admin shutdown "$url" --restart --seconds 0 --yes
await is_running
kill -9 "$pid"
wait "$pid" 2> /dev/null
serve --config controller.toml
status_is Running

# Executed again and again: all but the first find it shut down.
kill -9 "$pid"
wait "$pid" 2> /dev/null
configure "$again
$once"
serve --config controller.toml
await logged 'event log: 54015000 OPC UA Server Shutdown or Shutting Down'
corrected() {
    chief 0 admin events "$url" --code 54015000
    grep -q -s 'Correction: Execute it once only' out
}
await corrected

# Not used: it says so, and the controller ends by a signal only.
kill -9 "$pid"
wait "$pid" 2> /dev/null
use=false
configure "$again
$once"
rm -f log
"$controller" --config controller.toml > log 2>&1 < /dev/null &
pid=$!
await logged 'event log: 54015002 OPC UA Server Not Started'
kill "$pid"
await ended

# Without a machine there is nothing to shut down.
printf '[[plc.program]]\nkind = "shutdown"\ntarget = "x"\n[[plc.variable]]\nname = "x"\ntype = "Boolean"\n' \
    > none.toml
timeout 30 "$controller" --config none.toml > out 2>&1
last=none.toml
says 'a program in \[machine\]'
exit $((failures > 0))
