#!/bin/sh
# What the troubleshooting of a controller says is done, by symptom: the command exists, and helps
# (seed 000, 9-3; examples/controller/TROUBLESHOOTING.md).
# usage: remedies_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
takes_long

# event CODE: it is in the event log, with what is to be done.
event() {
    chief 0 admin events "$url" --code "$1"
    says "$1"
    says 'Correction: '
}
# recorded CATEGORY CODE TEXT
recorded() {
    await has_record "$1" "$2" "$3"
}
has_record() {
    cat medium/packages/OPCUA_Server/ExecutionLog/*.log 2> /dev/null | tr '\t\r' '  ' |
        grep -q -e " $1 $2 .*$3"
}
{
    server "$port" pki
    account op '"Operator"'
    machine 'mode = "PROGRAM"'
} | sed 's/^\[limits\]$/[limits]\npreset = "nj501"/' > controller.toml
cat > press.st << 'END'
{attribute 'publish' := 'publish only'}
VAR_GLOBAL
    Speed : INT;
    Name : STRING[4];
    Row : ARRAY [0..1] OF INT;
    Base : ARRAY [1..2] OF INT;
END_VAR
VAR_GLOBAL
    Hidden : INT := 3;
END_VAR
{attribute 'publish' := 'publish only'}
VAR_GLOBAL CONSTANT
    Fixed : INT := 5;
END_VAR
END
begin pki --config controller.toml
entry variables 9-3: remedies
one_step # nothing of it is to be there after a power cut

# A client cannot connect: the URL, its certificate, its policy, its user, and too many of them.
run 3 --timeout 2 endpoints "opc.tcp://127.0.0.1:1"
says 'hint: nothing listens at this port'
run 0 endpoints "$url"
says 'Basic256Sha256'
run 4 --pki stranger --user op --password-file password --trust read "$url" i=2259
says 'have its administrator trust it'
event 85600000
recorded AUTH 0001 'BadSecurityChecksFailed\|BadCertificateUntrusted\|ERROR'
chief 0 admin trust list "$url"
rejected=$(sed -n 's/^rejected .* \([0-9A-F]*\)$/\1/p' out)
chief 0 admin trust move "$url" "$rejected"
run 0 --pki stranger --user op --password-file password --trust read "$url" i=2259
chief 0 admin trust remove "$url" "$rejected" --yes
run 4 --pki stranger --user op --password-file password --trust read "$url" i=2259
run 4 --policy Aes256_Sha256_RsaPss --user op --password-file password --trust read "$url" i=2259
says 'see `busbar endpoints`'
chief 0 admin setting set "$url" endpoint "[\"{ mode = 'SignAndEncrypt', policy = 'Basic256Sha256' }\",
    \"{ mode = 'SignAndEncrypt', policy = 'Aes256_Sha256_RsaPss' }\"]"
await ends_with 0 --policy Aes256_Sha256_RsaPss --user op --password-file password --trust \
    read "$url" i=2259
echo wrong > wrong
run 4 --user op --password-file wrong --trust read "$url" i=2259
recorded AUTH 0002 'op'
run 4 --trust read "$url" i=2259
says 'log in with --user'
chief 0 admin user list "$url"
says '^op'
echo Patience123 > good
chief 0 admin user add "$url" night --new-password-file good
run 0 --user night --password-file good --trust read "$url" i=2259
chief 0 admin setting set "$url" users.anonymous read
says 'wait for a restart: users.anonymous'
chief 0 admin shutdown "$url" --restart --seconds 0 --yes
await ends_with 0 --trust read "$url" i=2259
sleepers=""
for i in 1 2 3 4 5; do
    timeout 60 "$busbar" --user op --password-file password --trust subscribe "$url" i=2258 \
        --duration 60 > "sleeper$i" 2>&1 < /dev/null &
    sleepers="$sleepers $!"
    await grep -q -s '[0-9]' "sleeper$i"
done
run 1 --user op --password-file password --trust read "$url" i=2259
says 'close other clients'
# shellcheck disable=SC2086 # several
kill $sleepers
await ends_with 0 --user op --password-file password --trust read "$url" i=2259

# A certificate that names another host, has expired, or is to have others: another one.
chief 0 admin cert show "$url"
own=$(sed -n 's/^own .* \([0-9A-F]*\)$/\1/p' out)
chief 0 --timeout 30 admin cert regenerate "$url" --host 127.0.0.1 --host press-4 --yes
await reaches admin cert show "$url"
grep -q "$own" out && fail "it has the same certificate"
recorded CERT 0001 'Update_Server'
chief 0 admin events "$url" --code 95D20000
says '95D20000 Server Certificate Generated'

# A variable is not shown, or cannot be read or written.
chief 1 read "$url" "$(node Hidden)"
chief 1 read "$url" "$(node Base)"
recorded SERVER 0101 'Base SubscriptOfArray'
event 35D40000
sed -i "s/    Hidden : INT/    {attribute 'publish' := 'publish only'}\n    Hidden : INT/; s/\[1\.\.2\]/[0..1]/" press.st
hang_up 'press.st'
await reaches read "$url" "$(node Hidden)"
await reaches read "$url" "$(node Base)"
value Controller/DeviceState/UnpublishedVariablesStatus 0
chief 1 write "$url" "$(node Fixed)" 6
says 'Bad_NotWritable'
chief 1 write "$url" "$(node Name)" 'too long'
says 'Bad_OutOfRange'
chief 0 write "$url" "$(node Name)" 'lid'
chief 1 write "$url" "$(node Row)" '[1, 2, 3]'
chief 0 write "$url" "$(node Row)" '[1, 2]'
chief 1 read "$url" "$(node Row[0])"
chief 0 read --value "$url" "$(node Row)"
chief 0 admin user add "$url" look --new-password-file good
run 4 --user look --password-file good --trust write "$url" "$(node Speed)" 1
says 'Bad_UserAccessDenied'
chief 0 admin role grant "$url" look Operator
run 0 --user look --password-file good --trust write "$url" "$(node Speed)" 1

# The program has a mistake: file, line and column; what is mended is taken.
cp press.st good.st
echo 'VAR_GLOBAL' >> press.st
hang_up 'press.st:.*nothing was changed'
chief 0 admin status "$url"
says '^Pending changes: *press.st:'
cp good.st press.st
hang_up 'read again'
chief 0 admin status "$url"
says '^Pending changes: *none$'

# The execution log is empty: its medium is away, and what waited is recorded when it is back.
mv medium gone
as op 0 read "$url" i=2259
sleep 1
mv gone medium
recorded AUTH 0002 op

# It was shut down, or is not to be used: it is started again.
chief 0 admin shutdown "$url" --restart --seconds 0 --yes
is_running() { reaches admin status "$url" && grep -q 'operating status: *Running$' out; }
await is_running
recorded SERVER 0006 Shutdown
event_is() { chief 0 admin events "$url" --code 95D10000 && says 95D10000; }
event_is
step_ends
shut_down
finish
