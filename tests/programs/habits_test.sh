#!/bin/sh
# Habits of command lines that users of others bring along: output for scripts, names instead of
# numbers, profiles, completion, help. Against a controller whose program has a bit of everything.
# usage: habits_test.sh CONTROLLER BUSBAR SOURCE_DIR
set -u
controller=$1 busbar=$2 source=$3
. "$source/tests/programs/functions.sh"

fail() {
    failures=$((failures + 1))
    echo "FAILED: $*"
    sed 's/^/  /' out err 2> /dev/null
}
export XDG_CONFIG_HOME="$work/config"
cp "$source/examples/controller/press.st" press.st
cat > press.toml << END
[server]
port = 0
address = "127.0.0.1"
nodesets = ["$work/oven.xml"]
[machine]
name = "Press 4"
program = "press.st"
state = "state"
[[endpoint]]
policy = "None"
mode = "None"
[users]
anonymous = "write"
END
cat > oven.xml << END
<UANodeSet xmlns="http://opcfoundation.org/UA/2011/03/UANodeSet.xsd">
  <NamespaceUris><Uri>urn:oven</Uri></NamespaceUris>
  <Models><Model ModelUri="urn:oven" Version="1.0" PublicationDate="2024-05-06T00:00:00Z"/></Models>
  <UAVariable NodeId="ns=1;i=1" BrowseName="1:Heat" DataType="i=11" AccessLevel="3">
    <DisplayName>Heat</DisplayName>
    <References>
      <Reference ReferenceType="i=40">i=17497</Reference>
      <Reference ReferenceType="i=47" IsForward="false">i=85</Reference>
      <Reference ReferenceType="i=46">ns=1;i=2</Reference>
    </References>
    <Value><Double xmlns="http://opcfoundation.org/UA/2008/02/Types.xsd">21.5</Double></Value>
  </UAVariable>
  <UAVariable NodeId="ns=1;i=2" BrowseName="EngineeringUnits" DataType="i=887">
    <DisplayName>EngineeringUnits</DisplayName>
    <References>
      <Reference ReferenceType="i=40">i=68</Reference>
      <Reference ReferenceType="i=46" IsForward="false">ns=1;i=1</Reference>
    </References>
    <Value>
      <ExtensionObject xmlns="http://opcfoundation.org/UA/2008/02/Types.xsd">
        <TypeId><Identifier>i=888</Identifier></TypeId>
        <Body><EUInformation><NamespaceUri>urn:units</NamespaceUri><UnitId>1</UnitId>
          <DisplayName><Text>kelvin</Text></DisplayName></EUInformation></Body>
      </ExtensionObject>
    </Value>
  </UAVariable>
</UANodeSet>
END
"$controller" --config press.toml > log 2>&1 < /dev/null &
pid=$!
await logged '^ready' || exit 1
url=$(sed -n 's/.* at \(opc.tcp:[^ ]*\)$/\1/p' log | head -n 1)
vars="/Objects/Press 4/GlobalVars"
read_() { run 0 --insecure read "$@"; }
out_is() { [ "$(cat out)" = "$1" ] || fail "$last: instead of $1"; }
BUSBAR_URL=$url
export BUSBAR_URL
quiet() { # The answer alone, without the warning that there is no security.
    timeout 60 "$busbar" --insecure "$@" > out 2> err < /dev/null
    code=$?
    last="busbar $*"
}

# Numbers of enumerations and bits have their names, times of the PLC are such.
read_ "$vars/Mode" "$vars/ShiftStart" "$vars/ActiveRecipe" i=2259
says 'Mode  *Automatic (2)'
says 'TOD#06:00:00'
says 'T#1s500ms'
says 'i=2259  *Running (0)'
read_ --all "$vars/Mode"
says '^Value  *Automatic (2)$'
says '^DataType  *MachineMode (ns='
says '^AccessLevel  *CurrentRead | CurrentWrite (3)$'
read_ -a DataType "$vars/Mode"
says 'MachineMode (ns='
read_ --json "$vars/Mode"
says '"value":2,"valueName":"Automatic"'
run 0 --insecure subscribe "$vars/Mode" -n 1
says 'Mode  Automatic (2)'
run 0 --insecure browse "$vars" --values -d 1
says '4:Mode .*Automatic (2)'
says '4:Pressure' # which is a source of events of Press 4 as well
read_ "/Objects/Heat"
says '21.5 kelvin'

# A node that has no value is told by its NodeClass, with what to do instead.
for command in read subscribe watch; do
    run 1 --insecure $command "$vars"
    says 'it is an Object, which has no value'
    says '`busbar watch --below` shows the Variables below it'
