#!/bin/sh
# What the troubleshooting says is done about variables that are not shown, not read or written, not
# subscribed to, or have lost their values: the trouble is there, the remedy exists, and it helps
# (W588, 9-3; TROUBLESHOOTING.md).
# usage: remedies_variable_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
takes_long
. "$here/remedies.sh"

# configure MORE: with these lines in [machine].
configure() {
    {
        server "$port" pki
        account engineer '"Engineer"'
        account op '"Operator"'
        machine "mode = \"PROGRAM\"
simulated_hardware = true
$1"
    } | sed 's/^\[limits\]$/[limits]\npreset = "nj501"/' > controller.toml
}
# with COMMAND...: what it prints is published, too.
with() {
    cat head.st
    printf "{attribute 'publish' := 'publish only'}\nVAR_GLOBAL\n"
    "$@"
    printf 'END_VAR\n'
}
cat > head.st << 'END_OF_PROGRAM'
TYPE Pair : STRUCT a : INT; b : INT; END_STRUCT; END_TYPE
{attribute 'publish' := 'publish only'}
VAR_GLOBAL
    Speed : INT := 17;
    Name : STRING[4];
    Row : ARRAY [0..1] OF INT;
    Both : Pair;
    IsTarget : BOOL := TRUE;
END_VAR
VAR_GLOBAL
    Hidden : INT := 3;
END_VAR
{attribute 'publish' := 'publish only'}
VAR_GLOBAL CONSTANT
    Fixed : INT := 5;
END_VAR
{attribute 'publish' := 'publish only'}
VAR_GLOBAL RETAIN
    Total : DINT := 5;
END_VAR
VAR_GLOBAL RETAIN
    Secret : DINT := 5;
END_VAR
END_OF_PROGRAM
configure ''
printf '[[plc.program]]\nkind = "copy"\nsource = "_Card1RestoreCmdTargetOpcuaSPF"\ntarget = "IsTarget"\n' \
    >> controller.toml
cp head.st press.st
begin pki --config controller.toml
entry variables 9-3: remedies
one_step # what is to be there after a power cut is in other scripts

remedy 9-3.35
told 'it is a system-defined variable'
chief 1 read "$url" "$(node _Card1RestoreCmdTargetOpcuaSPF)"
says Bad_NodeIdUnknown
chief 0 read --value "$url" "$(node IsTarget)"
says '^false$'
power_cut
configure ''
serve --config controller.toml

remedy 9-3.34 9-3.41
told 'it is not below GlobalVars'
chief 1 read "$url" "$(node Hidden)"
says Bad_NodeIdUnknown
chief 0 browse "$url" "$(node Controller/GlobalVars)"
says_not Hidden
sed -i "s/    Hidden : INT/    {attribute 'publish' := 'publish only'}\n&/" press.st
hang_up 'press.st'
await reaches read "$url" "$(node Hidden)"
chief 0 browse "$url" "$(node Controller/GlobalVars)"
says Hidden

remedy 9-3.36
told 'SERVER 0101 names it |'
echo 'Base : ARRAY [1..2] OF INT;' > more
with cat more > press.st
hang_up 'press.st'
recorded SERVER 0101 'Base SubscriptOfArray'
in_events 35D40000
chief 1 read "$url" "$(node Base)"
echo 'Base : ARRAY [0..1] OF INT;' > more
with cat more > press.st
kill -HUP "$pid"
await reaches read "$url" "$(node Base)"

remedy 9-3.37
told 'there is no node for a member'
chief 1 read "$url" "$(node Both.a)"
chief 0 --json read --value "$url" "$(node Both)"
says '"a":0'

