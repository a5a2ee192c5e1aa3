#!/bin/sh
# The program of a controller, at the machine and from afar: checked, compared, edited online,
# downloaded and taken back, and the mode that a download waits for (W588, 3-3-2, 4-1-4 and
# 8-1). After each step the power goes, and what was acknowledged is there again.
# usage: program_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"

gone() {
    chief 1 read --value "$url" "nsu=urn:busbar:machine;s=$1"
    says 'Bad_NodeIdUnknown'
}
mode_is() {
    chief 0 admin mode "$url"
    says "^$1\$"
    value Controller/DeviceState/Mode "$1"
}

{
    server "$port" pki
    account designer '"Engineer"'
    account operator '"Operator"'
    machine 'mode = "RUN"
retained_ms = 100'
} > controller.toml
# program FILE SPEED [MORE [RETAIN]]: the value of Speed, and declarations.
program() {
    cat > "$1" << END
{attribute 'publish' := 'publish only'}
VAR_GLOBAL
    Speed : $2;
    ${3:-}
END_VAR
{attribute 'publish' := 'publish only'}
VAR_GLOBAL RETAIN
    Total : DINT := 5;
    ${4:-}
END_VAR
END
}
program press.st 'INT := 17' 'Depth : INT := 3; Width : INT := 8;'

begin pki --config controller.toml
value Speed 17

# Who may: administrator and designer.
as designer 0 admin program show "$url"
says 'press.st'
as operator 1 admin program show "$url"
says 'role Engineer'
as operator 1 admin mode "$url" program --yes

# A file that is wrong, and what a program comes to.
program bad.st 'INTEGER'
as designer 1 admin program check "$url" bad.st
says 'bad.st:3:5: .*(Speed): .* INTEGER'
as designer 1 admin program edit "$url" bad.st --yes
says 'nothing was changed'
program edited.st 'INT := 17' 'Depth : INT := 3; Fresh : INT := 21;' 'Kept : INT := 1;'
as designer 0 admin program check "$url" edited.st
says 'an online edit takes it'
program other.st 'REAL := 2.5'
as designer 0 admin program check "$url" other.st
says 'takes a download: other.st:3:5: variables.*(Speed): .*had another type.*'
says 'waits until the machine is not in RUN'
as designer 1 admin program compare "$url" edited.st
says 'variable Fresh .*INT := 21, published .*not there'
says 'variable Width .*not there .*INT := 8'
as designer 0 admin program compare "$url" press.st
says 'no differences'

entry variables 3-3-2: add and delete, by download and online
# An online edit in RUN: what is deleted goes, and nobody has to connect again.
one_step
timeout 60 "$busbar" --user chief --password-file password --trust --json subscribe "$url" \
    "nsu=urn:busbar:machine;s=Speed" "nsu=urn:busbar:machine;s=Width" --interval 50 \
    --duration 60 > followed 2>&1 < /dev/null &
follower=$!
await grep -q -s '"value":8\b' followed
as designer 0 admin program edit "$url" edited.st --yes
says 'edited online'
await grep -q -s 'Bad_NodeIdUnknown' followed
grep -q -s 'connection lost' followed && fail "a client had to connect again"
kill -INT "$follower"
wait "$follower"
step_ends
value Fresh 21
gone Width
chief 0 write "$url" "nsu=urn:busbar:machine;s=Kept" 77
await grep -q -s Kept state/retained
sleep_scans() { chief 0 read --value "$url" "nsu=urn:busbar:machine;s=Kept"; grep -q 77 out; }
await sleep_scans
power_cycle
value Fresh 21
gone Width
chief 0 admin program show "$url"
says 'edited.st'
says 'sent over OPC UA by designer at .*it is used instead of press.st, which is different'
chief 0 admin program show "$url" --save saved.st
cmp -s saved.st edited.st || fail "the program that runs is not the one that was sent"

# The file is not used, and a user who changes it is told so.
program press.st 'INT := 18'
hang_up 'press.st is not used: edited.st, which was sent over OPC UA, is'
value Speed 17

