#!/bin/sh
# The server of a project registers with a discovery server, by which clients find it while it runs,
# and no longer (SH-082679, 9.11). The discovery server is node-opcua's, which comes with the peers
# of tests/interop; without it this is skipped.
# usage: discovery_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
. "$here/cell.sh"

modules=$(dirname "$controller")/../tests/interop/node_modules
if [ ! -d "$modules/node-opcua" ] || ! env node --version > /dev/null 2>&1; then
    echo "there is no node-opcua to register with"
    exit 77
fi
lds=$((port + 1))
env node "$here/lds.cjs" "$modules" $lds lds > lds.log 2>&1 < /dev/null &
lds_pid=$!
trap 'kill $pid $lds_pid 2>/dev/null; wait; rm -rf "$work"' EXIT

cell_program > line.st
cell_project cell.busbar
cell_controller '' '' > module.toml
discover() { ends_with 0 --trust discover "opc.tcp://localhost:$lds"; }
is_found() { discover && grep -q -e "opc.tcp://[^ ]*:$port" out; }
is_lost() { discover && ! grep -q -e "opc.tcp://[^ ]*:$port" out; }
# To load it takes a while where others build: a minute.
is_ready() { grep -q -s '^ready' lds.log; }
lds_ready() {
    for _ in $(seq 300); do
        ! is_ready || return 0
        sleep 0.2
    done
    return 1
}
lds_ready || fail "the discovery server does not start: $(cat lds.log)"

entry model 9.11: discovery
run 0 project set cell.busbar discovery.url "opc.tcp://localhost:$lds" discovery.interval_s 10
serve_cell cell.busbar
await logged 'is registered'
await is_found
run 0 --trust endpoints "$url"
kill "$pid"
await ended
await is_lost
# Killed without a word it is there again after its next start.
serve_cell cell.busbar
await is_found
power_cut
serve --config module.toml --project project
await logged 'is registered'
await is_found
# The discovery server forgets it, and learns of it again with the next registration.
kill -9 $lds_pid
wait $lds_pid 2> /dev/null
await logged 'cannot register\|no connection\|is not registered'
env node "$here/lds.cjs" "$modules" $lds lds > lds.log 2>&1 < /dev/null &
lds_pid=$!
lds_ready
await is_found
kill "$pid"
await ended
await is_lost

# A machine's server that is shut down is not to be found, although the controller goes on; after
# its restart it is.
{
    server "$port" machine-pki
    machine
    printf '[discovery]\nurl = "opc.tcp://%s:%s"\n' "$(uname -n)" "$lds"
} > machine.toml
press 0 > press.st
begin machine-pki --config machine.toml
await is_found
one_step
chief 0 admin shutdown "$url" --seconds 0 --yes
await logged 'is taken back from the discovery server'
await is_lost
await reaches admin status "$url"
says '^Server operating status: *Shutdown'
chief 0 admin shutdown "$url" --restart --seconds 0 --yes
await is_found
await reaches admin status "$url"
says '^Server operating status: *Running'
step_ends
finish
