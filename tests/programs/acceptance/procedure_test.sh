#!/bin/sh
# From a controller whose server is not used to values that a client reads and writes, and what to
# look at then: the steps of the manual's procedure (W588, 1-3-1), over the network once there
# is one.
# usage: procedure_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"

entry variables 1-3: procedure
# 1-1 and 1-2: address, and that the server is not used yet.
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
setup = true
END
machine 'mode = "PROGRAM"
use = false' >> controller.toml
echo "VAR_GLOBAL Speed : INT := 17; END_VAR" > press.st
serve --config controller.toml
logged 'no port: use = false' || fail "it does not say that the server is not used"
logged 'setup: there is no administrator, and no port' || fail "it does not say what comes later"
logged 'with the code' && fail "a code is shown that nobody can use"
code() { sed -n 's/.*with the code \([^,]*\),.*/\1/p' log; }
code > code
url=opc.tcp://127.0.0.1:$port
run 3 --trust admin status "$url"
shut_down
# 1-3 to 1-5: a variable is published, the server is used after a reset.
press 17 > press.st
sed -i 's/^use = false/use = true/' controller.toml
serve --config controller.toml
[ -s code ] || code > code
[ -s code ] || fail "there is no code for the first administrator"
# 1-6 and 1-7: it has started; its first administrator, its certificate, clients, users.
run 0 --user setup --password-file code --trust admin setup "$url" chief \
    --new-password-file password
await logged 'the setup is over'
chief 0 admin status "$url"
says '^Server operating status: *Running$'
chief 0 admin cert regenerate "$url" --yes
chief 0 admin cert export "$url"
chief 0 admin user add "$url" hmi --new-password-file password
chief 0 admin role grant "$url" hmi Operator
hmi() {
    cycle_when_due
    wanted_of=$1
    shift
    run "$wanted_of" --pki panel --user hmi --password-file password "$@"
}
run 0 --pki panel cert trust ServerCertificate.der
hmi 4 read "$url" "$(node Speed)" # its certificate is one of the rejected ones
chief 0 admin trust list "$url"
says '^rejected '
chief 0 admin trust move "$url" "$(sed -n 's/^rejected .* \([0-9A-F]*\)$/\1/p' out)"
# 2-1 to 2-3: connect, look around, read and write.
hmi 0 endpoints "$url"
hmi 0 browse "$url" "$(node Controller/)" --depth 4
says 'Speed'
hmi 0 read --value "$url" "$(node Speed)"
says '^17$'
hmi 0 write "$url" "$(node Speed)" 18
hmi 0 read --value "$url" "$(node Speed)"
says '^18$'
# 4-1 to 4-3: errors of a client, the status, the logs.
hmi 1 read "$url" "$(node Sped)"
says 'Bad_NodeIdUnknown'
chief 0 admin status "$url"
says '^Current errors: *none$'
chief 0 admin events "$url"
says '95D00000 OPC UA Server Started'
chief 0 admin log "$url"
says ' Run$'
# 3-1: disconnect, shut down, switch off.
one_step
chief 0 admin shutdown "$url" --seconds 0 --yes
await logged 'the OPC UA server is shut down'
chief 0 admin status "$url"
says '^Server operating status: *Shutdown$'
shut_down
finish
