#!/bin/sh
# Both days of examples/controller/GUIDE.md, command by command, each from an empty folder. What the
# integrator takes from the OPC Foundation comes with the peers of tests/interop; without them that
# day is left out.
# usage: guide_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"

guide=$here/../../../examples/controller/GUIDE.md
nodesets=$(dirname "$controller")/../tests/interop/node_modules/node-opcua-nodesets/nodesets
mkdir bin
ln -s "$busbar" bin/busbar
ln -s "$controller" bin/busbar-controller
PATH=$PWD/bin:$PATH

# commands HEADING: the lines of the section's blocks of shell, here with a port of this script.
commands() {
    awk -v heading="## $1" '
        /^## / { is_here = $0 == heading }
        is_here && /^```$/ { is_code = 0 }
        is_here && is_code
        is_here && /^```sh$/ { is_code = 1 }' "$guide" | sed "s/4840/$port/g"
}
# script: the lines as commands that are checked, of which a text of several lines is one. The process
# that is killed has ended before the next command, as it has for a user, who types that.
script() {
    awk '
        /<< .END.$/ { text = 1 }
        text { print; if ($0 == "END") { text = 0 } next }
        /[^&]&$/ || /^export / { print; next }
        /^kill -9 \$!$/ { print; print "wait $!"; next }
        /# refused$/ { print "! " $0 " || { echo \"FAILED: taken: " NR "\"; exit 1; }"; next }
        { print; print "[ $? -eq 0 ] || { echo \"FAILED: command of line " NR "\"; exit 1; }" }'
}
# day HEADING: in a folder of its own, and how many commands it has at most.
day() {
    commands "$1" > commands
    {
        echo "trap 'kill \$! 2> /dev/null; wait' EXIT"
        script < commands
    } > day.sh
    count=$(awk '/<< .END.$/ { text = 1; ++n } !text { ++n } $0 == "END" { text = 0 } END { print n }' commands)
    [ "$count" -gt 20 ] && [ "$count" -le 40 ] || fail "$1: $count commands"
    mkdir "$2"
    [ -d "$nodesets" ] && cp "$nodesets/Opc.Ua.Di.NodeSet2.xml" "$2/DI.xml" &&
        cp "$nodesets/Opc.Ua.PackML.NodeSet2.xml" "$2/PackML.xml"
    (cd "$2" && XDG_DATA_HOME=$PWD/data timeout 280 sh ../day.sh > out 2>&1) || {
        cp "$2/out" out
        cp "$2/controller.log" log 2> /dev/null
        fail "$1"
    }
}

day "A machine builder's day" machine
grep -q '^12$' machine/out || fail "a value that was written is gone"
if [ -d "$nodesets" ]; then
    day "An integrator's day" line
    grep -q '^1200$' line/out || fail "the Method of PackML does not set the speed"
    tail -n 1 line/out | grep -q "^900$" || fail "the label is not the one of the PLC, which began anew"
else
    echo "without node-opcua-nodesets: the integrator's day is left out"
fi
finish
