#!/bin/sh
# Model mode before a PLC of the network: a project's nodes are mapped to labels that the PLC has, by SLMP.
# usage: field_labels_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
. "$here/cell.sh"
responder=$(dirname "$controller")/busbar-plc-responder
[ -x "$responder" ] || { echo "there is no busbar-plc-responder"; exit 77; }
plc_port=$((port + 1))
trap 'kill -9 $plc 2> /dev/null; kill $pid 2> /dev/null; wait' EXIT
# start_plc ARGUMENTS...: with labels of these types and values, and commands from fd 7.
start_plc() {
    rm -f plc.in
    mkfifo plc.in
    "$responder" slmp --listen "127.0.0.1:$plc_port" --label Line.W=4:0500 \
        --label Line.DW=5:01000000 --label Line.Bit=1:01 --label Line.D=7:000000000000F83F \
        --label Line.S=9:41420000000000000000 "$@" < plc.in > plc.log 2>&1 &
    plc=$!
    exec 7> plc.in
    await grep -q 'ready at' plc.log
}
cell_table() {
    echo 'NodeId,Part,Label'
    for each in 101:Bit 104:W 108:DW 110:D 112:S; do
        echo "ns=1;i=${each%%:*},,Line.${each#*:}"
    done
}
{
    cat << END
[server]
address = "127.0.0.1"
port = $port
[certificates]
folder = "pki"
trust_all_clients = true
[[endpoint]]
policy = "None"
mode = "None"
[users]
anonymous = "write"
[labels]
backend = "slmp"
address = "127.0.0.1:$plc_port"
longest_pause_ms = 500
utc_offset_minutes = 0
END
} > module.toml
sed '/^backend/s/slmp/modbus/' module.toml > wrong.toml
last="another protocol"
"$controller" --config wrong.toml --project project > out 2>&1 && fail "$last"
says 'wrong.toml:[0-9]*: backend: found .modbus., expected "slmp"'

# The PLC is not there: the controller starts, and its nodes say so.
cell_project cell.busbar
serve_cell cell.busbar
get_refused Bad_NoCommunication "$(cell 104)"
start_plc
gets() {
    last="read $1 until $2"
    "$busbar" --trust read --value "$url" "$1" > out 2>&1
    grep -q -e "$2" out
}
await gets "$(cell 104)" '^5$'
await logged 'labels: connected to .*, R08CPU'
entry model 2.2: control CPU and access units
get "$(cell 101)" '^true$'
get "$(cell 108)" '^1$'
get "$(cell 110)" '^1.5$'
get "$(cell 112)" '^AB$'
put "$(cell 104)" -7 "$(cell 108)" 70000 "$(cell 101)" false "$(cell 112)" abc
get "$(cell 104)" '^-7$'
get "$(cell 112)" '^abc$'
get "$(cell 108)" '^70000$'

# The PLC is the control CPU of its station, by SLMP, and values of several units are read together.
# Its devices are not reached by their names, but a global label is, wherever it lies.
run 0 --trust read --value "$url" "$(cell 104)" "$(cell 108)" "$(cell 110)" "$(cell 112)"
says '^-7$'
says '^70000$'
says '^1.5$'
says '^abc$'
cp cell.busbar device.busbar
run 0 project map device.busbar "ns=1;i=102" D100
cp device.busbar project/project/project.busbar
power_cycle
get_refused Bad_NoCommunication "$(cell 102)"
asked() { "$busbar" --trust read "$url" "$(cell 102)" > out 2>&1; logged 'error 1921H: .*: D100 of '; }
await asked
cp cell.busbar project/project/project.busbar
power_cycle
await gets "$(cell 104)" '^-7$'

# It goes away, and comes back with its own values.
kill -9 $plc
wait $plc 2> /dev/null
await gets "$(cell 104)" Bad_NoCommunication
start_plc
await gets "$(cell 104)" '^5$'

# It comes back without a label, by another program: as the manual has it, no mapped node can be used.
kill -9 $plc
wait $plc 2> /dev/null
await gets "$(cell 104)" Bad_NoCommunication
rm -f plc.in
mkfifo plc.in
"$responder" slmp --listen "127.0.0.1:$plc_port" --label Line.W=4:0900 < plc.in > plc.log 2>&1 &
plc=$!
exec 7> plc.in
await logged 'Line.DW'
get_refused Bad_NoCommunication "$(cell 104)"
finish
