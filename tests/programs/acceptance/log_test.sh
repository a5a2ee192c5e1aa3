#!/bin/sh
# The execution log: its records, files and settings, how it is looked at, fetched and cleared, what
# becomes of it without its medium, and the shutdown that saves it (W588, 3-2-8 and chapter 7).
# usage: log_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
. "$here/certificates.sh"

echo "Ab345678" > good
{
    server "$port" pki | sed 's/^\[limits\]/[limits]\npreset = "nj501"/'
    machine 'mode = "PROGRAM"'
} > controller.toml
cat > press.st << 'END'
TYPE Pair : STRUCT a : INT; b : INT; c : INT; END_STRUCT; END_TYPE
VAR_GLOBAL
    {attribute 'publish' := 'publish only'} Var1 : WORD;
    {attribute 'publish' := 'publish only'} Var2 : Pair;
    {attribute 'publish' := 'publish only'} Var3 : INT;
    {attribute 'publish' := 'publish only'} Var4 : ARRAY[0..4] OF INT;
    {attribute 'publish' := 'publish only'} Odd : ARRAY[2..5] OF INT;
    {attribute 'publish' := 'publish only'} Long : ARRAY[0..1024] OF INT;
END_VAR
END
logs=medium/packages/OPCUA_Server
log=$logs/ExecutionLog/OPCUA_ExecutionLog.log
# The records, without number, day and time.
bare() { tr -d '\r' < "$log" | cut -f 5- | tr '\t' ' '; }

entry variables 7-1-7: examples
begin pki --config controller.toml
await has_records 'SERVER 0005 Run$' 1
bare | grep -v '^CERT' | sed -n '1,/ Run$/p' > begun
cat > wanted << 'END'
SERVER 0001 Start
SERVER 0004 Prepare
SERVER 0101 InvalidDataType Long MaxArrayElements
SERVER 0101 InvalidDataType Odd SubscriptOfArray
SERVER 0111 PublishedVariable Var1 2Byte 1 0
SERVER 0111 PublishedVariable Var2 6Byte 3 3
SERVER 0111 PublishedVariable Var3 2Byte 1 0
SERVER 0111 PublishedVariable Var4 10Byte 5 0
SERVER 0110 NumOfVariables Variables=4, Values=10, DataTypes=1
SERVER 0005 Run
END
cmp -s wanted begun || fail "the start is another one: $(diff wanted begun)"
application
client stranger
is_refused stranger BadCertificateUntrusted
chief 0 admin trust move "$url" "$(thumbprint_of stranger.pem)"
await has_records 'CERT 0102 Move stranger 20[0-9T:.-]*Z CLIENT REJECTED->TRUSTED$' 1
is_let_in stranger
await has_record 'AUTH 0001 Application OPEN 0x[0-9A-F]\{8\} 127.0.0.1 stranger$'
await has_record 'AUTH 0001 Application CLOSE 0x[0-9A-F]\{8\}$'

entry variables 7-1-6: records and messages
entry variables 7-1-1: kinds of entries
# Those that are not here are in trust_test.sh, settings_test.sh and limits_test.sh.
# One line of at most 256 bytes: number, day, time, milliseconds, category, code, name, details.
tab=$(printf '\t')
awk -v FS='\t' 'length($0) > 256 || !/\r$/ || $1 !~ /^[0-9]+$/ || $2 !~ /^20..-..-..$/ ||
    $3 !~ /^..:..:..$/ || $4 !~ /^[0-9][0-9][0-9]$/ || $5 !~ /^(SERVER|AUTH|CERT)$/ ||
    $6 !~ /^[0-9][0-9][0-9][0-9]$/ || length($7) > 32 { bad = 1; print }
    NR > 1 && $1 != before + 1 { bad = 1; print } { before = $1 } END { exit bad }' "$log" ||
    fail "these records are none"
run 4 --user chief --password-file wanted --trust read "$url" i=2259
await has_record 'AUTH 0002 User ERROR chief BadUserAccessDenied$'
chief 0 admin user add "$url" joan --new-password-file good
await has_record 'AUTH 0100 Update$'
# A limit that is full, and a download.
one_step
cp press.st before.st
{
    echo 'VAR_GLOBAL'
    for n in $(seq 101); do
        echo "{attribute 'publish' := 'publish only'} s$n : T$n;"
    done
    echo 'END_VAR'
} > many.st
{
    for n in $(seq 101); do
        echo "TYPE T$n : STRUCT a : INT; END_STRUCT; END_TYPE"
    done
    cat many.st
} > sent.st
chief 0 admin program download "$url" sent.st --yes
await has_records 'SERVER 0100 MaxVariables MaxDataTypes$' 1
chief 0 admin program restore "$url" --yes
step_ends

