#!/bin/sh
# What the manual of variables mode promises and where it ends (W588, 1-2-2): transport, models,
# sessions, variables, certificates, ways in; with the limits of its product.
# usage: machine_limits_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
. "$here/certificates.sh"

{
    server "$port" pki | sed 's/^\[limits\]/[limits]\npreset = "nj501"/'
    printf '[[endpoint]]\npolicy = "Basic256Sha256"\nmode = "Sign"\n'
    printf '[[endpoint]]\npolicy = "None"\nmode = "None"\n'
    machine 'mode = "PROGRAM"'
} > controller.toml
# publish DECLARATION...
publish() {
    printf 'VAR_GLOBAL\n'
    for declared; do
        printf "    {attribute 'publish' := 'publish only'} %s;\n" "$declared"
    done
    printf 'END_VAR\n'
}
# struct NAME COUNT: with so many members.
struct() {
    printf 'TYPE %s : STRUCT\n' "$1"
    for n in $(seq "$2"); do
        printf '    m%s : BYTE;\n' "$n"
    done
    printf 'END_STRUCT; END_TYPE\n'
}
{
    printf 'TYPE L4 : STRUCT a : INT; END_STRUCT; END_TYPE\n'
    for level in 3 2 1; do
        printf 'TYPE L%s : STRUCT a : L%s; END_STRUCT; END_TYPE\n' $level $((level + 1))
    done
    printf 'TYPE Grid : STRUCT a : ARRAY[0..1, 0..1] OF INT; END_STRUCT; END_TYPE\n'
    printf 'TYPE Either : UNION a : INT; b : WORD; END_UNION; END_TYPE\n'
    printf 'TYPE Within : STRUCT a : Either; END_STRUCT; END_TYPE\n'
    struct S100 100
    struct S101 101
    publish 'Deep3 : L2' 'Deep4 : L1' 'Plane : ARRAY[0..1, 0..1] OF L4' 'HasPlane : Grid' \
        'One : Either' 'HasOne : Within' 'From2 : ARRAY[2..5] OF INT' \
        'E1024 : ARRAY[0..1023] OF BYTE' 'E1025 : ARRAY[0..1024] OF BYTE' 'M100 : S100' \
        'M101 : S101' 'B1024 : ARRAY[0..127] OF LREAL' 'B1032 : ARRAY[0..128] OF LREAL'
} > press.st

entry variables 1-2-2: eight kinds that are not published
begin pki --config controller.toml
await has_record 'SERVER 0005 Run$'
not_published() { has_record "SERVER 0101 InvalidDataType $1 $2" || fail "$1 is no $2"; }
not_published Plane 'MultiDimensionalArray$'
not_published HasPlane 'MultiDimensionalArray$'
not_published Deep4 'NestedStructure\|NestedStructre'
not_published One 'Union$'
not_published HasOne 'Union$'
not_published From2 'SubscriptOfArray$'
not_published E1025 'MaxArrayElements$'
not_published M101 'MaxMembers$'
not_published B1032 'MaxSize 1032Byte$'
[ "$(records 'SERVER 0101')" -eq 9 ] || fail "there are $(records 'SERVER 0101') of them"
for name in Deep3 E1024 M100 B1024; do
    has_record "SERVER 0111 PublishedVariable $name " || fail "$name is not published"
    chief 0 read "$url" "$(node $name)"
done
chief 1 read "$url" "$(node E1025)"

entry variables 1-2-2: UA TCP binary and its URL
[ "$url" = "opc.tcp://127.0.0.1:$port" ] || fail "the URL is $url"
chief 0 read "$url/" i=2259
entry variables 1-2-2: PLCopen model
# Beside the controller's folder (6-2-1), with the same variables, of plain DataTypes (6-2-2).
chief 0 browse "$url" "$(node Controller/)" --depth 3
says 'GlobalVars'
chief 0 browse "$url" "$(node PLCopen/Configuration)" --depth 3
for part in Resources CPU Tasks Programs GlobalVars; do
    says ":$part  "
done
says ' Variable  *ns=[0-9]*;s=Deep3$'
chief 0 read "$url" "$(node PLCopen/Configuration)" --attribute BrowseName
says 'Controller'
entry variables 1-2-2: profile
"$controller" --print-conformance controller.toml > out 2>&1
last="--print-conformance"
says '^Micro2017Server: claimed$'

entry variables 1-2-2: seven security settings
run 0 endpoints "$url"
says '^SignAndEncrypt  *Basic256Sha256'
says '^Sign  *Basic256Sha256'
says '^None  *None'
seven="\"{ mode = 'None', policy = 'None' }\""
for policy in Basic256Sha256 Basic256 Basic128Rsa15; do
    for mode in Sign SignAndEncrypt; do
        seven="$seven, \"{ mode = '$mode', policy = '$policy' }\""
    done
done
one_step
if reaches admin setting set "$url" endpoint "[$seven]"; then
    for policy in Basic256Sha256 Basic256 Basic128Rsa15; do
        run 0 endpoints "$url"
        says "^Sign  *$policy "
        says "^SignAndEncrypt  *$policy "
        chief 0 --policy $policy read "$url" i=2259
        chief 0 --policy $policy --mode Sign read "$url" i=2259
    done
    chief 0 admin setting reset "$url" endpoint
