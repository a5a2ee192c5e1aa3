#!/bin/sh
# What the troubleshooting says is done where values of a model cannot be read or written, change
# late, or Methods are refused: the trouble is there, the remedy exists, and it helps (SH-082679,
# 8.3 and 10.3; TROUBLESHOOTING.md).
# usage: remedies_value_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
takes_long
. "$here/cell.sh"
. "$here/remedies.sh"

# again: the controller with its configuration and the project of cell.busbar.
again() {
    [ -z "$pid" ] || { kill "$pid" && await ended; }
    serve_cell cell.busbar
}
map() { run 0 project map cell.busbar "ns=1;i=$1" "$2" ${3:+"$3"}; }
# reread: line.st.
reread() { kill -HUP "$pid"; }
gets() { ends_with 0 --trust read --value "$url" "$1" && grep -q -e "$2" out; }
subscribed() {
    run 0 --json --trust subscribe "$url" "$@" --duration 3
}
cell_program > line.st
cell_project cell.busbar --preset rd81opc96
cell_controller '' '' > module.toml
again
entry model 10.3: remedies

remedy 10.3.10 10.3.12 10.3.14 10.3.16
told 'the value never changes'
put "$(cell 133)" 2.5
get "$(cell 133)" '^2.5$'
put "$(cell 111)" 7
run 0 project csv cell.busbar
says_not '/1:Duration'
map 133 Line.F
again
put "$(cell 111)" 7
get "$(cell 133)" '^7$'
put "$(cell 133)" 8
get "$(cell 111)" '^8$'
subscribed "$(cell 133)" --count 1
says '"value":8'

remedy 10.3.11 10.3.13 10.3.15
told 'Bad_NotReadable, Bad_NotWritable'
get_refused Bad_NotReadable "$(cell 171)"
put_refused Bad_NotWritable "$(cell 170)" 1
run 0 --trust subscribe "$url" "$(cell 171)" --count 1 --duration 3
says Bad_NotReadable
sed '/BrowseName="1:\(ReadOnly\|WriteOnly\)"/s/AccessLevel="[12]"/AccessLevel="3"/' \
    "$here/cell.xml" > mended.xml
run 0 project import cell.busbar mended.xml
again
put "$(cell 170)" 9
put "$(cell 171)" 3
get "$(cell 171)" '^3$'
subscribed "$(cell 171)" --count 1

told 'Bad_WriteNotSupported'
run 1 --trust write --range 1 "$url" "$(cell 140)" '[7]'
says Bad_WriteNotSupported
put_refused Bad_WriteNotSupported "$(cell 140)" '[1, 2]'
put "$(cell 140)" '[1, 7, 3]'
get "$(cell 140)" '1, 7, 3'

told 'Bad_OutOfRange | the label'
put_refused Bad_OutOfRange "$(cell 105)" 40000
run 0 project show cell.busbar "ns=1;i=105"
says 'UINT, WORD'
map 105 Line.UW
again
put "$(cell 105)" 40000

told 'Bad_NotSupported | no label'
cell_controller '' 'preset = "rd81opc96"' > module.toml
again
get_refused Bad_NotSupported "$(cell 163)"
cell_controller '' '' > module.toml
again
run 0 project show cell.busbar "ns=1;i=163"
says '^cannot be mapped: '

remedy 10.3.21
told 'Bad_NoCommunication for all nodes'
put "$(cell 140)" '[1, 7, 3]'
cp line.st whole.st
for fault in '1921H:s/DW : DINT;/DV : DINT;/' '1A00H:s/DW : DINT;/DW : LREAL;/'; do
    sed "${fault#*:}" whole.st > line.st
    reread
    await logged "error ${fault%%:*}: .*Line.DW of "
    logged 'event 24003' || fail "${fault%%:*}: no event"
    get_refused Bad_NoCommunication "$(cell 140)"
    cp whole.st line.st
    reread
    await gets "$(cell 140)" ', ' # what Line has begins anew, as it has another type
    put "$(cell 106)" 12
done
map 106 Line.Gone
cell_controller 'isolate_failures = true' '' > module.toml
again
get "$(cell 140)" '0, 0, 0'
get_refused Bad_NoCommunication "$(cell 106)"
logged 'error 1921H: .*Line.Gone of .*i=106' || await logged 'error 1921H: .*Line.Gone'
map 106 Line.DW
cell_controller '' '' > module.toml
again
put "$(cell 106)" 12

told 'Bad_InvalidArgument'
told 'Bad_TooManyOperations'
told 'Bad_NotImplemented'
mix() {
    run "$1" --trust call "$url" "$(cell 1)" "$(cell 20)" "$2" "${3:-[1, 2, 3]}" \
        '{"Name": "Cake", "Size": 1, "Mode": 0}'
}
mix 1 7 '[1, 2]'
says Bad_
mix 0 7
mix 1 7
says Bad_TooManyOperations
run 0 project csv cell.busbar
cell_controller '' '' | sed '/^\[\[plc.program\]\]/,$d' > module.toml
cat >> module.toml << 'END_OF_PROGRAM'
[[plc.program]]
kind = "acknowledge"
target = "Line.Handle"
sets = "Line.State"
to = 6
END_OF_PROGRAM
again
mix 0 7
mixed() {
    ends_with 0 --trust call "$url" "$(cell 1)" "$(cell 20)" 8 '[1, 2, 3]' \
        '{"Name": "Cake", "Size": 1, "Mode": 0}'
}
await mixed
run 1 --trust call "$url" "$(cell 1)" "$(cell 11)"
says Bad_NotImplemented
run 0 project map cell.busbar "ns=1;i=11" Line.ManyHandle Handle
again
run 0 --trust call "$url" "$(cell 1)" "$(cell 11)"

kill "$pid"
await ended

# Users of a project, and the listener for administration.
told 'Bad_UserAccessDenied | the account may only read, or nothing'
told 'Bad_NodeIdUnknown, though'
for permission in tool client; do
    run 0 project user cell.busbar hmi --new-password-file password --permission $permission \
        --pbkdf2-iterations 10000
    run 0 project set cell.busbar security.policies Basic256Sha256 security.mode SignAndEncrypt \
        security.allow_anonymous no security.allow_passwords yes
    serve_cell cell.busbar
    as_hmi() {
        run "$1" --user hmi --password-file password --trust "$2" "$url" "$(cell 104)" ${3:+"$3"}
    }
    if [ $permission = tool ]; then
        as_hmi 4 read
        says Bad_UserAccessDenied
        as_hmi 4 write 5
    else
        as_hmi 0 read
        as_hmi 0 write 5
    fi
    kill "$pid"
    await ended
done
run 0 project set cell.busbar "listener 2.address" 127.1.0.1 "listener 2.port" $((port + 1)) \
    "listener 2.use" administration
serve_cell cell.busbar
as_hmi 0 read
administration=opc.tcp://127.1.0.1:$((port + 1))
run 1 --ignore host-name --user hmi --password-file password --trust \
    read "$administration" "$(cell 104)"
says Bad_NodeIdUnknown
as_hmi 0 read
kill "$pid"
await ended
finish
