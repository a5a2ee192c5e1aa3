#!/bin/sh
# What the troubleshooting says is done where values of a model change late or cannot be sampled,
# and where requests ask for too much: the trouble is there, the remedy exists, and it helps
# (SH-082679, 8.3 and 10.3; TROUBLESHOOTING.md).
# usage: remedies_sampling_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
takes_long
. "$here/cell.sh"
. "$here/remedies.sh"
requests=$(dirname "$busbar")/acceptance-requests

# again [MODE] [LABELS] [LIMITS]: with this sampling mode and more lines of the configuration.
again() {
    run 0 project set cell.busbar sampling.mode "${1:-standard}"
    cell_controller "${2:-}" "${3:-}" > module.toml
    [ -z "$pid" ] || { kill "$pid" && await ended; }
    serve_cell cell.busbar
}
# samples NODE INTERVAL [MORE]: what a Subscription tells of it within three seconds.
samples() {
    run 0 --json --trust subscribe "$url" "$(cell "$1")" --interval "$2" --sampling "${3:-$2}" \
        --count 0 --duration 3
}
# samples_say PATTERN NODE INTERVAL: sooner or later, as this machine may have more to do.
samples_say() {
    wanted_sample=$1
    shift
    for _ in 1 2 3 4 5; do
        samples "$@"
        grep -q -s -e "$wanted_sample" out && return 0
    done
    says "$wanted_sample"
}
# sleeper NODE INTERVAL: a client that subscribes until it is killed.
sleeper() {
    timeout 200 "$busbar" --trust subscribe "$url" "$(cell "$1")" --interval "$2" --sampling "$2" \
        --duration 180 > /dev/null 2>&1 &
    sleeper=$!
}
smallest() {
    run 0 --trust read --value "$url" "$(module RevisedSamplingIntervalMinimum)" \
        "$(module ActualSamplingIntervalMinimum)"
}
cell_program > line.st
cell_project cell.busbar --preset rd81opc96
run 0 project map cell.busbar "ns=1;i=105" Line.Count
again
entry model 10.3: remedies

# What a client asks for: too long intervals, or a label that nobody writes.
remedy 10.3.17
told 'the label has not changed'
samples 140 200
[ "$(grep -o '"value":[^]]*' out | sort -u | wc -l)" -eq 1 ] ||
    fail "a label that nobody writes changes: $(cat out)"
put "$(cell 140)" '[1, 2, 3]'
samples_say '\[1,2,3\]' 140 200
remedy 10.3.18 10.3.20
told 'they are the same'
count_of() { grep -c '"value"' out; }
samples 105 2000
slow=$(count_of)
samples 105 200
[ "$(count_of)" -gt "$slow" ] || fail "shorter intervals do not help: $slow and $(count_of)"
sleeper 105 400
are_the_same() {
    ends_with 0 --trust read --value "$url" "$(module RevisedSamplingIntervalMinimum)" &&
        grep -q '^400$' out
}
await are_the_same
smallest
kill $sleeper

# More to sample than there is time for.
remedy 10.3.19
told 'ActualSamplingIntervalMinimum is larger'
told 'Good_Overload otherwise'
scan_ms=700
again standard '' 'preset = "rd81opc96"'
samples_say Good_Overload 105 200
sleeper 105 200
is_larger() {
    ends_with 0 --trust read --value "$url" "$(module RevisedSamplingIntervalMinimum)" || return 1
    revised=$(tail -n 1 out)
    ends_with 0 --trust read --value "$url" "$(module ActualSamplingIntervalMinimum)" || return 1
    [ "$revised" -gt 0 ] && [ "$(tail -n 1 out)" -gt "$revised" ]
}
await is_larger
kill $sleeper
wait $sleeper 2> /dev/null
samples 105 2000
says_not Good_Overload
scan_ms=20

# Labels are added: values wait for it.
remedy 10.3.22
told 'Good_Overload with values that stand still'
again
cp line.st whole.st
timeout 200 "$busbar" --json --trust subscribe "$url" "$(cell 105)" --interval 50 --sampling 0 \
    --duration 180 > subscribed 2>&1 &
sleeper=$!
await grep -q -s '"value"' subscribed
sed 's/^VAR_GLOBAL {/VAR_GLOBAL Extra : LREAL; END_VAR\n&/' whole.st > line.st
kill -HUP "$pid"
await logged 'event 24000'
await logged 'event 24001'
count=$(wc -l < subscribed)
goes_on() { [ "$(wc -l < subscribed)" -gt $((count + 5)) ]; }
await goes_on
run 0 --trust read --value "$url" "$(module LabelUpdateRunningStatus)"
says '^0$'
kill $sleeper
cp whole.st line.st

# What cannot be sampled in each scan.
told '1941H, 1945H, 1946H'
# trouble ERROR: is there, and goes with the standard mode.
trouble() {
    samples_say Bad_NoCommunication 104 200
    await logged "error $1"
    again standard "$2"
    samples_say '"value":' 104 200
    says_not '"status":"Bad_NoCommunication"'
    logged "error $1" && fail "$1 is still there"
}
again 'high-speed items' 'sampling = false'
trouble 1946H 'sampling = false'
{
    echo "{attribute 'publish' := 'publish only'} VAR_GLOBAL Dev AT %FX0 : INT; END_VAR"
    cat whole.st
} > line.st
run 0 project map cell.busbar "ns=1;i=104" Dev
again 'high-speed items'
trouble 1945H ''
cp whole.st line.st
run 0 project map cell.busbar "ns=1;i=104" Line.W
again 'high-speed variables' 'sampled_points = 8'
await logged 'error 1941H'
again 'high-speed variables'
get "$(cell 104)" '^5$'
logged 'error 1941H' && fail "1941H though there is room"

# Requests and items that are too large: several ones, fewer ones.
again standard '' 'preset = "rd81opc96"'
run 0 --json --trust read "$url" i=2255
index=$(($(sed 's/.*"value":\[//' out | tr ',' '\n' | grep -n cell.example | cut -d: -f1) - 1))
ask() {
    wanted_answer=$1
    shift
    last="acceptance-requests $*"
    timeout 100 "$requests" "$url" "$@" > out 2>&1 < /dev/null
    says "$wanted_answer"
}
told 'Bad_NoCommunication for one request'
ask '^Good: 9000 Bad_NoCommunication$' read 9000 "ns=$index;i=140"
ask '^Good: 4500 Good$' read 4500 "ns=$index;i=140"
told 'Bad_TooManyMonitoredItems'
ask 'Bad_TooManyMonitoredItems' items 4200 "ns=$index;i=112" 1000 1
ask '^Good: 4000 Good;' items 4000 "ns=$index;i=112" 1000 1

kill "$pid"
await ended
finish
