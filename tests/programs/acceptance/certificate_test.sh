#!/bin/sh
# The names of a project in the server's certificate, also where that was made before there was a
# project (seed 001, 9.10).
# usage: certificate_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/../functions.sh"

says() { grep -q -s -e "$1" out || fail "\"$1\" is not in the output of: $last"; }
as() {
    wanted=$1
    shift
    run "$wanted" --user chief --password-file password --trust "$@"
}

echo "patience is all" > password
hash=$(quick_hash password)
port=$((20000 + $$ % 12000))
cat > controller.toml << END
[server]
address = "127.0.0.1"
port = $port
[certificates]
folder = "pki"
[[endpoint]]
policy = "Basic256Sha256"
mode = "SignAndEncrypt"
$quick_logins
[[users.account]]
name = "chief"
password = "$hash"
roles = ["SecurityAdmin", "ConfigureAdmin", "Operator"]
END

# The first start makes a certificate, and there is no project yet.
run 0 cert create
serve --config controller.toml --project project
as 4 admin status "$url"
mv pki/rejected/certs/* pki/trusted/certs/
logged 'other names are configured' && fail "nobody has configured names"
as 0 admin cert show "$url"
says '^own *Busbar'

run 0 project new line.busbar
run 0 project set line.busbar "listener 1.address" 127.0.0.1 "listener 1.port" "$port" \
    network.host_name LINE4HOST certificate.server_name LINE4 certificate.organization ACME \
    certificate.country JP security.mode SignAndEncrypt security.policies Basic256Sha256
as 0 project write "$url" line.busbar --yes
as 0 project update "$url" --yes
await logged 'own certificate is CN=Busbar, O=Busbar, and other names are configured'

# Made again it has them, and lasts for twenty years.
await ends_with 0 --user chief --password-file password --trust admin cert regenerate "$url" --yes
await ends_with 0 --user chief --password-file password --trust --json admin cert show "$url"
says 'CN=LINE4'
says 'O=ACME'
says 'C=JP'
says 'LINE4HOST'
years=$(($(sed -n 's/.*"valid[A-Za-z]*":"\([0-9]*\)-.*"valid[A-Za-z]*":"\([0-9]*\)-.*/\2 - \1/p' out)))
[ "$years" -eq 20 ] || [ "$years" -eq 21 ] || fail "it lasts for $years years"
kill "$pid"
await ended
serve --config controller.toml --project project
logged 'other names are configured' && fail "the certificate has the names"
kill "$pid"
await ended
exit $((failures > 0))
