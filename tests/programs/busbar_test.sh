#!/bin/sh
# Runs the program busbar against busbar-controller, as people and scripts do.
# usage: busbar_test.sh BUSBAR CONTROLLER SOURCE_DIR CMAKE
set -u
busbar=$1 controller=$2 source=$3 cmake=$4

work=$(mktemp -d)
servers=""
failures=0
trap 'for pid in $servers; do kill "$pid"; done 2>/dev/null; wait; rm -rf "$work"' EXIT
export XDG_DATA_HOME="$work/data" LC_ALL=C COLUMNS=80
unset BUSBAR_URL BUSBAR_PASSWORD NO_COLOR

fail() {
    failures=$((failures + 1))
    echo "FAILED: $*"
    sed 's/^/  out: /' "$work/out"
    sed 's/^/  err: /' "$work/err"
}

# serve NAME: starts a controller with $work/NAME.toml and sets BUSBAR_URL.
serve() {
    (cd "$work" && exec "$controller" --config "$1.toml") > "$work/$1.log" 2>&1 &
    servers="$servers $!"
    # A minute: it makes its key first, which takes a busy machine long.
    for polls in $(seq 650); do
        grep -q '^ready' "$work/$1.log" && break
        if [ "$polls" -le 50 ]; then sleep 0.02; else sleep 0.1; fi
    done
    BUSBAR_URL=$(sed -n 's/.* at \(opc.tcp:[^ ]*\)$/\1/p' "$work/$1.log")
    export BUSBAR_URL
    [ -n "$BUSBAR_URL" ] || { fail "$1 does not start"; cat "$work/$1.log"; exit 1; }
}

# run CODE ARGUMENTS...: the exit code is CODE, nothing has an escape sequence or is too wide.
run() {
    wanted=$1
    shift
    timeout 60 "$busbar" "$@" > "$work/out" 2> "$work/err" < /dev/null
    code=$?
    [ $code -eq "$wanted" ] || fail "busbar $*: exit code $code instead of $wanted"
    grep -q "$(printf '\033')" "$work/out" "$work/err" && fail "busbar $*: an escape sequence"
    case " $* " in
        *" --json "* | *" completion "* | *" export "* | *" watch "*) ;;
        *) awk 'length > 80 { exit 1 }' "$work/out" "$work/err" || fail "busbar $*: too wide" ;;
    esac
}
# json CODE ARGUMENTS...: the same, and each line is a JSON document.
json() {
    run "$@" --json
    shift
    while IFS= read -r line; do
        printf '%s' "$line" > "$work/line"
        "$cmake" -D "FILE=$work/line" -P "$source/tests/programs/check_json.cmake" 2> "$work/err" ||
            fail "busbar $* --json: no JSON"
    done < "$work/out"
}
has() { grep -q -e "$1" "$work/out" || fail "\"$1\" is not in the output"; }
tells() { tr '\n' ' ' < "$work/err" | tr -s ' ' | grep -q -e "$1" || fail "\"$1\" is no error message"; }

# Without a server.
run 2
run 2 nonsense
run 2 read
run 0 --help
for shell in bash zsh fish; do run 0 completion $shell; has "busbar.*--complete\|COMP_WORDS.*--complete"; done
run 0 cert list
run 1 cert show
tells "busbar cert create"
run 3 read i=2258 --url opc.tcp://localhost:1 --timeout 2
json 3 read i=2258 --url opc.tcp://localhost:1 --timeout 2
has '"symbol":"Bad_'

# Against the demo, which has no security.
sed -e 's/^port = .*/port = 0/' \
    -e "s|^\[server\]|&\nnodesets = [\"$source/tests/model/line.NodeSet2.xml\"]|" \
    "$source/examples/controller/demo.toml" > "$work/demo.toml"
cat >> "$work/demo.toml" <<'TOML'
[[discovery.server]]
name = "Press 2"
url = "opc.tcp://press-2.example:4840"
capabilities = ["DA"]
TOML
serve demo
run 0 discover
has "Busbar demo"
json 0 discover
run 0 discover --network
has "Press 2"
json 0 discover --network
has '"DA"'
run 0 endpoints --conformance --insecure
has "StandardDataChangeSubscription2017"
has "yes"
json 0 endpoints --conformance --insecure
has '"lacks"'
run 0 endpoints
has "anonymous"
json 0 endpoints
run 4 read i=2258
tells "insecure"
[ -O "$work/data/busbar/pki/own/private/own.pem" ] || fail "no key was made"
[ "$(stat -c %a "$work/data/busbar/pki/own/private/own.pem")" = 600 ] || fail "the key is open"

run 0 browse --insecure
has "2:PLC"
run 0 browse /Objects/2:PLC --values --insecure
has '"BB-0001"'
json 0 browse --depth 1 --insecure
run 0 browse i=2253 --references --insecure
has "HasTypeDefinition"
run 1 browse i=999999 --insecure

run 0 read i=2255 /Objects/2:PLC/2:SerialNumber "nsu=urn:busbar:plc;s=Mode" --insecure
has "BB-0001"
json 0 read "ns=2;s=Axes" "ns=2;s=Grid" i=2256 --insecure
run 0 read --value "ns=2;s=SerialNumber" --insecure
run 0 read --all "ns=2;s=Speed" --insecure
has "AccessLevel"
json 0 read --all "ns=2;s=Speed" --insecure
run 1 read "ns=2;s=Nothing" --insecure
tells "Bad_NodeIdUnknown.*hint"
run 5 read "ns=2;s=Mode" "ns=2;s=Nothing" --insecure
run 2 read "what is this" --insecure

