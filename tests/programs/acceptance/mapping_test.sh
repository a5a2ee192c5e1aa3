#!/bin/sh
# Values of a model's nodes that are labels of a PLC (SH-082679, 8.2 and 8.3): conversions and their
# ranges, parts that are mapped, what labels can be, and what becomes of nodes when labels change.
# usage: mapping_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
takes_long
. "$here/cell.sh"

cell_program > line.st
cell_controller '' '' > module.toml
cell_project cell.busbar
serve_cell cell.busbar

entry model 8.3: initial values and timing
get "$(cell 104)" '^5$'
run 0 --trust write "$url" "$(cell 133)" 2.5 # without a label
get "$(cell 133)" '^2.5$'

entry model 8.2: conversions
# Sign and range, seen through another node with the same label.
put "$(cell 104)" -7
put_refused Bad_OutOfRange "$(cell 105)" 40000
put "$(cell 105)" 32767
get "$(cell 104)" '^32767$'
put "$(cell 104)" -7
get_refused Bad_NoCommunication "$(cell 105)"
await logged 'error 1A01H'
get "ns=1;s=Module/LastErrorCode" '^6657$' # 1A01H
get "ns=1;s=Module/LastError" 'error 1A01H: .* of ns=[0-9]*;i=105$'
get "ns=1;s=Module/LastErrorTime" '^20'
get "ns=1;s=Module/LastEventCode" '^24001$'
put "$(cell 104)" 5
put "$(cell 108)" -2147483648
put_refused Bad_OutOfRange "$(cell 108)" 2147483648
put_refused Bad_OutOfRange "$(cell 109)" 4294967296
put "$(cell 109)" 4294967295
get "$(cell 107)" '^4294967295$'
# Floating point.
put "$(cell 110)" 1.5 "$(cell 111)" 0.1
get "$(cell 111)" '^0.1'
put_refused Bad_OutOfRange "$(cell 110)" NaN
put_refused Bad_OutOfRange "$(cell 110)" Infinity
put_refused Bad_OutOfRange "$(cell 111)" 1e39
put "$(cell 111)" 1e-40
get "$(cell 111)" '^0$'
# Texts.
put "$(cell 112)" '日本'
get "$(cell 112)" '^日本$'
put "$(cell 112)" 'ÿA'
get "$(cell 112)" '^・A$'
put "$(cell 112)" 'ABCDEFGHIJ'
get "$(cell 112)" '^ABCDEF$' # an odd number of characters: one less is valid
put "$(cell 121)" 'Größe Ω12'
get "$(cell 121)" 'Größe Ω'
# DateTime: seconds since 2000, seen as a number.
cp cell.busbar dates.busbar
for each in 113:UDW 107:UDW 101:Tim.S 105:Tim.N 109:LTim.N 106:T 108:Cnt.N 103:Cnt.N; do
    run 0 project map dates.busbar "ns=1;i=${each%%:*}" "Line.${each#*:}"
done
kill "$pid"
await ended
serve_cell dates.busbar
put "$(cell 113)" 2000-01-01T00:01:00Z
get "$(cell 107)" '^60$'
put "$(cell 113)" 2099-12-31T23:59:59Z
put_refused Bad_OutOfRange "$(cell 113)" 1999-12-31T23:59:59Z
put_refused Bad_OutOfRange "$(cell 113)" 2100-01-01T00:00:00Z

entry model 8.2: assignment table
# Labels of timers and counters, and Time.
put "$(cell 101)" true "$(cell 105)" 65535 "$(cell 109)" 70000 "$(cell 106)" -5 "$(cell 108)" 40
get "$(cell 103)" '^40$'
get "$(cell 105)" '^65535$'
get "$(cell 109)" '^70000$'
put_refused Bad_OutOfRange "$(cell 109)" 4294967296
get "$(cell 106)" '^-5$'

entry model 8.2: arrays
put "$(cell 140)" '[1, 2, 3]'
get "$(cell 140)" '1, 2, 3'
put "$(cell 141)" '[[1, 2, 3], [4, 5, 6]]'
run 0 --trust read --value --range 1,0:1 "$url" "$(cell 141)"
says '4,5'
put_refused Bad_WriteNotSupported "$(cell 140)" '[1, 2]'
put_refused Bad_WriteNotSupported "$(cell 140)" '[1, 2, 3, 4]'
put_refused Bad_WriteNotSupported "$(cell 140)" '[]'
put_refused Bad_WriteNotSupported "$(cell 141)" '[[1, 2], [3, 4], [5, 6]]'
run 1 --trust write --range 1 "$url" "$(cell 140)" '[7]'
says Bad_WriteNotSupported

