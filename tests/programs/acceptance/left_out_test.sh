#!/bin/sh
# A program of which something cannot be served: it starts without that, says why, and does not
# become less by a mistake in a file.
# usage: left_out_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"

{
    server "$port" pki
    account designer '"Engineer"'
    machine 'mode = "RUN"'
} > controller.toml
# program FILE [MORE]: a block of variables as a development system has them.
program() {
    cat > "$1" << END
FUNCTION_BLOCK Ramp
VAR_INPUT
    Target : REAL;
END_VAR
    Actual := Actual + 0.1;
END_FUNCTION_BLOCK
{attribute 'publish' := 'publish only'}
VAR_GLOBAL
    Speed : INT := 17;
    Delay : TON;
    Slope : Ramp;
    ${2:-}
END_VAR
VAR_GLOBAL
    Next : POINTER TO INT;
END_VAR
END
}
# check STATUS FILE...: what --check says before anything runs.
check() {
    wanted=$1
    shift
    last="--check $*"
    "$controller" --check "$@" > out 2>&1
    status=$?
    [ $status -eq "$wanted" ] || fail "--check $*: exit code $status instead of $wanted"
}
program press.st

check 1 press.st
says '^press.st: 1 variables are published with 1 values .*; 2 are not .*; 1 other'
says '^  published *Speed '
says '^  not published *Delay *10:5: .*is of the type TON, which is not declared$'
says '^  not published *Slope *11:5: .*is of the type Ramp, which is a function block$'
says '^  left out *15:.* is of the type POINTER, which is not served$'
check 1 press.st --json
says '"name":"Slope","reason":"Unserved"'
printf 'VAR_GLOBAL\n    Speed : INT;\nEND_VAR\n' > good.st
check 0 good.st
printf 'Dear colleague,\nhere is the program.\n' > letter.st
check 1 letter.st
says "^letter.st is refused: letter.st:1:1: found 'Dear'"

# told 'SERVER 0101 names it with'
# It starts, with the event of variables that cannot be published (W588, 9-2-2).
begin pki --config controller.toml
value Speed 17
chief 1 read --value "$url" "$(node Delay)"
says 'Bad_NodeIdUnknown'
await logged 'Delay is not published: 10:5: .*TON'
await logged 'left out: press.st:15:.*POINTER'
chief 0 admin events "$url"
says '35D40000 Unsupported Data Type: 0100'

# What it left out before it leaves out again; what is new has to be meant.
# told 'a changed program is refused because of such a declaration'
program edited.st 'Width : INT := 8;'
as designer 0 admin program check "$url" edited.st
says 'left out: edited.st:10:5: .*TON'
says 'an online edit takes it'
as designer 0 admin program edit "$url" edited.st --yes
value Width 8
program worse.st 'Width : INTEGER;'
as designer 1 admin program check "$url" worse.st
says 'worse.st:12:5: .*(Width): .* INTEGER'
as designer 1 admin program edit "$url" worse.st --yes
says 'nothing was changed'
value Width 8
as designer 0 admin program edit "$url" worse.st --yes --leave-out
says 'left out: worse.st:12:5: .*(Width): .* INTEGER'
chief 1 read --value "$url" "$(node Width)"
says 'Bad_NodeIdUnknown'
as designer 0 admin program restore "$url" --yes

# The same for the controller's own file, while it runs and at a start.
program press.st 'Height : INTEGER;'
hang_up 'press.st:12:5: .*(Height): .* INTEGER.*; nothing was changed'
value Speed 17
power_cycle
value Speed 17
chief 0 admin status "$url"
says '^Pending changes: *press.st:12:5: .*ran with last'
sed 's/^\[machine\].*/&\nstrict = false/' controller.toml > lenient.toml
mv lenient.toml controller.toml
power_cycle
value Speed 17
chief 0 admin status "$url"
says '^Pending changes: *none'
await logged 'Height is not published'
sed 's/^strict = false/strict = true/' controller.toml > strict.toml
mv strict.toml controller.toml
power_cycle
value Speed 17
chief 0 admin status "$url"
says '^Pending changes: *press.st:1:1: .*FUNCTION_BLOCK.*ran with last'

# A file that was damaged meanwhile is no program to go back to, unless that is meant.
sed '/^strict = /d' controller.toml > plain.toml
mv plain.toml controller.toml
program press.st
power_cycle
value Speed 17
program sent.st 'Depth : INT := 3;'
as designer 0 admin program edit "$url" sent.st --yes
program press.st 'Depth : INTEGER;'
as designer 1 admin program restore "$url" --yes
says 'press.st:12:5: .*(Depth): .* INTEGER'
says 'nothing was changed'
value Depth 3
as designer 0 admin program restore "$url" --yes --leave-out
chief 1 read --value "$url" "$(node Depth)"
says 'Bad_NodeIdUnknown'
finish
