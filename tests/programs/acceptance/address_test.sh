#!/bin/sh
# The machine has another address than before while its server runs: the server is made anew, and
# says that its certificate does not name that address (W588, 3-1-1 and 4-2-5).
# usage: address_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
# In a network of its own, whose addresses nobody else has.
if [ -z "${has_own_network:-}" ] && unshare -rnu ip link set lo up 2> /dev/null; then
    has_own_network=yes exec unshare -rnu sh "$0" "$@"
fi
. "$(dirname "$0")/functions.sh"
. "$here/certificates.sh"
if [ -z "${has_own_network:-}" ]; then
    echo "left out: this user cannot have a network of his own"
    lacks variables 4-2-5: triggers -- no network of its own for the script of another address
    exit 77
fi

hostname localhost
ip link set lo up
ip address add 192.0.2.7/32 dev lo
{
    server "$port" pki | sed -e 's/^address = .*/address = ""/' \
        -e 's/^\[limits\]/[limits]\npreset = "nj501"/'
    machine 'mode = "PROGRAM"'
} > controller.toml
press 17 > press.st
begin pki --config controller.toml
is_running() {
    reaches admin status "$url" && grep -q 'operating status: *Running$' out
}
is_running || fail "it does not run"
run 0 endpoints "$url"
run 0 endpoints "opc.tcp://192.0.2.7:$port"
chief 0 admin cert show "$url"
says '^Hosts: .*192\.0\.2\.7'

entry variables 4-2-5: triggers
one_step
prepares=$(records 'SERVER 0004 Prepare$')
ip address add 192.0.2.8/32 dev lo
ip address del 192.0.2.7/32 dev lo
hang_up 'read again' # or within a minute
await has_records 'SERVER 0004 Prepare$' $((prepares + 1))
await has_records 'SERVER 0005 Run$' $((prepares + 1))
await logged 'event log: 15020000 Server Certificate Mismatch'
await has_records 'CERT 0004 Mismatch_Host NxOpcUaServer@192.0.2.7 20[0-9T:.-]*Z' 1
chief 0 admin events "opc.tcp://192.0.2.8:$port" --ignore host-name --code 15020000
says 'does not name an IP address or a host name of the controller'
chief 4 admin status "opc.tcp://192.0.2.8:$port" # whose name is in no certificate
chief 0 admin status "opc.tcp://192.0.2.8:$port" --ignore host-name
says '^Server operating status: *Running$'
says '^Current errors: *15020000 '
chief 0 admin cert regenerate "$url" --host 192.0.2.8 --host localhost --host 127.0.0.1 \
    --host ::1 --yes
await is_running
chief 0 admin status "opc.tcp://192.0.2.8:$port"
says '^Current errors: *none$'
step_ends
shut_down
finish
