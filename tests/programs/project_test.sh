#!/bin/sh
# Projects of model mode by `busbar project`: made without a server (SH-082679, 9.3 to 9.12), and
# transferred to one that runs (9.13 and 9.14).
# usage: project_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
here=$(cd "$(dirname "$0")" && pwd)
. "$here/functions.sh"


press_model '  <UAVariable NodeId="ns=1;i=6" BrowseName="1:Forces" DataType="i=4" ValueRank="1"
    AccessLevel="3">
    <DisplayName>Forces</DisplayName>
    <References>
      <Reference ReferenceType="i=40">i=63</Reference>
      <Reference ReferenceType="i=47" IsForward="false">i=85</Reference>
    </References>
  </UAVariable>' > press.xml

# 9.3: a new project, which is not replaced without a question.
run 0 project new press.busbar
head -n 1 press.busbar | grep -q '^busbar project 1$' || fail "no project file was made"
run 1 project new press.busbar
says 'nothing was done'
run 0 project new press.busbar --yes --preset rd81opc96
run 1 project new other.busbar --preset nj501
says 'preset: found "nj501"'
[ -e other.busbar ] && fail "a wrong project was written"

# 9.7 to 9.12: values, all or none.
run 0 project set press.busbar listener\ 1.address 192.168.3.40 network.host_name PRESS4
run 0 project show press.busbar
says 'end point: opc.tcp://192.168.3.40:4840'
says 'network.host_name *PRESS4'
cp press.busbar before
run 1 project set press.busbar network.host_name PRESS5 certificate.country de
says '\[certificate\] country: found "de"'
run 2 project set press.busbar network.hostname PRESS5
run 2 project set press.busbar network.host_name
cmp -s press.busbar before || fail "a refused change has changed the project"
run 0 --json project show press.busbar
says '"network.host_name":"PRESS4"'
echo "Secret_123" > password
run 0 project user press.busbar hmi --new-password-file password --permission client
grep -q 'Secret' press.busbar && fail "the project has a password"
grep -q '^password_hash = \$scrypt\$' press.busbar || fail "the project has no hash"
cp press.busbar small.busbar
run 0 project user small.busbar hmi --new-password-file password --pbkdf2-iterations 10000
grep -q '^password_hash = \$pbkdf2-sha256\$10000\$' small.busbar || fail "the hash is another one"
run 2 project user small.busbar hmi --new-password-file password --pbkdf2-iterations 9999
echo "secret" > password
run 1 project user press.busbar chief --new-password-file password

# 9.4 and 9.6: models.
run 0 project import press.busbar press.xml
says 'imported http://press.example/Press: 3 nodes'
run 0 project namespaces press.busbar
says 'http://press.example/Press *1.2 *2024-05-06'
run 0 project tree press.busbar
says '1:Speed *Variable *Int16 *ns=1;i=5'
cp press.busbar before
sed 's/DataType="i=4"/DataType="ns=1;i=77"/' press.xml > wrong.xml
run 1 project import press.busbar wrong.xml
says 'wrong.xml'
cmp -s press.busbar before || fail "a refused import has changed the project"
run 0 project export press.busbar http://press.example/Press
[ -s Press.xml ] || fail "nothing was exported"
run 0 project import press.busbar Press.xml
says 'replaced http://press.example/Press'
run 1 project delete press.busbar http://opcfoundation.org/UA/
run 0 project delete press.busbar http://press.example/Press
run 0 project tree press.busbar
says_not 'Speed'
run 0 project import press.busbar press.xml

