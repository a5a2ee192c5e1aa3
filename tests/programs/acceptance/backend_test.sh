#!/bin/sh
# A controller before PLCs of the network, as its user has it: variables by address, a PLC that is
# slow, refuses an address, goes away and comes back.
# usage: backend_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
responder=$(dirname "$controller")/busbar-plc-responder
[ -x "$responder" ] || { echo "there is no busbar-plc-responder"; exit 77; }

press_port=$((port + 1)) mixer_port=$((port + 2))
# plc NAME ARGUMENTS...: starts a simulated PLC, whose commands tell() writes.
plc() {
    plc_name=$1
    shift
    rm -f "$plc_name.in"
    mkfifo "$plc_name.in"
    "$responder" "$@" < "$plc_name.in" > "$plc_name.out" 2>&1 &
    echo $! > "$plc_name.pid"
    # Open, so that the PLC's input does not end.
    case $plc_name in
        press) exec 7> press.in ;;
        mixer) exec 8> mixer.in ;;
    esac
    await grep -q 'ready at' "$plc_name.out"
}
kill_plc() {
    kill -9 "$(cat "$1.pid")"
    wait "$(cat "$1.pid")" 2> /dev/null
}
press_plc() { plc press modbus --listen "127.0.0.1:$press_port" --set holding:0=17 --set holding:10=9; }
mixer_plc() { plc mixer slmp --listen "127.0.0.1:$mixer_port" --set D100=1234 "$@"; }
trap 'kill -9 $(cat press.pid mixer.pid 2> /dev/null) 2> /dev/null; kill $pid 2> /dev/null; wait' EXIT

field() { echo "nsu=urn:busbar:backends;s=$1"; }
# reads NODE PATTERN: what busbar prints of it.
reads() {
    run "${3:-0}" --user chief --password-file password --trust read "$url" "$(field "$1")"
    says "$2"
}
shows() {
    last="read $1 until $2"
    "$busbar" --user chief --password-file password --trust read "$url" "$(field "$1")" > out 2>&1
    grep -q -- "$2" out
}

cat > press.csv << 'END'
name,at,access,raw_low,raw_high,low,high,unit,description
Speed,holding:0:int16,write,,,,,,Speed of the press
Temperature,40011,write,0,27648,0,400,CEL,
Door,holding:10.3,write,,,,,,
Pressure,holding:20:float:CDAB,write,,,,,,
Missing,holding:9,read,,,,,,
END
{
    server "$port" pki
    cat << END
[[backend]]
name = "press"
protocol = "modbus"
address = "127.0.0.1:$press_port"
under_way = 4
longest_pause_ms = 500
table = "press.csv"

[[backend]]
name = "mixer"
protocol = "slmp"
address = "127.0.0.1:$mixer_port"
when_away = "last value"
longest_pause_ms = 500
[[backend.variable]]
name = "Level"
at = "D100"
access = "write"
[[backend.variable]]
name = "Count"
at = "D200:int32"
access = "write"
[[backend.variable]]
name = "Valve"
at = "M5"
access = "write"
END
} > controller.toml

# What is wrong in a file is told with its place.
sed 's/holding:0:int16/holding:0:int17/' press.csv > wrong.csv
sed 's/"press.csv"/"wrong.csv"/' controller.toml > wrong.toml
last="a wrong table"
"$controller" --config wrong.toml --check > out 2>&1 && fail "$last"
says '^busbar-controller: wrong.csv:2: at: "holding:0:int17", column 11: '
sed 's/at = "M5"/at = "M5x"/' controller.toml > wrong.toml
"$controller" --config wrong.toml --check > out 2>&1 && fail "$last"
says 'wrong.toml:[0-9]*: at: "M5x", column '

# told 'variables of a `[[backend]]` have Bad_NoCommunication'
# Nobody is there yet: --check says so, and the controller starts all the same.
last="--check without PLCs"
"$controller" --config controller.toml --check > out 2>&1 && fail "$last"
says '^press: modbus at .* is not reached: Connection refused'
begin pki --config controller.toml
reads press.Speed 'Bad_NoCommunication' 3
reads 'press Connection.State' ' 0 '
reads 'press Connection.Trouble' 'Connection refused'

# The PLCs come.
press_plc
mixer_plc
await shows press.Speed ' 17 '
await shows mixer.Level ' 1234 '
reads 'press Connection.State' ' 2 '
reads 'mixer Connection.Identity' 'R08CPU'
reads press.Door ' true '
last="--check with PLCs"
"$controller" --config controller.toml --check > out 2>&1 || fail "$last"
says '^press: modbus at .*: 5 of 5 variables read in .* by 1 requests$'
says '^press: modbus at [^,]*, Busbar busbar-plc-responder 1: 5 of 5'
says '^mixer: slmp at .*, R08CPU (family iq-r), in RUN: 3 of 3 variables read in .* by 1 requests$'
says '^  read *Level  D100  1234$'

# Values are written as the PLC has them.
run 0 --user chief --password-file password --trust write "$url" "$(field press.Temperature)" 200
run 0 --user chief --password-file password --trust write "$url" "$(field press.Door)" false
run 0 --user chief --password-file password --trust write "$url" "$(field press.Pressure)" 1.5
run 0 --user chief --password-file password --trust write "$url" "$(field mixer.Count)" -- -70000
run 0 --user chief --password-file password --trust write "$url" "$(field mixer.Valve)" true
reads press.Pressure ' 1.5 '
reads mixer.Count ' -70000 '
reads mixer.Valve ' true '
echo 'get holding:10' >&7
await grep -q '^13824$' press.out
echo 'get D201' >&8
await grep -q '^65534$' mixer.out

# One address that is refused costs the others nothing.
echo 'refuse holding:9' >&7
await shows press.Missing 'Bad_ConfigurationError'
reads press.Speed ' 17 '
reads 'press Connection.LastRefusal' 'exception 2'
echo 'allow' >&7

# A PLC that is killed: no communication at once, and the other one goes on.
kill_plc press
kill_plc mixer
await shows press.Speed 'Bad_NoCommunication'
await shows mixer.Level ' 1234 (Uncertain_NoCommunicationLastUsableValue)'
run 3 --user chief --password-file password --trust write "$url" "$(field press.Speed)" 5
says 'Bad_NoCommunication'
press_plc
await shows press.Speed ' 17 '
reads mixer.Level 'Uncertain_NoCommunicationLastUsableValue'

# A built-in port that knows 3E only.
mixer_plc --plc q
await shows mixer.Count ' 0 '
reads mixer.Level ' 1234 '

# A slow PLC is late, not away.
echo 'slow 3000' >&7
reads press.Speed 'Bad_Timeout' 3
echo 'slow 0' >&7
await shows press.Speed ' 17 '

# A restart of the controller takes them over again, and power that is cut harms nothing.
restart
await shows press.Speed ' 17 '
power_cycle
await shows press.Speed ' 17 '
await shows mixer.Level ' 1234 '
finish
