#!/bin/sh
# Who may do what (W588, 8-1): each of the 25 rows of the manual's table, tried by a user of
# each of its five levels. Who may not is refused with a reason, and has changed nothing.
# usage: authorities_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
. "$here/certificates.sh"

{
    server "$port" pki | sed 's/^password_iterations.*/&\nauthorities = "five levels"/'
    account engineer '"Engineer"'
    account fitter '"Supervisor"'
    account op '"Operator"'
    account watcher '"Observer"'
    machine 'mode = "PROGRAM"'
} > controller.toml
press 17 > press.st
begin pki --config controller.toml
one_step # or power went a hundred times; what was changed is looked at after a cut below

rows=0
# row LEVEL ARGUMENTS...: this user may, and those above; those below may not, and are asked first.
row() {
    from=$1 is_reached=""
    shift
    rows=$((rows + 1))
    for user in watcher op fitter engineer chief; do
        [ "$user" != "$from" ] || is_reached=yes
        if [ -n "$is_reached" ]; then
            as $user 0 "$@"
        else
            is_refused_to $user "$@"
        fi
    done
}
is_refused_to() {
    last="busbar --user $*"
    timeout 60 "$busbar" --password-file password --trust --user "$@" > out 2>&1 < /dev/null
    code=$?
    [ $code -eq 1 ] || [ $code -eq 4 ] || fail "$last: exit code $code instead of 1 or 4"
    says '^busbar: '
}

application
authority root
authority deep
authority old
revoking root
revoking deep
client new
client stranger
cp stranger.der pki/rejected/certs/
openssl x509 -in old.pem -outform DER -out pki/rejected/certs/old.der

entry variables 8-1: authorities
# Server certificate.
row op admin cert show "$url"
row chief admin cert export "$url" own.der
# Client authentication.
row op admin trust list "$url"
row chief admin trust add "$url" new.der
row op admin trust show "$url" "$(thumbprint_of new.pem)"
row chief admin trust remove "$url" "$(thumbprint_of new.pem)" --yes
row chief admin trust move "$url" "$(thumbprint_of stranger.pem)"
chief 0 admin trust add "$url" root.pem
row chief admin trust add "$url" root.crl
row op admin trust show "$url" "$(print_of root.crl)"
row chief admin trust remove "$url" "$(print_of root.crl)" --yes
# Issuer authentication.
row op admin trust list "$url" --sort validity
says '^trusted *root '
says '^rejected *old '
row chief admin trust add "$url" --issuer deep.pem
row op admin trust show "$url" "$(thumbprint_of deep.pem)"
row chief admin trust move "$url" --issuer "$(thumbprint_of old.pem)"
row chief admin trust remove "$url" "$(thumbprint_of old.pem)" --yes
row chief admin trust add "$url" deep.crl
row op admin trust show "$url" "$(print_of deep.crl)"
row chief admin trust remove "$url" "$(print_of deep.crl)" --yes
# Security settings: users, anonymous, policies.
row op admin user list "$url"
rows=$((rows - 2)) # which are one of the table's with this
row op admin setting list "$url" users. endpoint
says 'users.anonymous'
row chief admin setting set "$url" users.anonymous read
row chief admin user add "$url" newbie --new-password-file password
# Service status.
row op admin status "$url"
for user in watcher op fitter; do
    is_refused_to $user admin shutdown "$url" --restart --seconds 0 --yes
done
for user in engineer chief; do
    restart $user
done
# Execution log.
row op admin log "$url"
row fitter admin log "$url" --clear --yes
# The last one, because clients have to trust it then.
row chief admin cert regenerate "$url" --yes
[ $rows -eq 24 ] || fail "$((rows + 1)) rows were tried instead of 25"
step_ends
chief 0 admin trust list "$url"
says '^trusted *stranger '
says '^issuers *deep '
says_not '^trusted *new '
says_not '^[a-z]* *old '
says_not ' crl '
chief 0 admin user list "$url"
says '^newbie'
shut_down
finish
