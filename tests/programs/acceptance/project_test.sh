#!/bin/sh
# A project of model mode over power cycles (SH-082679, 9.13 and 9.14): what was written is served
# from the next start on, a damaged one is told while the last one runs, and each user does what
# the permission says (9.7).
# usage: project_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"

in_use() {
    chief 0 project status "$url"
    says "project *in use"
}

press_model '  <UAVariable NodeId="ns=1;i=6" BrowseName="1:Unmapped" DataType="i=4" AccessLevel="3">
    <DisplayName>Unmapped</DisplayName>
    <References>
      <Reference ReferenceType="i=40">i=63</Reference>
      <Reference ReferenceType="i=47" IsForward="false">i=85</Reference>
    </References>
    <Value><Int16 xmlns="http://opcfoundation.org/UA/2008/02/Types.xsd">417</Int16></Value>
  </UAVariable>' > press.xml
cat > line.st << 'END'
TYPE LineType : STRUCT
    Speed : INT := 900;
    Handle : WORD;
    State : INT := 4;
END_STRUCT; END_TYPE
{attribute 'publish' := 'publish only'}
VAR_GLOBAL Line : LineType; END_VAR
END
{
    server "$port" pki | sed 's/^folder.*/&\ntrust_all_clients = true/'
    cat << 'END'
[labels]
program = "line.st"
[[plc.program]]
kind = "acknowledge"
target = "Line.Handle"
sets = "Line.State"
to = 6
END
} > module.toml
run 0 cert create
run 0 project new press.busbar
run 0 project set press.busbar "listener 1.address" 127.0.0.1 "listener 1.port" $port \
    security.trust_all_clients yes
run 0 project import press.busbar press.xml
run 0 project map press.busbar "ns=1;i=5" Line.Speed
run 0 project map press.busbar "ns=1;i=7" Line.Handle Handle
for permission in client tool "tool and client"; do
    user=$(echo "$permission" | sed 's/tool and client/both/')
    run 0 project user press.busbar "$user" --new-password-file password \
        --permission "$permission" --pbkdf2-iterations 10000
done
speed='nsu=http://press.example/Press;i=5'
unmapped='nsu=http://press.example/Press;i=6'
start_method='nsu=http://press.example/Press;i=7'

serve --config module.toml --project project
chief 0 project status "$url"
says 'project *none'
power_cycle
one_step
chief 0 project write "$url" press.busbar --yes
chief 0 project status "$url"
says 'project *written, an update or restart is due'
step_ends
power_cycle
in_use
chief 0 project verify "$url" press.busbar
says 'no differences'

# 9.7: who is let in for the tool only has no access to data, by whichever service.
denied() { says 'Bad_UserAccessDenied'; }
for node in "$speed" "$unmapped"; do
    as tool 4 read "$url" "$node"
    denied
    as tool 4 write "$url" "$node" 1
    denied
    as tool 0 subscribe "$url" "$node" --count 1
    denied
done
as tool 4 call "$url" /Objects "$start_method"
denied
as tool 0 browse "$url" /Objects
says 'Speed'
as tool 0 project status "$url"
as tool 0 project read "$url" read.busbar
cmp -s read.busbar press.busbar || fail "the tool's user has read another project"
as tool 0 project write "$url" press.busbar --yes
one_step # no variable is RETAIN
for user in client both; do
    as "$user" 0 write "$url" "$speed" 17 "$unmapped" 18
    as "$user" 0 read --value "$url" "$speed" "$unmapped"
    says '^17$'
done
step_ends
as client 0 call "$url" /Objects "$start_method"
as client 1 project status "$url"
as both 0 project status "$url"
power_cycle
in_use
as tool 4 read "$url" "$speed"
denied

# A project that is refused changes nothing, also over a power cycle.
sed 's/i=5/i=8/' press.busbar > damaged.busbar
chief 1 project write "$url" damaged.busbar --yes
power_cycle
in_use
chief 0 project verify "$url" press.busbar

# One that is damaged where it is kept: the last one runs, and the status tells.
echo damaged > project/project/project.busbar
power_cycle
chief 0 project status "$url"
says 'project *damaged, the one that was served last is in use: project:1'
as client 0 read "$url" "$speed"
chief 0 project read "$url" read.busbar --yes
cmp -s read.busbar press.busbar || fail "another project was read than runs"
power_cycle
chief 0 project status "$url"
says 'project *damaged'
one_step
chief 0 project write "$url" read.busbar --yes
chief 0 project status "$url"
says 'project *written'
step_ends
power_cycle
in_use
shut_down
finish
