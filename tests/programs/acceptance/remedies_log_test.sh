#!/bin/sh
# What the troubleshooting says is done where the execution log is empty, or values cannot be saved:
# the trouble is there, and the remedy helps (W588, 9-3; TROUBLESHOOTING.md). Media that are full
# or write-protected are mounted for it, where that is allowed.
# usage: remedies_log_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
takes_long
. "$here/remedies.sh"

{
    server "$port" pki
    account op '"Operator"'
    machine 'mode = "PROGRAM"'
} > controller.toml
cat > press.st << 'END_OF_PROGRAM'
{attribute 'publish' := 'publish only'}
VAR_GLOBAL RETAIN
    Total : DINT := 5;
END_VAR
END_OF_PROGRAM
# Nobody but root may, and not even root everywhere.
mounts=""
insert() { # FOLDER: an empty medium is there from now on
    mkdir -p "$1"
    mount -t tmpfs -o size=256k tmpfs "$1" 2> /dev/null && mounts="$mounts $1"
}
eject() { umount "$1" 2> /dev/null; }
eject_all() {
    for each in $mounts; do
        umount -l "$each" 2> /dev/null
    done
}
trap 'kill $pid 2>/dev/null; wait; eject_all; rm -rf "$work"' EXIT
# A login is a record.
login() { run 0 --user op --password-file password --trust read "$url" i=2259; }
records() { log_text | grep -c ' AUTH 0002 .*op'; }
has_more_than() { [ "$(records)" -gt "$1" ]; }
# fails_with CODE: records cannot be saved for this reason, which is told once some wait.
fails_with() {
    login
    reaches admin events "$url" --code 15000000 --last 1 && grep -q -e "15000000 .*" out &&
        chief_sees "$1"
}
chief_sees() { reaches admin status "$url" && grep -q -e "15000000.*$1" out; }
is_well() { reaches admin status "$url" && grep -q '^Current errors: *none$' out; }
fill() { dd if=/dev/zero of="$1/filler" bs=4096 2> /dev/null; }
entry variables 9-3: remedies

remedy 9-3.54
told 'no folder at all'
sed '/^execution_log/d' controller.toml > without.toml
begin pki --config without.toml
one_step # what is to be there after a power cut is in other scripts
login
[ -e medium/packages/OPCUA_Server/ExecutionLog ] && fail "there is a folder without the setting"
chief 0 admin setting set "$url" machine.execution_log true
says 'wait for a restart'
restart
login
await has_more_than 0
chief 0 admin log "$url"
says ' Run$'
shut_down
rm -rf medium
insert medium || echo "media cannot be mounted here: those that are full or protected are left out"
serve --config controller.toml

remedy 9-3.52
told '15000000 with 0001'
login
await has_more_than 0
before=$(records)
if [ -n "$mounts" ]; then
    mkdir pulled
    mount --move medium pulled
    # The controller may have written below it in that moment, which a card cannot have.
    until rm -rf medium; do :; done
else
    mv medium pulled
fi
await logged 'the medium is away'
login
if [ -n "$mounts" ]; then
    mkdir medium
    mount --move pulled medium
else
    mv pulled medium
fi
await has_more_than "$before"
await is_well

if [ -n "$mounts" ]; then
    remedy 9-3.53
    told 'with 0003'
    before=$(records)
    mount -o remount,ro medium
    await fails_with 0003
    in_events 15000000
    says 'Correction: .*can be written'
    mount -o remount,rw medium
    await has_more_than "$before"
    await is_well

    told 'with 0005'
    fill medium
    await fails_with 0005
    rm medium/filler
    before=$(records)
    login
    await has_more_than "$before"
    await is_well
fi

told 'with 0002 or 0302'
file=medium/packages/OPCUA_Server/ExecutionLog/OPCUA_ExecutionLog.log
mv $file taken
mkdir $file
await fails_with 0302
[ -z "$mounts" ] || eject medium
rm -rf medium
await logged 'the medium is away'
insert medium || mkdir medium
login
await has_more_than 0
await is_well

# The folder of the values.
if [ -n "$mounts" ]; then
    told 'Bad_ResourceUnavailable'
    told 'a line says that values cannot be saved'
    for trouble in full protected; do
        shut_down
        rm -rf state
        insert state
        serve --config controller.toml
        chief 0 write "$url" "$(node Total)" 6
        if [ $trouble = full ]; then
            fill state
        else
            mount -o remount,ro state
        fi
        refused() { ! reaches write "$url" "$(node Total)" 7; }
        await refused
        grep -q Bad_ResourceUnavailable out || fail "$trouble: $(cat out)"
        await logged 'values.* cannot be saved\|cannot be saved'
        if [ $trouble = full ]; then
            rm state/filler
        else
            mount -o remount,rw state
        fi
        await reaches write "$url" "$(node Total)" 8
        power_cycle
        value Total 8
        shut_down
        eject state
        serve --config controller.toml
    done
fi
shut_down
finish