# 9.5: mapping, one by one and as a table.
run 0 project map press.busbar "ns=1;i=5" Line.Speed
run 0 project tree press.busbar
says '1:Speed .*Line.Speed'
run 0 project tree press.busbar --parts
says '^ *Handle '
says '^ *\[0\] '
run 0 project tree press.busbar --all
says '^ *1:Forces  *Forces  *Variable  *Int16\[\]  *ns=1;i=6  *rw  *BaseDataVariableType  *1$'
run 0 project show press.busbar /Objects/1:Speed
says '^NodeClass  *Variable$'
says '^ValueRank  *-1 (Scalar)$'
says '^Value  *417$'
says '^ *Int16  *Line.Speed  *INT  *UINT, WORD; '
says '^<- HasComponent  *Object  *Objects '
run 0 project show press.busbar "i=852"
says '^Running  *0$'
says '^cannot be mapped: '
run 1 project show press.busbar /Objects/1:Slow
says 'there is no such node'
run 0 project csv press.busbar --all
says ',Handle,,,,,,UInt16'
run 0 project types
says '^BOOL  *Boolean'
run 0 project array press.busbar /Objects/1:Forces 1 3 --first 'Line.Force[0]'
run 0 project csv press.busbar
says '^"\{0,1\}nsu=http://press.example/Press;i=5"\{0,1\},/Objects/1:Speed,,Line.Speed,'
says ',/Objects/1:Forces,,,1,3,'
says ',\[0\],Line.Force\[0\],'
cp out table.csv
cp press.busbar before
run 0 project csv press.busbar --in table.csv
cmp -s press.busbar before || fail "a table that was printed has changed the project"
run 1 project map press.busbar "ns=1;i=99" Line.Speed
run 1 project map press.busbar "i=2258" Line.Time
printf 'NodeId,Part,Label\nns=1;i=99,,x\n' > wrong.csv
run 1 project csv press.busbar --in wrong.csv
cmp -s press.busbar before || fail "a refused mapping has changed the project"
run 0 project map press.busbar "ns=1;i=5" ""
run 0 project csv press.busbar
says_not 'Line.Speed'
run 0 project csv press.busbar --in table.csv
run 0 project map press.busbar "ns=1;i=7" Line.Handle Handle
# A table is added to what there is; what it does not have goes when that is asked for.
cp press.busbar before
echo 'NodeId,Part,Label' > header.csv
run 0 project csv press.busbar --in header.csv
says '0 labels of the table, 3 in all'
cmp -s press.busbar before || fail "an empty table has changed the project"
run 1 project csv press.busbar --in header.csv --replace
says 'the table has no line for 3 labels of the project: nothing was changed'
cmp -s press.busbar before || fail "labels went without a question"
run 0 project csv press.busbar --in header.csv --replace --yes
says '0 labels of the table, 0 in all'
cp before press.busbar
run 2 project csv press.busbar --replace
run 0 project export press.busbar http://press.example/Press --yes
grep -q 'Line.Speed' Press.xml || fail "no mapping was exported"
# Without mapping in the file, what was there stays (9.4).
run 0 project import press.busbar press.xml
run 0 project csv press.busbar
says 'Line.Speed'

# 4.2: the check, with the counters of the status bar.
run 0 project check press.busbar
says '^labels *3 *25000$'
says '0 errors, 0 warnings'
run 0 --json project check press.busbar
says '"name":"labels","count":3,"limit":25000,"isExceeded":false'

# What no label can be called is no mapping, by hand or by a table (8.3).
run 1 project map press.busbar "ns=1;i=5" 'K4Line'
says 'ns=1;i=5'
run 1 project map press.busbar "ns=1;i=5" 'Line.7'
run 0 project check press.busbar
says '0 errors, 0 warnings'
run 0 project export press.busbar http://press.example/Press --yes
cp press.busbar wrong.busbar
sed 's/Data="Line.Speed"/Data="Line.Speed.7"/' Press.xml > wrong.xml
run 0 project import wrong.busbar wrong.xml
run 1 project check wrong.busbar
says 'Line.Speed.7'
says '1 errors'

# A file that was changed by hand or is damaged is refused with its line.
sed 's/PRESS4/PRESS5/' press.busbar > damaged.busbar
run 1 project show damaged.busbar
says 'damaged.busbar:[0-9]*: \[end\] checksum: found'
sed 's/^busbar project 1/busbar project 2/' press.busbar > newer.busbar
run 1 project show newer.busbar
says 'newer.busbar:1: found version 2, expected version 1'


# 9.13: a server that runs takes it, whole or not at all.
echo "patience is all" > password
hash=$(quick_hash password)
cat > controller.toml << END
[server]
port = 0
[certificates]
folder = "pki"
[[endpoint]]
policy = "Basic256Sha256"
mode = "SignAndEncrypt"
$quick_logins
[[users.account]]
name = "chief"
password = "$hash"
roles = ["SecurityAdmin"]
[[users.account]]
name = "operator"
password = "$hash"
roles = ["Operator"]
[labels]
program = "line.st"
[[plc.program]]
kind = "acknowledge"
target = "Line.Handle"
sets = "Line.State"
to = 6
END
cat > line.st << 'END'
TYPE LineType : STRUCT
    Speed : INT := 900;
    Other : INT := 901;
    Force : ARRAY [0..2] OF INT;
    Handle : WORD;
    State : INT := 4;
