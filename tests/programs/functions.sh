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

# await COMMAND...: until it succeeds, for a minute. What takes longer is asked for less often:
# each time is a process or more, which the tests beside this one would wait for.
await() {
    for polls in $(seq 600); do
        "$@" && return 0
        if [ "$polls" -le 20 ]; then sleep 0.02; else sleep 0.1; fi
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

# ends_with CODE ARGUMENTS...: whether that is busbar's exit code, for await.
ends_with() {
    wanted=$1
    shift
    timeout 60 "$busbar" "$@" > out 2>&1 < /dev/null
    [ $? -eq "$wanted" ]
}

# Where logins are not what is tested: tables of a configuration with which a login costs as little
# as the controller allows, and nobody who is refused has to wait; and the hash of FILE's password.
quick_logins='[limits]
login_failures_per_address = 1000
first_login_delay_ms = 0
max_login_delay_ms = 0
[users]
password_hash = "pbkdf2"
password_iterations = 10000'
quick_hash() {
    echo "$quick_logins" > quick.toml
    "$controller" --hash-password --config quick.toml < "$1"
}

# new_key FILE: an RSA key for openssl, another one each time; kept as those of the programs are.
new_keys=0
new_key() {
    new_keys=$((new_keys + 1))
    if [ -z "${BUSBAR_KEPT_KEYS:-}" ] || [ "${BUSBAR_TEST_EFFORT:-}" = full ]; then
        openssl genrsa -out "$1" 2048 2> /dev/null
        return
    fi
    kept=$BUSBAR_KEPT_KEYS/openssl-2048-$new_keys.pem
    if ! [ -s "$kept" ]; then
        mkdir -p -m 700 "$BUSBAR_KEPT_KEYS"
        openssl genrsa -out "$kept.$$" 2048 2> /dev/null && mv "$kept.$$" "$kept"
    fi
    cp "$kept" "$1"
}

# What busbar said at the last run.
says() { grep -q -s -e "$1" out || fail "\"$1\" is not in the output of: $last"; }
says_not() { ! grep -q -s -e "$1" out || fail "\"$1\" is in the output of: $last"; }

# press_model VARIABLE: an information model of a variable Speed, another one of these lines, and a
# Method Start.
press_model() {
    cat << END
<UANodeSet xmlns="http://opcfoundation.org/UA/2011/03/UANodeSet.xsd">
  <NamespaceUris><Uri>http://press.example/Press</Uri></NamespaceUris>
  <Models><Model ModelUri="http://press.example/Press" Version="1.2"
    PublicationDate="2024-05-06T00:00:00Z"/></Models>
  <UAVariable NodeId="ns=1;i=5" BrowseName="1:Speed" DataType="i=4" AccessLevel="3">
    <DisplayName>Speed</DisplayName>
    <References>
      <Reference ReferenceType="i=40">i=63</Reference>
      <Reference ReferenceType="i=47" IsForward="false">i=85</Reference>
    </References>
    <Value><Int16 xmlns="http://opcfoundation.org/UA/2008/02/Types.xsd">417</Int16></Value>
  </UAVariable>
$1
  <UAMethod NodeId="ns=1;i=7" BrowseName="1:Start">
    <DisplayName>Start</DisplayName>
    <References><Reference ReferenceType="i=47" IsForward="false">i=85</Reference></References>
  </UAMethod>
</UANodeSet>
END
}

# serve ARGUMENTS...: a controller whose output goes to log, and its URL.
serve() {
    served=$*
    rm -f log # or the one before is found in it, who was ready too
    "$controller" "$@" > log 2>&1 < /dev/null &
    pid=$!
    await logged '^ready' || exit 1
    url=$(sed -n 's/.* variables at \(opc.tcp:[^ ]*\)$/\1/p' log)
}
