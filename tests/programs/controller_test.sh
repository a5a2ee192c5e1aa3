#!/bin/sh
# Runs busbar-controller as operators do: without a file, on a terminal, with signals and with
# configurations that are wrong.
# usage: controller_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
# shellcheck source-path=SCRIPTDIR
. "$(dirname "$0")/functions.sh"

stop() {
    kill "$pid"
    wait "$pid" || fail "the controller ends with $?"
    pid=""
}

# refused TEXT ARGUMENTS...: the controller does not start and says so in one line.
refused() {
    wanted=$1
    shift
    timeout 30 "$controller" "$@" > out 2> log < /dev/null
    code=$?
    [ $code -eq 1 ] || fail "busbar-controller $*: exit code $code instead of 1"
    grep -q -F -e "$wanted" log || fail "busbar-controller $*: expected $wanted"
}

account() {
    printf '[[users.account]]\nname = "%s"\npassword = "%s"\n' "$1" \
        "$(printf '%s' "$2" | "$controller" --hash-password)"
}

# Without a file. Without a terminal no password is shown.
refused "expected a first start on a terminal" --port 0
[ -e busbar-certificates/operator.password ] && fail "a password that nobody has seen"
# start_on_terminal: in a terminal of its own; what it shows goes to log.
start_on_terminal() {
    rm -f pid log
    script -qfec "sh -c 'echo \$\$ > pid; exec \"$controller\" --port 0 2> errors'" log \
        > /dev/null 2>&1 < /dev/null &
    terminal=$!
    await logged '^ready' || exit 1
    pid=$(cat pid)
    url=$(tr -d '\r' < log | sed -n 's/.* variables at opc.tcp:[^ ]*:\([0-9]*\)$/opc.tcp:\/\/localhost:\1/p')
}
start_on_terminal
password=$(sed -n 's/.*user "operator", password "\([^"]*\)": shown this once.*/\1/p' log)
[ ${#password} -eq 23 ] || fail "a password of 23 characters"
grep -q -F -e "$password" errors && fail "the password is in the log"
[ "$(stat -c %a busbar-certificates/operator.password)" = 600 ] || fail "others may read the hash"
grep -q -F -e "$password" busbar-certificates/operator.password && fail "the password is stored"
echo "$password" > secret
login="--user operator --password-file secret"
run 4 read i=2258 --url "$url" $login --trust
mv busbar-certificates/rejected/certs/* busbar-certificates/trusted/certs/
run 0 read i=2258 --url "$url" $login --trust
tr -d '\r' < log | grep -q -E '^  plc: the task runs at (real-time priority 10|ordinary priority, .*LimitRTPRIO=10)$' ||
    fail "no word of the task's priority"
# Closing the terminal ends it.
kill -KILL $terminal
await ended
start_on_terminal
logged 'password "' && fail "the password is shown again"
run 0 read i=2258 --url "$url" $login --trust
kill "$pid"
await ended
pid=""

# The memory that each limit costs.
limits() {
    timeout 30 "$controller" "$@" > out 2> log < /dev/null || fail "busbar-controller $*: $?"
    grep -q '^limit .*key in \[limits\] .*memory' out || fail "no columns: $*"
    grep -q '^in all, at worst .*iB$' out || fail "no sum: $*"
}
limits --print-limits
grep -q '^max_sessions  *100  *sessions ' out || fail "the built-in limit"
printf '[limits]\nsessions = 7\n' > limits.toml
limits --print-limits limits.toml
grep -q '^max_sessions  *7  *sessions ' out || fail "the limit of the file"
limits --config limits.toml --print-limits
grep -q '^max_sessions  *7  *sessions ' out || fail "the limit of --config"
refused "none/limits.toml" --print-limits none/limits.toml

# Endpoints follow the address and the URL that clients used.
cat > plain.toml << END
[server]
address = "127.0.0.1"
port = 0
host_names = ["plc.example"]
[[endpoint]]
policy = "None"
[users]
anonymous = "write"
END
serve --config plain.toml
case $url in opc.tcp://127.0.0.1:*) ;; *) fail "the URL $url" ;; esac
logged 'clients may also use: plc.example' || fail "the names of the configuration"
run 0 discover "$url"
grep -q -F "opc.tcp://127.0.0.1:" out || fail "an endpoint by address"
run 0 discover "opc.tcp://localhost:${url##*:}"
grep -q -F "opc.tcp://localhost:" out || fail "an endpoint by name"
# The key of a first start is made before anybody can connect.
cat > secure.toml << END
[server]
address = "127.0.0.1"
port = ${url##*:}
[certificates]
folder = "first"
[[endpoint]]
policy = "Basic256Sha256"
mode = "SignAndEncrypt"
[users]
anonymous = "read"
END
refused "cannot listen on" --config secure.toml
[ -n "$(ls first/own/private)" ] || fail "it listens before it has a key"
stop
# What has not begun to serve ends at once, and well.
mkfifo late.toml
"$controller" --config late.toml > log 2>&1 < /dev/null &
pid=$!
catches_term() {
    caught=$(sed -n 's/^SigCgt:.*\(....\)$/\1/p' "/proc/$pid/status")
    [ $((0x$caught & 0x4000)) -ne 0 ]
}
await catches_term
stop
if [ -s /proc/net/if_inet6 ]; then
    sed 's/^address = .*/address = "::1"/' plain.toml > six.toml
    serve --config six.toml
    case $url in "opc.tcp://[::1]:"*) ;; *) fail "the URL $url" ;; esac
    run 0 read i=2258 --url "$url" --insecure
    stop
