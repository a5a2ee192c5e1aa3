#!/bin/sh
# The first connection to a controller that nobody can log in to: the steps that its start tells, and
# a setup that is cut, by its client's end or by a power cut, and done again.
# usage: setup_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
takes_long

press 17 > press.st
# fresh FOLDER: a controller that nobody has touched, with its code in the file "code".
fresh() {
    cat > "$1.toml" << END
[server]
address = "127.0.0.1"
port = 0
[certificates]
folder = "$1"
[limits]
first_login_delay_ms = 0
max_login_delay_ms = 0
[users]
setup = true
[machine]
program = "press.st"
state = "$1-state"
medium = "$1-medium"
[[endpoint]]
policy = "Basic256Sha256"
mode = "SignAndEncrypt"
END
    fresh_again "$1"
}
# fresh_again FOLDER: the same as it is configured.
fresh_again() {
    serve --config "$1.toml"
    sed -n 's/.*with the code \([^,]*\),.*/\1/p' log > code
    [ -s code ] || fail "there is no code"
}
as_setup() {
    wanted_by=$1
    shift
    run "$wanted_by" --user setup --password-file code --trust "$@"
}
setup() { as_setup "$1" admin setup "$url" chief --new-password-file password; }
# Chief administers, and reads and writes; strangers are strangers.
is_done() {
    await logged 'the setup is over'
    run 0 --user chief --password-file password admin status "$url"
    run 0 --user chief --password-file password admin user list "$url"
    run 0 --user chief --password-file password write "$url" "nsu=urn:busbar:machine;s=Speed" "$1"
    run 0 --user chief --password-file password read --value "$url" "nsu=urn:busbar:machine;s=Speed"
    says "^$1\$"
    run 4 --pki stranger --user chief --password-file password --trust admin status "$url"
}

# The steps, as they are told: a newcomer who has no certificate and trusts nobody.
fresh first
sed -n 's/^  1\. busbar //p' log > told
grep -q "^admin setup $url chief --user setup\$" told || fail "the first step is not told"
thumbprint=$(sed -n 's/^  certificate: //p' log)
setup 0
says "$thumbprint"
says 'chief administers the server from now on, and writes variables'
is_done 5
logged "  2\. busbar watch $url --user chief" || fail "the second step is not told"
logged "  3\. other clients" || fail "the third step is not told"
run 0 --pki stranger cert show
stranger=$(sed -n 's/.*[Tt]humbprint: *//p' out | head -n 1)
run 0 --user chief --password-file password admin trust list "$url"
says '^rejected'
rejected=$(sed -n 's/^rejected .* \([0-9A-F]*\)$/\1/p' out)
[ -z "$stranger" ] || [ "$stranger" = "$rejected" ] || fail "another one was rejected: $rejected"
run 0 --user chief --password-file password admin trust move "$url" "$rejected"
run 0 --pki stranger --user chief --password-file password admin status "$url"
# Again: it is over, and says what to do.
setup 4
says 'hint: the code is wrong, or the setup is over'
power_cycle
is_done_still() { run 0 --user chief --password-file password admin status "$url"; }
is_done_still
logged 'setup:' && fail "the setup goes on"
shut_down

# Cut after each of its steps, by a power cut too: done again it works, with another password as well.
for cut in user Operator ConfigureAdmin; do
    rm -rf "$XDG_DATA_HOME"
    fresh "cut$cut"
    echo "Another_12345" > other
    as_setup 0 admin user add "$url" chief --new-password-file other
    for role in Operator ConfigureAdmin; do
        [ $cut = user ] && break
        as_setup 0 admin role grant "$url" chief $role
        [ $cut = $role ] && break
    done
    power_cycle
    logged 'by the code that an earlier start has shown; if it is lost' ||
        fail "$cut: the start does not say that the code is still good"
    run 4 --user chief --password-file password --trust admin user list "$url"
    setup 0
    is_done 6
    shut_down
done

# Killed at any time: it can be done again, or is done.
rm -rf "$XDG_DATA_HOME"
fresh killed
for wait in 0.05 0.1 0.2 0.3 0.4 0.5 0.6 0.8; do
    timeout -s KILL $wait "$busbar" --user setup --password-file code --trust admin setup "$url" \
        chief --new-password-file password > /dev/null 2>&1 < /dev/null
    logged 'the setup is over' && break
done
# The server may have done the last request after its client was killed.
timeout 60 "$busbar" --user setup --password-file code --trust admin setup "$url" chief \
    --new-password-file password > out 2>&1 < /dev/null
code=$?
case $code in
    0) ;;
    4)
        says 'hint: the code is wrong, or the setup is over'
        logged 'the setup is over' || fail "killed: the code is refused before the setup is over"
        ;;
    *) fail "killed: exit code $code" ;;
esac
is_done 7
shut_down

# Without a port nobody could use a code: none is made, and the start says what to do.
rm -rf "$XDG_DATA_HOME"
sed -e 's/"first/"closed/' -e 's/^\[machine\]/&\nuse = false/' first.toml > closed.toml
rm -f log # or that of the one before is found
"$controller" --config closed.toml > log 2>&1 < /dev/null &
pid=$!
await logged '^ready'
logged 'setup: there is no administrator, and no port .* use = true in \[machine\] shows a code' ||
    fail "it does not say what to do"
logged 'with the code' && fail "a code is shown that nobody can use"
shut_down
sed -i '/^use = false/d' closed.toml
fresh_again closed
setup 0
is_done 8
shut_down
# A start that fails has shown no code: the one that succeeds shows one.
rm -rf "$XDG_DATA_HOME"
echo "no NodeSet" > broken.xml
sed -e 's/"first/"failed/' -e 's/^\[server\]/&\nnodesets = ["broken.xml"]/' first.toml > failed.toml
"$controller" --config failed.toml > log 2>&1 < /dev/null && fail "it starts without its models"
logged 'broken.xml' || fail "it does not say why"
logged 'with the code' && fail "a code is shown that nobody can use"
[ -e failed/setup.code ] && fail "a code stays that nobody has seen"
sed -i '/^nodesets/d' failed.toml
fresh_again failed
setup 0
is_done 9
shut_down
finish
