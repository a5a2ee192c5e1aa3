#!/bin/sh
# What the troubleshooting says is done when a client does not reach the server: the trouble is
# there, the remedy is a command that exists, and it helps (W588, 9-3; TROUBLESHOOTING.md).
# usage: remedies_connection_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
takes_long
. "$here/remedies.sh"

configure() {
    {
        server "$port" pki
        account op '"Operator"'
        machine "mode = \"PROGRAM\"
$1"
        printf '[[plc.program]]\nkind = "shutdown"\ntarget = "Trigger"\nsets = "Outcome"\n'
    } | sed 's/^\[limits\]$/[limits]\npreset = "nj501"/' > controller.toml
}
# program SPEED: it has the instruction OPCUA_Shutdown.
program() {
    cat > press.st << END_OF_PROGRAM
{attribute 'publish' := 'publish only'}
VAR_GLOBAL
    Speed : INT := $1;
    Trigger : BOOL;
    Outcome : UINT;
END_VAR
END_OF_PROGRAM
}
# reads CODE [URL]: the operator's reading ends so.
reads() { run "$1" --timeout 3 --user op --password-file password --trust read "${2:-$url}" i=2259; }
configure ''
program 17
begin pki --config controller.toml
home=$url
entry variables 9-3: remedies
one_step # what is to be there after a power cut is in other scripts

remedy 9-3.1 9-3.2
told 'no answer | another address or port'
reads 3 "opc.tcp://127.0.0.1:$((port + 1))"
says 'hint: nothing listens at this port'
reads 3 "opc.tcp://127.0.0.9:$port"
logged "variables at $url\$" || fail "the start does not tell the URL"
chief 0 admin status "$url"
says "^End point: *$url\$"
reads 0

# Another protocol or encoding than this: there is none but opc.tcp, which has UA Binary.
remedy 9-3.25 9-3.26
told 'the client knows another protocol'
for scheme in opc.https https opc.wss http; do
    reads 2 "$scheme${url#opc.tcp}"
    says 'opc.tcp'
done
run 0 --json endpoints "$url"
says 'uatcp-uasc-uabinary'
reads 0

remedy 9-3.6 9-3.46 9-3.51
told 'no answer | the cable'
follows op i=2258
await has_followed 20
kill -STOP "$pid"
reads 3
says 'check host, port and firewall'
await has_followed 'connection lost'
kill -CONT "$pid"
await has_followed 'connected again'
count=$(wc -l < followed)
more() { [ "$(wc -l < followed)" -gt $((count + 1)) ]; }
await more
ends_following
reads 0
recorded AUTH 0001 'Application CLOSE'

# What client and server can both do.
remedy 9-3.19 9-3.20
told 'Bad_SecurityPolicyRejected'
other() {
    ends_with "$1" --policy Aes256_Sha256_RsaPss --user op --password-file password --trust \
        read "$url" i=2259
}
other 4 || fail "a policy that is not there"
says 'see `busbar endpoints`'
run 0 endpoints "$url"
says 'Basic256Sha256'
says_not 'Aes256'
run 0 --policy Basic256Sha256 --user op --password-file password --trust read "$url" i=2259
chief 0 admin setting set "$url" endpoint "[\"{ mode = 'SignAndEncrypt', policy = 'Basic256Sha256' }\",
    \"{ mode = 'SignAndEncrypt', policy = 'Aes256_Sha256_RsaPss' }\"]"
await other 0
chief 0 --policy Basic256Sha256 admin setting reset "$url" endpoint
await is_running

remedy 9-3.24
told 'Bad_TooManySessions'
sleepers=""
for i in 1 2 3 4 5; do
    timeout 60 "$busbar" --user op --password-file password --trust subscribe "$url" i=2258 \
        --duration 60 > "sleeper$i" 2>&1 < /dev/null &
    sleepers="$sleepers $!"
    await grep -q -s '[0-9]' "sleeper$i"
done
reads 1
says 'close other clients'
recorded AUTH 0001 'BadTooManySessions'
# shellcheck disable=SC2086 # several
kill $sleepers
in_events 85600000
await ends_with 0 --user op --password-file password --trust read "$url" i=2259

# It is made anew for another program: who waits for it goes on.
remedy 9-3.11 9-3.43 9-3.50
told 'it is told that a program is downloaded'
follows op "$(node Speed)"
await has_followed '17$'
program 18
sed -i 's/Outcome : UINT/Outcome : UDINT/' press.st
hang_up 'downloaded: press.st'
await has_followed 'connection lost'
await has_followed '18$'
ends_following
recorded SERVER 0004 Prepare
recorded SERVER 0005 Run
await ends_with 0 --user op --password-file password --trust read "$url" "$(node Speed)"

