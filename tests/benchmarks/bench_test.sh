#!/bin/sh
# Runs the commands of busbar-bench that need no other server, and looks at what they print; not at
# how long anything took.
# usage: bench_test.sh BUSBAR_BENCH SOURCE_DIR CMAKE
set -eu
bench=$1 source=$2 cmake=$3

work=$(mktemp -d)
waiting=""
trap 'kill $waiting 2> /dev/null || true; wait; rm -rf "$work"' EXIT
cd "$work"

# has TEXT FILE
has() {
    grep -q -- "$1" "$2" || { echo "not found: $1, in:"; cat "$2"; exit 1; }
}
# refuses COMMAND...: fails, and says why in refused.txt.
refuses() {
    if "$@" 2> refused.txt; then
        echo "does not fail: $*"
        exit 1
    fi
}
is_json() { "$cmake" -D FILE="$work/$1" -P "$source/tests/programs/check_json.cmake"; }

# These wait nearly all the time: for attackers that hold out, and for the intervals of publishing.
"$bench" hostile --seconds 0.1 --quotas 2 > quotas.txt &
quotas=$!
"$bench" hostile --seconds 0.1 --quotas 2 --json > quotas.json &
quotas_json=$!
"$bench" appendix7 --rounds 2 --most 100 > appendix7.txt &
appendix7=$!
waiting="$quotas $quotas_json $appendix7"

"$bench" --connects 2 --read 1,10 --write 5 --browse 20 --in-flight 4 --seconds 0.02 --rounds 2 --json > loads.json
is_json loads.json
has "\"load\": \"read 10\", .*\"floor_us\": [0-9.]*, \"server_floor_us\": [0-9]" loads.json
for load in "connect and activate" "read 1" "read 10" "write 5" "browse 20" "one value, 4 in flight"; do
    has "\"load\": \"$load\", \"round\": 1, .*\"server_us\": [0-9.]*, \"page_faults\": " loads.json
done
"$bench" --policy Basic256Sha256 --mode SignAndEncrypt --only connects,reads --connects 2 --read 10 \
    --seconds 0.02 --sequential --json > secure.json
has "\"connect and activate\", .*\"server_floor_us\": [0-9]" secure.json
"$bench" --policy Basic256Sha256 --mode SignAndEncrypt --only connects,reads --connects 2 --read 10 \
    --seconds 0.02 --sequential > loads.txt
has "SignAndEncrypt  sequential order" loads.txt
has "^connect and activate " loads.txt
has "^read 10 " loads.txt
has "^load .* per second .* calls$" loads.txt
[ "$(wc -l < loads.txt)" = 4 ] || { echo "not the two loads alone:"; cat loads.txt; exit 1; }
refuses "$bench" --only nothing
"$bench" --compare loads.json loads.json > compare.txt
has "^read 10 *server_us .* 1.00 *1.00 1.00$" compare.txt
refuses "$bench" --compare loads.json nothing.json
has "nothing.json: the file cannot be read" refused.txt
echo '{"rows": [{"load": 1}]}' > wrong.json
refuses "$bench" --compare loads.json wrong.json
has "wrong.json: row 1: found no" refused.txt
refuses "$bench" --in-flight 0
refuses "$bench" --subscribe 10
has "found no URL" refused.txt

"$bench" hostile --seconds 0.05 --connections 3 --bomb 1000000 > hostile.txt
has "^none " hostile.txt
has "^decode bomb before login " hostile.txt
has "^Browses of 3 connections " hostile.txt
"$bench" hostile --seconds 0.05 --administration --calls 3 > administration.txt
has "^SecurityAdmin UserManagementType.AddUser  *3  *0 .* Good$" administration.txt
has "^ConfigureAdmin FileDirectoryType.CreateFile  *3  *0 .* Good$" administration.txt
has "^ConfigureAdmin FileDirectoryType.Delete  *3  *0 .* Good$" administration.txt
has "^Operator press.csv.Open  *3  *0 .* Good$" administration.txt
"$bench" hostile --seconds 0.05 --administration --calls 1 --json > administration.json
is_json administration.json
has '"attack": "SecurityAdmin RoleSetType.AddRole".* "longest_piece_ms": [0-9.]*, "status": "Good"' administration.json
"$bench" hostile --seconds 1 --passwords 2 > passwords.txt
has "^2 change passwords, add users and guess " passwords.txt
has " logins *failed " passwords.txt
"$bench" churn --seconds 2 --clients 3 > churn.txt
has "^come  *[1-9]" churn.txt
has "^call  *[1-9]" churn.txt
"$bench" churn --mutated 300 --seed 3 > mutated.txt
has "^[A-Z][A-Za-z]*  *[0-9][0-9]*  *[1-9]" mutated.txt
has "^seed 3, memory " mutated.txt
refuses "$bench" churn --controller nothing
"$bench" hostile --seconds 0.05 --connections 3 --bomb 1000000 --json > hostile.json
is_json hostile.json
has '"attack": "Browses of 3 connections"' hostile.json
has '"failed": 0, ' hostile.json
has '"peak_growth_mb": ' hostile.json

