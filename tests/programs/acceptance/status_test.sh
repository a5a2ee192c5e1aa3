#!/bin/sh
# What a controller says of itself: its status as the tool prints it (W588, 4-2-1), faults (4-1-3
# and 6-2-1), what is asked for and not in force, and past events with cause and correction (9-1-1);
# for whom (8-1), and again after each power cut.
# usage: status_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"

status() { as "${1:-chief}" 0 admin status "$url"; }
shows_running() {
    status
    says '^OPC UA Server: *Use$'
    says '^Server operating status: *Running$'
    says "^End point: *$url\$"
    says '^Number of connected clients: *1$'
    says '^Number of connected users: *1$'
    says '^Connected users: *chief$'
    says '^Restart due: *no$'
}
is_fine() {
    shows_running
    says '^Pending changes: *none$'
    says '^Current errors: *none$'
}
property() {
    chief 0 read --value "$url" "nsu=urn:busbar:machine;s=Controller/DeviceState/$1"
    says "^$2\$"
}
# got CODE LEVEL: what the program got from GetPLCError.
got() {
    chief 0 read --value "$url" "$(node ErrorCode)" "$(node ErrorLevel)"
    [ "$(tr '\n' ' ' < out)" = "$1 $2 " ]
}
simulate() {
    as engineer 0 call "$url" "nsu=urn:busbar:machine;s=Machine/Hardware" Simulate "$1"
}

{
    server "$port" pki | sed 's/^password_iterations.*/&\nauthorities = "five levels"/'
    account engineer '"Engineer"'
    account fitter '"Supervisor"'
    account op '"Operator"'
    account watcher '"Observer"'
    machine 'simulated_hardware = true
mode = "PROGRAM"'
    printf '[[plc.program]]\nkind = "plc_error"\ntarget = "ErrorCode"\nsets = "ErrorLevel"\n'
} > good.toml
cp good.toml controller.toml
{
    press 17
    cat << 'END'
{attribute 'publish' := 'publish only'}
VAR_GLOBAL
    ErrorCode : DWORD;
    ErrorLevel : UINT;
END_VAR
END
} > press.st
cp press.st good.st

entry variables 3-2-7: status
begin pki --config controller.toml
is_fine
power_cycle
is_fine

# For five levels of users: who may see it, the certificate, the users, and the events.
for user in chief engineer fitter op; do
    status $user
    says "^Connected users: *$user\$"
    as $user 0 admin cert show "$url"
    says '^own'
    as $user 0 admin user list "$url"
    as $user 0 admin events "$url"
    says '95D00000 OPC UA Server Started'
done
as watcher 4 admin status "$url"
says 'it is for users with the role Operator'
as watcher 1 admin cert show "$url"
as watcher 1 admin events "$url"
says 'may not see it'

# A client sees the same as nodes, below the machine's folder.
as op 0 read --value "$url" "ns=1;s=Status/ConnectedUserNames"
says 'op'
as op 0 browse "$url" "nsu=urn:busbar:machine;s=Controller/"
says 'Status'

entry variables 9-1-1: error status
# Faults of the controller: told, shown as 4-1-3 has it, and over after a reset. The program gets
# the highest level and in that the highest code by GetPLCError, which a major fault does not
# change.
got 0 0 || fail "there is an error"
one_step
simulate "minor fault"
property ErrorState ContinuousError
await got 3 3
simulate "partial fault"
property ErrorState ContinuousError
await got 2 2
status
says '00000003 Controller Minor Fault: CPU Unit'
says '00000002 Controller Partial Fault: CPU Unit'
says '^Restart due: *no$'
simulate "major fault"
property ErrorState MajorFault
status
says '^Server operating status: *Running$'
says '00000001 Controller Major Fault: CPU Unit. Remove the cause'
says '^Restart due: *a fault has stopped the user program$'
await logged 'event log: 00000001 Controller Major Fault: CPU Unit. Remove the cause'
restart
step_ends
property ErrorState NoError
got 0 0 || fail "an error is not over"
is_fine
power_cycle
is_fine

