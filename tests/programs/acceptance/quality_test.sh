#!/bin/sh
# What a mapping has beside the manual: numbers that are scaled, labels that say how good a value is, and
# Methods that answer OutputArguments when the program is done.
# usage: quality_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
. "$here/cell.sh"

cat > tank.xml << 'END'
<UANodeSet xmlns="http://opcfoundation.org/UA/2011/03/UANodeSet.xsd">
  <NamespaceUris><Uri>urn:tank</Uri></NamespaceUris>
  <Models><Model ModelUri="urn:tank"/></Models>
  <UAVariable NodeId="ns=1;s=Level" BrowseName="1:Level" DataType="i=11" AccessLevel="3"><References>
    <Reference ReferenceType="i=40">i=2368</Reference>
    <Reference ReferenceType="i=47" IsForward="false">i=85</Reference></References></UAVariable>
  <UAVariable NodeId="ns=1;s=Range" BrowseName="EURange" DataType="i=884"><References>
    <Reference ReferenceType="i=40">i=68</Reference>
    <Reference ReferenceType="i=46" IsForward="false">ns=1;s=Level</Reference></References>
    <Value><ExtensionObject xmlns="http://opcfoundation.org/UA/2008/02/Types.xsd"><TypeId>
    <Identifier>i=885</Identifier></TypeId><Body><Range><Low>0</Low><High>200</High></Range></Body>
    </ExtensionObject></Value></UAVariable>
  <UAVariable NodeId="ns=1;s=Flow" BrowseName="1:Flow" DataType="i=10" AccessLevel="3"><References>
    <Reference ReferenceType="i=40">i=63</Reference>
    <Reference ReferenceType="i=47" IsForward="false">i=85</Reference></References></UAVariable>
  <UAVariable NodeId="ns=1;s=Name" BrowseName="1:Name" DataType="i=12" AccessLevel="3"><References>
    <Reference ReferenceType="i=40">i=63</Reference>
    <Reference ReferenceType="i=47" IsForward="false">i=85</Reference></References></UAVariable>
  <UAVariable NodeId="ns=1;s=Raw" BrowseName="1:Raw" DataType="i=4" AccessLevel="3"><References>
    <Reference ReferenceType="i=40">i=63</Reference>
    <Reference ReferenceType="i=47" IsForward="false">i=85</Reference></References></UAVariable>
  <UAVariable NodeId="ns=1;s=Good" BrowseName="1:Good" DataType="i=7" AccessLevel="3"><References>
    <Reference ReferenceType="i=40">i=63</Reference>
    <Reference ReferenceType="i=47" IsForward="false">i=85</Reference></References></UAVariable>
  <UAMethod NodeId="ns=1;s=Weigh" BrowseName="1:Weigh"><References>
    <Reference ReferenceType="i=47" IsForward="false">i=85</Reference></References></UAMethod>
  <UAVariable NodeId="ns=1;s=In" BrowseName="InputArguments" DataType="i=296" ValueRank="1"
      ArrayDimensions="1"><References><Reference ReferenceType="i=40">i=68</Reference>
    <Reference ReferenceType="i=46" IsForward="false">ns=1;s=Weigh</Reference></References>
    <Value><ListOfExtensionObject xmlns="http://opcfoundation.org/UA/2008/02/Types.xsd">
    <ExtensionObject><TypeId><Identifier>i=297</Identifier></TypeId><Body><Argument><Name>Scale</Name>
    <DataType><Identifier>i=4</Identifier></DataType><ValueRank>-1</ValueRank><ArrayDimensions/>
    </Argument></Body></ExtensionObject></ListOfExtensionObject></Value></UAVariable>
  <UAVariable NodeId="ns=1;s=Out" BrowseName="OutputArguments" DataType="i=296" ValueRank="1"
      ArrayDimensions="1"><References><Reference ReferenceType="i=40">i=68</Reference>
    <Reference ReferenceType="i=46" IsForward="false">ns=1;s=Weigh</Reference></References>
    <Value><ListOfExtensionObject xmlns="http://opcfoundation.org/UA/2008/02/Types.xsd">
    <ExtensionObject><TypeId><Identifier>i=297</Identifier></TypeId><Body><Argument><Name>Weight</Name>
    <DataType><Identifier>i=6</Identifier></DataType><ValueRank>-1</ValueRank><ArrayDimensions/>
    </Argument></Body></ExtensionObject></ListOfExtensionObject></Value></UAVariable>
</UANodeSet>
END
cat > line.st << 'END'
{attribute 'publish' := 'publish only'}
VAR_GLOBAL
    Level : INT := 13824; LevelState : UDINT; Flow : UINT; FlowBad : BOOL; Name : STRING[8];
    Scale : INT; Weight : INT; Start : WORD; Ready : INT;
END_VAR
END
node() { echo "nsu=urn:tank;s=$1"; }
project() {
    code=$1
    shift
    run "$code" project "$@"
}

run 0 cert create
project 0 new tank.busbar
project 0 set tank.busbar "listener 1.address" 127.0.0.1 "listener 1.port" $port \
    security.policies "" security.mode None security.allow_anonymous yes \
    security.trust_all_clients yes
