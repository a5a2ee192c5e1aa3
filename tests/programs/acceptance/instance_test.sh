#!/bin/sh
# A companion specification alone is mapped: it has types only, of which the project gets instances.
# usage: instance_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
. "$here/cell.sh"

nodesets=$(dirname "$controller")/../tests/interop/node_modules/node-opcua-nodesets/nodesets
own=urn:busbar:instances
project() {
    code=$1
    shift
    run "$code" project "$@"
}
at() { echo "nsu=$own;s=$1"; }

# Without files of the OPC Foundation: a type of the cell, beside the cell's own nodes.
cell=http://cell.example/Cell
cell_project cell.busbar
project 1 instance cell.busbar /Objects CellType Second
says 'has nodes that are mapped'
says 'expected the instance in the same namespace'
project 0 instance cell.busbar /Objects CellType Second --namespace $cell
says "nsu=$cell;s=Second: [0-9]* nodes added"
project 0 instance cell.busbar /Objects CellType Second --namespace $cell
says 'has all of it'
project 1 instance cell.busbar /Objects NoSuchType
says 'NoSuchType: there is no such type in the models'
project 1 instance cell.busbar /Nowhere CellType
says 'there is no such node'
project 1 instance cell.busbar /Objects CellType Other --namespace http://opcfoundation.org/UA/
says "expected one of the project's own"
project 0 check cell.busbar
project 0 show cell.busbar "nsu=$cell;s=Second"

# A member of an abstract type, whose instances choose one.
{
    cat << 'END'
<UANodeSet xmlns="http://opcfoundation.org/UA/2011/03/UANodeSet.xsd">
  <NamespaceUris><Uri>urn:axes</Uri></NamespaceUris>
  <Models><Model ModelUri="urn:axes" Version="1"/></Models>
END
    # axis_type NAME SUPERTYPE ATTRIBUTES
    axis_type() {
        echo "<UAObjectType NodeId=\"ns=1;s=$1\" BrowseName=\"1:$1\" $3><References>
            <Reference ReferenceType=\"i=45\" IsForward=\"false\">$2</Reference></References></UAObjectType>"
    }
    axis_type AxisType i=58 ''
    axis_type ToolType i=58 'IsAbstract="true"'
    axis_type DrillType 'ns=1;s=ToolType' ''
    axis_type MillType 'ns=1;s=ToolType' ''
    cat << 'END'
<UAObject NodeId="ns=1;s=AxisType.Tool" BrowseName="1:Tool"><References>
  <Reference ReferenceType="i=40">ns=1;s=ToolType</Reference>
  <Reference ReferenceType="i=37">i=78</Reference>
  <Reference ReferenceType="i=47" IsForward="false">ns=1;s=AxisType</Reference></References></UAObject>
<UAVariable NodeId="ns=1;s=DrillType.Speed" BrowseName="1:Speed" DataType="i=11" AccessLevel="3"><References>
  <Reference ReferenceType="i=40">i=63</Reference>
  <Reference ReferenceType="i=37">i=78</Reference>
  <Reference ReferenceType="i=47" IsForward="false">ns=1;s=DrillType</Reference></References></UAVariable>
</UANodeSet>
END
} > axes.xml
project 0 new axes.busbar
project 0 import axes.busbar axes.xml
project 1 instance axes.busbar /Objects AxisType Axis
says 'has the member Tool of the abstract type 1:ToolType; choose one'
says '(--type Tool=TYPE): DrillType, MillType$'
project 2 instance axes.busbar /Objects AxisType Axis --type Tool
project 1 instance axes.busbar /Objects AxisType Axis --type Tool=ToolType
says 'subtype of 1:ToolType that is not abstract: DrillType, MillType$'
project 1 instance axes.busbar /Objects AxisType Axis --type Tol=DrillType
project 0 instance axes.busbar /Objects AxisType Axis --type Tool=DrillType
says 's=Axis: 3 nodes added'
project 0 csv axes.busbar --all
says "^nsu=$own;s=Axis/Tool/Speed,.*,Double"

if [ ! -d "$nodesets" ]; then
    echo "without node-opcua-nodesets: PackML and Machinery are left out"
    finish
fi
project 0 new line.busbar
project 0 set line.busbar "listener 1.address" 127.0.0.1 "listener 1.port" $port \
    security.policies "" security.mode None security.allow_anonymous yes \
    security.trust_all_clients yes
for name in Di IA PackML Machinery; do
    project 0 import line.busbar "$nodesets/Opc.Ua.$name.NodeSet2.xml"
    says_not 'M107' # what they require is there, or later
done
project 0 namespaces line.busbar
says 'UA/DI/ (of 1\.[0-9.]*, published 20[0-9T:Z-]*, and here is a later version)'
project 0 csv line.busbar --all
says_not 'PackML'
project 0 instance line.busbar /Objects PackMLBaseObjectType Packer
says 's=Packer: [0-9]* nodes added'
project 1 instance line.busbar /Objects MachineIdentificationType Machine --optional Serial
says 'no Optional member of a path that was asked for'
project 0 instance line.busbar /Objects MachineIdentificationType Machine
project 0 instance line.busbar /Objects MachineIdentificationType Machine --optional YearOfConstruction
says 's=Machine: 1 nodes added'
project 1 instance line.busbar /Objects IMachineryItemVendorNameplateType Plate
says 'which is abstract, expected'
project 0 csv line.busbar --all
says "^nsu=$own;s=Packer/Status/CurMachSpeed,.*,Float"
says "^nsu=$own;s=Packer/SetMachSpeed,.*,Handle,"
says "^nsu=$own;s=Packer/SetMachSpeed,.*,Input.0.,.*,Float"
says "^nsu=$own;s=Machine/YearOfConstruction,.*,UInt16"

# What is mapped of it is served, and NodeIds and mapping stay when more is added.
cat > packer.st << 'END'
{attribute 'publish' := 'publish only'}
VAR_GLOBAL
    Speed : REAL := 12.5; Wanted : REAL; Set : WORD; Serial : STRING[20] := '4711'; Year : UINT := 2026;
END_VAR
END
project 0 map line.busbar "$(at Packer/Status/CurMachSpeed)" Speed
project 0 map line.busbar "$(at Packer/SetMachSpeed)" Set Handle
project 0 map line.busbar "$(at Packer/SetMachSpeed)" Wanted 'Input[0]'
project 0 map line.busbar "$(at Machine/SerialNumber)" Serial
project 0 map line.busbar "$(at Machine/YearOfConstruction)" Year
project 0 check line.busbar --program packer.st
project 0 instance line.busbar /Objects MachineryItemState_StateMachineType State
project 0 csv line.busbar
says "s=Packer/Status/CurMachSpeed,.*,Speed,"
cell_controller '' '' | sed 's/line.st/packer.st/; /^\[\[plc/,$d' > module.toml
cat >> module.toml << 'END'
[[plc.program]]
kind = "acknowledge"
target = "Set"
END
serve_cell line.busbar
get "$(at Packer/Status/CurMachSpeed)" '^12.5$'
get "$(at Machine/SerialNumber)" '4711'
get "$(at Machine/YearOfConstruction)" '^2026$'
run 0 --trust call "$url" "$(at Packer)" "$(at Packer/SetMachSpeed)" 80.5
run 0 --trust browse "$url" "$(at Packer/Status)"
says 'CurMachSpeed'
kill "$pid"
await ended
finish