done
run 1 --insecure read i=11492 # GetMonitoredItems
says 'it is a Method, which has no value'
run 5 --insecure read "$vars" "$vars/Mode"
says 'GlobalVars: it is an Object, which has no value'
run 5 --insecure subscribe "$vars" "$vars/Mode" -n 1
says 'Bad_AttributeIdInvalid, it is an Object, which has no value'
run 1 --insecure read -a Value "$vars"
says 'it is an Object'
run 1 --insecure read -a Historizing "$vars" # nothing is said of a value
says_not 'which has no value'
run 2 --insecure --policy "" read i=2258
says '"" is not a security policy'

# For scripts: values as write takes them, lines by a pattern, CSV.
quiet read --value "$vars/SerialNumber" "$vars/Mode" "$vars/ShiftStart"
out_is "BB-0001
Automatic
TOD#06:00:00"
quiet read --csv "$vars/SerialNumber" /Objects/Heat
[ "$(sed -n 1p out)" = "node,value,unit,status,sourceTimestamp" ] || fail "another title of CSV"
sed -n 2p out | grep -q "^$vars/SerialNumber,BB-0001,,Good,20..-..-..T.*Z\$" || fail "another line of CSV"
sed -n 3p out | grep -q '^/Objects/Heat,21.5,kelvin,Good,' || fail "the unit is not in the CSV"
quiet read --format '%n=%v%%\t%s %d' "$vars/MaxSpeed"
out_is "$(printf '%s=1500%%\tGood Int16' "$vars/MaxSpeed")"
quiet read --csv "$vars/ActiveRecipe"
grep -q '"{""UaTypeId"":' out || fail "quotes are not doubled in CSV"
quiet subscribe --format '%v' "$vars/MaxSpeed" -n 1
out_is 1500
quiet watch --value "$vars/MaxSpeed" -n 1
out_is 1500
run 2 --insecure read --format '%q' "$vars/Mode"
says '%q is not part of a pattern'
run 2 --insecure read --format '%v' --csv "$vars/Mode"
says 'excludes'
# What read gives is what write takes.
quiet read --value "$vars/ActiveRecipe"
recipe=$(cat out)
run 0 --insecure write "$vars/Mode" SetUp "$vars/ShiftStart" TOD#07:30:00 "$vars/ActiveRecipe" "$recipe"
quiet read --value "$vars/Mode" "$vars/ShiftStart" "$vars/ActiveRecipe"
out_is "SetUp
TOD#07:30:00
$recipe"

