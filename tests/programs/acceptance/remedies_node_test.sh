#!/bin/sh
# What the troubleshooting says is done where a node of a model is missing or wrong, or a project
# does not become what is served: the trouble is there, the remedy exists, and it helps (SH-082679,
# 10.3; TROUBLESHOOTING.md).
# usage: remedies_node_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
takes_long
. "$here/cell.sh"
. "$here/remedies.sh"

project() {
    wanted_of_project=$1
    shift
    run "$wanted_of_project" project "$@"
}
press() { echo "nsu=http://press.example/Press;i=$1"; }
# press_file LINES: the press, which needs the model of the cell in version $needs of $needs_day.
press_file() {
    required="<RequiredModel ModelUri=\"http://cell.example/Cell\" Version=\"$needs\""
    required="$required PublicationDate=\"$needs_day\"/>"
    press_model "$1" | sed "s#00Z\"/></Models>#00Z\">$required</Model></Models>#"
}
load='  <UAVariable NodeId="ns=1;i=6" BrowseName="1:Load" DataType="i=4" AccessLevel="3">
    <DisplayName>Load</DisplayName>
    <References>
      <Reference ReferenceType="i=40">i=63</Reference>
      <Reference ReferenceType="i=47" IsForward="false">i=85</Reference>
    </References>
  </UAVariable>'
needs=1.0 needs_day=2024-05-06T00:00:00Z
press_file '' > press.xml
grep -q RequiredModel press.xml || fail "the press needs nothing"
cell_program > line.st
entry model 10.3: remedies

# Without a server.
remedy 10.3.1
told 'the project cannot be imported, M106'
project 0 new line.busbar
project 1 import line.busbar press.xml
says 'M106.*http://cell.example/Cell'
project 0 namespaces line.busbar
says_not cell.example
project 0 import line.busbar "$here/cell.xml"
project 0 namespaces line.busbar
says cell.example
project 0 import line.busbar press.xml

told 'warning M107'
needs=1.1 needs_day=2025-06-07T00:00:00Z
press_file '' > press.xml
project 0 import line.busbar press.xml
says 'M107'
sed -e 's#\(ModelUri="http://cell.example/Cell" Version="\)1.0#\11.1#' \
    -e "s#\(PublicationDate=\"\)2024-05-06T00:00:00Z#\1$needs_day#" "$here/cell.xml" > cell11.xml
project 0 import line.busbar cell11.xml
project 0 import line.busbar press.xml
says_not 'M107'

remedy 10.3.2
told 'the node is in no `busbar project tree`'
project 0 map line.busbar 'nsu=http://press.example/Press;i=5' Line.W
project 0 tree line.busbar
says_not Load
press_file "$load" > press.xml
project 0 import line.busbar press.xml
project 0 tree line.busbar
says Load
project 0 csv line.busbar
says 'Speed,,Line.W'

remedy 10.3.3
told 'an Attribute or a Reference is not as it should be'
project 0 show line.busbar 'nsu=http://press.example/Press;i=6'
says '^DisplayName  *Load$'
says '^AccessLevel .*3'
press_file "$load" | sed 's#<DisplayName>Load#<DisplayName>Pressing force#' > press.xml
project 0 import line.busbar press.xml
project 0 show line.busbar 'nsu=http://press.example/Press;i=6'
says '^DisplayName  *Pressing force$'
remedy 10.3.4
says 'Organizes\|HasComponent  *Object  *0*:*Objects'
sed 's#\(<Reference ReferenceType="i=47" IsForward="false">\)i=85</Reference>#\1ns=2;i=1</Reference>#
    s#</NamespaceUris>#<Uri>http://cell.example/Cell</Uri></NamespaceUris>#' press.xml > below.xml
project 0 import line.busbar below.xml
project 0 show line.busbar 'nsu=http://press.example/Press;i=6'
says '1:Cell'
project 0 csv line.busbar
says 'Speed,,Line.W'

remedy 10.3.5
told 'M102 names the model'
head -n 10 press.xml > broken.xml
cp line.busbar before
project 1 import line.busbar broken.xml
says 'M102 broken.xml: '
cmp -s line.busbar before || fail "a model that is broken has changed the project"
project 0 import line.busbar press.xml

told 'M320 or M321'
project 0 map line.busbar 'nsu=http://press.example/Press;i=6' Line.Lode
project 1 check line.busbar --program line.st
says 'M320.*Line.Lode'
project 0 map line.busbar 'nsu=http://press.example/Press;i=6' Line.S
project 1 check line.busbar --program line.st
says 'M321.*Line.S'
project 0 show line.busbar 'nsu=http://press.example/Press;i=6'
says '^ *Int16 .* INT '
project 0 map line.busbar 'nsu=http://press.example/Press;i=6' Line.UW
project 0 check line.busbar --program line.st

# With a server.
{
    server "$port" pki
    printf '[labels]\nprogram = "line.st"\n'
} > module.toml
project 0 set line.busbar "listener 1.address" 127.0.0.1 "listener 1.port" $port
project 0 user line.busbar hmi --new-password-file password --permission client \
    --pbkdf2-iterations 10000
begin pki --config module.toml --project project
one_step # each step is looked at, and power is cut where that is the trouble
remedy 10.3.7 10.3.8 10.3.9
told 'the tree has it, the server does not'
chief 0 project status "$url"
says 'project *none'
chief 1 read "$url" "$(press 6)"
chief 0 project write "$url" line.busbar --yes
chief 1 read "$url" "$(press 6)"
chief 0 project status "$url"
says 'project *written, an update or restart is due'
chief 0 project update "$url" --yes
in_use() { reaches project status "$url" && grep -q 'project *in use' out; }
await in_use
as hmi 0 read --all "$url" "$(press 6)"
says 'Pressing force'
as hmi 0 browse "$url" /Objects
says 'Load'
as hmi 0 write "$url" "$(press 6)" 7
as hmi 0 read --value "$url" "$(press 6)"
says '^7$'

told '`project verify` lists differences'
cp line.busbar other.busbar
project 0 map other.busbar 'nsu=http://press.example/Press;i=6' Line.W
chief 1 project verify "$url" other.busbar
says 'Line.UW'
chief 0 project read "$url" other.busbar --yes
chief 0 project verify "$url" other.busbar
says 'no differences'

told 'the update changes nothing'
project 0 set other.busbar "listener 1.address" 192.0.2.77
chief 0 project write "$url" other.busbar --yes
chief 1 project update "$url" --yes
says '192.0.2.77'
logged 'cannot listen on.*192.0.2.77' || fail "the log does not say why"
as hmi 0 read "$url" "$(press 6)"
project 0 set other.busbar "listener 1.address" 127.0.0.1
chief 0 project write "$url" other.busbar --yes
chief 0 project update "$url" --yes
await in_use

told '`project status` says that it is damaged'
echo damaged > project/project/project.busbar
power_cycle
chief 0 project status "$url"
says 'project *damaged, the one that was served last is in use: project:1'
as hmi 0 read "$url" "$(press 6)"
chief 0 project read "$url" served.busbar --yes
chief 0 project write "$url" served.busbar --yes
power_cycle
in_use || fail "what was written again is not in use: $(cat out)"

shut_down
finish
