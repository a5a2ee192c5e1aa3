#!/bin/sh
# The instruction OPCUA_Shutdown, as the user program executes it (W588, A-2): the server is shut
# down and the program goes on, what fails is an event, and a restart brings the server back.
# usage: instruction_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"

status_is() {
    chief 0 admin status "$url"
    says "^Server operating status: *$1\$"
}

# configure PROGRAMS: the configuration with these tables.
configure() {
    {
        server "$port" pki
        machine "use = ${use:-true}"
        printf '%s\n' "$1"
    } > controller.toml
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
begin pki --config controller.toml
entry variables A-2: OPCUA_Shutdown
status_is Running

one_step
chief 0 write "$url" "$(node Trigger)" true
await logged 'the OPC UA server is shut down'
status_is Shutdown
says '^Restart due: *the OPC UA server was shut down$'
chief 0 admin events "$url" --code 95D10000
says '95D10000 OPC UA Server Stopped'
kill -0 "$pid" || fail "the program ended with the server"
restart
step_ends
power_cycle
status_is Running

# Executed again and again: all but the first find it shut down.
power_cut
configure "$again
$once"
serve --config controller.toml
await logged 'event log: 54015000 OPC UA Server Shutdown or Shutting Down'
corrected() {
    chief 0 admin events "$url" --code 54015000
    grep -q -s 'Correction: Execute it once only' out
}
await corrected

# Executed in the first scan, which the server is still initialized in, once more often than there
# are places: it fails with its codes, and the server runs.
power_cut
{
    echo VAR_GLOBAL
    echo "    {attribute 'publish' := 'publish only'} Trigger : BOOL := TRUE;"
    seq 33 | sed "s/.*/    {attribute 'publish' := 'publish only'} O& : UINT;/"
    echo END_VAR
} > early.st
cp press.st late.st
cp early.st press.st
configure "$(seq 33 | sed 's/.*/[[plc.program]]\nkind = "shutdown"\ntarget = "Trigger"\nsets = "O&"/')"
serve --config controller.toml
for start in first next; do
    value O1 20481  # 16#5001
    value O32 20481
    value O33 1053 # 16#041D
    status_is Running
    entry variables 9-2: events
    chief 0 admin events "$url" --code 54015001 --last 1
    says 'Observation  54015001 OPC UA Server Being Initialized'
    says 'Correction: '
    entry variables A-2: OPCUA_Shutdown
    one_step
    if [ $start = next ]; then await is_running; else restart; fi
    step_ends
done

# Not used: it says so, and the controller ends by a signal only.
power_cut
cp late.st press.st
use=false
configure "$again
$once"
rm -f log
"$controller" --config controller.toml > log 2>&1 < /dev/null &
pid=$!
await logged 'event log: 54015002 OPC UA Server Not Started'
shut_down

# Without a machine there is nothing to shut down.
printf '[[plc.program]]\nkind = "shutdown"\ntarget = "x"\n[[plc.variable]]\nname = "x"\ntype = "Boolean"\n' \
    > none.toml
timeout 30 "$controller" --config none.toml > out 2>&1
last=none.toml
says 'a program in \[machine\]'
finish
