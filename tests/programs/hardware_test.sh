#!/bin/sh
# A machine whose hardware is simulated: faults that stop its server and faults that do not
# (W588, 4-1-4), the watchdog, and a memory card whose power switch is pressed (7-4-3).
# usage: hardware_test.sh CONTROLLER BUSBAR PROGRAM
set -u
controller=$1 busbar=$2 program=$3
. "$(dirname "$0")/functions.sh"


# as USER CODE ARGUMENTS...: all have one password.
as() {
    user=$1 wanted=$2
    shift 2
    run "$wanted" --user "$user" --password-file password --trust "$@"
}
account() {
    printf '[[users.account]]\nname = "%s"\npassword = "%s"\nroles = ["%s"]\n' "$1" "$hash" "$2"
}
# Part 5, 12.6: 0 is Running, 1 Failed.
state() {
    as op 0 --json read "$url" i=2259
    says "\"value\":$1[,}]"
}
hardware="nsu=urn:busbar:machine;s=Machine/Hardware"
# simulate CODE EVENT
simulate() { as engineer "$1" call "$url" "$hardware" Simulate "$2"; }
count() { [ "$(grep -c -e "$2" log)" -eq "$1" ]; }
records() { cat medium/packages/OPCUA_Server/ExecutionLog/*.log | grep -c -e "$1"; }
recorded() { [ "$(records "$2")" -eq "$1" ]; }
coded() { grep -s -e 15000000 state/events/events.log | grep -q -e "$1"; }

echo "patience is all" > password
hash=$(quick_hash password)
{
    cat << END
[server]
port = 0
[certificates]
folder = "pki"
[machine]
program = "$program"
state = "state"
medium = "medium"
execution_log = true
simulated_hardware = true
[[endpoint]]
policy = "Basic256Sha256"
mode = "SignAndEncrypt"
$quick_logins
END
    account chief SecurityAdmin
    account engineer Engineer
    account op Operator
} > controller.toml
serve --config controller.toml
run 0 cert create
as chief 4 admin status "$url"
mv pki/rejected/certs/* pki/trusted/certs/

# Not everybody is hardware, and hardware does not tell everything.
as op 1 call "$url" "$hardware" Simulate "watchdog"
simulate 1 "earthquake"
says 'OutOfRange'

# Faults that are not the server's stop nothing.
for event in "major fault" "partial fault" "minor fault" "minor fault of the server"; do
    simulate 0 "$event"
done
simulate 0 "medium out"
await logged 'medium: the medium is away'
state 0
simulate 0 "medium in"
await logged 'medium: the medium is in again'
# Somebody takes it without a word, and brings it back.
simulate 0 "medium taken"
await count 2 'medium: the medium is away'
state 0
simulate 0 "medium in"
await count 2 'medium: the medium is in again'
grep -q -s -e 15000000 state/events/events.log && fail "what waits is told as lost"
# One that cannot be written to has an event, with the reason as its code.
simulate 0 "medium full"
state 0
await coded 0005
simulate 0 "medium in"
await logged 'records of the execution log are saved again'
simulate 0 "medium protected"
state 0
await coded 0003
simulate 0 "medium in"
await count 2 'records of the execution log are saved again'

# One of the server does, until a restart.
simulate 0 "partial fault of the server"
await logged 'halt, until a restart'
halted() { grep -q -s -e 44180000 state/events/events.log; }
await halted
await recorded 1 HaltError
simulate 1 "minor fault"
state 1
as chief 0 admin shutdown "$url" --restart --seconds 0 --yes
await count 2 '^ready'
simulate 0 "minor fault"
state 0

# So does the watchdog: the server is shut down.
simulate 0 "watchdog"
await count 2 'halt, until a restart'
await recorded 1 Shutdown
as chief 0 admin shutdown "$url" --restart --seconds 0 --yes
await count 3 '^ready'
state 0

# Without the setting there is no such thing.
kill "$pid"
wait "$pid"
sed -i '/^simulated_hardware/d' controller.toml
serve --config controller.toml
simulate 1 "minor fault"
kill "$pid"
wait "$pid"
pid=""
exit $((failures > 0))
