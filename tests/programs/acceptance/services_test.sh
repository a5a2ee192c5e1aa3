#!/bin/sh
# What a server of model mode says to clients' requests with the limits of its product (SH-082679,
# 2.1, 8.1 and 8.3): revised values, limits of each service, status codes, sampling and its time
# stamps. usage: services_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
takes_long
. "$here/cell.sh"
requests=$(dirname "$busbar")/acceptance-requests

# ask PATTERN REQUEST...: one request as it is; what came of it.
ask() {
    wanted_answer=$1
    shift
    last="acceptance-requests $*"
    timeout 100 "$requests" "$url" "$@" > out 2>&1 < /dev/null
    says "$wanted_answer"
}

cell_program > line.st
cell_controller '' 'preset = "rd81opc96"' > module.toml
cell_project cell.busbar --preset rd81opc96
serve_cell cell.busbar
run 0 --json --trust read "$url" i=2255
index=$(($(sed 's/.*"value":\[//' out | tr ',' '\n' | grep -n cell.example | cut -d: -f1) - 1))
speed="ns=$index;i=104"

entry model 2.1: sampling interval and its revision
for each in 250:200 260:300 949:900 950:900 9500:9000 15001:20000 1000000:60000 0:200 -1:1000; do
    ask "Good: 1 Good; sampling ${each#*:}, " items 1 "$speed" "${each%:*}" 1
done

entry model 2.1: queues, items, life time, keep-alive, subscriptions
ask '; sampling 1000, queue 10$' items 1 "$speed" 1000 100
ask 'Good: 1 Good; interval 50, lifetime 300, keep-alive 100$' subscriptions 1 10
ask 'Good: 1 Good; interval 1000, lifetime 15, keep-alive 5$' subscriptions 1 1000
ask 'Good: 1 Bad_TooManySubscriptions, 10 Good;' subscriptions 11 1000
ask 'Good: 5 Bad_TooManyMonitoredItems, 15000 Good;' items 15005 "$speed" 1000 1

entry model 2.1: notifications
run 0 --trust subscribe "$url" "$speed" "$(cell 140)" "$(cell 105)" --count 3 --duration 20

entry model 2.1: sessions
# The client of the 16th tries until its time is over.
ask 'Good: 1 Bad_Timeout, 15 Good; timeout 60000$' sessions 16 60
logged '15 sessions, all activated, which is the limit: Bad_TooManySessions' || fail "no such line"
ask 'Good: 1 Good; timeout 10000$' sessions 1 1
ask 'Good: 1 Good; timeout 180000$' sessions 1 10000

entry model 2.1: operations of a request
ask '^Good: 25000 Good$' read 25000 i=2258
ask '^Bad_TooManyOperations:$' read 25001 i=2258
ask '^Good: 3000 Good$' write 3000 "$speed"
ask '^Bad_TooManyOperations:$' write 3001 "$speed"
ask '^Good: 1 ' call 1 "ns=$index;i=1" "ns=$index;i=11"
ask '^Bad_TooManyOperations:$' call 2 "ns=$index;i=1" "ns=$index;i=11"
ask '^Good: 10000 Good$' browse 10000
ask '^Bad_TooManyOperations:$' browse 10001
ask '^Good: 10000 Good$' translate 10000
ask '^Bad_TooManyOperations:$' translate 10001
for each in 11705:25000 11707:3000 11709:1 11710:10000 11712:10000; do
    get "i=${each%:*}" "^${each#*:}\$"
done

entry model 2.1: units of a request
# Each has three labels: more than 25,000 units of mapped data.
ask '^Good: 8000 Good$' read 8000 "ns=$index;i=140"
ask '^Good: 9000 Bad_NoCommunication$' read 9000 "ns=$index;i=140"

entry model 2.1: arguments
values=$(seq 1 20)
# shellcheck disable=SC2086 # a value each
run 0 --trust call "$url" "$(cell 1)" "$(cell 40)" $values
# shellcheck disable=SC2086
run 1 --trust call "$url" "$(cell 1)" "$(cell 40)" $values
says Bad_TooManyOperations

