#!/bin/sh
# A program of labels of which something cannot be served: the PLC of model mode starts without that,
# and does not become less by a mistake in its file.
# usage: labels_left_out_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
. "$here/cell.sh"

# program MORE: that of the cell, with a variable whose type nobody declares, and these.
program() {
    cell_program
    printf "VAR_GLOBAL {attribute 'publish' := 'publish only'}\n    Delay : TON;\n    %s\nEND_VAR\n" "$1"
}
speed() {
    as hmi 0 read --value "$url" "$(cell 104)"
    says "^$1\$"
}
is_taken_over() { [ "$(grep -c 'downloaded: line.st' log)" -gt "$taken" ]; }
# take_over: the file's program is in force after it.
take_over() {
    taken=$(grep -c 'downloaded: line.st' log)
    kill -HUP "$pid"
    await is_taken_over
    due=yes
}
# pending PATTERN
pending() {
    chief 0 admin status "$url"
    says "^Pending changes: *$1"
}

{
    server "$port" pki
    printf '[labels]\nprogram = "line.st"\n'
} > module.toml
program '' > line.st
run 0 project new line.busbar
run 0 project import line.busbar "$here/cell.xml"
cell_table > cell.csv
run 0 project csv line.busbar --in cell.csv
run 0 project set line.busbar "listener 1.address" 127.0.0.1 "listener 1.port" $port
run 0 project user line.busbar hmi --new-password-file password --permission client \
    --pbkdf2-iterations 10000
mkdir -p project/project
cp line.busbar project/project/project.busbar
begin pki --config module.toml --project project
logged 'left out: line.st:.*TON' || fail "the log does not say what is left out"
one_step # the value is not kept
as hmi 0 write "$url" "$(cell 104)" 12
speed 12

# A mistake in a variable, and one in the type that all labels are of.
program 'Width : INTEGER;' > line.st
hang_up 'line.st:.*(Width): .*INTEGER.*; nothing was changed'
pending 'line.st:.*INTEGER'
speed 12
program '' | sed 's/ W : INT := 5;/ W : INTEGER;/' > line.st
hang_up 'line.st:.*INTEGER.*; nothing was changed'
speed 12
# So is one that is meant to count with a restart, or after power was gone.
chief 1 project restart "$url" --yes --seconds 0
says 'line.st:.*INTEGER'
speed 12
step_ends
power_cycle
pending 'line.st:.*INTEGER.*ran with last'
as hmi 0 read --value "$url" "$(cell 104)"
hang_up 'line.st:.*INTEGER.*; nothing was changed'

# What it left out before it leaves out again, and what is mended counts.
program 'Width : INT := 8;' > line.st
take_over
pending none
as hmi 0 read --value "$url" "$(cell 104)"

# It can be meant.
# told 'a changed program is refused because of such a declaration'
program '' | sed 's/ W : INT := 5;/ W : INTEGER;/' > line.st
hang_up 'line.st:.*INTEGER.*; nothing was changed'
one_step
printf '[labels]\nprogram = "line.st"\nstrict = false\n' > labels
sed '/^\[labels\]/,$d' module.toml | cat - labels > lenient.toml
mv lenient.toml module.toml
take_over
pending none
as hmi 3 read "$url" "$(cell 104)"
says Bad_NoCommunication
step_ends
power_cycle
pending none
sed -i 's/^strict = false/strict = true/' module.toml
program '' > line.st
hang_up 'line.st:.*TON.*; nothing was changed'
cell_program > line.st
take_over
as hmi 0 read --value "$url" "$(cell 104)"
power_cycle
pending none
shut_down
finish
