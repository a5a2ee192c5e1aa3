#!/bin/sh
# The security settings: users, names and passwords, anonymous logins, policies and modes, each as a
# whole and not in RUN; and connections with each of them (W588, 3-2-6, 5-1-2, 5-2 and 6-1).
# usage: users_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
. "$here/certificates.sh"

echo "Ab345678" > good
echo "Cd345678" > better
echo "Ab1" > short
{
    server "$port" pki | sed 's/^\[limits\]/[limits]\npreset = "nj501"/'
    machine 'mode = "PROGRAM"'
} > controller.toml
press 17 > press.st
begin pki --config controller.toml
add() { chief "$1" admin user add "$url" "$2" --new-password-file "$3"; }

entry variables 3-2-6: users
one_step
for n in $(seq 20); do
    add 0 "user$n" good
done
add 1 user21 good
step_ends
chief 0 admin user list "$url"
[ "$(grep -c '^user' out)" -eq 20 ] || fail "there are not 20 users"
chief 0 admin user remove "$url" user19 --yes
run 4 --user user19 --password-file good --trust admin status "$url"
chief 0 admin role grant "$url" user1 Operator
run 0 --user user1 --password-file good --trust admin status "$url"
chief 0 admin user password "$url" user1 --new-password-file better
run 4 --user user1 --password-file good --trust admin status "$url"
run 0 --user user1 --password-file better --trust admin status "$url"
# Who changes his own gives the current one, as the dialogue of 3-2-6 asks for it.
as user1 4 admin user password "$url" user1 --new-password-file password
run 1 --user user1 --password-file better --trust admin user password "$url" user2 \
    --new-password-file good
run 1 --user user1 --password-file better --trust admin user password "$url" user1 \
    --new-password-file short
one_step
run 0 --user user1 --password-file better --trust admin user password "$url" user1 \
    --new-password-file good
step_ends
run 4 --user user1 --password-file better --trust admin status "$url"
run 0 --user user1 --password-file good --trust admin status "$url"
# An administrator does not: a user has another password because the current one is forgotten.

entry variables 3-2-6: names and passwords
for name in abc "$(printf 'a%.0s' $(seq 33))" 'with_line' 'with space' 'umläut' 'Administrator' \
    'designer' 'MAINTAINER' 'Operator' 'observer' 'anonymous' 'Anonymous'; do
    add 1 "$name" good
done
for password in Ab34567 "A1$(printf 'b%.0s' $(seq 31))" 'with_line1' 'with space1' 'umläut12'; do
    echo "$password" > bad
    add 1 goodname bad
done
one_step
add 0 ABcd good
chief 0 admin user remove "$url" ABcd --yes
add 0 "$(printf 'a%.0s' $(seq 32))" good
step_ends
run 4 --user ABCD --password-file good --trust admin status "$url"

entry variables 3-2-6: anonymous
run 4 --trust read "$url" i=2259
one_step # at once, and after a start
chief 0 admin setting set "$url" users.anonymous read
says_not 'restart'
run 0 --trust read --value "$url" "$(node Speed)"
run 4 --trust write "$url" "$(node Speed)" 5
step_ends
cycle_when_due
run 0 --trust read --value "$url" "$(node Speed)"
one_step
chief 0 admin setting set "$url" users.anonymous write
run 0 --trust write "$url" "$(node Speed)" 5
# Who is in goes with the right to be.
timeout 60 "$busbar" --trust subscribe "$url" "$(node Speed)" > stream 2>&1 < /dev/null &
stream=$!
await grep -q '  5$' stream
chief 0 admin setting set "$url" users.anonymous no
says_not 'restart'
run 4 --trust read "$url" i=2259
await grep -q 'Bad_' stream
kill "$stream" 2> /dev/null
step_ends
cycle_when_due
run 4 --trust read "$url" i=2259

# The default is Prohibit, not Permit: clients without a name write no variables of a machine unless
# that is set.
departs users.anonymous '\\"write' 3-2-6

