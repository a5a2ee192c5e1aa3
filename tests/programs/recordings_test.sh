#!/bin/sh
# busbar proxy, show, diff and replay between a client and busbar-controller.
# usage: recordings_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"

for level in 1.5 1.75; do
    cat > level-$level.st << END
{attribute 'publish' := 'publish only'}
VAR_GLOBAL
    Level : LREAL := $level;
END_VAR
END
    cat > machine-$level.toml << END
[server]
port = 0
address = "127.0.0.1"
[certificates]
folder = "pki-$level"
[machine]
program = "level-$level.st"
state = "state-$level"
[[endpoint]]
policy = "None"
[users]
anonymous = "write"
END
done

# start FILE: a controller of its own; its URL in url.
controllers=""
trap 'kill $pid $controllers 2> /dev/null; wait; rm -rf "$work"' EXIT
start() {
    "$controller" --config "$1" > "$1.log" 2>&1 < /dev/null &
    controllers="$controllers $!"
    await grep -q -s '^ready' "$1.log"
    url=$(sed -n 's/.* at \(opc.tcp:[^ ]*\)$/\1/p' "$1.log" | head -n 1)
}
start machine-1.5.toml
first=$url
start machine-1.75.toml
second=$url

# proxy FILE ARGUMENTS...: in the background, with its URL in through.
proxy() {
    file=$1
    shift
    "$busbar" proxy "$first" --record "$file" "$@" > "$file.out" 2> "$file.err" < /dev/null &
    pid=$!
    await grep -q -s ' leads to ' "$file.err"
    through=$(sed -n 's/^busbar: \([^ ]*\) leads to.*/\1/p' "$file.err")
}
# stop CODE: as Ctrl+C does; its exit code.
stop() {
    kill -TERM "$pid"
    wait "$pid"
    code=$?
    pid=""
    [ "$code" -eq "$1" ] || fail "the proxy ends with $code instead of $1"
}
level="nsu=urn:busbar:machine;s=Level"

# A client is recorded, and what it said is shown.
proxy a.rec
run 0 --insecure read "$through" "$level"
says 1.5
stop 0
grep -q 'client -> ReadRequest ns=' a.rec.out || fail "the proxy does not show the request"
grep -q 'server -> ReadResponse Double 1.5' a.rec.out || fail "it does not show the response"
run 0 show a.rec --filter 'Double 1.5'
says 'ReadResponse Double 1.5'
run 0 show a.rec --filter 'Double 1.5' --json
says '"name":"ReadResponse"'
run 0 show a.rec --filter 'node~;s=Level and from=server or name=x'
says 'server -> ReadResponse Double 1.5'
says_not ReadRequest
run 0 show a.rec --filter 'service=Read and status!=Good'
says_not .
run 0 show a.rec --filter 'results[0].value>1.4 and time<1000'
says 'Double 1.5'
run 2 show a.rec --filter 'time=soon'
says 'found "time=soon"; expected a name, one of = != < <= > >= ~, and a value'
run 0 show a.rec --fields --pcap a.pcap
says '^  results\[0\].sourceTimestamp: \$time$'
[ -s a.pcap ] || fail "there is no capture file"
for file in a.rec a.pcap; do
    [ "$(stat -c %a $file)" = 600 ] || fail "others can read $file"
done

# A pipe gets the recording once, at the end, and a file that cannot be written is told at once.
mkfifo pipe.rec
cat pipe.rec > piped.rec &
reader=$!
proxy pipe.rec
run 0 --insecure read "$through" "$level"
stop 0
wait "$reader"
[ "$(grep -c "$(head -n 1 a.rec)" piped.rec)" -eq 1 ] || fail "the pipe got: $(cat piped.rec)"
run 0 show piped.rec --filter 'Double 1.5'
says 'ReadResponse Double 1.5'
run 1 proxy "$first" --record nowhere/a.rec --for 60

# Messages are disturbed by name; what did not happen is told.
proxy b.rec --fault "edit results[0].value = Double:9 at ReadResponse 2"
run 0 --insecure read "$through" "$level"
says 'Level *9 '
stop 0
echo '# never' > never.faults
echo 'cut after WriteResponse 7' >> never.faults
proxy c.rec --faults never.faults --quiet
run 0 --insecure read "$through" "$level"
stop 5
grep -q 'has never acted: cut after WriteResponse 7' c.rec.err || fail "a fault is not told"
[ -s c.rec.out ] && fail "--quiet says something"

# Faults are played while it runs.
mkfifo control
sleep 60 > control & # keeps it open
holder=$!
"$busbar" proxy "$first" --control --quiet > control.out 2> control.err < control &
pid=$!
await grep -q -s ' leads to ' control.err
through=$(sed -n 's/^busbar: \([^ ]*\) leads to.*/\1/p' control.err)
run 0 --insecure read "$through" "$level"
echo 'refuse times 1' > control
await grep -q 'played refuse' control.err
run 3 --insecure read "$through" "$level" --timeout 2
echo 'cute' > control
await grep -q 'cute: found "cute"; expected cut, delay' control.err
run 0 --insecure read "$through" "$level"
stop 0
kill "$holder"

# Two recordings differ in what was changed, and by name.
run 0 diff a.rec c.rec
[ -s out ] && fail "two reads of the same differ: $(cat out)"
run 1 diff a.rec b.rec --junit junit.xml
says 'ReadResponse to ns=[^:]*: results\[0\].value Double 1.5 -> Double 9 (messages'
grep -q '<failure message="differences: ' junit.xml || fail "there is no report"
run 0 diff a.rec b.rec --tolerance 7.5

