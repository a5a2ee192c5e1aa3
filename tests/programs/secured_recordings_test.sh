#!/bin/sh
# busbar proxy between a client and busbar-controller that both have security: it ends the channels of both.
# usage: secured_recordings_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"

echo "Long-Password-123" > password
cat > level.st << END
{attribute 'publish' := 'publish only'}
VAR_GLOBAL
    Level : LREAL := 1.5;
END_VAR
END
cat > machine.toml << END
[server]
port = 0
address = "127.0.0.1"
[certificates]
folder = "pki"
[machine]
program = "level.st"
state = "state"
[[endpoint]]
policy = "Basic256Sha256"
[users]
anonymous = "no"
password_hash = "pbkdf2"
password_iterations = 10000
[[users.account]]
name = "operator"
password = "$(quick_hash password)"
access = "write"
[limits]
login_failures_per_address = 1000
first_login_delay_ms = 0
max_login_delay_ms = 0
END
trap 'kill $pid $proxy 2> /dev/null; wait; rm -rf "$work"' EXIT
proxy=""
serve --config machine.toml
first=$url
level="nsu=urn:busbar:machine;s=Level"
login="--user operator --password-file password"

# Both sides trust the proxy, and it them: each first meets a stranger.
run 4 --pki proxy proxy "$first"
says 'busbar cert trust'
says '\-\-pass'
run 4 --pki proxy --trust $login read "$first" "$level"
mv pki/rejected/certs/* pki/trusted/certs/
run 0 --pki proxy $login read "$first" "$level"
says 1.5

# proxy FILE ARGUMENTS...: in the background, with its URL in through.
proxy() {
    file=$1
    shift
    "$busbar" --pki proxy proxy "$first" --record "$file" "$@" > "$file.out" 2> "$file.err" < /dev/null &
    proxy=$!
    await grep -q -s ' leads to ' "$file.err"
    through=$(sed -n 's/^busbar: \([^ ]*\) leads to.*/\1/p' "$file.err")
}
stop() {
    kill -TERM "$proxy"
    wait "$proxy"
    code=$?
    proxy=""
    [ "$code" -eq "$1" ] || fail "the proxy ends with $code instead of $1: $(cat "$file.err")"
}
proxy a.rec
run 4 --pki client --trust $login read "$through" "$level"
await grep -q 'Trust List Check failed' a.rec.err
mv proxy/rejected/certs/* proxy/trusted/certs/
run 0 --pki client $login read "$through" "$level"
says 1.5
run 4 --pki client --user operator --password wrong read "$through" "$level"
stop 0
grep -q 'server -> ReadResponse Double 1.5' a.rec.out || fail "the proxy does not show the response"
grep -q 'Long-Password' a.rec a.rec.out a.rec.err && fail "the password is told"
grep -q '4c6f6e672d50617373776f7264' a.rec && fail "the password is recorded"
[ "$(stat -c %a a.rec)" = 600 ] || fail "others can read what was secret"

# Faults by field.
proxy b.rec --fault 'edit results[0].value = Double:9 at ReadResponse 2' --any-client
run 0 --pki other --trust $login read "$through" "$level"
says 'Level *9 '
stop 0
grep -q 'insecure: every client is accepted' b.rec.err || fail "it does not warn of any client"
run 1 diff a.rec b.rec
says 'ReadResponse to .*: results\[0\].value Double 1.5 -> Double 9'

# The same requests again, with security and a user.
run 0 --pki proxy $login replay "$first" b.rec --tolerance 7.5
run 4 --pki proxy replay "$first" b.rec

# Channels that it passes on are secret, unless their keys are there.
proxy c.rec --pass
run 0 --pki proxy --ignore host-name $login read "$through" "$level" --key-log keys
stop 0
if grep -q 'this build does not export keys' out; then
    exit $failures
fi
says 'insecure: the keys of all channels are written to keys'
[ "$(stat -c %a keys)" = 600 ] || fail "others can read the keys"
run 5 diff c.rec c.rec
says 'messages are secured and not compared; let .busbar proxy. end the channels, or give their'
run 0 diff c.rec c.rec --keys keys --junit junit.xml
[ "$(stat -c %a junit.xml)" = 600 ] || fail "others can read the report of what was secret"
echo 'client_key_1_1: 00' > other.keys
run 5 diff c.rec c.rec --keys other.keys
says 'other.keys: these keys are'
run 0 show c.rec --keys keys --filter 'service=Read and status=Good and from=server' --pcapng c.pcapng
says 'server -> ReadResponse Double 1.5'
[ "$(stat -c %a c.pcapng)" = 600 ] || fail "others can read the keys in the capture"
touch open.keys
chmod 644 open.keys
run 1 --pki proxy $login read "$first" "$level" --key-log open.keys
says 'others may read or write it'
exit $failures
