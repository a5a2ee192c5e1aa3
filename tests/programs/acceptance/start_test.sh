#!/bin/sh
# A controller always starts: whatever has become of its program, its configuration, its settings,
# its project or its addresses since it ran last (W588, 4-2-4; SH-082679, 9.8 and 9.13).
# usage: start_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"

{
    server "$port" pki
    account operator '"Operator"'
    machine
} > good.toml
cp good.toml controller.toml
press 17 > good.st
cp good.st press.st

# A client that comes while the models are read, here from somebody slow, is refused at once instead
# of waiting for an answer; and the controller can be ended meanwhile.
run 0 cert create
is_client=yes
mkfifo slow.xml
sed -e 's/^\[server\]/&\nnodesets = ["slow.xml"]/' -e 's/"pki"/"slow-pki"/' -e 's/"state"/"slow-state"/' \
    -e 's/"medium"/"slow-medium"/' good.toml > slow.toml
for end in kill read; do
    "$controller" --config slow.toml > slow 2>&1 < /dev/null &
    slow=$!
    exec 3> slow.xml # returns once it is read
    as chief 3 read "opc.tcp://127.0.0.1:$port" i=2259
    says 'refused'
    if [ $end = kill ]; then
        kill $slow
        wait $slow || fail "it ends with $?"
    else
        cat "$here/cell.xml" >&3
    fi
    exec 3>&-
done
await grep -q '^ready' slow
kill $slow
wait $slow || fail "it ends with $?"

begin pki --config controller.toml
value Speed 17

# A program that was copied in half, or is wrong.
printf 'VAR_GLOBAL\n    Speed : IN' > press.st
power_cycle
logged 'press.st:2:.*; it begins with what it ran with last' || fail "the log does not say so"
value Speed 17
# What was used once stays there to be used again.
power_cycle
value Speed 17
rm press.st
power_cycle
value Speed 17
sed 's/17/18/' good.st > press.st
power_cycle
logged 'ran with last' && fail "it began with what it ran with last, though nothing is wrong"
value Speed 18

# A configuration that is no TOML, or says what is not possible.
for damage in '[[[' 'nonsense = 1' '[limits.sessions]'; do
    { cat good.toml; echo "$damage"; } > controller.toml
    power_cycle
    logged 'controller.toml:.*; it begins with what it ran with last' || fail "$damage: no line"
    value Speed 18
done
cp good.toml controller.toml
# One that is not there was not meant: it is refused.
timeout 30 "$controller" --config other.toml > other 2>&1 && fail "another configuration was used"
grep -q 'other.toml: the file cannot be read' other || fail "no reason was told"

# Settings that are damaged.
chief 0 admin setting set "$url" limits.sessions 7
power_cycle
echo '{"version":1,' > pki/settings.json
power_cycle
logged 'settings.json.*; it begins with what it ran with last' || fail "settings: no line"
chief 0 admin setting list "$url" limits.sessions
says '7'
[ "$(cat pki/settings.json.refused)" = '{"version":1,' ] || fail "what was there is lost"

# A setting that could not work is not kept.
chief 1 admin setting set "$url" server.address 192.0.2.77
says 'cannot listen on'
chief 1 admin setting set "$url" server.nodesets '["good.st"]'
says "information models cannot be loaded"
says_not 'x0A' # a reason of several lines is one line

# An address that is gone: where it listened last, and where it is told to once it can.
sed 's/^address = .*/address = "192.0.2.77"/' good.toml > controller.toml
power_cycle
logged 'cannot listen on .* of 192.0.2.77.*; it listens where it did last' || fail "address: no line"
value Speed 18
sed 's/^address = .*/address = "192.0.2.78"/' good.toml > controller.toml
chief 1 admin shutdown "$url" --restart --yes
logged 'a restart is refused: server.port: cannot listen' || fail "a restart that fails was promised"
value Speed 18
cp good.toml controller.toml
hang_up 'read again'

# A port that somebody else has: the program runs, and administrators are let in at the machine.
power_cut
cat > squatter.toml << END
[server]
address = "127.0.0.1"
port = $port
[certificates]
folder = "other-pki"
trust_all_clients = true
[[endpoint]]
policy = "None"
mode = "None"
[users]
anonymous = "read"
END
"$controller" --config squatter.toml > squatter 2>&1 < /dev/null &
squatter=$!
await grep -q '^ready' squatter
serve --config controller.toml
logged 'the OPC UA server halts: Server Start Error' || fail "the server does not halt"
logged 'administrators reach it at this machine' || fail "nobody is told how to reach it"
[ "$url" = "opc.tcp://127.0.0.1:$port" ] && fail "it listens where somebody else does"
chief 0 admin status "$url"
as operator 1 read "$url" "nsu=urn:busbar:machine;s=Speed"
says 'Bad_NodeIdUnknown' # it is for administrators only
kill -9 $squatter
wait $squatter 2> /dev/null
await logged 'the OPC UA server runs at opc.tcp://127.0.0.1:'$port
url=opc.tcp://127.0.0.1:$port
value Speed 18
shut_down

# A project's security stays whatever is read again or changed online.
{
    server 0 module-pki
    printf '[[endpoint]]\npolicy = "None"\nmode = "None"\n'
} > module.toml
run 0 project new press.busbar
run 0 project set press.busbar security.policies Aes256_Sha256_RsaPss security.mode SignAndEncrypt \
    "listener 1.address" 127.0.0.1 "listener 1.port" $port
run 0 project user press.busbar hmi --new-password-file password --pbkdf2-iterations 10000
begin module-pki --config module.toml --project project
one_step # it listens elsewhere from the next start on
chief 0 project write "$url" press.busbar --yes
chief 0 project update "$url" --yes
url=opc.tcp://127.0.0.1:$port
await reaches project status "$url"
step_ends
is_secured() {
    run 0 endpoints "$url"
    grep -q 'Aes256' out || fail "$1: the project's policy is gone"
    grep -q 'None' out && fail "$1: there is an end point without security"
    run 0 --user hmi --password-file password --trust read --value "$url" i=2259
}
is_secured "after the update"
echo "# another line" >> module.toml
hang_up 'read again'
is_secured "after SIGHUP"
chief 0 admin setting set "$url" limits.sessions 20
is_secured "after a setting"
chief 0 admin user add "$url" newbie --new-password-file password
is_secured "after a user"
# A damaged project is not forgotten, either.
echo damaged > project/project/project.busbar
power_cycle --config module.toml --project project
logged 'the one that was served last is served' || fail "a damaged project: no line"
is_secured "after damage"
shut_down
finish
