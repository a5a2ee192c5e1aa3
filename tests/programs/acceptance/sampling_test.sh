#!/bin/sh
# How values of a model come from the PLC (SH-082679, 8.3 and 9.12): the sampling modes and what
# they cannot sample, samples that come late, and values that are read over several scans.
# usage: sampling_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
takes_long
. "$here/cell.sh"

# again MODE [LABELS] [LIMITS]: with this sampling mode and more lines of the configuration.
again() {
    run 0 project set cell.busbar sampling.mode "$1"
    cell_controller "${2:-}" "${3:-}" > module.toml
    [ -z "$pid" ] || { kill "$pid" && await ended; }
    serve_cell cell.busbar
}
# samples NODE PATTERN: what a Subscription tells of it.
samples() {
    run 0 --json --trust subscribe "$url" "$(cell "$1")" --interval 200 --sampling 200 --count 3 \
        --duration 3
    says "$2"
}
stamps() { sed "s/.*\"$1\":\"\([^\"]*\)\".*/\1/" out; }
cell_program > line.st
cell_project cell.busbar
run 0 project map cell.busbar "ns=1;i=105" Line.Count

entry model 9.12: sampling mode
run 2 project set cell.busbar sampling.mode fast
says 'expected one of: standard'
for mode in standard 'high-speed items' 'high-speed variables'; do
    again "$mode"
    put "$(cell 104)" 21
    get "$(cell 104)" '^21$'
    samples 105 '"value":[1-9]'
    run 0 --json --trust read "$url" "$(cell 105)"
    case "$mode" in
        # What a scan has sampled is older than the Read of it.
        *variables) [ "$(stamps sourceTimestamp)" != "$(stamps serverTimestamp)" ] ;;
        *) [ "$(stamps sourceTimestamp)" = "$(stamps serverTimestamp)" ] ;;
    esac || fail "$mode: time stamps of a Read: $(cat out)"
done

entry model 8.3: sampling modes and time stamps
samples 105 '"value":[1-9]'
[ "$(head -n 1 out | stamps sourceTimestamp)" != "$(head -n 1 out | stamps serverTimestamp)" ] ||
    fail "a sampled value has one time: $(cat out)"

entry model 8.3: devices and their errors
again 'high-speed items' 'sampling = false'
run 0 --json --trust subscribe "$url" "$(cell 104)" --interval 200 --sampling 200 --count 0 \
    --duration 3 # the first may come before that is known
says 'Bad_NoCommunication'
logged 'error 1946H' || fail "no 1946H"
cp line.st kept.st
devices() {
    {
        echo "{attribute 'publish' := 'publish only'} VAR_GLOBAL"
        for each; do
            printf '    Dev%s AT %%%s : INT;\n' "${each%%:*}" "${each#*:}"
        done
        echo END_VAR
        cat kept.st
    } > line.st
    for each; do
        run 0 project map cell.busbar "ns=1;i=${each%%:*}" "Dev${each%%:*}"
    done
    again 'high-speed items'
    run 0 --json --trust subscribe "$url" "$(cell 104)" "$(cell 106)" "$(cell 107)" \
        --interval 200 --sampling 200 --count 0 --duration 3
}
devices 104:FX0 106:'J1\X0' 107:'U3E0\HG5'
says 'Bad_NoCommunication'
for node in 104 106 107; do
    logged "error 1945H: .*Dev$node of .*i=$node" || fail "no 1945H for Dev$node"
done
devices 104:Z1 106:D100 107:W1F
says '"value":0'
says_not 'Bad_'
logged 'error 1945H' && fail "1945H for what can be sampled"
# More points than there are.
sed 's/ARRAY\[0..2\] OF INT/ARRAY[0..9999] OF INT/' kept.st > line.st
{
    echo 'NodeId,Part,Label'
    awk 'BEGIN { for (i = 0; i <= 9000; ++i) printf "ns=1;i=150,[%d],Line.Row[%d]\n", i, i }'
} > rows.csv
run 0 project csv cell.busbar --in rows.csv --replace --yes
again 'high-speed variables' 'sampled_points = 8192'
logged 'error 1941H' || await logged 'error 1941H'

entry model 8.3: Good_Overload
cp kept.st line.st
cell_table > cell.csv
run 0 project csv cell.busbar --in cell.csv --replace --yes
run 0 project map cell.busbar "ns=1;i=105" Line.Count
scan_ms=700
again standard '' 'preset = "rd81opc96"'
samples 105 'Good_Overload'
run 0 --trust subscribe "$url" "$(cell 105)" --interval 200 --sampling 200 --count 3 --duration 3
says '[0-9]  Good_Overload$'

entry model 8.1: ServiceResult
# One request may wait for a scan: of many at once some are refused.
again standard 'waiting = 1' 'preset = "rd81opc96"'
for i in 1 2 3 4 5 6 7 8; do
    timeout 60 "$busbar" --trust read "$url" "$(cell 104)" > "out.$i" 2>&1 &
    readers="${readers:-} $!"
done
# shellcheck disable=SC2086 # several
wait $readers
grep -q -s Bad_TooManyOperations out.? || fail "all of eight Reads waited where one may"
grep -q -L Bad_TooManyOperations out.? || fail "none of eight Reads was done"

entry model 8.3: access units and consistency
# A value that moves in each scan is read by pieces where the unit is small, else whole. Of a CPU of
# the maker (2.2) field_labels_test.sh has the rest.
scan_ms=20 moves=Line.Row
again standard 'access_unit = 0'
is_torn() { [ "$(sed 's/[^0-9]/\n/g' out | sort -u | grep -c '[0-9]')" -gt 1 ]; }
get "$(cell 140)" '[1-9]'
is_torn && fail "a value of one scan is torn: $(cat out)"
again standard 'access_unit = 1'
get "$(cell 140)" '[1-9]'
is_torn || fail "a value over three scans is of one: $(cat out)"
kill "$pid"
await ended

entry model App. 7: performance
# Figures beside those of the manual; nothing is judged by a clock.
bench=$(dirname "$busbar")/busbar-bench
if [ -x "$bench" ]; then
    "$bench" appendix7 --rounds 1 --most 500 > figures 2>&1 || fail "not measured: $(cat figures)"
    for mode in standard items all; do
        for load in read subscription write startup; do
            # A manual's figure and a measured one.
            grep -q "^$load  *$mode  *[0-9].*  *[0-9.]*  *[0-9.]*[1-9][0-9.]* " figures ||
                fail "$load, $mode: $(cat figures)"
        done
    done
else
    lacks model App. 7: performance -- busbar-bench, which measures it, is not here
fi
finish