entry variables 5-1-2: user authentication
run 4 --user user2 --password-file better --trust read "$url" i=2259
await has_record 'AUTH 0002 User ERROR user2 BadUserAccessDenied$'
chief 0 admin role grant "$url" user2 Operator
says_not 'is not a user'
chief 0 admin role grant "$url" nobody Operator # who may come with a token
says 'nobody is not a user of the server'
chief 0 admin role list "$url"
says 'user nobody'
chief 0 admin role revoke "$url" nobody Operator
as_user2() {
    cycle_when_due
    # shellcheck disable=SC2086 # nothing, or a word
    run "$1" --user user2 --password-file good --trust "$2" "$url" "$(node Speed)" $3
}
as_user2 0 write 8
await has_record 'AUTH 0002 User Success 0x[0-9A-F]* user2$'
run 0 --user user2 --password-file good --trust read --value "$url" "$(node Speed)"
says '^8$'
# The manual's "access to all, fixed": every user who logs in writes, also who is added later.
chief 2 admin role grant "$url" user3 Operator --everyone
says 'expected ROLE, as --everyone takes the place of USER'
chief 0 admin role grant "$url" Operator --everyone
says 'every user who logs in has the role Operator'
chief 0 admin user remove "$url" user18 --yes
add 0 another good
as_another() {
    cycle_when_due
    # shellcheck disable=SC2086 # nothing, or a word
    run "$1" --user another --password-file good --trust "$2" "$url" "$(node Speed)" $3
}
as_another 0 write 9
chief 0 admin role list "$url"
says '^Operator .*authenticated user'
chief 0 admin role revoke "$url" Operator --everyone
as_another 0 read ''
as_another 4 write 10
as_user2 0 write 8

entry variables 3-2-6: policies
entry variables 5-2: signature and encryption
# The policies of SHA-1 are tried in machine_limits_test.sh.
# By default there are those without SHA-1 and with protection: 3-2-6 itself has None cleared for
# security.
departs endpoint None 3-2-6
both="\"{ mode = 'SignAndEncrypt', policy = 'Basic256Sha256' }\",
    \"{ mode = 'Sign', policy = 'Basic256Sha256' }\", \"{ mode = 'None', policy = 'None' }\""
one_step
chief 0 admin setting set "$url" endpoint "[$both]"
run 0 endpoints "$url"
says '^SignAndEncrypt  *Basic256Sha256'
says '^Sign  *Basic256Sha256'
says '^None  *None'
chief 0 admin setting reset "$url" endpoint
run 0 endpoints "$url"
says '^SignAndEncrypt  *Basic256Sha256'
says_not '^None'
step_ends

entry variables 3-2-6: transfer as one set
chief 1 admin setting set "$url" users.anonymous read endpoint '["nonsense"]'
chief 0 admin setting list "$url" users.anonymous
says '^users.anonymous  *"no"'
chief 0 admin mode "$url" run --yes
chief 1 admin setting set "$url" users.anonymous read
add 1 late good
chief 1 admin user password "$url" user2 --new-password-file better
chief 1 admin user remove "$url" user2 --yes
chief 1 admin role grant "$url" user3 Operator
chief 1 admin setting set "$url" endpoint "[$both]"
as_user2 0 read ''
shut_down

entry variables 6-1: connecting
serve --config controller.toml
[ "$url" = "opc.tcp://127.0.0.1:$port" ] || fail "the end point is $url"
for name in 127.0.0.1 localhost; do
    run 0 --user user2 --password-file good --trust read "opc.tcp://$name:$port" "$(node Speed)"
    run 0 --user user2 --password-file good --trust read "opc.tcp://$name:$port/" "$(node Speed)"
done
entry variables 5-2: signature and encryption
for security in 'Sign --mode Sign' 'None --insecure'; do
    power_cut
    mode=${security%% *} option=${security#* }
    sed "s/^mode = \"SignAndEncrypt\"/mode = \"$mode\"/" controller.toml > other.toml
    [ "$mode" = Sign ] || sed -i 's/^policy = .*/policy = "None"/' other.toml
    serve --config other.toml
    run 0 endpoints "$url"
    says "^$mode  "
    says_not '^SignAndEncrypt'
    # shellcheck disable=SC2086 # words
    run 0 $option --user user2 --password-file good --trust read --value "$url" "$(node Speed)"
done
run 3 --user user2 --password-file good --trust read "opc.tcp://127.0.0.1:$((port + 1))" i=2259
shut_down
finish
