#!/bin/sh
# A controller whose list of roles or of users is damaged starts, and nobody may do more than before:
# the last good copy is used, and without one all roles but SecurityAdmin are closed.
# usage: damaged_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"

operator_applications=i=15418 operator_endpoints=i=15423 # ApplicationsExclude, EndpointsExclude
{
    server "$port" pki
    account operator '"Operator"'
    machine 'mode = "PROGRAM"'
} > controller.toml
press 0 > press.st
begin pki --config controller.toml

# Operators are to come by certain applications only, of which there are none yet.
as operator 0 admin log "$url"
chief 0 write "$url" "$operator_applications" false
as operator 1 admin log "$url"
chief 0 admin user add "$url" pat --new-password-file password
as pat 0 read "$url" i=2259

# The list is cut short, the power goes: the copy counts, and it says so.
# told '`users.json` or `roles.json`, "which is kept beside it as .refused, and its last good copy is used"'
is_as_before() {
    logged "$1.*, which is kept beside it as .refused, and its last good copy is used" ||
        fail "$1: the log does not say so"
    chief 0 admin status "$url"
    says "^Pending changes: .*$1.*last good copy is used"
    as operator 1 admin log "$url"
    as pat 0 read "$url" i=2259
}
one_step # the status tells of the start
printf '{"version":1,"roles":[{"na' > pki/roles.json
power_cycle
is_as_before roles.json
printf '' > pki/roles.json
power_cycle
is_as_before roles.json
printf '{"version":1,"use' > pki/users.json
power_cycle
is_as_before users.json
[ "$(cat pki/users.json.refused)" = '{"version":1,"use' ] || fail "what was there is lost"
step_ends
power_cycle
logged 'last good copy is used' && fail "the copy counts though nothing is wrong"
as operator 1 admin log "$url"

# Without a copy all is closed to all but the administrator, who opens it.
# told '`roles.json`, "every role but SecurityAdmin is closed until an administrator opens it"'
one_step
echo damage > pki/roles.json
echo damage > pki/taken-over/roles.json
power_cycle
logged 'roles.json.* is not used; every role but SecurityAdmin is closed' || fail "no line"
chief 0 admin status "$url"
says '^Pending changes: .*every role but SecurityAdmin is closed until an administrator opens it'
as operator 1 admin log "$url"
step_ends
chief 0 write "$url" "$operator_endpoints" true
as operator 0 admin log "$url"

# Without a copy its users are gone, until an administrator adds them again.
# told '`users.json`, "which is kept beside it as .refused and is not used"'
one_step
echo damage > pki/users.json
echo damage > pki/taken-over/users.json
power_cycle
logged 'users.json.* is not used' || fail "no line"
as pat 4 read "$url" i=2259
chief 0 admin user add "$url" pat --new-password-file password
as pat 0 read "$url" i=2259
step_ends
finish