# What was recorded is asked again, of the same controller and of another one.
run 4 replay "$first" a.rec
says 'insecure'
run 0 --insecure replay "$first" a.rec
run 1 --insecure replay "$second" a.rec
says 'results\[0\].value Double 1.5 -> Double 1.75'

# Two servers: their nodes and values, and nothing of sessions.
run 0 --insecure diff "$first" "$first"
run 1 --insecure diff "$first" "$second" --junit servers.xml
says 'Level Value *Double 1.5 *Double 1.75'
grep -q 'Level Value: Double 1.5 -&gt; Double 1.75' servers.xml || fail "no report of servers"
run 0 --insecure diff "$first" "$second" --tolerance 0.5
run 0 --insecure diff "$first" "$second" --no-values --json
says '"isSame":true'
# A profile is that of one of the servers.
mkdir -p config/busbar
printf '[first]\nurl = "%s"\ninsecure = true\n' "$first" > config/busbar/profiles.toml
XDG_CONFIG_HOME="$work/config" run 4 diff @first "$second"
says insecure
XDG_CONFIG_HOME="$work/config" run 1 --insecure diff @first "$second"
run 2 --insecure diff "$first" a.rec
says 'expected two of a kind'

# A recording answers in the place of the controller.
"$busbar" replay a.rec --serve 0 > served.out 2> served.err < /dev/null &
pid=$!
await grep -q -s ' answers as ' served.err
served=$(sed -n 's/^busbar: \([^ ]*\) answers as.*/\1/p' served.err)
run 0 --insecure read "$served" "$level"
says 1.5
stop 0

# A server from a file, which passes values, takes some, and is late as it is told.
cat > tank.sim << END
# a tank
Level    Double  steps 1.5 2.5 50ms
Setpoint Int16   50 write
Alarm    Boolean false
method Add   in a Double b Double  out sum Double "a + b * 2"
method Reset in to Int16  out was Int16 Setpoint text String "all is well"  sets Setpoint to
event "too full" 700 when "Setpoint > 90"
END
mkfifo orders
sleep 60 > orders & # keeps it open
holder=$!
"$busbar" simulate tank.sim --control --fault 'delay 300ms at WriteResponse' > tank.out 2> tank.err < orders &
pid=$!
await grep -q -s ' is at ' tank.err
tank=$(sed -n 's/^busbar: .* is at //p' tank.err)
run 0 --insecure read "$tank" 'ns=1;s=Level' --json
says '[12]\.5'
run 0 --insecure write "$tank" 'ns=1;s=Setpoint' 60
run 0 --insecure read "$tank" 'ns=1;s=Setpoint'
says ' 60 '
run 1 --insecure diff "$tank" "$first" --no-values
says 'ns=1;s=Setpoint *Variable *-'
run 1 --insecure write "$tank" 'ns=1;s=Level' 7
says Bad_NotWritable
run 0 --insecure call "$tank" i=85 'ns=1;s=Add' 1.5 2
says '5.5'
run 0 --insecure call "$tank" i=85 'ns=1;s=Reset' 70
says '60'
says 'all is well'
run 0 --insecure read "$tank" 'ns=1;s=Setpoint'
says ' 70 '
"$busbar" --insecure events "$tank" > events.out 2> events.err < /dev/null &
listener=$!
await grep -q -s 'EventItem\|CreateMonitoredItemsResponse' tank.out
echo 'set Setpoint 95' > orders
await grep -q 'too full' events.out
echo 'event "by hand" 300' > orders
await grep -q 'by hand' events.out
kill "$listener"
run 0 --insecure read "$tank" 'ns=1;s=Setpoint'
says ' 95 '
echo 'set Nothing 1' > orders
await grep -q 'set Nothing 1: there is no variable "Nothing"' tank.err
stop 0
kill "$holder"
grep -q 'server -> WriteResponse Good' tank.out || fail "the simulation does not show the response"

# Mistakes.
run 2 show machine-1.5.toml
says 'machine-1.5.toml: found no recording; expected a file that begins with "busbar-recording 1"'
run 2 proxy "$first" --fault "cut near OPN"
says 'found "near"; expected before, at, after'
echo 'delay' > bad.faults
run 2 proxy "$first" --faults bad.faults
says 'bad.faults:1: found the end; expected a time with its unit'
run 3 proxy opc.tcp://127.0.0.1:1 --timeout 5
says '\-\-pass the proxy begins without the server'
run 2 proxy "$first" --listen there
says 'expected \[ADDRESS:\]PORT'
run 2 proxy "$first" --any-client
says '\-\-any-client: the server has no endpoint with security'
run 2 proxy "$first" --pass --key-log keys
says '\-\-key-log: \-\-pass passes channels on as they are'
ln -s a.rec led.rec
run 1 proxy "$first" --record led.rec
says 'led.rec: cannot be written: '
mkdir folder.rec
run 1 proxy "$first" --record folder.rec
says 'folder.rec: cannot be written: '
run 2 show a.rec --filter 'service=Read or  or time>1'
says 'found ""; expected a name'
run 2 show a.rec --filter 'status>Good'
says 'expected one of = != ~ after status'
exit $failures
