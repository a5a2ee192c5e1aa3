#!/bin/sh
# The names of a project in the server's certificate, also where that was made before there was a
# project (SH-082679, 9.10), and the records of certificates that come and go.
# usage: certificate_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"

server "$port" pki > controller.toml

# The first start makes a certificate, and there is no project yet.
begin pki --config controller.toml --project project
logged 'other names are configured' && fail "nobody has configured names"
chief 0 admin cert show "$url"
says '^own *Busbar'

run 0 project new line.busbar
run 0 project set line.busbar "listener 1.address" 127.0.0.1 "listener 1.port" "$port" \
    network.host_name LINE4HOST certificate.server_name LINE4 certificate.organization ACME \
    certificate.country JP security.mode SignAndEncrypt security.policies Basic256Sha256
chief 0 project write "$url" line.busbar --yes
chief 0 project update "$url" --yes
await logged 'own certificate is CN=Busbar, O=Busbar, and other names are configured'

# Made again it has them, and lasts for twenty years.
# Until the update is in force, it is made with the names from before.
makes_new_one() {
    reaches admin cert regenerate "$url" --yes && reaches --json admin cert show "$url" &&
        grep -q 'CN=LINE4' out
}
await makes_new_one
says 'O=ACME'
says 'C=JP'
says 'LINE4HOST'
years=$(($(sed -n 's/.*"valid[A-Za-z]*":"\([0-9]*\)-.*"valid[A-Za-z]*":"\([0-9]*\)-.*/\2 - \1/p' out)))
[ "$years" -eq 20 ] || [ "$years" -eq 21 ] || fail "it lasts for $years years"
shut_down
serve --config controller.toml --project project
logged 'other names are configured' && fail "the certificate has the names"
shut_down

# What comes into the folders of a machine that runs, and goes, is in the execution log once; what
# was there at the start is not (W588, 7-1-1).
machine >> controller.toml
press 17 > press.st
mine=$(ls pki/trusted/certs)
records() { cat medium/packages/OPCUA_Server/ExecutionLog/*.log 2> /dev/null | grep -c -e "$1"; }
has_records() { [ "$(records "$1")" -eq "$2" ]; }
serve --config controller.toml
chief 0 admin status "$url"
cp pki/own/certs/*.der pki/rejected/certs/dropped.der
kill -HUP "$pid"
await has_records 'CERT.*0100.*REJECTED' 1
mv pki/rejected/certs/dropped.der pki/issuers/certs/
kill -HUP "$pid"
await has_records 'CERT.*0102.*REJECTED->ISSUER' 1
rm pki/issuers/certs/dropped.der
kill -HUP "$pid"
await has_records 'CERT.*0101.*ISSUER' 1
chief 0 admin trust add "$url" pki/own/certs/*.der
await has_records 'CERT.*0100.*TRUSTED' 1
shut_down
has_records 'CERT.*010[0-2]' 4 || fail "the execution log has other records of certificates"
has_records "${mine%% \[*}.*0100" 0 || fail "what was there at the start was added"
finish