project 0 import tank.busbar tank.xml
# A table, what is wrong with it, and the same back.
cat > wrong.csv << 'END'
NodeId,Part,Label
nsu=urn:tank;s=Level,,Level
nsu=urn:tank;s=Level,Scaling,0 to 27648
END
project 1 csv tank.busbar --in wrong.csv
says 'M508 line 3: .*found 0 to 27648'
says '0..27648=0..100'
cat > tank.csv << 'END'
NodeId,Part,Label
nsu=urn:tank;s=Level,,Level
nsu=urn:tank;s=Level,Quality,LevelState
nsu=urn:tank;s=Level,Scaling,0..27648
nsu=urn:tank;s=Flow,,Flow
nsu=urn:tank;s=Flow,Scaling,4000..20000=0..80
nsu=urn:tank;s=Raw,,Level
nsu=urn:tank;s=Good,,LevelState
nsu=urn:tank;s=Weigh,Handle,Start
nsu=urn:tank;s=Weigh,Done,Ready
nsu=urn:tank;s=Weigh,Input[0],Scale
nsu=urn:tank;s=Weigh,Output[0],Weight
END
project 0 csv tank.busbar --in tank.csv
says '9 labels'
project 0 csv tank.busbar
says '^nsu=urn:tank;s=Level,.*,Scaling,0..27648,'
says '^nsu=urn:tank;s=Level,.*,Quality,LevelState,'
says '^nsu=urn:tank;s=Weigh,.*,Done,Ready,'
says '^nsu=urn:tank;s=Weigh,.*,Output.0.,Weight,'
cp out all.csv
cp tank.busbar before
project 0 csv tank.busbar --in all.csv --replace
cmp -s tank.busbar before || fail "the table is not all of the mapping"
# The parts of a Method count together, so that one command maps them.
project 0 map tank.busbar "$(node Weigh)" ''
project 1 map tank.busbar "$(node Weigh)" Start Handle
says 'M319 '
project 2 map tank.busbar "$(node Weigh)" Start Handle Ready
says 'a label without its part'
project 0 map tank.busbar "$(node Weigh)" Start Handle Ready Done Scale 'Input[0]' Weight 'Output[0]'
says 'has 4 labels'
cmp -s tank.busbar before || fail "one command maps a Method otherwise than a table"
# What cannot be is refused, with node, found and expected.
project 0 map tank.busbar "$(node Name)" Name
project 1 map tank.busbar "$(node Name)" 0..1=0..2 Scaling
says 'M323 .*Name: Scaling: .*found the DataType String, expected a number'
project 1 map tank.busbar "$(node Raw)" 0..1 Scaling
says 'M323 .*no EURange, expected .* 0..1=0..100'
project 0 map tank.busbar "$(node Name)" ''
project 1 map tank.busbar "$(node Name)" LevelState Quality
says 'M324'
project 0 map tank.busbar "$(node Flow)" Name Quality
project 1 check tank.busbar --program line.st
says 'M321 .*Flow: Quality: .*Name: found STRING(8), expected BOOL; UINT, WORD'
project 0 map tank.busbar "$(node Flow)" FlowBad Quality
project 0 check tank.busbar --program line.st
# Exported and imported it is the same.
project 0 export tank.busbar urn:tank again.xml
project 0 new again.busbar
project 0 import again.busbar again.xml
project 0 csv again.busbar
cp out again.csv
project 0 csv tank.busbar
cmp -s out again.csv || fail "the exported model has another mapping"
cp tank.busbar other.busbar
project 0 map other.busbar "$(node Level)" 0..10000 Scaling
project 1 compare tank.busbar other.busbar
says 'Scaling  *0..27648  *0..10000$'

# module LINES: its configuration, with more lines for the program that takes the Handle.
module() {
    cat << END
[server]
address = "127.0.0.1"
port = $port
[certificates]
folder = "pki"
trust_all_clients = true
[[endpoint]]
policy = "None"
mode = "None"
[users]
anonymous = "write"
[labels]
program = "line.st"
[plc]
scan_ms = 20
[[plc.program]]
kind = "copy"
source = "Scale"
target = "Weight"
[[plc.program]]
kind = "acknowledge"
target = "Start"
$1
END
}
module 'sets = "Ready"
to = 1' > module.toml
serve_cell tank.busbar
# Scaled by the EURange, and by the range of the mapping.
get "$(node Level)" '^100$'
put "$(node Level)" 50
get "$(node Raw)" '^6912$'
put "$(node Flow)" 40
get "$(node Flow)" '^40$'
put_refused Bad_OutOfRange "$(node Level)" 1000000
# The quality is the status: a StatusCode of 32 bits.
put "$(node Good)" 1083179008 # Uncertain_LastUsableValue
run 0 --json --trust read "$url" "$(node Level)"
says 'Uncertain_LastUsableValue'
put "$(node Good)" 2156593152 # Bad_OutOfService
run 1 --trust read "$url" "$(node Level)"
says 'Bad_'
run 0 --trust read --value "$url" "$(node Raw)"
put "$(node Good)" 0
get "$(node Level)" '^50$'
# The output is what the program has made of the input.
run 0 --trust call "$url" /Objects "$(node Weigh)" 12
says 12
run 0 --trust call "$url" /Objects "$(node Weigh)" -7
says -7
kill "$pid"
await ended
# A program that is never done.
module '' > module.toml
serve_cell tank.busbar
run 3 --trust call "$url" /Objects "$(node Weigh)" 12
says 'Bad_Timeout'
kill "$pid"
await ended
# One that takes longer than a Call waits by default: the second Call waits for six seconds.
module 'sets = "Ready"
to = 1
period_ms = 6000' | sed 's/^program = "line.st"/&\ncall_limit_ms = 20000/' > module.toml
serve_cell tank.busbar
for scale in 12 13; do
    run 0 --trust call "$url" /Objects "$(node Weigh)" $scale
    says $scale
done
kill "$pid"
await ended
finish