run 0 write "ns=2;s=Mode" 7 "ns=2;s=Offset" -5 "ns=2;s=Recipe" "two words" --insecure
run 0 read --value "ns=2;s=Mode" "ns=2;s=Offset" "ns=2;s=Recipe" --insecure
[ "$(tr '\n' ' ' < "$work/out")" = '7 -5 two words ' ] || fail "other values than written"
run 0 write "ns=2;s=Grid" "[[1, 2, 3, 4], [5, 6, 7, 8], [9, 10, 11, 12]]" --insecure
run 2 write "ns=2;s=Mode" 300 --insecure
run 1 write "ns=2;s=SerialNumber" x --insecure
json 5 write "ns=2;s=Mode" 1 "ns=2;s=SerialNumber" x --insecure

run 0 call "ns=2;s=PLC" ResetCounters --insecure
json 0 call "ns=2;s=PLC" "ns=2;s=ResetCounters" --insecure
run 2 call "ns=2;s=PLC" ResetCounters 1 --insecure
run 1 call "ns=2;s=PLC" Nothing --insecure

run 0 subscribe "ns=2;s=Parts" "ns=2;s=Speed" --count 5 --interval 50 --insecure
[ "$(wc -l < "$work/out")" -eq 5 ] || fail "not five changes"
json 0 subscribe "ns=2;s=Parts" --count 3 --interval 50 --insecure
has '"sourceTimestamp"'
run 1 subscribe "ns=2;s=Nothing" --duration 5 --insecure
run 0 watch "ns=2;s=Parts" --count 3 --interval 50 --no-events --insecure
[ "$(wc -l < "$work/out")" -eq 3 ] || fail "not three changes"
run 0 watch --count 40 --interval 50 --insecure
has "/Objects/2:PLC/2:SerialNumber  \"BB-0001\""
run 0 watch --below /Objects/2:PLC --limit 2 --duration 2 --insecure
has "/Objects/2:PLC/2:Mode  1"
tells "17 more Variables are left out"
json 0 watch --below "ns=2;s=PLC" --limit 2 --count 6 --insecure
has '"node":"\[ns=2;s=PLC\]/2:Mode"'
has '"event":{"Time"'
run 1 watch --below "ns=2;s=Mode" --insecure
run 1 watch --below "ns=2;s=Nothing" --insecure
tells "Bad_NodeIdUnknown"
run 1 watch "ns=2;s=Nothing" --duration 5 --insecure
run 2 watch "what is this" --insecure
json 0 events --count 1 --duration 10 --insecure
has '"Message"'
# Whoever reads no more ends it; so does Ctrl+C.
timeout 30 "$busbar" subscribe "ns=2;s=Parts" --interval 50 --insecure 2> "$work/err" | head -n 2 > "$work/out"
[ "$(wc -l < "$work/out")" -eq 2 ] || fail "a pipe that ends"
timeout 30 "$busbar" subscribe "ns=2;s=Mode" --insecure > "$work/out" 2> "$work/err" &
for _ in $(seq 500); do
    [ -s "$work/out" ] && break
    sleep 0.02
done
[ -s "$work/out" ] || fail "nothing before Ctrl+C"
kill -INT $!
wait $!
[ $? -eq 130 ] || fail "Ctrl+C does not end it as an interruption"

json 0 bench --seconds 0.2 --insecure
has '"p99Ms"'
run 2 export 99 --insecure
run 0 export urn:line -o "$work/line.xml" --insecure
run 0 export 3 --insecure

# What was exported loads again.
cat > "$work/again.toml" << END
[server]
name = "Again"
address = "127.0.0.1"
port = 0
nodesets = ["$work/line.xml"]
[[endpoint]]
policy = "None"
[users]
anonymous = "write"
END
serve again
run 0 export 3 -o "$work/line2.xml" --insecure
# The order of nodes is the server's.
sort "$work/line.xml" > "$work/line"
sort "$work/line2.xml" | diff "$work/line" - > "$work/out" || fail "exported twice, the files differ"

# Against a server with security.
hash=$(printf 'Long-Password-123' | "$controller" --hash-password)
sed 's/^port = .*/port = 0\naddress = "127.0.0.1"/' "$source/examples/controller/controller.toml" > "$work/secure.toml"
cat >> "$work/secure.toml" << END
[[users.account]]
name = "operator"
password = "$hash"
access = "write"
END
serve secure
echo "Long-Password-123" > "$work/password"
run 4 read i=2258
tells "Bad_IdentityTokenRejected"
login="--user operator --password-file $work/password"
# First the server is a stranger to busbar, then busbar to the server.
run 4 read i=2258 $login
tells "busbar cert trust"
json 4 read i=2258 $login
has Bad_CertificateUntrusted
json 0 cert list
has '"list":"rejected"'
thumbprint=$(sed 's/.*"list":"rejected"[^}]*"thumbprint":"\([0-9A-F]*\)".*/\1/' "$work/out")
run 0 cert show "$thumbprint"
run 0 cert trust "$thumbprint"
run 4 read i=2258 $login
tells "own.der"
mv "$work"/busbar-certificates/rejected/certs/* "$work/busbar-certificates/trusted/certs/"
run 0 read i=2258 $login
run 0 cert reject "$thumbprint"
run 4 read i=2258 $login
run 0 read i=2258 $login --trust
tells "trusted from now on"
run 4 read i=2258 --user operator --password wrong
tells "warning"
run 0 read i=2258 $login --policy Basic256Sha256 --mode Sign
run 0 cert export "$work/own.der"
run 1 cert create
run 0 cert create --force --days 30

echo "$failures failures"
[ $failures -eq 0 ]
