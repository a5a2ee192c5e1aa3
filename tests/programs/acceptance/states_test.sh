#!/bin/sh
# When the server runs, stops and is made anew: for its administrator, in each state of the CPU, and
# with each change that reconfigures it (W588, 4-1, 4-2-4 and 4-2-5).
# usage: states_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
takes_long

log_text() { cat medium/packages/OPCUA_Server/ExecutionLog/*.log 2> /dev/null | tr '\t\r' '  '; }
# count NAME: how many records of SERVER have it.
count() { log_text | grep -c " SERVER [0-9]* $1 "; }
counted() { [ "$(count "$1")" -ge "$2" ]; }
# settled: records are written by and by, in their order: all of those so far are there once that of
# a login is there that is refused now.
settled() {
    refusals=$(count_refusals)
    run 4 --user nobody --password-file password --trust read "$url" i=2259
    await has_refused_more
}
count_refusals() { log_text | grep -c ' AUTH 0002 .*nobody'; }
has_refused_more() { [ "$(count_refusals)" -gt "$refusals" ]; }
status_is() {
    chief 0 admin status "$url"
    says "^Server operating status: *$1\$"
}
# No values, whatever an administrator at the machine may see.
serves_nobody() {
    run_code=$(timeout 60 "$busbar" --user op --password-file password --trust \
        read "$url" "$(node Speed)" > out 2>&1 < /dev/null; echo $?)
    [ "$run_code" -ne 0 ] || fail "$1: values are served"
}
simulate() {
    as engineer 0 call "$url" "nsu=urn:busbar:machine;s=Machine/Hardware" Simulate "$1"
}
# configure MORE: the configuration, with these lines in [machine].
configure() {
    {
        server "$port" pki
        account engineer '"Engineer"'
        account op '"Operator"'
        machine "$1
simulated_hardware = true
retained_ms = 500"
        printf '[[plc.program]]\nkind = "shutdown"\ntarget = "Trigger"\nsets = "Outcome"\n'
        printf '[[plc.program]]\nkind = "increment"\ntarget = "Cycles"\n'
    } > controller.toml
}
# program SPEED [MORE]
program() {
    cat > press.st << END
{attribute 'publish' := 'publish only'}
VAR_GLOBAL
    Speed : INT := $1;
    Trigger : BOOL;
    Outcome : UINT;
    ${2:-}
END_VAR
VAR_GLOBAL RETAIN
    Cycles : UDINT;
END_VAR
END
}
configure 'mode = "PROGRAM"'
program 17 'Kind : INT;'
begin pki --config controller.toml
await counted Run 1

entry variables 4-2-4: five states
# Nobody is let in before it runs: the two states before are in the execution log, and in the log.
for state in Start Prepare Run; do
    [ "$(count $state)" -eq "$(count Start)" ] || fail "$(count $state) records of $state"
done
logged 'the OPC UA server starts' || fail "Initializing is not told"
logged 'the OPC UA server is being prepared' || fail "Preparing is not told"
status_is Running
says "^End point: *$url\$"
one_step
simulate "partial fault of the server"
await logged 'halt, until a restart'
status_is 'Halt error'
says '^End point: *---$'
await counted HaltError 1
restart
status_is Running

entry variables 4-1: start, stop, conditions
# Stopped by an administrator: there is no server until a restart, and all else goes on.
one_step
before=$(count Shutdown)
chief 0 admin shutdown "$url" --seconds 0 --reason maintenance --yes
says "the server stops in 0 s, and the controller's program goes on"
await counted Shutdown $((before + 1))
logged 'shutdown: maintenance' || fail "clients are not told why"
status_is Shutdown
says '^End point: *---$'
says '^Restart due: *the OPC UA server was shut down$'
serves_nobody "after a shutdown"
chief 0 admin events "$url" --code 95D10000 --last 1
says '95D10000 OPC UA Server Stopped'
# The program counts on, into a variable that is kept.
kept=$(cksum state/retained)
counts() { [ "$(cksum state/retained)" != "$kept" ]; }
await counts
# Neither its files, nor another program, nor a second shutdown starts it: a restart does.
runs=$(count Run)
hang_up 'read again'
downloaded() { [ "$(grep -c 'downloaded: press.st' log)" -eq "$1" ]; }
for kind in DINT INT; do
    program 17 "Kind : $kind;"
    kill -HUP "$pid"
    await downloaded $((${downloads:-0} + 1))
    downloads=1
done
chief 0 admin shutdown "$url" --seconds 0 --yes
await logged 'shutdown: an administrator stops the server'
status_is Shutdown
serves_nobody "after all of that"
[ "$(count Run)" -eq "$runs" ] || fail "it ran in between"
restart
value Speed 17
step_ends
one_step
before=$(count Shutdown)
chief 0 admin shutdown "$url" --seconds 0 --yes
await counted Shutdown $((before + 1))
power_cycle
step_ends
status_is Running
value Speed 17
# By the instruction, out of the program.
one_step
chief 0 write "$url" "$(node Trigger)" true
await logged 'the OPC UA server is shut down'
status_is Shutdown
serves_nobody "after OPCUA_Shutdown"
power_cycle
step_ends
status_is Running
# Not to be used: it runs until the restart, and then there is none, until it is to be used again
# and the power comes back.
one_step
chief 0 admin setting set "$url" machine.use false
says 'wait for a restart: machine.use'
status_is Running
says 'machine.use: waits for a restart'
power_cut
rm -f log
"$controller" --config controller.toml > log 2>&1 < /dev/null &
pid=$!
await logged '^ready'
logged 'variables and no port: use = false' || fail "it does not say that there is no server"
run 3 --user chief --password-file password --trust admin status "$url"
kill -HUP "$pid"
await logged 'read again'
run 3 --user chief --password-file password --trust admin status "$url"
shut_down
"$controller" --config controller.toml --forget-changes > out || fail "use stays as it is"
serve --config controller.toml
step_ends
status_is Running
says '^OPC UA Server: *Use$'

entry variables 4-1: faults of the controller
one_step
for fault in "minor fault" "partial fault" "major fault"; do
    simulate "$fault"
    case "$fault" in
        major*) value Controller/DeviceState/ErrorState 'MajorFault' ;;
        *) value Controller/DeviceState/ErrorState 'ContinuousError' ;;
    esac
    status_is Running
done
restart
step_ends
value Controller/DeviceState/ErrorState 'NoError'

entry variables 4-1-4: states of the CPU
value Controller/DeviceState/Mode 'PROGRAM'
# Executed during a backup, an online edit and in RUN; stopped during a download and after a
# restore, a clearing, a watchdog error and an error of the server.
chief 0 admin backup "$url" whole.backup
value Speed 17
one_step
settled
runs=$(count Run) prepares=$(count Prepare)
program 18 'Kind : REAL;'
hang_up 'downloaded: press.st'
await counted Run $((runs + 1))
settled
[ "$(count Prepare)" -eq $((prepares + 1)) ] || fail "it was not stopped for the download"
step_ends
value Speed 18
chief 0 admin mode "$url" run --yes
value Controller/DeviceState/Mode 'RUN'
one_step
settled
runs=$(count Run)
program 18 'Kind : REAL; Added : INT := 3;'
hang_up 'edited online: press.st'
value Added 3
[ "$(count Run)" -eq "$runs" ] || fail "an online edit made the server anew"
step_ends
one_step
stops=$(count Shutdown)
chief 0 admin restore "$url" whole.backup --yes
says 'it takes effect after a restart'
await counted Shutdown $((stops + 1))
await is_running
step_ends
value Speed 17
one_step
stops=$(count Shutdown)
chief 0 admin clear "$url" --yes
await counted Shutdown $((stops + 1))
await is_running
simulate "watchdog"
await logged 'the OPC UA server is shut down'
status_is Shutdown
serves_nobody "after a watchdog error"
restart
simulate "partial fault of the server"
await logged 'halt, until a restart'
serves_nobody "after an error of the server"
restart
step_ends

entry variables 4-2-5: triggers
# once WHAT: the server was made anew once since the last time.
once() {
    await counted Run $((runs + 1))
    await is_running
    settled
    [ "$(count Prepare)" -eq $((prepares + 1)) ] ||
        fail "$1: $(($(count Prepare) - prepares)) times instead of once"
    runs=$(count Run) prepares=$(count Prepare)
}
one_step
settled
runs=$(count Run) prepares=$(count Prepare)
program 19 'Kind : DINT;'
hang_up 'downloaded: press.st'
once "a download"
chief 0 admin cert regenerate "$url" --yes
once "another certificate"
chief 0 admin user add "$url" pat --new-password-file password
once "another user"
chief 0 admin restore "$url" whole.backup --yes
once "a restore"
step_ends
shut_down
finish
