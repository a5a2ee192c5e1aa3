#!/bin/sh
# A controller before PLCs with SLMP, as its user has it: RUN and STOP, remote passwords, families, and what
# --check says of them.
# usage: plc_states_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
responder=$(dirname "$controller")/busbar-plc-responder
[ -x "$responder" ] || { echo "there is no busbar-plc-responder"; exit 77; }

mixer_port=$((port + 1)) kiln_port=$((port + 2))
# mixer ARGUMENTS..., kiln PASSWORD: start a simulated PLC with commands from fd 8 or 9.
mixer() {
    rm -f mixer.in
    mkfifo mixer.in
    "$responder" slmp --listen "127.0.0.1:$mixer_port" "$@" < mixer.in > mixer.out 2>&1 &
    mixer=$!
    exec 8> mixer.in
    await grep -q 'ready at' mixer.out
}
kiln() {
    rm -f kiln.in
    mkfifo kiln.in
    "$responder" slmp --listen "127.0.0.1:$kiln_port" --plc q --password "$1" --set D1=8 < kiln.in > kiln.out 2>&1 &
    kiln=$!
    exec 9> kiln.in
    await grep -q 'ready at' kiln.out
}
mixer='' kiln=''
end_plc() {
    kill -9 "$1"
    wait "$1" 2> /dev/null
}
trap 'kill -9 $mixer $kiln 2> /dev/null; kill $pid 2> /dev/null; wait' EXIT

field() { echo "nsu=urn:busbar:backends;s=$1"; }
# reads NODE PATTERN [EXIT CODE]: what busbar prints of it.
reads() {
    run "${3:-0}" --user chief --password-file password --trust read "$url" "$(field "$1")"
    says "$2"
}
shows() {
    last="read $1 until $2"
    "$busbar" --user chief --password-file password --trust read "$url" "$(field "$1")" > out 2>&1
    grep -q -- "$2" out
}
# check EXIT CODE FILE: what --check says of it.
check() {
    last="--check of $2"
    "$controller" --config "$2" --check > out 2>&1
    code=$?
    [ $code -eq "$1" ] || fail "$last ended with $code"
}

{
    server "$port" pki
    cat << END
[[backend]]
name = "mixer"
protocol = "slmp"
address = "127.0.0.1:$mixer_port"
longest_pause_ms = 500
[[backend.variable]]
name = "Level"
at = "D100"
[[backend.variable]]
name = "Inlet"
at = "X10"

[[backend]]
name = "kiln"
protocol = "slmp"
address = "127.0.0.1:$kiln_port"
family = "q"
remote_password_file = "kiln.password"
when_stopped = "bad"
longest_pause_ms = 500
[[backend.variable]]
name = "Heat"
at = "D1"
END
} > controller.toml
echo abcd > kiln.password

# What is wrong is told with line, what was found and what is expected; a password is not shown.
sed 's/"kiln.password"/"long.password"/' controller.toml > wrong.toml
echo secret > long.password
check 1 wrong.toml
says 'wrong.toml:[0-9]*: remote_password_file: long.password: found 6 characters in its first line, expected 4 of ASCII$'
grep -q secret out && fail "a password is shown"
sed 's/"kiln.password"/"no.password"/' controller.toml > wrong.toml
check 1 wrong.toml
says "wrong.toml:[0-9]*: remote_password_file: found 'no.password', expected a file that can be read"
sed 's/family = "q"/family = "r"/' controller.toml > wrong.toml
check 1 wrong.toml
says "wrong.toml:[0-9]*: family: found 'r', expected \"auto\", \"iq-r\", \"q\", "
sed 's/"bad"$/"worse"/' controller.toml > wrong.toml
check 1 wrong.toml
says "wrong.toml:[0-9]*: when_stopped: found 'worse', expected \"uncertain\", \"good\" or \"bad\""
sed 's/family = "q"/family = "auto"/; s/"D1"/"Y10"/' controller.toml > wrong.toml
check 1 wrong.toml
says 'wrong.toml:[0-9]*: at: "Y10", column 2: found "10" of X or Y, which is octal for FX5 and hexadecimal for others'

mixer --set D100=1234 --set X10=1
kiln abcd
check 0 controller.toml
says '^mixer: slmp at .*, R08CPU (family iq-r), in RUN: 2 of 2 variables read in .* by 1 requests$'
says '^kiln: slmp at .*, family q, in RUN: 1 of 1 variables read in .* by 1 requests$'
begin pki --config controller.toml
await shows mixer.Level ' 1234 '
await shows kiln.Heat ' 8 '
reads 'mixer Connection.Product' 'R08CPU'
reads 'kiln Connection.Family' '"q"'

# told 'all variables of a `[[backend]]` have Uncertain_LastUsableValue'
# A PLC in STOP still answers, but its program does not renew the values.
echo stop >&8
echo stop >&9
await shows mixer.Level ' 1234 (Uncertain_LastUsableValue)'
await shows kiln.Heat 'Bad_OutOfService'
reads 'mixer Connection.Mode' ' 2 '
reads 'mixer Connection.State' ' 2 '
check 0 controller.toml
says '^mixer: slmp at .*, in STOP: 2 of 2'
echo run >&8
echo run >&9
await shows kiln.Heat ' 8 '
await shows mixer.Level ' 1234  *[0-9]'

# told 'variables of a `[[backend]]` have Bad_NoCommunication, and `Trouble` has C201 or C810'
# A port with another remote password, and with the right one again.
end_plc "$kiln"
kiln wxyz
await shows 'kiln Connection.Trouble' 'C810: the remote password is wrong'
reads kiln.Heat 'Bad_NoCommunication' 3
check 1 controller.toml
says '^kiln: slmp at .* is not reached: C810: the remote password is wrong'
end_plc "$kiln"
kiln abcd
power_cycle # or it is not tried for ten minutes
await shows kiln.Heat ' 8 '
grep -q abcd log && fail "the log has the password"

# Another PLC than configured, in which X10 is another input.
end_plc "$mixer"
mixer --plc fx5 --set D100=5
await shows 'mixer Connection.Trouble' 'X and Y are octal: set family = '
sed 's/^name = "mixer"/&\nfamily = "fx5"/' controller.toml > fx5.toml
check 0 fx5.toml
says '^mixer: slmp at .*, FX5U-32MT/DS (family fx5), in RUN: 2 of 2'

# told 'one variable of a `[[backend]]` has Bad_ConfigurationError'
# Refused, in the PLC's own words.
echo 'refuse D100' >&8
check 1 fx5.toml
says '^  not read *Level  D100  Bad_ConfigurationError: 4031: '
says '^  read *Inlet  X10  false$'
finish
