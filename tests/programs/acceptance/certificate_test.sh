#!/bin/sh
# The names of a project in the server's certificate, also where that was made before there was a
# project (seed 001, 9.10).
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
await reaches admin cert regenerate "$url" --yes
await reaches --json admin cert show "$url"
says 'CN=LINE4'
says 'O=ACME'
says 'C=JP'
says 'LINE4HOST'
years=$(($(sed -n 's/.*"valid[A-Za-z]*":"\([0-9]*\)-.*"valid[A-Za-z]*":"\([0-9]*\)-.*/\2 - \1/p' out)))
[ "$years" -eq 20 ] || [ "$years" -eq 21 ] || fail "it lasts for $years years"
shut_down
serve --config controller.toml --project project
logged 'other names are configured' && fail "the certificate has the names"
shut_down
exit $((failures > 0))
