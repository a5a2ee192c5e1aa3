#!/bin/sh
# Restarts a controller by `busbar admin shutdown --restart`: another server takes over behind the
# same listeners, and clients come back to it.
# usage: restart_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"


as_admin() {
    wanted=$1
    shift
    run "$wanted" --user chief --password-file chief --trust "$@"
}

# The sockets that listen at the port, as the system numbers them.
listening() {
    port=$(printf '%04X' "${url##*:}")
    awk -v port=":$port\$" '$2 ~ port && $4 == "0A" { print $10 }' /proc/net/tcp /proc/net/tcp6
}
restarted() { [ "$(grep -c '^ready' log)" -eq "$1" ]; }

echo "the chief's pass phrase" > chief
hash=$(quick_hash chief)
cat > controller.toml << END
[server]
port = 0
[certificates]
folder = "pki"
[[endpoint]]
policy = "Basic256Sha256"
mode = "SignAndEncrypt"
$quick_logins
[[users.account]]
name = "chief"
password = "$hash"
roles = ["SecurityAdmin", "ConfigureAdmin"]
[plc]
scan_ms = 10
[[plc.variable]]
name = "Speed"
type = "Int32"
initial = 1
END
speed="nsu=urn:busbar:plc;s=Speed"
serve --config controller.toml
run 0 cert create
as_admin 4 admin status "$url"
mv pki/rejected/certs/* pki/trusted/certs/
before=$(listening)
[ -n "$before" ] || fail "nothing listens at $url"

# Whoever is connected learns why, and comes back.
timeout 60 "$busbar" --json --user chief --password-file chief --trust subscribe "$url" "$speed" \
    --interval 50 --duration 60 > followed 2>&1 &
follower=$!
await grep -q -s '"value":1\b' followed
as_admin 0 admin setting set "$url" plc.scan_ms 25
says 'wait for a restart: plc.scan_ms'
sed -i 's/^initial = 1/initial = 2/' controller.toml
as_admin 1 admin shutdown "$url" --restart
says 'nothing was done'
as_admin 0 admin shutdown "$url" --restart --seconds 1 --reason "another recipe" --yes
says 'the server restarts in 1 s'
await restarted 2
logged 'another recipe' || fail "the log does not say why"
[ "$(listening)" = "$before" ] || fail "the port was closed"
await grep -q -s '"value":2\b' followed
kill -INT "$follower"
wait "$follower"
as_admin 0 --json admin setting list "$url" plc.scan_ms
says '"value":"25".*"waitsForRestart":false'

# What cannot be served is not: the server before goes on, and the log says why.
cp controller.toml good.toml
echo 'speed = 1' >> controller.toml
as_admin 1 admin shutdown "$url" --restart --seconds 0 --yes
await logged 'controller.toml:[0-9]*: found "speed", expected .*; nothing was changed'
as_admin 0 read "$url" "$speed"
says '2'
restarted 2 || fail "it is restarted"
cp good.toml controller.toml
kill -HUP "$pid"
await logged 'read again: 1 accounts'
as_admin 0 admin shutdown "$url" --restart --seconds 0 --yes
await restarted 3

# A port that somebody has is not taken, and the one before is not closed.
sed 's/^folder = .*/folder = "other"/' controller.toml > other.toml
"$controller" --config other.toml > other.log 2>&1 < /dev/null &
other=$!
await grep -q -s '^ready' other.log
taken=$(sed -n 's/.* variables at opc.tcp:[^ ]*:\([0-9]*\)$/\1/p' other.log)
sed -i "s/^port = .*/port = $taken/" controller.toml
as_admin 1 admin shutdown "$url" --restart --seconds 0 --yes
says "cannot listen on $taken"
await logged "server.port: cannot listen on $taken; nothing was changed"
[ "$(listening)" = "$before" ] || fail "the port was closed"
as_admin 0 read "$url" "$speed"
kill "$other"
wait "$other"

# Once nobody has it any more, the controller is at it without a time in which it is nowhere.
old=$url
as_admin 0 admin shutdown "$url" --restart --seconds 0 --yes
await restarted 4
logged 'starting again' && fail "the listeners were closed before there were others"
gone() { [ -z "$(url=$old; listening)" ]; }
await gone
url=$(sed -n 's/.* variables at \(opc.tcp:[^ ]*\)$/\1/p' log | tail -1)
[ "${url##*:}" = "$taken" ] || fail "it is at $url instead of port $taken"
as_admin 0 read "$url" "$speed"

# Another address of the same port cannot be opened beside the one before.
sed -i 's/^port = .*/&\naddress = "127.0.0.1"/' controller.toml
as_admin 0 admin shutdown "$url" --restart --seconds 0 --yes
await restarted 5
url=$(sed -n 's/.* variables at \(opc.tcp:[^ ]*\)$/\1/p' log | tail -1)
as_admin 0 read "$url" "$speed"
kill "$pid"
wait "$pid" || fail "the controller ends with $?"
pid=""
exit $((failures > 0))