fi

# The log's reader ends, the controller keeps running.
mkfifo pipe
"$controller" --config plain.toml > pipe 2>&1 < /dev/null &
pid=$!
sed -n '/^ready/q;p' < pipe > log
url=$(sed -n 's/.* variables at \(opc.tcp:[^ ]*\)$/\1/p' log)
run 0 read i=2258 --url "$url" --insecure
timeout 30 "$busbar" read i=2258 --url "$url" --user nobody --password-file secret > out 2>&1
run 0 read i=2258 --url "$url" --insecure
ended && fail "the log's reader went, and the controller too"
stop

# SIGHUP reads the users again; a broken file changes nothing.
{ cat plain.toml; account anna first-password; } > users.toml
serve --config users.toml
echo second-password > secret
login="--insecure --user anna --password-file secret"
run 4 read i=2258 --url "$url" $login
{ cat plain.toml; account anna second-password; } > users.toml
kill -HUP "$pid"
await logged 'read again: 1 accounts of users.toml'
run 0 read i=2258 --url "$url" $login
echo 'acess = "read"' >> users.toml
kill -HUP "$pid"
await logged 'users.toml:12: found "acess", expected one of: .*; nothing was changed'
run 0 read i=2258 --url "$url" $login
grep -q scrypt log && fail "a hash in the log"
stop

# Hashes cost what the file says; the rest of the file need not be valid yet.
{ cat plain.toml; printf 'password_hash = "pbkdf2"\npassword_iterations = 10000\n'; } > small.toml
{ cat small.toml; printf '[[users.account]]\nname = "anna"\npassword = ""\n'; } > begun.toml
hash=$(printf 'third-password' | "$controller" --hash-password --config begun.toml)
case $hash in '$pbkdf2-sha256$10000$'*) ;; *) fail "the hash $hash" ;; esac
{ cat small.toml; printf '[[users.account]]\nname = "anna"\npassword = "%s"\n' "$hash"; } > users.toml
serve --config users.toml
echo third-password > secret
run 0 read i=2258 --url "$url" $login
echo second-password > secret
run 4 read i=2258 --url "$url" $login
limits --print-limits users.toml
grep -q '^MemoryAssumptions::password_cost  *2048 B  *2.0 KiB' out || fail "the memory of a login"
stop
sed 's/"pbkdf2"/"bcrypt"/' small.toml > wrong.toml
refused 'wrong.toml:9: password_hash: found ' --hash-password --config wrong.toml

# A refusal is reported with its reason.
refused "/nowhere: the file cannot be read: No such file or directory" --config /nowhere
refused "$work: found a directory, expected a file" --config "$work"
echo '[server]' > nobody.toml
refused "nobody.toml: no user can log in, expected an account" --config nobody.toml
{ cat plain.toml; printf '[[endpoint]]\npolicy = "None"\n'; } > twice.toml
refused "twice.toml: endpoint None None: is there twice" --config twice.toml

echo "$failures failures"
[ $failures -eq 0 ]
