#!/bin/sh
# The execution log of a machine, as `busbar admin log` shows, follows, saves and clears it
# (W588, 7-2-2 and 8-1).
# usage: log_test.sh CONTROLLER BUSBAR PROGRAM
set -u
controller=$1 busbar=$2 program=$3
. "$(dirname "$0")/functions.sh"


# as USER CODE ARGUMENTS...: all have one password.
as() {
    user=$1 wanted=$2
    shift 2
    run "$wanted" --user "$user" --password-file password --trust "$@"
}

account() {
    printf '[[users.account]]\nname = "%s"\npassword = "%s"\nroles = ["%s"]\n' "$1" "$hash" "$2"
}

echo "patience is all" > password
hash=$(quick_hash password)
{
    cat << EOF
[server]
port = 0
[certificates]
folder = "pki"
[machine]
program = "$program"
state = "state"
medium = "medium"
execution_log = true
[[endpoint]]
policy = "Basic256Sha256"
mode = "SignAndEncrypt"
$quick_logins
EOF
    account chief SecurityAdmin
    account op Operator
    account super Supervisor
    account eng Engineer
    account looker Observer
} > controller.toml
serve --config controller.toml
run 0 cert create
as op 4 admin log "$url"
mv pki/rejected/certs/* pki/trusted/certs/

# Who may see it does, with the columns of the manual, and what to look for.
has_run() {
    as op 0 admin log "$url" --text rUN --category server
    grep -q -e '  SERVER    0005      Run' out
}
await has_run
says '^Entry  Date/Time                Category  Log Code  Log Name           Details$'
says_not 'AUTH'
as op 0 admin log "$url" --code 0110
says 'NumOfVariables'
says_not 'PublishedVariable'
as op 0 admin log "$url" --count 1
says 'there may be older ones'
[ "$(wc -l < out)" -eq 3 ] || fail "there are not a title, an entry and a hint"
has_application() {
    as op 0 --json admin log "$url" --category AUTH --code 1
    grep -q -e '"code":"0001"' out
}
await has_application
says '^{"entries":\[{"entry":[0-9]*,"time":"20[^"]*","category":"AUTH","code":"0001","name":"Application","details":\["[A-Z]*'
says '"isCut":false,"damaged":0}$'
as op 0 admin log "$url" --text "nothing of this kind"
says '^No entries'
as op 2 admin log "$url" --code none
as op 2 admin log "$url" --category HARDWARE
as op 2 admin log "$url" --count 0
as op 2 admin log "$url" --follow --clear
as looker 1 admin log "$url"
says 'execution_log = true in \[machine\]'

# All of its files, also those that came while it ran.
folder=medium/packages/OPCUA_Server/ExecutionLog
as op 0 admin log "$url" --save saved
[ -s saved/OPCUA_ExecutionLog.log ] || fail "nothing was saved"
cp saved/OPCUA_ExecutionLog.log "$folder/OPCUA_ExecutionLog_20200101000000000.log"
echo "no log" > "$folder/other.txt"
saved_both() {
    as op 0 admin log "$url" --save saved --yes
    grep -q -e 'saved 2 files' out
}
await saved_both
cmp -s saved/OPCUA_ExecutionLog_20200101000000000.log \
    "$folder/OPCUA_ExecutionLog_20200101000000000.log" || fail "what was saved is another one"
echo mine > saved/OPCUA_ExecutionLog.log
as op 1 admin log "$url" --save saved # nobody says yes
[ "$(cat saved/OPCUA_ExecutionLog.log)" = mine ] || fail "it was replaced"
as op 0 admin log "$url" --code 5 --count 10
[ "$(grep -c -e ' Run$' out)" -eq 2 ] || fail "the older file is not shown"

# What is new, as it happens; the log may be cleared meanwhile.
timeout 60 "$busbar" --json --user op --password-file password --trust admin log "$url" --follow \
    --category AUTH --count 1 --duration 50 > followed 2>&1 &
follower=$!
timeout 60 "$busbar" --json --user op --password-file password --trust admin log "$url" --follow \
    --duration 50 > whole 2>&1 &
whole=$!
await grep -q -s AUTH followed
await grep -q -s AUTH whole
before=$(wc -l < followed)
as chief 0 read "$url" i=2259
has_more() { [ "$(wc -l < followed)" -gt "$before" ]; }
await has_more

# The file that is being written stays, and what else is in its folder is the controller's, too.
current=ExecutionLog/OPCUA_ExecutionLog.log
echo mine > mine
for user in super eng; do
    as $user 1 admin file remove "$url" "$current" --yes
    says 'Bad_InvalidState'
    says 'only files that are complete'
    as $user 1 admin file remove "$url" ExecutionLog/other.txt --yes
    as $user 1 admin file mkdir "$url" ExecutionLog/folder
    as $user 1 admin file put "$url" mine ExecutionLog/mine
    as $user 4 admin file put "$url" mine "$current" --yes
    as $user 1 admin file move "$url" "$current" ExecutionLog/moved.log
    as $user 1 admin file remove "$url" EventLog/events.log --yes
done
[ -s "$folder/OPCUA_ExecutionLog.log" ] || fail "the log that is being written is gone"
[ "$(find "$folder" -type f | wc -l)" -eq 3 ] || fail "there is more in its folder: $(ls "$folder")"

# Who may clear it does, after a question, and it goes on.
as op 1 admin log "$url" --clear --yes
as super 1 admin log "$url" --clear
says 'nothing was done'
as super 0 admin log "$url" --code 5
says 'Run'
as super 0 admin log "$url" --clear --yes
says 'cleared the execution log: 2 files'
[ -e "$folder/OPCUA_ExecutionLog.log" ] || fail "there is no file to be written"
[ -e "$folder/other.txt" ] || fail "what is no log is gone"
as super 0 admin log "$url" --code 5
says '^No entries'
has_login() {
    as super 0 admin log "$url" --category AUTH
    grep -q -e 'AUTH' out
}
await has_login
first=$(sed -n '2s/^ *\([0-9]*\) .*/\1/p' out)
[ "$first" -gt 0 ] || fail "the numbers do not go on"
before=$(wc -l < followed)
as chief 0 read "$url" i=2259
await has_more
# No record was missed, also of those just before that.
has_all() { grep -q "\"entry\":$(sed -n 's/.*"entry":\([0-9]*\).*/\1/p' followed | tail -n 1)," whole; }
await has_all
sed -n 's/^{"entry":\([0-9]*\),.*/\1/p' whole |
    awk 'NR > 1 && $1 != 0 && $1 != last + 1 { exit 1 } { last = $1 }' ||
    fail "records were missed: $(cat whole)"
kill -INT "$whole"
wait "$whole"
kill -INT "$follower"
wait "$follower"
code=$?
[ $code -eq 130 ] || fail "the one who follows ends with $code: $(cat followed)"
as op 0 --json admin log "$url" --follow --category AUTH --count 1 --duration 1
says AUTH

# Another certificate has the server prepared anew (4-2-5).
host=${url#opc.tcp://}
host=${host%:*}
as chief 0 admin cert regenerate "$url" --subject "CN=Press 4/O=Works" --days 365 \
    --host "$host" --yes
has_prepared() { grep -q -s -e Prepare "$folder/OPCUA_ExecutionLog.log"; }
await has_prepared
exit $((failures > 0))
