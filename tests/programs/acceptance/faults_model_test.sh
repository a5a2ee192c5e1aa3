#!/bin/sh
# Faults of model mode that users met once and that no other script looks for: each would come back
# here.
# usage: faults_model_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
takes_long
. "$here/cell.sh"

cell_program > line.st
cell_project cell.busbar
# Anonymous users write where the project lets them in, whatever the configuration has.
cell_controller '' '' | sed 's/^anonymous.*/anonymous = "no"/' > module.toml
serve_cell cell.busbar
put "$(cell 104)" 6
get "$(cell 104)" '^6$'

# The number of elements is told as such, also in a structure.
for part in 0 1 2; do
    run 0 project map cell.busbar "ns=1;i=162" "Line.Amounts[$part]" ".Amounts[$part]"
done
kill "$pid"
await ended
serve_cell cell.busbar
order() {
    echo "{\"Recipe\": {\"Name\": \"a\", \"Size\": 1, \"Mode\": 0}, \"Steps\": [], \"Amounts\": $1}"
}
run 0 --json --trust read "$url" "$(cell 162)"
put_refused Bad_WriteNotSupported "$(cell 162)" "$(order '[1, 2]')"

# What is mapped counts as Variables; a password that is none of the rules is told by them.
run 0 project check cell.busbar
says '^Variables  *[1-9]'
echo weak > weak
run 1 project user cell.busbar hmi --new-password-file weak
says_not 'PasswordRules'
kill "$pid"
await ended

# A project whose address is gone keeps no power cycle from starting.
rm -rf project pki
{
    server "$port" pki
    printf '[labels]\nprogram = "line.st"\n'
} > module.toml
run 0 project new line.busbar
run 0 project import line.busbar "$here/cell.xml"
run 0 project set line.busbar "listener 1.address" 127.0.0.1 "listener 1.port" $port
is_client=yes
begin pki --config module.toml --project project
one_step
chief 0 project write "$url" line.busbar --yes
chief 0 project update "$url" --yes
in_use() { reaches project status "$url" && grep -q 'project *in use' out; }
await in_use
run 0 project set line.busbar "listener 1.address" 192.0.2.77
chief 0 project write "$url" line.busbar --yes
ends_with 0 --user chief --password-file password --trust project restart "$url" --yes --seconds 0 &&
    await logged 'cannot listen'
chief 0 project status "$url"
says 'project *written, an update or restart is due'
power_cycle
logged 'cannot listen.*192.0.2.77' || fail "the log does not say so"
chief 0 project status "$url"
step_ends
shut_down

# A server that was stopped comes back although the project that waits for it cannot be served.
rm -rf project pki
run 0 project set line.busbar "listener 1.address" 127.0.0.1
run 0 project map line.busbar "ns=1;i=104" Line.W
begin pki --config module.toml --project project
one_step
chief 0 project write "$url" line.busbar --yes
chief 0 project update "$url" --yes
await in_use
run 0 project map line.busbar "ns=1;i=104" Line.S
chief 0 project write "$url" line.busbar --yes
chief 1 project restart "$url" --yes --seconds 0 # while it serves clients
says 'Line\.S of'
chief 0 project stop "$url" --yes --seconds 0
is_stopped() { reaches admin status "$url" && grep -q 'operating status: *Shutdown$' out; }
await is_stopped
chief 0 project restart "$url" --yes --seconds 0
is_back() { reaches admin status "$url" && grep -q 'operating status: *Running$' out; }
await is_back
says '^Pending changes: .*Line.S of ns=1;i=104.*goes on with what it ran with last'
chief 0 read --value "$url" "$(cell 104)"
says '^5$'
step_ends
shut_down
finish