# Shut down by the program: a restart, or the power.
remedy 9-3.10 9-3.42 9-3.49
told 'it was shut down'
for way in restart power_cycle; do
    follows op "$(node Speed)"
    await has_followed '18$'
    chief 0 write "$url" "$(node Trigger)" true
    await logged 'the OPC UA server is shut down'
    await has_followed Bad_ServerHalted
    status_is Shutdown
    says 'Restart due: *the OPC UA server was shut down'
    run 3 --user op --password-file password --trust read "$url" "$(node Speed)"
    says Bad_ServerHalted
    chief 0 admin events "$url" --code 95D10000
    says '95D10000 OPC UA Server Stopped'
    recorded SERVER 0006 Shutdown
    $way
    await is_running
    await has_followed 'connected again'
    ends_following
    as op 0 read "$url" "$(node Speed)"
done

# It is not to be used: the file, or what was changed online, says so.
remedy 9-3.8
told 'no answer, and the start says'
power_cut
configure 'use = false'
"$controller" --config controller.toml > log 2>&1 < /dev/null &
pid=$!
await logged 'no port: use = false'
reads 3
shut_down
configure ''
serve --config controller.toml
chief 0 admin setting set "$url" machine.use false
power_cut
rm -f log
"$controller" --config controller.toml > log 2>&1 < /dev/null &
pid=$!
await logged 'no port: use = false'
shut_down
"$controller" --config controller.toml --forget-changes > out || fail "nothing is forgotten"
serve --config controller.toml
reads 0

# Something else has the port: another one, or an end of that.
remedy 9-3.4
told '"cannot listen"'
power_cut
sed -e 's/"pki"/"other-pki"/' -e '/^\[machine\]/,$d' controller.toml > squatter.toml
"$controller" --config squatter.toml > squatter 2>&1 < /dev/null &
squatter=$!
await grep -q '^ready' squatter
serve --config controller.toml
status_is 'Halt error'
says '^Halted because of: *Server Start Error: .*cannot listen on'
recorded SERVER 0007 'Server Start Error'
in_events 35D00000
sed -i "s/^port = .*/port = $((port + 2))/" controller.toml
chief 0 admin shutdown "$url" --restart --seconds 0 --yes
await logged 'the OPC UA server runs at opc.tcp://127.0.0.1:'$((port + 2))
url=opc.tcp://127.0.0.1:$((port + 2))
reads 0
sed -i "s/^port = .*/port = $port/" controller.toml
power_cycle
chief 0 admin status "$url"
says '^Pending changes: .*it listens where it did last'
kill $squatter
wait $squatter 2> /dev/null
await logged "the OPC UA server runs at opc.tcp://127.0.0.1:$port"
url=$home
reads 0

# What it is configured by has a mistake, or is damaged.
remedy 9-3.7
told 'a file, a line and what was expected there'
told 'the controller ends with such a line'
cp controller.toml good.toml
cp press.st good.st
for file in controller.toml press.st; do
    echo '[[[' >> $file
    hang_up "$file:[0-9]*.*nothing was changed"
    chief 0 admin status "$url"
    says "^Pending changes: .*$file:[0-9]"
    cp "good.${file#*.}" $file
    hang_up 'read again'
    chief 0 admin status "$url"
    says '^Pending changes: *none$'
    echo '[[[' >> $file
    power_cycle
    logged "$file:[0-9]*.*it begins with what it ran with last" || fail "$file: no line"
    in_events 00000004
    cp "good.${file#*.}" $file
    power_cycle
    chief 0 admin status "$url"
    says '^Pending changes: *none$'
done
chief 0 admin setting set "$url" limits.sessions 4
power_cut
echo damaged > pki/settings.json
serve --config controller.toml
logged 'settings.json.*it begins with what it ran with last' || fail "settings: no line"
in_events 00000004
chief 0 admin setting set "$url" limits.sessions 3
power_cycle
chief 0 admin status "$url"
says '^Pending changes: *none$'
chief 0 admin setting list "$url" limits.sessions
says 'limits.sessions *3 '
shut_down
mkdir fresh
sed 's/"pki"/"fresh"/; s/"state"/"fresh-state"/; s/^port = .*/port = x/' controller.toml > fresh.toml
"$controller" --config fresh.toml > out 2>&1 && fail "a start without anything to begin with"
last=fresh.toml
says 'fresh.toml:[0-9]*: '
sed -i "s/^port = x/port = $port/" fresh.toml
serve --config fresh.toml
shut_down
finish
