#!/bin/sh
# A PLC maker's controller around a runtime of his own, examples/vendor_runtime: its variables, a
# download that the runtime refuses and one that it takes, power cycles.
# usage: vendor_test.sh VENDOR_RUNTIME BUSBAR EXAMPLE
set -u
controller=$1 busbar=$2 example=$3
. "$(dirname "$0")/functions.sh"

reads() { chief 0 read --value "$url" "$(node "$1")"; }
has_value() { # NAME VALUE, for await
    reads "$1"
    grep -q -x -e "$2" out
}
above() { # NAME NUMBER, for await
    reads "$1"
    awk -v least="$2" '{ exit !($1 > least) }' out
}

cp "$example"/tank.st .
sed "s/^name = .*/&\naddress = \"127.0.0.1\"\nport = $port/" "$example"/tank.toml > controller.toml
serve --config controller.toml
grep -q 'the task runs' log && fail "tells of a task that is not the controller's"

# The first administrator.
sed -n 's/^setup: .* the code \([^,]*\),.*/\1/p' log > code
echo "patience is all" > password
run 0 admin setup "$url" chief --user setup --password-file code --new-password-file password --trust

# The runtime's memory is what clients see and write.
await above Level 20
has_value SetPoint 50 || fail "the runtime's own value is not there"
chief 0 write "$url" "$(node SetPoint)" 70 "$(node Note)" '"well water"'
await above Level 60
# Its program asks for the controller's error, as GetPLCError does.
has_value ErrorCode 0 || fail "there is an error"
one_step
chief 0 write "$url" "$(node Leaking)" true
await has_value ErrorCode 3
chief 0 write "$url" "$(node Leaking)" false
step_ends
power_cycle
await has_value ErrorCode 0

# The runtime tells that its card is away: records wait for it, and come to it.
log_files() { cat busbar-medium/packages/OPCUA_Server/ExecutionLog/*.log; }
has_logins() { [ "$(log_files | grep -c AUTH)" -gt "$1" ]; }
one_step
await has_logins 0
chief 0 write "$url" "$(node CardIn)" false
await logged 'the medium is away, and records wait for it'
logins=$(log_files | grep -c AUTH)
reads Level
reads Level
[ "$(log_files | grep -c AUTH)" -eq "$logins" ] || fail "it writes to a card that is away"
chief 0 write "$url" "$(node CardIn)" true
await logged 'the medium is in again, and records are saved'
await has_logins "$logins"
step_ends
chief 0 browse "$url" "/Objects/Tank 1"
says GlobalVars

# A program without what the runtime needs is refused, and what ran goes on; so it does after power
# was gone.
sed -i '/Pumping/d' tank.st
sed -i 's/^program = .*/&\nmode = "PROGRAM"/' controller.toml
hang_up 'Pumping: the program has no such variable.*nothing was changed'
await has_value SetPoint 70
power_cycle
await logged 'begins with what it ran with last'
reads Pumping

# One with more than before is downloaded: the new variable lies in the controller's memory.
cp "$example"/tank.st .
sed -i 's/^    Leaking .*/&\n    Batch : UDINT := 17;/' tank.st
hang_up '\(downloaded\|edited online\): tank.st'
await has_value Batch 17
one_step # it is not RETAIN
chief 0 write "$url" "$(node Batch)" 18
has_value Batch 18 || fail "a variable of the controller's memory is not written"
step_ends
await above Level 20

# Whoever sends a program over OPC UA learns what the runtime has against it, and everybody else
# sees it in the status, until another one is taken up.
sed '/Pumping/d' tank.st > less.st
one_step
chief 0 write "$url" "$(node Batch)" 18
chief 1 admin program download "$url" less.st --yes
says 'less.st was sent and refused: .*Pumping: the program has no such variable'
has_value Batch 18 || fail "the program from before does not go on"
chief 0 admin program show "$url"
says '^refused: .*less.st'
chief 0 admin status "$url"
says 'less.st was sent and refused'
step_ends
sed 's/^    Batch .*/    Batch : UDINT := 19;/' tank.st > more.st
one_step
chief 0 admin program download "$url" more.st --yes
says 'the controller runs the program'
has_value Batch 19 || fail "the program that was sent does not run"
chief 0 admin status "$url"
! grep -q 'was sent and refused' out || fail "a refusal is told of that is over"
step_ends
power_cycle
await has_value Batch 19

kill "$pid"
wait "$pid" || fail "exit code $?"
logged '^stopped' || fail "it does not say that it stopped"
pid=""
finish
