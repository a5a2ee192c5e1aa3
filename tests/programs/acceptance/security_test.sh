#!/bin/sh
# Who may come in and how changes in PROGRAM only, and the logs have it (W588, 3-2-6 and 4-2-5).
# usage: security_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"

# count CATEGORY CODE: how many records of these the execution log has.
count() {
    cat medium/packages/OPCUA_Server/ExecutionLog/*.log 2> /dev/null | tr '\t' ' ' |
        grep -c " $1 $2 "
}
has() { [ "$(count "$1" "$2")" -ge "$3" ]; }
echo "patience is more" > other
{
    server "$port" pki
    machine
} > controller.toml
press 0 > press.st

begin pki --config controller.toml
await has SERVER 0005 1
[ "$(count SERVER 0004)" -eq "$(count SERVER 0005)" ] || fail "0004 does not go with 0005"

# In RUN users, passwords and roles stay.
chief 1 admin user add "$url" pat --new-password-file other
grep -q 'Bad_InvalidState' out || fail "a user in RUN: $(cat out)"
chief 1 admin role grant "$url" chief Supervisor
grep -q 'Bad_InvalidState' out || fail "a role in RUN: $(cat out)"
logged 'users and roles failed: cannot change while the machine is in RUN' ||
    fail "the log has no reason"
chief 1 admin setting set "$url" users.anonymous read
# Nor by the file: they wait for PROGRAM, and the status says so.
one_step
cp controller.toml before.toml
account late '"Operator"' >> controller.toml
hang_up 'users and roles: cannot change while the machine is in RUN.*nothing was changed'
as late 4 read "$url" i=2259
chief 0 admin status "$url"
says '^Pending changes: .*users and roles: cannot change while the machine is in RUN'
cp before.toml controller.toml
hang_up 'read again'
chief 0 admin status "$url"
says '^Pending changes: *none$'
step_ends
# Other settings change, and neither that nor a file that is as it was is a change of security.
chief 0 admin setting set "$url" limits.sessions 40
hang_up 'read again'
chief 0 admin setting set "$url" machine.mode PROGRAM
shut_down
await has SERVER 0006 1
has AUTH 0100 1 && fail "a change of limits is one of security"
# A power cut may come between the two records of a start.
runs=$(count SERVER 0005) starts=$(count SERVER 0004)

one_step # starts are counted
# In PROGRAM they change, which is logged and reconfigures the server.
serve --config controller.toml
await has SERVER 0005 $((runs + 1))
chief 0 admin user add "$url" pat --new-password-file other
await has AUTH 0100 1
await has SERVER 0005 $((runs + 2))
chief 0 admin role grant "$url" pat Operator
await has AUTH 0100 2
await has SERVER 0005 $((runs + 3))
[ $(($(count SERVER 0004) - starts)) -eq $(($(count SERVER 0005) - runs)) ] ||
    fail "0004 does not go with 0005"
run 0 --user pat --password-file other --trust write "$url" "$(node Speed)" 7
chief 0 admin setting set "$url" endpoint "[\"{ mode = 'SignAndEncrypt', policy = 'Basic256Sha256' }\",
    \"{ mode = 'SignAndEncrypt', policy = 'Aes256_Sha256_RsaPss' }\"]"
await has AUTH 0100 3
await has SERVER 0005 $((runs + 4))
# Once each, and nothing for what is no change of security.
chief 0 admin setting set "$url" limits.sessions 41
kill -HUP "$pid"
chief 0 read --value "$url" "$(node Speed)"
# Taking back the policy that the command itself has come by is answered before it goes.
chief 0 admin setting reset "$url" endpoint
says '^changed'
await has AUTH 0100 4
await has SERVER 0005 $((runs + 5))
chief 0 admin setting list "$url" --changed
grep -q '^endpoint ' out && fail "the endpoints are still others than the file's"
# An account of the file, changed at the machine.
sed -i 's/"ConfigureAdmin", //' controller.toml
kill -HUP "$pid"
await has AUTH 0100 5
await has SERVER 0005 $((runs + 6))
shut_down
await has SERVER 0006 2
[ "$(count AUTH 0100)" -eq 5 ] || fail "$(count AUTH 0100) changes of security instead of 5"
[ "$(count SERVER 0005)" -eq $((runs + 6)) ] || fail "$(count SERVER 0005) starts"
finish
