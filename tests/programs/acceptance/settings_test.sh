#!/bin/sh
# The settings of the server: address, use, port, end point and execution log, when a change counts,
# and what transfers, restores and clears take of them (W588, 3-1-1, 3-2-2, 3-2-3 and 3-2-9).
# usage: settings_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
. "$here/certificates.sh"

setting() {
    chief 0 admin setting list "$url" "$1"
    says "^$1  *$2\\( \\|\$\\)"
}
refuses() {
    chief 1 admin setting set "$url" "$1" "$2"
    says "$1"
    says "$3"
}

{
    server "$port" pki | sed 's/^\[limits\]/[limits]\npreset = "nj501"/'
    machine 'mode = "PROGRAM"'
} > controller.toml
sed -i '/^execution_log = true/d' controller.toml
press 17 > press.st
echo "Ab345678" > good
begin pki --config controller.toml

entry variables 3-2-2: execution log settings
setting machine.execution_log false
setting machine.execution_log_files 24
setting machine.execution_log_records 12000
[ -e medium/packages/OPCUA_Server/ExecutionLog/OPCUA_ExecutionLog.log ] &&
    fail "there is a log without the setting"
refuses machine.execution_log_files 1 2
refuses machine.execution_log_files 101 100
refuses machine.execution_log_records 99 100
refuses machine.execution_log_records 65537 65536
one_step
chief 0 admin setting set "$url" machine.execution_log true machine.execution_log_files 2 \
    machine.execution_log_records 100
says 'wait for a restart'
restart
step_ends
setting machine.execution_log_records 100
await [ -e medium/packages/OPCUA_Server/ExecutionLog/OPCUA_ExecutionLog.log ]
chief 0 admin setting reset "$url" machine.execution_log_files machine.execution_log_records
setting machine.execution_log_files 24
setting machine.execution_log_records 12000

entry variables 3-2-2: port
setting server.port "$port"
refuses server.port 1024 1025
refuses server.port 80 1025
refuses server.port 65536 65535
one_step
chief 0 admin setting set "$url" server.port $((port + 1))
says 'wait for a restart'
chief 0 admin status "$url"
says '^Restart due: *.*server.port'
chief 0 admin shutdown "$url" --restart --seconds 0 --yes
url=opc.tcp://127.0.0.1:$((port + 1))
await is_running
step_ends
entry variables 3-2-2: end point
chief 0 admin status "$url"
says "^End point: *opc.tcp://127.0.0.1:$((port + 1))\$"
logged "endpoint: .*Basic256Sha256" || fail "the start does not show its end points"
one_step
chief 0 admin setting reset "$url" server.port
chief 0 admin shutdown "$url" --restart --seconds 0 --yes
url=opc.tcp://127.0.0.1:$port
await is_running
step_ends

# Neither of them changes in RUN.
entry variables 3-2-2: port
chief 0 admin mode "$url" run --yes
refuses server.port $((port + 2)) 'RUN'
entry variables 3-2-2: use
refuses machine.use false 'RUN'
# The default is Use: the maker's tool sets it by USB (4-1-1), here the server is the only way in.
departs machine.use false 3-2-2
chief 0 admin mode "$url" program --yes
one_step # without a port nobody could be asked
chief 0 admin setting set "$url" machine.use false
says 'wait for a restart'
entry variables 3-2-3: restart due
chief 0 admin status "$url"
says '^OPC UA Server: *Use$'
says '^Restart due: *.*machine.use'
chief 0 admin setting reset "$url" machine.use
step_ends
chief 0 admin status "$url"
says '^Restart due: *no$'

entry variables 3-2-2: port used by another
power_cut
sed -e 's/"pki"/"other-pki"/' -e '/^\[machine\]/,/^mode/d' controller.toml > squatter.toml
"$controller" --config squatter.toml > squatter 2>&1 < /dev/null &
squatter=$!
await grep -q '^ready' squatter
serve --config controller.toml
await has_records 'SERVER 0007 HaltError Server Start Error$' 1
chief 0 admin events "$url" --code 35D00000
says '35D00000 OPC UA Server Setting Error'
kill -9 $squatter
wait $squatter 2> /dev/null
url=opc.tcp://127.0.0.1:$port
await is_running

# A certificate with another address than the server has.
entry variables 3-1-1: address and mismatch
one_step
chief 0 admin cert regenerate "$url" --subject 'CN=NxOpcUaServer@192.0.2.50/O=Works' \
    --host 192.0.2.50 --host localhost --yes
url=opc.tcp://localhost:$port
await logged 'event log: 15020000 Server Certificate Mismatch'
await has_records 'CERT 0004 Mismatch_Host NxOpcUaServer@192.0.2.50 20[0-9T:.-]*Z' 1
step_ends
power_cut
serve --config controller.toml
await logged 'event log: 15020000 Server Certificate Mismatch'
one_step
chief 0 admin cert regenerate "opc.tcp://localhost:$port" --host 127.0.0.1 --host localhost \
    --host "$(hostname)" --yes
chief 0 admin cert show "$url"
says '^Subject: .*NxOpcUaServer@127.0.0.1'
step_ends
power_cycle
chief 0 admin status "$url"
says "^End point: *opc.tcp://127.0.0.1:$port\$"
logged 15020000 && fail "a certificate that was made again does not match"

# What each operation takes. The certificate of the server goes with none, the log is never cleared.
entry variables 3-2-9: what transfers, restores and clears take
chief 0 admin setting set "$url" limits.sessions 4
chief 0 admin user add "$url" joan --new-password-file good
authority works
revoking works
chief 0 admin trust add "$url" --issuer works.pem works.crl
chief 0 admin cert show "$url"
own=$(sed -n 's/^Thumbprint: *//p' out)
chief 0 admin backup "$url" whole.backup
chief 0 admin setting set "$url" limits.sessions 3
chief 0 admin user remove "$url" joan --yes
chief 0 admin trust remove "$url" "$(thumbprint_of works.pem)" --yes
has_profile() {
    chief 0 admin user list "$url"
    "says$1" '^joan'
    chief 0 admin trust list "$url"
    "says$1" '^issuers *works '
    "says$1" '^issuers crl .*CN=works '
    chief 0 admin cert show "$url"
    says "^Thumbprint: *$own\$"
}
chief 0 admin restore "$url" whole.backup --without-security-profile --yes
power_cycle
setting limits.sessions 4
has_profile _not
chief 0 admin restore "$url" whole.backup --yes
power_cycle
setting limits.sessions 4
has_profile ''
press 18 > sent.st
chief 0 admin program download "$url" sent.st --yes
await logged 'downloaded: sent.st'
power_cycle
setting limits.sessions 4
has_profile ''
before=$(records 'SERVER 0001 Start')
chief 0 admin clear "$url" --yes
says 'restart'
power_cycle
setting limits.sessions 5
has_profile ''
[ "$(records 'SERVER 0001 Start')" -ge "$before" ] || fail "the execution log was cleared"
shut_down
finish