END_STRUCT; END_TYPE
{attribute 'publish' := 'publish only'}
VAR_GLOBAL Line : LineType; END_VAR
END
cp line.st line.first
serve --config controller.toml --port 0 --project project
as() {
    user=$1 wanted=$2
    shift 2
    run "$wanted" --user "$user" --password-file password --trust "$@"
}
run 0 cert create
as chief 4 admin status "$url"
mv pki/rejected/certs/* pki/trusted/certs/
as chief 0 project status "$url"
says 'operationMode *model mode'
says 'serverStatus *Running'
says 'project *none'
as chief 1 project read "$url" read.busbar
as operator 1 project write "$url" press.busbar --yes

run 0 project set press.busbar "listener 1.address" ""
as chief 0 project write "$url" press.busbar --yes
as chief 0 project status "$url"
says 'project *written, an update or restart is due'
as chief 0 project read "$url" read.busbar
cmp -s read.busbar press.busbar || fail "another project was read than was written"
as chief 0 project verify "$url" press.busbar
says 'no differences'
run 0 project set press.busbar network.host_name PRESS5
run 0 project map press.busbar "ns=1;i=5" Line.Other
as chief 1 project verify "$url" press.busbar
says 'network.host_name *"PRESS5" *"PRESS4"'
says 'http://press.example/Press: ns=1;i=5 *Line.Other *Line.Speed$'
sed 's/PRESS5/PRESS6/' press.busbar > damaged.busbar
as chief 1 project write "$url" damaged.busbar --yes
as chief 0 project read "$url" read.busbar --yes
grep -q 'host_name = PRESS4' read.busbar || fail "a refused project is there"

as chief 0 project update "$url" --yes
speed='nsu=http://press.example/Press;i=5'
forces='nsu=http://press.example/Press;i=6'
has_speed() {
    "$busbar" --user chief --password-file password --trust read --value "$url" "$speed" \
        > out 2>&1 && grep -q -x -e "$1" out
}
logged 'there is none' && fail "a first start without a project is an error"
# 8.3: Variables are labels of the PLC, which the labels' program is in.
await has_speed 900 # and not 417, as the model has it
await logged 'labels: event 24001'
logged '2 Variables and 1 Methods are mapped' || fail "not all was mapped"
as operator 0 write "$url" "$speed" 17
as operator 0 write "$url" "$forces" '[7,8,9]'
as chief 0 read --value "$url" "$speed" "$forces"
says '^17$'
says '^\[7, 8, 9\]$' # what has no label keeps what was written
as operator 0 call "$url" /Objects '/Objects/2:Start'
as chief 0 read "$url" /Objects/1:Module/1:TargetDevice1Status
says '1'
as chief 0 project status "$url"
says 'project *in use'

# An online change of the PLC: labels are found where they are then, with their values.
sed 's/VAR_GLOBAL Line/VAR_GLOBAL Before : LREAL; Line/' line.st > line.new && mv line.new line.st
kill -HUP "$pid"
await logged 'downloaded: line.st'
await has_speed 17
[ "$(grep -c 'event 24001' log)" -eq 2 ] || fail "labels were not updated once"
sed 's/Speed : INT/Gone : INT/' line.st > line.new && mv line.new line.st
kill -HUP "$pid"
await logged 'event 24003'
logged 'error 1921H: .*: Line.Speed of ns=2;i=5' || fail "no error names the label"
as chief 3 read "$url" "$speed"
says 'Bad_NoCommunication'
echo 'VAR_GLOBAL' > line.st
kill -HUP "$pid"
await logged 'line.st:[0-9]*:[0-9]*: .*nothing was changed'

# 9.8: a second listener, for administrators only, at an address of its own.
. "$here/ports.sh"
tool_port=$port
tool=opc.tcp://127.0.1.2:$tool_port
cp line.first line.st
run 0 project set press.busbar "listener 1.address" 127.0.0.1 "listener 1.use" data \
    "listener 2.use" administration "listener 2.address" 192.0.2.77
run 1 project set press.busbar "listener 2.address" 127.0.0.2
says 'expected another network'
as chief 0 project write "$url" press.busbar --yes
as chief 1 project update "$url" --yes
says 'cannot listen on 4840 of 192.0.2.77'
logged 'nothing was changed: server.port: cannot listen on 4840 of 192.0.2.77' || fail "not logged"
as chief 0 project status "$url"
says 'project *written, an update or restart is due'
as chief 1 project restart "$url" --yes
logged 'a restart is refused: server.port: cannot listen on 4840' || fail "a restart was not refused"
run 0 project set press.busbar "listener 2.address" 127.0.1.2 "listener 2.port" "$tool_port"
as chief 0 project write "$url" press.busbar --yes
as chief 0 project update "$url" --yes
await logged '^starting again'
new_url() { url=$(sed -n '/^starting again/,$s/.* variables at \(opc.tcp:[^ ]*\)$/\1/p' log); [ -n "$url" ]; }
await new_url
at_data() { "$busbar" --user operator --password-file password --trust read "$url" "$speed" > out 2>&1; }
await at_data
as chief 1 project status "$url"
as chief 0 --ignore host-name project status "$tool"
says 'project *in use'
as operator 1 --ignore host-name read "$tool" "$speed"
says 'Bad_NodeIdUnknown' # he sees nothing there
as chief 0 --ignore host-name project stop "$tool" --yes --seconds 0
stopped() {
    "$busbar" --user chief --password-file password --trust --ignore host-name admin status "$tool" \
        > out 2>&1 && grep -q '^Server operating status: *Shutdown$' out
}
await stopped
kill "$pid"
await ended
exit $((failures > 0))