# More than the product publishes: of variables, of values, of structures.
# The names have as many digits each, as it is by their order what is left out.
many() { seq -f '    z%05g : INT;' "$1"; }
long() { seq -f '    z%05g : ARRAY [0..399] OF INT;' "$1"; }
types() { seq -f 'TYPE T%05g : STRUCT a : INT; END_STRUCT; END_TYPE' 101; }
structures() { seq -f '%05g' "$1" | sed 's/.*/    z& : T&;/'; }
program_of() {
    types
    printf "{attribute 'publish' := 'publish only'}\nVAR_GLOBAL\n"
    "$@"
    printf 'END_VAR\n'
}
# take_over: the file's program, whose variables may have the names of the one before.
taken_over() { grep -c -e 'downloaded: press.st' -e 'edited online: press.st' log; }
is_taken_over() { [ "$(taken_over)" -gt "$taken_before" ]; }
take_over() {
    taken_before=$(taken_over)
    kill -HUP "$pid"
    await is_taken_over
    await reaches read "$url" "$(node z00001)" # it may start again for it
}
# too_many BIT CODE NAME COMMAND...: with so many and with fewer.
too_many() {
    bit=$1 event=$2 name=$3 kind=$4 fewer=$6
    left_out=$(printf 'z%05d' "$5") shown=$(printf 'z%05d' "$6")
    program_of "$kind" "$5" > press.st
    take_over
    chief 0 read --value "$url" "$(node Controller/DeviceState/UnpublishedVariablesStatus)"
    [ $(($(tail -n 1 out) >> bit & 1)) -eq 1 ] || fail "bit $bit of $(cat out)"
    recorded SERVER 0100 "$name"
    in_events "$event"
    chief 1 read "$url" "$(node "$left_out")"
    program_of "$kind" "$fewer" > press.st
    kill -HUP "$pid"
    is_gone() {
        reaches read --value "$url" "$(node Controller/DeviceState/UnpublishedVariablesStatus)" &&
            [ "$(tail -n 1 out)" = 0 ]
    }
    await is_gone
    chief 0 read "$url" "$(node "$shown")"
}
remedy 9-3.40
told 'bit 2'
too_many 2 35D60000 MaxDataTypes structures 101 90
remedy 9-3.39
told 'bit 1'
too_many 1 35D50000 MaxValues long 26 20
remedy 9-3.38
told 'bit 0'
too_many 0 35D30000 MaxVariables many 10001 9

# A mistake, and what is more than an addition.
told 'the program has it, but the controller still serves'
cp head.st press.st
hang_up 'press.st'
await reaches read --value "$url" "$(node Speed)"
sed 's/    Speed : INT := 17;/    Speed : INTEGER; Fresh : INT;/' head.st > press.st
hang_up 'press.st:4:.*nothing was changed'
chief 1 read "$url" "$(node Fresh)"
sed 's/    Speed : INT := 17;/    Speed : INT := 17; Fresh : INT;/' head.st > press.st
hang_up 'edited online: press.st\|downloaded: press.st'
await reaches read "$url" "$(node Fresh)"
chief 0 admin mode "$url" run --yes
sed 's/    Speed : INT := 17;/    Speed : REAL := 1.5; Fresh : INT;/' head.st > press.st
hang_up 'press.st:4:.*waits until the machine is not in RUN'
chief 0 read --value "$url" "$(node Speed)"
says '^17$'
chief 0 admin mode "$url" program --yes
kill -HUP "$pid"
is_real() { reaches read --value "$url" "$(node Speed)" && grep -q '^1.5$' out; }
await is_real
cp head.st press.st
kill -HUP "$pid"
is_whole() { reaches read --value "$url" "$(node Speed)" && grep -q '^17$' out; }
await is_whole

# Reading and writing.
remedy 9-3.44 9-3.45
told 'Bad_NodeIdUnknown | it is an element'
told 'Bad_TypeMismatch'
told 'Bad_OutOfRange | a text'
told 'Bad_NotWritable'
chief 1 read "$url" "$(node 'Row[0]')"
says Bad_NodeIdUnknown
chief 0 read --value "$url" "$(node Row)"
chief 1 read "$url" "$(node Both.a)"
says Bad_NodeIdUnknown
chief 0 read --value "$url" "$(node Both)"
chief 1 write "$url" "$(node Row)" '[1, 2, 3]'
says Bad_TypeMismatch
chief 0 read "$url" "$(node Row)"
chief 0 write "$url" "$(node Row)" '[1, 2]'
chief 1 write "$url" "$(node Name)" 'too long'
says Bad_OutOfRange
chief 0 write "$url" "$(node Name)" lid
chief 1 write "$url" "$(node Fixed)" 6
says Bad_NotWritable
sed '/CONSTANT/s/ CONSTANT//' head.st > press.st
kill -HUP "$pid"
writes_fixed() { reaches write "$url" "$(node Fixed)" 6; }
await writes_fixed

# An administrator has suspended the server, or said that it failed.
told 'Bad_OutOfService, Bad_ServerHalted'
# state NUMBER: the server is in this ServerState.
state() {
    chief 0 call "$url" i=2253 i=12886 "$1" 1601-01-01T00:00:00Z 0 '{"text": "a trial"}' false
}
for each in 3:Bad_OutOfService 1:Bad_ServerHalted; do
    state "${each%%:*}"
    ends_with 0 --user op --password-file password --trust read "$url" "$(node Speed)" &&
        fail "values are read in state ${each%%:*}"
    says "${each#*:}"
    if [ "${each%%:*}" -eq 3 ]; then
        state 0
    else
        restart
    fi
    await ends_with 0 --user op --password-file password --trust read "$url" "$(node Speed)"