entry model 8.2: structures
put "$(cell 160)" '{"Name": "Bread", "Size": 12, "Mode": 1}'
get "$(cell 160)" 'Bread'
get "$(cell 130)" '^1\|Manual'
put "$(cell 161)" '[{"Name": "a", "Size": 1, "Mode": 0}, {"Name": "b", "Size": 2, "Mode": 5}]'
run 0 --json --trust read "$url" "$(cell 161)"
says '"Name":"b","Size":2'

entry model 8.2: enumerations, methods, arguments
put "$(cell 130)" 5
put_refused Bad_OutOfRange "$(cell 130)" 3

entry model 8.3: handle
call_mix() {
    run "$1" --trust call "$url" "$(cell 1)" "$(cell 20)" 7 '[1, 2, 3]' \
        '{"Name": "Cake", "Size": 1, "Mode": 0}'
}
call_mix 0
call_mix 1
says Bad_TooManyOperations

entry model 8.3: groups that fail together
put "$(cell 104)" 300 # which the SByte of the same label cannot be
run 1 --trust read "$url" "$(cell 102)" "$(cell 106)"
says 'i=106 *Bad_NoCommunication'
get "$(cell 106)" '^[-0-9]'
get "$(cell 133)" '^2.5$\|null'
put "$(cell 104)" 5

entry model 10.3: remedies
get_refused Bad_NotReadable "$(cell 171)"
put_refused Bad_NotWritable "$(cell 170)" 1
run 0 project csv cell.busbar # what has no label, and why its value never changes
says_not 'i=133'
run 0 project show cell.busbar "ns=1;i=133"
says '^ *Double  *LREAL'
run 0 project show cell.busbar "ns=1;i=164"
says '^cannot be mapped: '
run 0 --trust read --value "$url" "$(module ActualSamplingIntervalMinimum)"
run 0 --trust read --value "$url" "$(module TargetDevice1Status)"

entry model 8.3: restrictions
# What cannot be a label, once the PLC is asked: no mapped node can be used, others can.
cp cell.busbar wrong.busbar
for each in 104:Secret 105:Fixed 106:Line.None 107:Line.Recipe 109:Line.Row; do
    run 0 project map wrong.busbar "ns=1;i=${each%%:*}" "${each#*:}"
done
kill "$pid"
await ended
rm -r pki/taken-over # there is no project before it that could stay in force
serve_cell wrong.busbar
await logged 'event 24003'
get "ns=1;s=Module/LastEventCode" '^24003$'
get "ns=1;s=Module/ErrorCount" '^[1-9]'
for each in 104:Secret 105:Fixed 106:Line.None 107:Line.Recipe 109:Line.Row; do
    logged "error 1921H: .*: ${each#*:} of .*i=${each%%:*}" || fail "1921H does not name $each"
done
get_refused Bad_NoCommunication "$(cell 140)"
put_refused Bad_NoCommunication "$(cell 140)" '[1, 2, 3]'
get "$(cell 133)" null
# Where failures are isolated only that node is lost.
cell_controller 'isolate_failures = true' '' > module.toml
kill "$pid"
await ended
serve_cell wrong.busbar
await logged 'error 1921H: .*Line.Row of .*i=109'
get_refused Bad_NoCommunication "$(cell 104)"
put_refused Bad_NoCommunication "$(cell 104)" 5
put "$(cell 140)" '[4, 5, 6]'
get "$(cell 140)" '4, 5, 6'
get_refused Bad_NoCommunication "$(cell 105)"
cell_controller '' '' > module.toml

entry model 8.3: label specification
cp cell.busbar named.busbar
run 0 project map named.busbar "ns=1;i=104" 'lINE.tABLE[1][2]'
run 0 project map named.busbar "ns=1;i=105" 'LINE.ROW[0]'
run 0 project map named.busbar "ns=1;i=101" 'line.tim.c'
kill "$pid"
await ended
serve_cell named.busbar
put "$(cell 104)" 77 "$(cell 105)" 78 "$(cell 101)" true
get "$(cell 141)" '77'
get "$(cell 140)" '78'

entry model 8.3: label update
await logged 'event 24001'
put "$(cell 106)" 99
# Moved: found again, the value stays.
sed 's/^VAR_GLOBAL {/VAR_GLOBAL Extra : LREAL; END_VAR\n&/' line.st > moved.st
cp moved.st line.st
kill -HUP "$pid"
await logged 'event 24000.*'
get_again() { ends_with 0 --trust read --value "$url" "$(cell 106)" && grep -q '^99$' out; }
await get_again
# Of another type: 1A00H, which other nodes feel; healed by the next program.
sed 's/DW : DINT;/DW : LREAL;/' moved.st > line.st
kill -HUP "$pid"
await logged 'error 1A00H: .*Line.DW of '
logged 'event 24003' || fail "no 24003"
get_refused Bad_NoCommunication "$(cell 140)"
get "$(cell 133)" null
cp moved.st line.st
kill -HUP "$pid"
healed() { ends_with 0 --trust read --value "$url" "$(cell 140)"; }
await healed
kill "$pid"
await ended
finish
