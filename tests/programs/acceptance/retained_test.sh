#!/bin/sh
# Values of RETAIN variables over power cycles (W588, 6-2-2): what a client was told is written
# is there after kill -9, whenever it comes and whatever has become of the files.
# usage: retained_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"

# The value, below the warning that the connection is not secure.
value_of() {
    run 0 --insecure read --value "$url" "$(node "$1")"
    found=$(tail -n 1 out)
}
is() {
    value_of "$1"
    [ "$found" = "$2" ] || fail "$1 is $found instead of $2: $3"
}

cat > machine.toml << 'END'
[server]
address = "127.0.0.1"
port = 0
[certificates]
folder = "pki"
trust_all_clients = true
[[endpoint]]
policy = "None"
mode = "None"
[users]
anonymous = "write"
[machine]
program = "line.st"
name = "Controller"
state = "state"
medium = "medium"
retained_ms = 3600000
[plc]
scan_ms = 10
END
cat > line.st << 'END'
TYPE Axis : STRUCT
    Name : STRING[16];
    Position : LREAL;
END_STRUCT; END_TYPE
VAR_GLOBAL RETAIN
    {attribute 'publish' := 'publish only'}
    Count : DINT;
    {attribute 'publish' := 'publish only'}
    Recipe : STRING[40] := 'none';
    {attribute 'publish' := 'publish only'}
    Levels : ARRAY [0..3] OF INT;
    {attribute 'publish' := 'publish only'}
    Home : Axis;
END_VAR
VAR_GLOBAL
    {attribute 'publish' := 'publish only'}
    Speed : INT := 100;
END_VAR
END
serve --config machine.toml

# Each kind of value, a power cycle after each.
run 0 --insecure write "$url" "$(node Count)" 1
power_cycle
is Count 1 "a number"
is Recipe 'none' "what nobody wrote"
run 0 --insecure write "$url" "$(node Recipe)" 'cover plate'
power_cycle
is Recipe 'cover plate' "a text"
is Count 1 "a power cycle later"
run 0 --insecure write "$url" "$(node Levels)" '[1,2,3,4]'
power_cycle
is Levels '[1, 2, 3, 4]' "an array"
run 0 --insecure write "$url" "$(node Levels)" --range 1:2 '[8,9]'
power_cycle
is Levels '[1, 8, 9, 4]' "a part of an array"
run 0 --insecure write "$url" "$(node Home)" '{"Name":"X","Position":2.5}'
power_cycle
value_of Home
grep -q '2.5' out || fail "a structure is lost"
run 0 --insecure write "$url" "$(node Speed)" 7
power_cycle
is Speed 100 "it is not RETAIN"

# Killed while a client writes: never older than the last one that was answered.
for round in 1 2 3 4 5; do
    (
        for i in $(seq 40); do
            timeout 10 "$busbar" --insecure write "$url" "$(node Count)" $((round * 100 + i)) > /dev/null 2>&1 &&
                echo $((round * 100 + i)) > answer && mv answer answered
        done
    ) &
    writer=$!
    sleep 0.$((round * 17 % 10))3
    power_cut
    kill "$writer" 2> /dev/null
    wait "$writer" 2> /dev/null
    serve --config machine.toml
    value_of Count
    [ "$found" -ge "$(cat answered 2> /dev/null || echo 0)" ] ||
        fail "$(cat answered) was answered, and $found is there"
done

# An orderly end, and what was written since.
run 0 --insecure write "$url" "$(node Count)" 1000
shut_down
serve --config machine.toml
is Count 1000 "after SIGTERM"
run 0 --insecure write "$url" "$(node Count)" 1001
power_cycle
is Count 1001 "after SIGTERM and a power cycle"

# An end of the journal that was cut off, and one that is damaged: no reason not to start.
journal() { ls state/retained.journal-? | head -n 1; }
# Values are saved once right after a start: then what was written before is not in the journal.
for before in 1002 1012 1022 1032 1042; do
    run 0 --insecure write "$url" "$(node Count)" "$before"
    run 0 --insecure write "$url" "$(node Count)" $((before + 1))
    power_cut
    [ "$(grep -a -o Count "$(journal)" | wc -l)" -ge 2 ] && break
    serve --config machine.toml
done
size=$(wc -c < "$(journal)")
head -c $((size - 3)) "$(journal)" > cut
cat cut > "$(journal)"
serve --config machine.toml
logged 'retained.journal-[12]: the write at byte [0-9]* was cut off' || fail "nobody learns of it"
is Count "$before" "the write before the one that was cut off"
for count in 1104 1114 1124 1134 1144; do
    run 0 --insecure write "$url" "$(node Count)" "$count"
    run 0 --insecure write "$url" "$(node Recipe)" lid
    power_cut
    grep -q -a -s Count "$(journal)" && grep -q -a -s Recipe "$(journal)" && break
    serve --config machine.toml
    before=$count
done
printf 'X' | dd of="$(journal)" bs=1 seek=40 conv=notrunc 2> /dev/null
serve --config machine.toml
logged 'is damaged, and is left out' || fail "nobody learns of the damage"
is Count "$before" "the write before the damaged one"
is Recipe 'lid' "the write after the damaged one"
[ -e state/retained.journal-1.kept ] || [ -e state/retained.journal-2.kept ] ||
    fail "what was damaged is lost"
for count in 1205 1215 1225 1235 1245; do
    run 0 --insecure write "$url" "$(node Count)" "$count"
    power_cut
    grep -q -a -s Count "$(journal)" && break
    serve --config machine.toml
done
echo damaged > state/retained
serve --config machine.toml
logged 'retained: is not a file of retained values' || fail "nobody learns of the file's damage"
is Count "$count" "the journal alone"

# A value whose variable has another type begins as declared; the others are as they were.
run 0 --insecure write "$url" "$(node Recipe)" cover
sed -i 's/Count : DINT/Count : LINT := 3/' line.st
power_cycle
logged 'retained: Count: has another type' || fail "nobody learns of the other type"
is Count 3 "of another type"
is Recipe 'cover' "of the same type"

# A restart by an online edit or a download keeps what was written.
run 0 --insecure write "$url" "$(node Count)" 2000
sed -i "s/    Recipe : /    Added : INT := 5;\n    {attribute 'publish' := 'publish only'}\n    Recipe : /" line.st
hang_up 'edited online: line.st'
run 0 --insecure write "$url" "$(node Added)" 6
power_cycle
is Added 6 "added online"
is Count 2000 "beside it"

# One that is deleted online and comes back begins as declared, also after a power cycle.
sed -i '/Added : INT/d' line.st
hang_up 'edited online: line.st'
sed -i "s/    Recipe : /    Added : INT := 5;\n    {attribute 'publish' := 'publish only'}\n    Recipe : /" line.st
rm -f log.before
cp log log.before
kill -HUP "$pid"
edited_twice() { [ "$(grep -c 'edited online: line.st' log)" -ge 2 ]; }
await edited_twice
is Added 5 "deleted and added again"
power_cycle
is Added 5 "deleted, added again, and a power cycle"
is Count 2000 "beside it"
shut_down
finish
