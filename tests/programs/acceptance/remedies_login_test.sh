#!/bin/sh
# What the troubleshooting says is done about logins and what users may: the trouble is there, the
# remedy is a command that exists, and it helps (W588, 9-3; TROUBLESHOOTING.md).
# usage: remedies_login_test.sh CONTROLLER BUSBAR
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
press 17 > press.st
echo wrong > wrong
echo Patience123456 > good
echo Patience654321 > better
# login CODE USER FILE
login() { run "$1" --user "$2" --password-file "$3" --trust read "$url" i=2259; }
begin pki --config controller.toml
entry variables 9-3: remedies
one_step # what is to be there after a power cut is in other scripts

remedy 9-3.27 9-3.28
told 'Bad_UserAccessDenied | name or password is wrong'
login 4 op wrong
recorded AUTH 0002 'ERROR op BadUserAccessDenied'
in_events 85600000
login 0 op password
login 4 night good
recorded AUTH 0002 'ERROR night BadUserAccessDenied'
chief 0 admin user list "$url"
says_not '^night'
chief 0 admin user add "$url" night --new-password-file good
chief 0 admin user list "$url"
says '^night'
login 0 night good

remedy 9-3.29
told 'Bad_UserAccessDenied | an administrator changed the password'
chief 0 admin user password "$url" night --new-password-file better
recorded AUTH 0100 Update
login 4 night good
login 0 night better
chief 0 admin user remove "$url" night --yes
login 4 night better
chief 0 admin user add "$url" night --new-password-file good
login 0 night good

remedy 9-3.31
told 'Bad_IdentityTokenRejected'
run 4 --trust read "$url" i=2259
says 'log in with --user'
recorded AUTH 0002 'ERROR'
login 0 op password
chief 0 admin setting set "$url" users.anonymous read
says_not 'restart' # it counts at once
run 0 --trust read "$url" i=2259

remedy 9-3.30
run 0 --pki user cert create
certificate=$(ls user/own/certs/*.der)
key=$(ls user/own/private/*.pem)
with_certificate() {
    run "$1" --user-certificate "$certificate" --user-key "$key" --trust read "$url" i=2259
}
with_certificate 4
says 'log in with --user'
login 0 op password
power_cut
sed -i 's/^\[users\]$/&\ncertificates = "read"/' controller.toml
serve --config controller.toml
with_certificate 4
chief 0 admin trust list "$url" --users
chief 0 admin trust move "$url" --users "$(sed -n 's/^rejected .* \([0-9A-F]*\)$/\1/p' out)"
with_certificate 0

# After some attempts the user has to wait for five minutes. A lock of a second is waited for.
power_cut
cp controller.toml quick.toml
sed -i 's/^\(first\|max\)_login_delay_ms.*/\1_login_delay_ms = 100/' controller.toml
serve --config controller.toml
fails_often() {
    for _ in 1 2 3 4 5 6; do
        login 4 night wrong
    done
}
fails_often
login 4 night good
logged 'login lock-out failed: user "night"' || fail "the log does not say why"
power_cut
sed -i 's/^\[limits\]$/&\nlogin_lock_ms = 1000/' controller.toml
serve --config controller.toml
fails_often
await ends_with 0 --user night --password-file good --trust read "$url" i=2259
power_cut
cp quick.toml controller.toml
serve --config controller.toml

# Who may only read gets a role.
told 'Bad_UserAccessDenied | the account may only read |'
run 4 --user night --password-file good --trust write "$url" "$(node Speed)" 1
says Bad_UserAccessDenied
chief 0 admin role grant "$url" night Operator
run 0 --user night --password-file good --trust write "$url" "$(node Speed)" 1

# The lists of users and roles are damaged: their last good copies are used. Without these nobody
# may do more than before.
told '`users.json` or `roles.json`, "which is kept beside it as .refused, and its last good' \
    'copy is used"'
chief 0 admin backup "$url" whole.backup
ls pki/*.json > lists
operator_endpoints=i=15423
for list in users.json roles.json; do
    [ -s pki/$list ] || fail "there is no $list: $(cat lists)"
    power_cut
    echo damaged > pki/$list
    serve --config controller.toml
    logged "$list.*which is kept beside it as .refused, and its last good copy is used" ||
        fail "$list: no line of the copy"
    run 0 --user night --password-file good --trust write "$url" "$(node Speed)" 1
    power_cut
    echo damaged > pki/$list
    echo damaged > pki/taken-over/$list
    serve --config controller.toml
    logged "$list.*is not used" || fail "$list: no line"
    [ "$(cat pki/$list.refused)" = damaged ] || fail "$list is lost"
    in_events 00000004
    if [ $list = users.json ]; then
        told '`users.json`, "which is kept beside it as .refused and is not used"'
        login 4 night good
        chief 0 admin user add "$url" night --new-password-file good
    else
        told '`roles.json`, "every role but SecurityAdmin is closed'
        chief 0 write "$url" "$operator_endpoints" true # EndpointsExclude
        run 4 --user night --password-file good --trust write "$url" "$(node Speed)" 1
        chief 0 admin role grant "$url" night Operator
    fi
    run 0 --user night --password-file good --trust write "$url" "$(node Speed)" 1
    power_cycle
    chief 0 admin status "$url"
    says '^Pending changes: *none$'
done
power_cut
echo damaged > pki/users.json
echo damaged > pki/taken-over/users.json
serve --config controller.toml
login 4 night good
chief 0 admin restore "$url" whole.backup --yes
power_cycle
run 0 --user night --password-file good --trust write "$url" "$(node Speed)" 1
shut_down
finish