entry variables 3-2-8: operation log
entry variables 7-2: columns, fetch, clear, card
chief 0 admin log "$url" --category SERVER --text run
says '^Entry  Date/Time                Category  Log Code  Log Name           Details$'
says ' SERVER    0005      Run'
says_not 'AUTH'
chief 0 admin log "$url" --code 0110
says 'NumOfVariables'
chief 0 admin log "$url" --save saved
head -n 20 "$log" > wanted
head -n 20 saved/OPCUA_ExecutionLog.log | cmp -s - wanted || fail "what was saved is another one"
chief 1 admin log "$url" --save saved # nobody says yes
last_number() { tail -n 1 "$log" | cut -f 1; }
number=$(last_number)
one_step
chief 1 admin log "$url" --clear
says 'nothing was done'
chief 0 admin log "$url" --clear --yes
says 'cleared the execution log: '
chief 0 admin log "$url"
says_not ' Run$'
step_ends
# 7-2-3 and 7-2-4: whoever reads the medium, as the unit's FTP server (W506) does, finds whole
# records there, while the controller writes.
mkdir fetched
await test -s "$log"
cp "$logs"/ExecutionLog/OPCUA_ExecutionLog*.log fetched
awk -F'\t' 'NF < 7 || !/\r$/ { bad = 1 } END { exit bad }' fetched/OPCUA_ExecutionLog.log ||
    fail "a record on the medium is not whole"
[ -s fetched/OPCUA_ExecutionLog.log ] || fail "there are no records on the medium"
shut_down

entry variables 7-1-3: settings
entry variables 7-1-5: files
sed -i 's/^execution_log = true/&\nexecution_log_files = 3\nexecution_log_records = 100/' \
    controller.toml
serve --config controller.toml
[ "$(head -n 1 "$log" | cut -f 1)" -gt 0 ] || fail "the numbers begin anew"
full() { [ "$(ls "$logs"/ExecutionLog/OPCUA_ExecutionLog_20*.log 2> /dev/null | wc -l)" -ge 2 ]; }
tries=0
until full || [ $tries -gt 150 ]; do
    run 4 --user joan --password-file wanted --trust read "$url" i=2259
    tries=$((tries + 1))
done
for file in "$logs"/ExecutionLog/*; do
    case ${file##*/} in
        OPCUA_ExecutionLog.log) ;;
        OPCUA_ExecutionLog_20[0-9]*.log)
            [ ${#file} -eq $((${#log} + 18)) ] || fail "$file has another name"
            [ "$(wc -l < "$file")" -eq 100 ] || fail "$file has not 100 records"
            ;;
        *) fail "there is $file" ;;
    esac
done
[ -s "$logs/System/OPCUA_ExecutionLog.fjc" ] || fail "there is no log control file"
cat "$logs"/ExecutionLog/OPCUA_ExecutionLog_*.log "$log" | cut -f 1 |
    awk 'NR > 1 && $1 != before + 1 { bad = 1 } { before = $1 } END { exit bad }' ||
    fail "the numbers do not go on over the files"

entry variables 7-4: card
before=$(records 'AUTH 0002 User')
mv medium pulled
await logged 'the medium is away, and records wait for it'
chief 0 read "$url" i=2259
mv pulled medium
await logged 'the medium is in again, and records are saved'
await has_more_than "$before" 'AUTH 0002 User'
number=$(last_number)
mv medium pulled
chief 0 read "$url" i=2259
kill "$pid"
await ended
grep -q 15000000 state/events/events.log || fail "lost records are no event"
# A start without it (7-4-1): it is told, and recording begins when it is put in.
sed -i 's/^medium = .*/&\nmake_medium = false\nsimulated_hardware = true/' controller.toml
serve --config controller.toml
await logged 'event log: 15000000 Execution Log Save Failed: 0001'
[ ! -e medium ] || fail "a start without the medium makes it"
mv pulled medium
await logged 'the medium is in again, and records are saved'
begun_again() {
    awk -v last="$number" '$1 > last && $6 == "0005" { is = 1 } END { exit !is }' \
        "$logs"/ExecutionLog/*.log
}
await begun_again
# Its power switch (7-4-3): what waits is saved first, and nothing more until it is in again.
simulate() { chief 0 call "$url" "$(node Machine/Hardware)" Simulate "$1"; }
one_step
simulate 'medium out'
# The log has that line of the start, too.
is_away_again() { [ "$(grep -c 'the medium is away' log)" -eq 2 ]; }
await is_away_again
# What waits is saved first, by the next turn of what saves.
is_saved() {
    lines=$(wc -l < "$log")
    sleep 0.5
    [ "$(wc -l < "$log")" -eq "$lines" ]
}
await is_saved
written=$(wc -l < "$log")
chief 0 read "$url" i=2259
[ "$(wc -l < "$log")" -eq "$written" ] || fail "records are written to a medium that is going"
simulate 'medium in'
await logged 'the medium is in again'
more_written() { [ "$(wc -l < "$log")" -gt "$written" ]; }
await more_written
# The end of its life (7-4-5), which a medium's own firmware knows.
simulate 'medium worn'
await logged 'event log: 00000005 Storage Medium Life Exceeded'
await grep -q -s 00000005 state/events/events.log # a moment after the line
chief 0 admin events "$url" --code 00000005
says 'Storage Medium Life Exceeded'
step_ends
shut_down

entry variables 7-3: shutdown
serve --config controller.toml
one_step
before=$(records 'SERVER 0006 Shutdown$')
chief 0 admin shutdown "$url" --seconds 0 --reason "maintenance" --yes
await has_more_than "$before" 'SERVER 0006 Shutdown$'
[ "$(tail -n 1 "$log" | tr -d '\r' | cut -f 6)" = 0006 ] || fail "something follows the shutdown"
grep -q 95D10000 state/events/events.log || fail "the shutdown is no event"
logged maintenance || fail "the log does not say why"
chief 0 admin status "$url"
says '^Server operating status: *Shutdown$'
shut_down
finish