else
    lacks variables 1-2-2: seven security settings -- \
        "Basic256 and Basic128Rsa15 need SHA-1 and are deprecated (Part 7): only a build with" \
        "BUSBAR_LEGACY_POLICIES has them, for plants whose clients know no other ones"
    lacks variables 5-2: signature and encryption -- \
        "not with Basic256 and Basic128Rsa15, which this build does not have"
fi
step_ends
entry variables 1-2-2: user name and anonymous
chief 1 admin setting set "$url" users.anonymous maybe
chief 0 admin setting set "$url" users.anonymous read
cycle_when_due
run 0 --trust read "$url" i=2259
chief 0 read "$url" i=2259
chief 0 admin setting set "$url" users.anonymous no

entry variables 1-2-2: five sessions
one_step
for n in 1 2 3 4 5; do
    timeout 100 "$busbar" --user chief --password-file password --trust subscribe "$url" i=2258 \
        --duration 60 > "subscribed$n" 2>&1 &
    eval "client$n=\$!"
    await grep -q '20' "subscribed$n"
done
run 4 --insecure read "$url" i=2259
ends_with 0 --user chief --password-file password --trust read "$url" i=2259 &&
    fail "there is a sixth session"
grep -q 'Bad_TooManySessions' out || fail "the sixth one is refused otherwise: $(cat out)"
await has_record 'AUTH 0001 Application ERROR BadTooManySessions$'
for n in 1 2 3 4 5; do
    eval "kill \$client$n"
done
await logged 'event log: 85600000 .*: 04'
step_ends
power_cycle

entry variables 1-2-2: 2,000 items, 100 subscriptions
chief 0 admin setting list "$url" limits.subscriptions
says '^limits.subscriptions.in_all  *100'
says '^limits.subscriptions.items  *2000'
items=$(yes "$(node Deep3)" | head -n 2001)
one_step
# shellcheck disable=SC2086 # words
chief 5 subscribe "$url" $items --count 2000 --duration 20
says 'Bad_TooManyMonitoredItems'
[ "$(grep -c 'Bad_TooManyMonitoredItems' out)" -eq 1 ] || fail "more than one is refused"
# Which one is refused is known before the first value is enough.
# shellcheck disable=SC2086 # words
chief 5 subscribe "$url" $items --count 1 --duration 20
says 'Bad_TooManyMonitoredItems'
chief 0 admin setting set "$url" limits.subscriptions.in_all 1
timeout 60 "$busbar" --user chief --password-file password --trust subscribe "$url" i=2258 \
    --duration 40 > subscribed 2>&1 &
client1=$!
await grep -q '20' subscribed
run 1 --user chief --password-file password --trust subscribe "$url" i=2258 --duration 2
says 'Bad_TooManySubscriptions'
kill $client1
chief 0 admin setting reset "$url" limits.subscriptions.in_all
step_ends

entry variables 1-2-2: 32 certificates of each kind
application
client spare
one_step
index=0
while [ $index -lt 33 ]; do
    index=$((index + 1))
    openssl req -x509 -key spare.key -subj "/CN=n$index" -days 20 -out "n$index.pem" 2> /dev/null
done
count() { chief 0 admin trust list "$url"; grep -c "^$1 " out; }
files=$(for n in $(seq 31); do echo "n$n.pem"; done)
# shellcheck disable=SC2086 # words
chief 0 admin trust add "$url" $files
[ "$(count trusted)" -eq 32 ] || fail "there are not 32 trusted ones"
chief 1 admin trust add "$url" n32.pem
# shellcheck disable=SC2086
chief 0 admin trust add "$url" --issuer $files n32.pem
[ "$(count issuers)" -eq 32 ] || fail "there are not 32 issuers"
chief 1 admin trust add "$url" --issuer n33.pem
for n in $(seq 32); do
    openssl x509 -in "n$n.pem" -outform DER -out "pki/rejected/certs/n$n.der"
done
client stranger
discarded=$(records 'CERT 0103 Discard stranger .* CLIENT REJECTED$')
is_refused stranger BadCertificateUntrusted
await has_more_than "$discarded" 'CERT 0103 Discard stranger 20[0-9T:.-]*Z CLIENT REJECTED$'
await logged 'event log: 95D30000'
[ "$(count rejected)" -eq 32 ] || fail "there are not 32 rejected ones"
step_ends
shut_down

# variables COUNT: a program of so many, and what the log says of it.
variables() {
    {
        echo VAR_GLOBAL
        seq "$1" | sed "s/.*/{attribute 'publish' := 'publish only'} v& : INT;/"
        echo END_VAR
    } > press.st
    rm -rf medium
    serve --config controller.toml
    await has_record 'SERVER 0005 Run$'
    shut_down
}
entry variables 1-2-2: 10,000 variables and values, 100 definitions
variables 10001
has_record 'SERVER 0100 MaxVariables MaxVariables$' || fail "no record of the limit"
has_record 'SERVER 0110 NumOfVariables Variables=10000, Values=10000, DataTypes=0$' ||
    fail "not 10,000 are published"
{
    for n in $(seq 101); do
        echo "TYPE T$n : STRUCT a : INT; END_STRUCT; END_TYPE"
    done
    echo VAR_GLOBAL
    seq 101 | sed "s/.*/{attribute 'publish' := 'publish only'} v& : T&;/"
    echo END_VAR
} > press.st
rm -rf medium
serve --config controller.toml
await has_record 'SERVER 0100 MaxVariables MaxDataTypes$'
has_record 'DataTypes=100$\|DataTypes=99$' || fail "another number of definitions is published"
shut_down
finish