done

# Subscriptions.
remedy 9-3.47 9-3.48
told 'Bad_TooManySubscriptions'
chief 0 admin setting set "$url" limits.subscriptions.in_all 1
follows op "$(node Speed)"
await has_followed '17$'
chief 1 subscribe "$url" i=2258 --count 1 --duration 10
says Bad_TooManySubscriptions
ends_following
await reaches subscribe "$url" i=2258 --count 1 --duration 10
chief 0 admin setting reset "$url" limits.subscriptions.in_all
chief 0 admin setting set "$url" limits.subscriptions.items 3
chief 0 subscribe "$url" i=2258 i=2259 "$(node Speed)" --count 3 --duration 10
chief 5 subscribe "$url" i=2258 i=2259 "$(node Speed)" "$(node Row)" --count 3 --duration 10
says Bad_TooManyMonitoredItems
chief 0 admin setting set "$url" limits.subscriptions.items 4
chief 0 subscribe "$url" i=2258 i=2259 "$(node Speed)" "$(node Row)" --count 3 --duration 10
says_not Bad_TooManyMonitoredItems
"$controller" --print-limits controller.toml > out || fail "--print-limits"
last="--print-limits"
says 'limits.subscriptions\|items'

# Values of RETAIN variables.
told 'none of these'
chief 0 write "$url" "$(node Total)" 77
power_cycle
chief 0 read --value "$url" "$(node Total)"
says '^77$'
chief 1 read "$url" "$(node Secret)"
told 'a line says that it has another type'
sed 's/Total : DINT/Total : LINT/' head.st > press.st
power_cycle
await logged 'retained: Total: has another type'
value Total 5
is_kept() { # NAME: the journal has a write of it
    grep -q -a -s "$1" state/retained.journal-?
}
journal() { ls state/retained.journal-? | head -n 1; }
cp head.st press.st
power_cycle
told 'a line says that a write of'
chief 0 write "$url" "$(node Total)" 78
await is_kept Total
chief 0 write "$url" "$(node Total)" 79
power_cut
head -c $(($(wc -c < "$(journal)") - 3)) "$(journal)" > cut
cat cut > "$(journal)"
serve --config controller.toml
logged 'retained.journal-[12]: the write at byte [0-9]* was cut off' || fail "no line"
value Total 78
told 'a line says that one is damaged'
for count in 80 81 82 83 84; do
    chief 0 write "$url" "$(node Total)" "$count"
    power_cut
    grep -q -a -s Total "$(journal)" && break
    serve --config controller.toml
done
printf 'X' | dd of="$(journal)" bs=1 seek=40 conv=notrunc 2> /dev/null
serve --config controller.toml
logged 'is damaged, and is left out' || fail "no line of the damage"
ls state/*.kept > /dev/null || fail "what was damaged is lost"
chief 0 write "$url" "$(node Total)" 90
power_cycle
value Total 90

# What the program changes is saved now and then, and at an orderly end.
told 'its value is some seconds old'
total() {
    chief 0 read --value "$url" "$(node Total)"
    tail -n 1 out
}
power_cut
configure 'retained_ms = 3600000'
printf '[[plc.program]]\nkind = "increment"\ntarget = "Total"\n' >> controller.toml
serve --config controller.toml
before=$(total)
further() { [ "$(total)" -gt $((before + 50)) ]; }
await further
before=$(total)
power_cycle
[ "$(total)" -lt "$before" ] || fail "$(total) was kept of $before"
await further
before=$(total)
shut_down
serve --config controller.toml
[ "$(total)" -ge "$before" ] || fail "$(total) is there instead of $before"
power_cut
sed -i 's/^retained_ms.*/retained_ms = 100/' controller.toml
serve --config controller.toml
before=$(total)
await further
sleep 1
power_cycle
[ "$(total)" -gt "$before" ] || fail "$(total) is there, and $before was long before"

# The task stands still: what was is read with that quality, and nothing is written.
told 'Bad_NoCommunication, or Uncertain_LastUsableValue'
as engineer 0 call "$url" "nsu=urn:busbar:machine;s=Machine/Hardware" Simulate "major fault"
refused() {
    ends_with 3 --user chief --password-file password --trust write "$url" "$(node Speed)" 3
}
await refused
says Bad_NoCommunication
chief 0 --json read "$url" "$(node Speed)"
says Uncertain_LastUsableValue
chief 0 admin status "$url"
says '00000001 Controller Major Fault.*Remove the cause'
restart
chief 0 write "$url" "$(node Speed)" 3
chief 0 admin status "$url"
says '^Current errors: *none$'
shut_down
finish