"$bench" growth --sessions 1,2 --items 5,10 --variables 10,20 --reads 5 > growth.txt
has "^sessions " growth.txt
has "^items " growth.txt
has "^variables " growth.txt
has "^items, each by a request of its own " growth.txt
has "step" growth.txt
"$bench" growth --sessions 1,2 --items 5,10 --variables 10,20 --reads 5 --json > growth.json
is_json growth.json
has '"of": "items", "count": 10, .*"delete_us": ' growth.json

"$bench" publishes --seconds 0.3 --subscriptions 12 --sessions 3 --interval 50 > publishes.txt
has "^12 Subscriptions in 3 sessions at 50 ms: [1-9][0-9]* messages a second of 240, server .* 0 lost" publishes.txt
"$bench" publishes --seconds 0.2 --subscriptions 2 --sessions 1 --interval 50 --json > publishes.json
is_json publishes.json

"$bench" startup --limited 3,30 --open 60 --rounds 1 > startup.txt
has "^3 *nj501 " startup.txt
has "^30 *nj501 " startup.txt
has "^60 *none " startup.txt
has "growth" startup.txt
"$bench" startup --limited 3,30 --open 60 --rounds 1 --json > startup.json
is_json startup.json
has '"count": 3, "published": 3, "limits": "nj501", "declarations_ms": ' startup.json
has '"count": 60, "published": 60, "limits": null, ' startup.json
has '"running_ms": .*, "growth": null}' startup.json
# What the preset does not publish is started, too.
"$bench" startup --limited 10001 --open 10002 --rounds 1 --json > startup.json
has '"count": 10001, "published": 10000, ' startup.json
has '"count": 10002, "published": 10002, ' startup.json

"$bench" appendix7 --rounds 2 --most 500 --only writes,startup --modes items --json > seven.json
is_json seven.json
has '"load": "write", "mode": "items", "variables": 500, "objects": 5, ' seven.json
has '"files": 1, "mapped": false, "rounds": 2, "manual_ms": 18200.0, "measured_ms": ' seven.json
has '"floor_ms": .*, "time": "wall"}' seven.json
has '"floor_ms": .*, "time": "processor"}' seven.json
if grep -q '"read"\|"standard"\|: 1000, ' seven.json; then
    echo "not asked for:"
    cat seven.json
    exit 1
fi

# A server that is not there, and sizes that do not grow.
refuses "$bench" hostile opc.tcp://127.0.0.1:1
has "opc.tcp://127.0.0.1:1: Bad_" refused.txt
refuses "$bench" growth --sessions 2,2 --reads 5
has "growth: Bad_InvalidArgument" refused.txt
refuses "$bench" startup --limited 20 --open 20
has "startup: .* do not grow" refused.txt
refuses "$bench" appendix7 --only reading
refuses "$bench" appendix7 --most 99

wait $quotas
for attack in none "2 take sessions" "2 leave Subscriptions" "2 never finish" "2 say nothing" \
        "2 guess passwords"; do
    has "^$attack " quotas.txt
done
wait $quotas_json
is_json quotas.json
has '"logins": [1-9][0-9]*, "failed_logins": ' quotas.json
wait $appendix7
for load in read subscription write startup; do
    for mode in standard items all; do
        has "^$load  *$mode  *100 " appendix7.txt
    done
done