entry model 2.1: sizes of messages, texts, arrays
text=$(printf '%01024d' 0)
put "$(cell 112)" "$text"
put_refused 'Bad_EncodingLimitsExceeded' "$(cell 112)" "${text}0"
put "$(cell 115)" "0x$(printf '%020480d' 0)"
put_refused 'Bad_EncodingLimitsExceeded' "$(cell 115)" "0x$(printf '%020482d' 0)"
# Requests of at most 3 MB: what is larger is refused as a whole.
ask '^Good: 300 Good$' bytes 300 "ns=$index;i=115" 10240
ask '^Bad_RequestTooLarge:$' bytes 308 "ns=$index;i=115" 10240
# One more, so that a request of 25,001 operations gets the status of that.
get i=11702 '^25001$'
get i=11703 '^1024$'

entry model 8.1: services
run 0 --trust browse "$url" /Objects
says '2:Cell\|:Cell '
run 0 --trust read "$url" "$(cell 104)" --all
says 'DisplayName'
put "$(cell 104)" 6
run 0 --trust subscribe "$url" "$(cell 104)" --count 1 --duration 20

entry model 8.1: ranges and unmapped variables
put "$(cell 140)" '[1, 2, 3]'
run 0 --trust read --value --range 1 "$url" "$(cell 140)"
says '2'
run 0 --trust read --value --range 1:2 "$url" "$(cell 140)"
says '2, 3'
run 0 --trust read --value --range 0:1,1 "$url" "$(cell 141)"
put "$(cell 133)" 4.5
get "$(cell 133)" '^4.5$'
run 1 --trust write --range 1 "$url" "$(cell 140)" '[7]'
says Bad_WriteNotSupported

entry model 8.1: Bad_NoCommunication and Bad_NotSupported
for node in 163 164 149 131; do
    get_refused Bad_NotSupported "$(cell $node)"
    run 1 --trust subscribe "$url" "$(cell $node)" --count 1 --duration 3
    says Bad_NotSupported
done

entry model 8.1: codes of Write
put_refused Bad_OutOfRange "$(cell 105)" 40000
put_refused Bad_WriteNotSupported "$(cell 140)" '[1, 2]'
put_refused Bad_WriteNotSupported "$(cell 140)" '[1, 2, 3, 4]'
put_refused Bad_NotWritable "$(cell 170)" 5
# One that fails, fails all; the others say what 8.1 has, and the wrong one what is wrong.
put "$(cell 104)" 5
run 1 --trust write "$url" "$(cell 104)" 6 "$(cell 106)" 7 "$(cell 105)" 40000
says "Bad_OutOfRange"
says 'Bad_NoCommunication'
says_not 'Bad_InvalidState'
get "$(cell 104)" '^5$'
run 1 --trust write "$url" "$(cell 104)" 6 "$(cell 170)" 7
says 'Bad_NotWritable'
says 'Bad_NoCommunication'
get "$(cell 104)" '^5$'

entry model 8.1: codes of Call
run 1 --trust call "$url" "$(cell 1)" "$(cell 11)"
says Bad_NotImplemented
run 1 --trust call "$url" "$(cell 1001)" "$(cell 1002)"
says Bad_NotSupported
mix() {
    run "$1" --trust call "$url" "$(cell 1)" "$(cell 20)" "$2" "$3" \
        '{"Name": "Cake", "Size": 1, "Mode": 0}'
}
mix 1 7 '[1, 2]'
says Bad_NotSupported
mix 0 7 '[1, 2, 3]'
mix 1 7 '[1, 2, 3]'
says Bad_TooManyOperations

entry model 8.1: items by size
# A String counts as 1,024 bytes of the 4,194,304 that there are.
ask '[1-9][0-9]* Bad_TooManyMonitoredItems, [1-9][0-9]* Good' items 4200 "ns=$index;i=112" 1000 1

entry model 8.3: sampling modes and time stamps
# A Read has the time when it was done twice.
run 0 --json --trust read "$url" "$(cell 104)"
source=$(sed 's/.*"sourceTimestamp":"\([^"]*\)".*/\1/' out)
server=$(sed 's/.*"serverTimestamp":"\([^"]*\)".*/\1/' out)
[ "$source" = "$server" ] || fail "time stamps of a Read: source $source, server $server"

entry model 8.3: smallest interval and its counters
run 0 --trust subscribe "$url" "$(cell 105)" --sampling 400 --interval 400 --duration 3 &
subscriber=$!
smallest() { ends_with 0 --trust read --value "$url" "$(module RevisedSamplingIntervalMinimum)" && grep -q '^400$' out; }
await smallest
run 0 --trust read --value "$url" "$(module ActualSamplingIntervalMinimum)"
wait $subscriber

kill "$pid"
await ended
finish
