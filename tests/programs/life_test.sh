#!/bin/sh
# The life of a machine with a program: downloads by SIGHUP, a program that is wrong, values that
# are kept through a power cut.
# usage: life_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"


variable() { echo "nsu=urn:busbar:machine;s=$1"; }

# is VARIABLE VALUE
is() {
    timeout 60 "$busbar" --json --insecure read "$url" "$(variable "$1")" > out 2>&1
    grep -q -e "\"value\":$2[,}]" out
}
ready() { [ "$(grep -c '^ready' log)" -eq "$1" ]; }

# What the execution log has of the server's life, in a line.
life() {
    tr -d '\r' < medium/packages/OPCUA_Server/ExecutionLog/OPCUA_ExecutionLog.log | cut -f 7 |
        grep -x -e Start -e Prepare -e Run -e Shutdown -e HaltError | tr '\n' ' '
}
lived() { [ "$(life)" = "$1 " ]; }

# program DECLARATION: among others.
program() {
    cat > program.st << END
{attribute 'publish' := 'publish only'}
VAR_GLOBAL
    Cycles : DINT;
    $1
END_VAR
{attribute 'publish' := 'publish only'}
VAR_GLOBAL RETAIN
    Total  : DINT := 5;
    Recipe : STRING[20] := 'none';
END_VAR
END
}

listening() {
    port=$(printf '%04X' "${url##*:}")
    awk -v port=":$port\$" '$2 ~ port && $4 == "0A" { print $10 }' /proc/net/tcp /proc/net/tcp6
}
cut_power() {
    kill -KILL "$pid"
    wait "$pid"
}

cat > machine.toml << END
[server]
port = 0
[certificates]
folder = "pki"
[machine]
mode = "RUN"
program = "program.st"
state = "state"
medium = "medium"
execution_log = true
retained_ms = 100
[[endpoint]]
policy = "None"
[users]
anonymous = "write"
[[plc.program]]
kind = "increment"
target = "Cycles"
period_ms = 50
END
program 'Speed : INT := 100;'
serve --config machine.toml
await lived "Start Prepare Run"
is Total 5 || fail "a RETAIN variable does not begin as declared"
before=$(listening)
[ -n "$before" ] || fail "nothing listens at $url"

# What was saved outlives a power cut; what is not RETAIN does not.
run 0 --insecure write "$url" "$(variable Total)" 42 "$(variable Recipe)" "cover plate" \
    "$(variable Speed)" 7
is_saved() { grep -q -s 'cover plate' state/retained; }
await is_saved
cut_power
serve --config machine.toml
before=$(listening)
logged '2 RETAIN variables have the values' || fail "nothing is restored"
is Total 42 || fail "a RETAIN variable is not restored"
is Recipe '"cover plate"' || fail "a RETAIN text is not restored"
is Speed 100 || fail "a variable that is not RETAIN is restored"

# In RUN an online edit is taken, and what would be a download is not.
program 'Speed : INT := 100; Early : INT := 8;'
kill -HUP "$pid"
await logged 'edited online: program.st'
is Early 8 || fail "the variable that was added in RUN is not there"
program 'Speed : REAL := 100.0;'
kill -HUP "$pid"
await logged 'program.st:4:5: variables.*(Speed): .*had another type; .*PROGRAM.*; nothing was changed'
is Speed 100 || fail "the program was changed in RUN"
lived "Start Prepare Run Start Prepare Run" || fail "the life went on in RUN: $(life)"
sed -i 's/^mode = .*/mode = "PROGRAM"/' machine.toml

# A download: other variables behind the same port, and clients learn why.
timeout 60 "$busbar" --json --insecure subscribe "$url" "$(variable Total)" --interval 50 \
    --duration 60 > followed 2>&1 &
follower=$!
await grep -q -s '"value":42\b' followed
run 0 --insecure write "$url" "$(variable Total)" 43
program 'Pace : INT := 200; Speed : REAL := 2.5;'
kill -HUP "$pid"
await logged 'downloaded: program.st'
logged 'shutdown: a program is downloaded to the controller' || fail "clients are not told why"
[ "$(listening)" = "$before" ] || fail "the port was closed"
is Pace 200 || fail "the new variable is not there"
is Speed 100 && fail "the old variable is there"
is Total 43 || fail "the latest value is lost in a download"
await lived "Start Prepare Run Start Prepare Run Prepare Run"
run 0 --insecure write "$url" "$(variable Total)" 44
await grep -q -s '"value":44\b' followed
kill -INT "$follower"
wait "$follower"

# An online edit: what is new comes besides what there is, and nobody has to connect again.
rm -f followed # or what the client before has said is taken for what this one says
timeout 60 "$busbar" --json --insecure subscribe "$url" "$(variable Total)" --interval 50 \
    --duration 60 > followed 2>&1 &