# A structure is written with all its fields, or those that are not named stay.
run 2 --insecure write "$vars/ActiveRecipe" '{"Name":"lid"}'
says 'Recipe is not complete'
says 'Force, HoldTime, Positions'
says 'merge'
quiet read --value "$vars/ActiveRecipe"
out_is "$recipe"
run 0 --insecure write --merge "$vars/ActiveRecipe" '{"Name":"lid"}'
quiet read --value "$vars/ActiveRecipe"
out_is "$(echo "$recipe" | sed 's/"Name":"[^"]*"/"Name":"lid"/')"

# Nodes are found by name and by type.
run 0 --insecure find mode
says '/Objects/4:Press 4/4:GlobalVars/4:Mode  *Variable  *MachineMode'
run 0 --insecure find machinemode
[ "$(grep -c Variable out)" -eq 1 ] || fail "not one Variable of MachineMode"
run 0 --insecure find '*speed' --below "$vars" --json
says '"nodeId":"ns=4;s=MaxSpeed"'
run 0 --insecure find e --limit 1
says 'more are not shown'
run 1 --insecure find nothing-such
says 'nothing below /Objects'

# Profiles stand for a server and what it takes to log in.
unset BUSBAR_URL
run 2 read @press i=2258
says 'there is no file of profiles'
mkdir -p config/busbar
cat > config/busbar/profiles.toml << END
# The press in hall 2
[press]
url = "$url"
insecure = true
timeout = 10
policy = ["Basic256Sha256", "Aes256_Sha256_RsaPss"]

[gone]
url = "opc.tcp://127.0.0.1:1"
insecure = true
END
read_ @press i=2259
run 0 read --profile press i=2259
BUSBAR_PROFILE=press
export BUSBAR_PROFILE
run 0 read i=2259
unset BUSBAR_PROFILE
run 0 endpoints @press
run 3 --timeout 2 read @gone i=2259
run 0 read --profile gone --url "$url" i=2259 # what is given counts
run 2 read @pres i=2259
says 'there are gone, press'
completes() { # LINE ANSWER...
    line=$1
    shift
    timeout 60 "$busbar" --complete "$line" > out 2> err < /dev/null
    [ "$(cat out)" = "$(printf '%s\n' "$@")" ] || fail "completion of '$line': $(cat out)"
}
completes 'busbar rea' read
completes 'busbar read --poli' --policy
completes 'busbar read --policy Aes' Aes128_Sha256_RsaOaep Aes256_Sha256_RsaPss
completes 'busbar --policy=Basic256Sha256,Aes2' --policy=Basic256Sha256,Aes256_Sha256_RsaPss
completes 'busbar --mode S' Sign SignAndEncrypt
completes 'busbar read -a UserA' UserAccessLevel
completes 'busbar read @' @gone @press
completes 'busbar read --profile p' press
completes 'busbar completion f' fish
completes 'busbar admin trust sh' show
completes 'busbar read @press "/Objects/Press 4/Glob' "/Objects/Press 4/GlobalVars/"
completes 'busbar read @press /Objects/Press\ 4/GlobalVars/Sh' "$vars/ShiftStart"
completes 'busbar read @press /Objects/4:P' "/Objects/4:Press 4/"
completes "busbar write @press '$vars/Mode' " Idle SetUp Automatic Halted
completes "busbar write @press '$vars/Running' t" true
completes 'busbar read @gone /Objects/' ''
if command -v bash > /dev/null; then
    cat > complete.bash << 'END'
eval "$("$1" completion bash)"
reply() { # LINE WORDS...: as bash has it after Tab
    COMP_LINE=$1 COMP_POINT=${#1} COMP_WORDS=("${@:2}") COMP_CWORD=$(($# - 2))
    _busbar
    printf '%s\n' "${COMPREPLY[@]}"
}
reply 'busbar rea' "$1" rea
reply 'busbar read @press /Objects/4:P' "$1" read @press /Objects/4 : P
END
    bash complete.bash "$busbar" > out 2> err < /dev/null
    out_is "read
Press 4/"
fi
if command -v zsh > /dev/null; then # the script as a file of $fpath, and as text
    mkdir zsh
    "$busbar" completion zsh > zsh/_busbar
    cat > complete.zsh << 'END'
zmodload zsh/zpty
zpty shell "PATH=$1:\$PATH zsh -f -i"
zpty -w shell "$2"
zpty -w -n shell $'busbar completion f\t'
zpty -r shell out '*completion f*ish*'
END
    for load in 'fpath=(zsh $fpath); autoload -U compinit && compinit -u -D' \
        'autoload -U compinit && compinit -u -D; eval "$(busbar completion zsh)"'; do
        timeout 60 zsh complete.zsh "${busbar%/*}" "$load" > out 2>&1 < /dev/null ||
            fail "zsh does not complete with: $load"
    done
fi

# Mistakes in the file are told with their place; a password is refused.
for line in 'password = "x"' 'user = ""' 'usr = "x"' 'mode = "None"' 'policy = "Basic"' 'timeout = "no"'; do
    printf '[press]\nurl = "%s"\n%s\n' "$url" "$line" > config/busbar/profiles.toml
    run 2 read @press i=2258
    tr '\n' ' ' < out | tr -s ' ' | grep -q "profiles.toml: press.${line%% *}" || fail "no place of: $line"
done
printf '[press]\npassword = "secret-1"\n' > config/busbar/profiles.toml
run 2 read @press i=2258
says_not 'secret-1'
says 'password-file'

# Help as it is looked for, in lines that a terminal has room for.
run 0 help
says 'Subcommands:'
run 0 help admin trust
says 'busbar admin trust'
run 2 help raed
says 'did you mean'
# A server after the other arguments is not passed over for another one.
for words in "mode run" "role grant chief Operator" "user add chief"; do
    # shellcheck disable=SC2086 # they are words
    run 2 admin $words opc.tcp://192.0.2.1:4840
    says 'opc.tcp://192.0.2.1:4840: the server comes before the other arguments'
done
run 2 raed --help
says 'did you mean `busbar read`'
for program in "$busbar" "$controller"; do
    "$program" --help | awk 'length > 80 { print; wide = 1 } END { exit wide }' ||
        fail "help is wider than 80 columns"
    "$program" --version | grep -q '^busbar.* [0-9]' || fail "there is no version"
done
"$controller" --help | grep -q '^Usage: busbar-controller ' || fail "the usage has the folder of the program"
for command in $("$busbar" --complete 'busbar '); do
    "$busbar" "$command" --help | awk 'length > 80 { print; wide = 1 } END { exit wide }' ||
        fail "help of $command is wider than 80 columns"
done

echo "$failures failures"
[ $failures -eq 0 ]