# A download waits for PROGRAM, and the mode changes while sessions go on.
as designer 1 admin program download "$url" other.st --yes
says 'waits until the machine is not in RUN'
mode_is RUN
power_cycle
mode_is RUN
as designer 0 admin mode "$url" program --yes
mode_is PROGRAM
power_cycle
mode_is PROGRAM
as designer 0 admin program download "$url" other.st --yes
says 'downloaded'
power_cycle
value Speed 2.5
gone Fresh
as designer 0 admin program download "$url" edited.st --yes
await logged 'downloaded: edited.st'
value Speed 17
value Fresh 21

# Back to the file.
one_step
as designer 0 admin program restore "$url" --yes
await logged 'press.st'
value Speed 17 # an online edit: the variable stays what it is
gone Fresh
as designer 1 admin program restore "$url" --yes
says "the program is the file's already"
step_ends
power_cycle
value Speed 18
chief 0 admin program show "$url"
says '^from: *press.st$'

# RUN after PROGRAM by SIGHUP: an administrator's word counts, and the log says so; without one the
# file's does.
hang_up 'changed online, and used instead of the file: machine.mode'
mode_is PROGRAM
one_step
as designer 0 admin mode "$url" run --yes
sed -i 's/^mode = "RUN"/mode = "PROGRAM"/' controller.toml
hang_up 'the machine is in PROGRAM'
mode_is PROGRAM
sed -i 's/^mode = "PROGRAM"/mode = "RUN"/' controller.toml
kill -HUP "$pid"
in_run() { [ "$(grep -c 'the machine is in RUN' log)" -eq 2 ]; }
await in_run
step_ends
mode_is RUN
power_cycle
mode_is RUN

# What was changed online is dropped at the machine: settings, and the program that was sent. It
# does not come back, either, where the configuration is damaged later.
program sent.st 'INT := 18' 'Depth : INT := 3;'
as designer 0 admin program edit "$url" sent.st --yes
value Depth 3
chief 0 admin setting set "$url" limits.sessions 30
power_cut
"$controller" --config controller.toml --forget-changes || fail "nothing is forgotten"
cp controller.toml good.toml
for damage in '' '[[['; do
    { cat good.toml; echo "$damage"; } > controller.toml
    serve --config controller.toml
    value Speed 18
    gone Depth
    chief 0 admin program show "$url"
    says '^from: *press.st$'
    chief 0 admin setting list "$url" limits.sessions
    says 'limits.sessions *100\( \|$\)'
    power_cut
done
cp good.toml controller.toml
serve --config controller.toml

# What was sent and is damaged since keeps nobody from starting.
as designer 0 admin program edit "$url" press.st --yes
power_cycle
echo damaged >> pki/program.received
power_cycle
logged 'program.received.*; it begins with what it ran with last' || fail "damage: no line"
value Speed 18
# Nor does it keep a file that was changed meanwhile out of force.
echo damaged >> pki/program.received
power_cut
cp controller.toml before.toml
sed -i 's/^\[limits\]$/&\nsessions = 31/' controller.toml
serve --config controller.toml
value Speed 18
as chief 0 admin setting list "$url" limits.sessions
says 'limits.sessions *31\( \|$\)'
power_cut
cp before.toml controller.toml
serve --config controller.toml

# Whoever has the machine, and nobody to ask, drops what was sent: readable or not.
forget() {
    shut_down
    "$controller" --config controller.toml --forget-changes > out || fail "nothing is forgotten"
}
forget
says 'forgot a program that was sent, and cannot be read'
serve --config controller.toml
as designer 0 admin mode "$url" program --yes
as designer 0 admin program download "$url" other.st --yes
forget
says 'forgot the settings that were changed online'
says 'forgot the program other.st that designer sent'
"$controller" --config controller.toml --forget-changes > out || fail "it is no error"
says 'nothing was changed online'
serve --config controller.toml
as chief 0 admin program show "$url"
says '^from: *press.st$'
mode_is RUN
power_cycle
value Speed 18
shut_down
finish