# One of the server halts it. An administrator sees why, also in the events, and mends it.
one_step
simulate "partial fault of the server"
await logged 'halt, until a restart'
status
says '^Server operating status: *Halt error$'
says '^End point: *---$'
says '^Halted because of: *OPC UA System Error'
says '^Restart due: *a fatal error has stopped the OPC UA server$'
says '44180000 OPC UA System Processing Error. Cycle the power'
chief 0 admin events "$url" --code 44180000
says 'Correction: Cycle the power'
restart
step_ends
is_fine
one_step
simulate "watchdog"
await logged 'the OPC UA server is shut down'
status
says '^Server operating status: *Shutdown$'
restart
step_ends
is_fine

entry_ends
# What is asked for and not in force.
printf 'VAR_GLOBAL\n    Speed : IN' > press.st
hang_up 'press.st:2:.*; nothing was changed'
shows_running
says '^Pending changes: *press.st:2:'
power_cycle
shows_running
says '^Pending changes: *press.st:2:.*$'
says 'ran with last'
says '00000004 Configuration Not in Force: press.st:2:'
cp good.st press.st
hang_up 'read again'
is_fine
one_step
chief 0 admin setting set "$url" machine.execution_log_files 7
status
says 'waits for a restart'
restart
step_ends
is_fine

# A port that somebody else has: the program goes on, and an administrator is told why it halts.
power_cut
sed -e 's/"pki"/"other-pki"/' -e '/^\[machine\]/,/^mode/d' -e '/^\[\[plc/,$d' good.toml > squatter.toml
"$controller" --config squatter.toml > squatter 2>&1 < /dev/null &
squatter=$!
await grep -q '^ready' squatter
serve --config controller.toml
status
says '^Server operating status: *Halt error$'
says '^Halted because of: *Server Start Error: .*cannot listen on'
says '^Pending changes: .*cannot listen on'
says '35D00000 OPC UA Server Setting Error. Transfer the settings again'
kill -9 $squatter
wait $squatter 2> /dev/null
await logged "the OPC UA server runs at opc.tcp://127.0.0.1:$port"
url=opc.tcp://127.0.0.1:$port
is_fine
power_cycle
is_fine

entry variables 9-1-1: error status
# Past events, also of before the power cuts.
chief 0 admin events "$url" --level "minor fault" --last 100
says '35D00000 OPC UA Server Setting Error$'
says 'Cause: .*something else uses the port'
says_not '95D00000'
chief 0 admin events "$url" --code 00000001 --last 1
says 'Major fault  00000001 Controller Major Fault: CPU watchdog'
chief 0 --json admin events "$url" --code 95d00000 --last 1
says '"code":"95D00000","name":"OPC UA Server Started","level":"Information"'
chief 2 admin events "$url" --code 95D0
says 'is not an event code'
as op 0 admin file list "$url" EventLog
says 'events.log'

entry variables 9-2: events
# More is to be published than the product does: told with cause and correction, and over with a
# program that fits.
power_cut
sed -e '/^\[\[plc/,$d' -e 's/^\[limits\]/[limits]\npreset = "nj501"/' good.toml > controller.toml
# publish COUNT NAME TYPE: so many variables.
publish() {
    echo VAR_GLOBAL
    seq "$1" | sed "s/.*/{attribute 'publish' := 'publish only'} $2& : $3;/"
    echo END_VAR
}
tells() { reaches admin events "$url" --code "$1" --last 1 && grep -q "Observation  $1 $2" out; }
# exceeds CODE NAME: what press.st is too much of.
exceeds() {
    serve --config controller.toml
    await logged "event log: $1 $2. Publish "
    await tells "$1" "$2"
    says 'Cause: '
    says 'Correction: Publish '
    status
    says "^Current errors: *$1 $2"
    power_cut
}
publish 10001 v INT > press.st
exceeds 35D30000 'Too Many Public Variables'
publish 10 a 'ARRAY[0..1023] OF BYTE' > press.st
exceeds 35D50000 'Too Many Public Value Attributes'
{
    seq 101 | sed 's/.*/TYPE T& : STRUCT a : INT; END_STRUCT; END_TYPE/'
    publish 101 s 'T&'
} > press.st
exceeds 35D60000 'Too Many Structure Definitions'
cp good.st press.st
serve --config controller.toml
is_fine
shut_down
finish
