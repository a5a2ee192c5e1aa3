# What the tests of programs share; read into a script whose $controller is busbar-controller, and
# which runs in a folder of its own from here on. Not a program.

work=$(mktemp -d)
pid=""
failures=0
trap 'kill $pid 2>/dev/null; wait; rm -rf "$work"' EXIT
export XDG_DATA_HOME="$work/data" LC_ALL=C
unset BUSBAR_URL BUSBAR_PASSWORD
cd "$work" || exit 1

fail() {
    failures=$((failures + 1))
    echo "FAILED: $*"
    sed 's/^/  /' log out 2> /dev/null
}

# await COMMAND...: until it succeeds.
await() {
    for _ in $(seq 300); do
        "$@" && return 0
        sleep 0.1
    done
    fail "waited in vain for: $*"
    return 1
}

logged() { grep -q -s -e "$1" log; }
ended() { ! kill -0 "$pid" 2> /dev/null; }

# run CODE ARGUMENTS...: busbar's exit code, its output in out.
run() {
    wanted=$1
    shift
    last="busbar $*"
    timeout 60 "$busbar" "$@" > out 2>&1 < /dev/null
    code=$?
    [ $code -eq "$wanted" ] || fail "$last: exit code $code instead of $wanted"
}

# serve ARGUMENTS...: a controller whose output goes to log, and its URL.
serve() {
    rm -f log # or the one before is found in it, who was ready too
    "$controller" "$@" > log 2>&1 < /dev/null &
    pid=$!
    await logged '^ready' || exit 1
    url=$(sed -n 's/.* variables at \(opc.tcp:[^ ]*\)$/\1/p' log)
}
