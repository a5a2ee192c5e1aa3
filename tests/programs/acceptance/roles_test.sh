#!/bin/sh
# Which roles may do what with a node of a project: said by a command or a table, checked, compared, enforced
# by the server, and part of the project that is read back.
# usage: roles_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
. "$here/cell.sh"

cell_program > line.st
{
    server "$port" pki
    account ann '"Operator"'
    account bob '"Observer"'
    printf '[labels]\nprogram = "line.st"\n'
} > module.toml
run 0 project new line.busbar
run 0 project import line.busbar "$here/cell.xml"
cell_table > cell.csv
run 0 project csv line.busbar --in cell.csv
run 0 project set line.busbar "listener 1.address" 127.0.0.1 "listener 1.port" $port
cp line.busbar before.busbar

# Said node by node, and in a table; what is wrong is told.
run 0 project roles line.busbar ns=1\;i=104 Observer=read Operator=write
says 'is for Observer=read Operator=write'
run 0 project roles line.busbar ns=1\;i=104
says 'i=104 .* Observer=read Operator=write$'
run 2 project roles line.busbar ns=1\;i=104 Operater=read
says 'Operater: found no such role, expected one of Anonymous, '
run 2 project roles line.busbar ns=1\;i=104 Operator=wrote
says 'found wrote, expected browse, read, write, call or all'
run 1 project roles line.busbar i=2253 Operator=read
says 'namespace 0, which no model has'
cat > roles.csv << 'END'
NodeId,Part,Label
ns=1;i=105,Roles,Operator=read
ns=1;i=20,Roles,Operator=call Observer=browse
END
run 0 project csv line.busbar --in roles.csv
says '0 labels of the table, .* and the roles of 2 nodes'
printf 'NodeId,Part,Label\nns=1;i=105,Roles,Operator=go\n' > wrong.csv
run 1 project csv line.busbar --in wrong.csv
says 'M509 line 2: .*found go, expected browse'
run 0 project csv line.busbar
says 'i=104,.*,Roles,Observer=read Operator=write,'
says 'i=20,.*,Roles,Operator=call Observer=browse,'
run 0 project roles line.busbar
says 'i=105 .* Operator=read$'
run 0 project show line.busbar ns=1\;i=104
says '^RolePermissions *Observer=read Operator=write$'
run 0 project roles line.busbar ns=1\;i=20 Operator=write Observer=browse
says 'M326 .*i=20: .*write for a Method, expected call'
run 0 project check line.busbar
says 'M326'
run 0 project roles line.busbar ns=1\;i=20 Operator=call Observer=browse
run 1 project compare before.busbar line.busbar
says 'i=104: Roles *everybody *Observer=read Operator=write$'
# A file that is imported again does not open what was closed.
run 0 project import line.busbar "$here/cell.xml"
says 'M327 .*i=104: .*keeps them'
run 0 project roles line.busbar ns=1\;i=104
says 'Observer=read Operator=write$'

# The server does as it says, after a power cut, too.
begin pki --config module.toml --project project
one_step
chief 0 project write "$url" line.busbar --yes
chief 0 project update "$url" --yes
in_use() { reaches project status "$url" && grep -q 'project *in use' out; }
await in_use
step_ends
for round in first second; do
    one_step # what a label has is gone with the power
    as ann 0 write "$url" "$(cell 104)" 12
    as bob 0 read --value "$url" "$(cell 104)"
    says '^12$'
    step_ends
    as bob 4 write "$url" "$(cell 104)" 13
    says Bad_UserAccessDenied
    as ann 0 read --value "$url" "$(cell 105)"
    as ann 4 write "$url" "$(cell 105)" 13
    says Bad_UserAccessDenied
    as bob 1 read "$url" "$(cell 105)"
    says Bad_NodeIdUnknown
    as bob 0 browse "$url" "$(cell 1)"
    says 'i=104'
    grep -q 'i=105' out && fail "the Observer sees what is the Operator's"
    as bob 4 call "$url" "$(cell 1)" "$(cell 20)" 7 '[1, 2, 3]' '{"Name": "Cake", "Size": 1, "Mode": 0}'
    says Bad_UserAccessDenied
    power_cycle
done
as ann 0 call "$url" "$(cell 1)" "$(cell 20)" 7 '[1, 2, 3]' '{"Name": "Cake", "Size": 1, "Mode": 0}'
# What was read back is the same, and who takes the roles away gives the node to everybody.
chief 0 project read "$url" back.busbar
run 0 project compare line.busbar back.busbar
run 0 project roles back.busbar ns=1\;i=105 ""
says 'is for everybody'
one_step
chief 0 project write "$url" back.busbar --yes
chief 0 project update "$url" --yes
seen() { ends_with 0 --user bob --password-file password --trust read --value "$url" "$(cell 105)"; }
await seen
step_ends
finish