follower=$!
await grep -q -s '"value":44\b' followed
program 'Pace : INT := 200; Depth : INT := 12;'
sed -i 's/^    Total .*/&\n    Shifts : DINT := 3;/' program.st
kill -HUP "$pid"
edited_twice() { [ "$(grep -c 'edited online: program.st' log)" -eq 2 ]; }
await edited_twice
is Depth 12 || fail "the variable that was added is not there"
is Shifts 3 || fail "the RETAIN variable that was added is not there"
run 0 --insecure write "$url" "$(variable Total)" 45 "$(variable Shifts)" 4
await grep -q -s '"value":45\b' followed
grep -q -s 'Uncertain' followed && fail "the task stood still in an online edit"
kill -INT "$follower"
wait "$follower"
has_shifts() { grep -q -s 'Shifts' state/retained; }
await has_shifts
lived "Start Prepare Run Start Prepare Run Prepare Run" || fail "an online edit is no preparation"
grep -q -s 'Depth' medium/packages/OPCUA_Server/ExecutionLog/*.log || fail "it is not in the log"

# A program that is wrong, and one that the rest of the configuration does not fit, change nothing.
program 'Pace : INTEGER;'
kill -HUP "$pid"
await logged 'program.st:4:5: .*(Pace): .* INTEGER, .*; nothing was changed'
program 'Cycles2 : INT;'
sed -i '/Cycles :/d' program.st
kill -HUP "$pid"
await logged 'machine.toml:[0-9]*: target: .*Cycles.*; nothing was changed'
is Pace 200 || fail "the program before is gone"
[ "$(listening)" = "$before" ] || fail "the port was closed"
lived "Start Prepare Run Start Prepare Run Prepare Run" || fail "the life went on: $(life)"

# A variable of another type begins as declared, and the log says so; power that goes is no loss.
program 'Pace : INT := 300;'
sed -i 's/Total  : DINT/Total  : LINT/' program.st
kill -HUP "$pid"
await ready 3
logged 'retained: Total: has another type' || fail "nobody learns of the other type"
is Total '"5"' || fail "a variable of another type has the value of the old one"
is Recipe '"cover plate"' || fail "the others lose their values"
sed -i 's/^retained_ms = .*/retained_ms = 3600000/' machine.toml
kill "$pid"
wait "$pid" || fail "the controller ends with $?"
serve --config machine.toml
run 0 --insecure write "$url" "$(variable Total)" 6
kill "$pid"
await ended && wait "$pid"
serve --config machine.toml
is Total '"6"' || fail "what is to be saved when power goes is lost"
kill "$pid"
await ended && wait "$pid"

# RETAIN variables that clients do not see are kept as well.
cat >> program.st << END
VAR_GLOBAL RETAIN
    Hidden : INT := 7;
END_VAR
END
serve --config machine.toml
timeout 60 "$busbar" --insecure read "$url" "$(variable Hidden)" > out 2>&1 &&
    fail "a variable without publish attribute is seen"
kill "$pid"
await ended && wait "$pid"
sed -i "s/Hidden : INT := 7;/{attribute 'publish' := 'publish only'} Hidden : INT := 1;/" program.st
serve --config machine.toml
is Hidden 7 || fail "a RETAIN variable that is not published is not kept"
kill "$pid"
await ended && wait "$pid"

# A machine whose OPC UA server is not used opens no port.
sed -i 's/^mode = .*/&\nuse = false/; s/^port = .*/port = '"${url##*:}/" machine.toml
before=$(life)
served=$url
serve --config machine.toml
logged 'no port: use = false' || fail "it does not say that there is no port"
url=$served
[ -z "$(listening)" ] || fail "a port is open without an OPC UA server"
program 'Pace : INT := 9;'
kill -HUP "$pid"
await logged 'downloaded: program.st'
sed -i 's/^use = .*/use = true/' machine.toml
program 'Pace : INT := 10;'
kill -HUP "$pid"
await logged 'machine.use: takes effect only after a restart .*; nothing was changed'
[ -z "$(listening)" ] || fail "a port is open before the restart"
lived "${before% }" || fail "a server that is not used has a life: $(life)"
kill "$pid"
await ended && wait "$pid"
serve --config machine.toml
is Pace 10 || fail "the server is not used after the restart"
kill "$pid"
await ended && wait "$pid"

# The DataTypes of PLCopen, and its configuration with what runs the program.
sed -i '/^use = .*/d' machine.toml
program 'Dwell : TIME := T#5s;'
cat >> program.st << END
CONFIGURATION Press
    RESOURCE Main ON CPU
        TASK Fast (INTERVAL := T#10ms, PRIORITY := 1);
        PROGRAM Cycle WITH Fast : CycleType;
    END_RESOURCE
END_CONFIGURATION
END
serve --config machine.toml
is Dwell '"5000"' || fail "TIME is not the Int64 of PLCopen"
run 0 --insecure browse "$url" "$(variable PLCopen/Configuration)" --depth 6
for part in Resources Fast Cycle GlobalVars; do
    says "$part"
done
kill "$pid"
await ended && wait "$pid"

# Or plain ones, as a product has them: TIME is a Double.
sed -i 's/^program = .*/&\ntypes = "built-in"/' machine.toml
serve --config machine.toml
is Dwell 5000 || fail "TIME is not a Double of milliseconds"
run 1 --insecure browse "$url" "$(variable PLCopen/Configuration)"
kill "$pid"
wait "$pid"
pid=""
exit $((failures > 0))
