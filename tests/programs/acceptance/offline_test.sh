#!/bin/sh
# A project of model mode without a server (SH-082679, 9.3 to 9.6, 8.2 and Appendix 8): models,
# everything that they say of a node, what can be mapped, mapping by hand and by spreadsheet, and
# what is refused with its reason.
# usage: offline_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"

press_model '' > press.xml
project() {
    wanted_of_project=$1
    shift
    run "$wanted_of_project" project "$@"
}
# shows NODE: all about one node.
shows() {
    project 0 show cell.busbar "$1"
}
# map NODE LABEL [PART]
map() {
    project 0 map cell.busbar "ns=1;i=$1" "$2" ${3:+"$3"}
}
# refused NODE PATTERN [PART]: no label can be mapped there, for this reason, and nothing changes.
refused() {
    cp cell.busbar before
    project 1 map cell.busbar "$1" Line.A ${3:+"$3"}
    says "$2"
    cmp -s cell.busbar before || fail "a refused mapping has changed the project: $1"
}
# can_have NODE TYPES: what a label of it is declared as, without a check and with one.
can_have() {
    shows "ns=1;i=$1"
    says "$2"
}

entry model 9.3: new, open, save, compatibility
project 0 new cell.busbar
head -n 1 cell.busbar | grep -q '^busbar project 1$' || fail "no project file was made"
project 1 new cell.busbar
says 'nothing was done'
project 1 new other.busbar --preset nj501
[ -e other.busbar ] && fail "a wrong project was written"
project 0 show cell.busbar
echo "no project" > other.busbar
project 1 show other.busbar
sed 's/^busbar project 1/busbar project 2/' cell.busbar > newer.busbar
project 1 show newer.busbar
says 'newer.busbar:1: found version 2, expected version 1'
sed 's/4840/4841/' cell.busbar > damaged.busbar
project 1 show damaged.busbar
says 'damaged.busbar:[0-9]*: '

entry model 9.4: import
project 0 import cell.busbar "$here/cell.xml"
says 'imported http://cell.example/Cell: 75 nodes'
cp cell.busbar before
sed 's/DataType="i=4"/DataType="ns=1;i=77"/' press.xml > wrong.xml
project 1 import cell.busbar wrong.xml
says 'wrong.xml'
head -n 10 press.xml > broken.xml
project 1 import cell.busbar broken.xml
says 'broken.xml'
sed 's/i=7" BrowseName/i=5" BrowseName/' press.xml > double.xml
project 1 import cell.busbar double.xml
sed 's#</Models>#<RequiredModel ModelUri="urn:none"/></Model></Models>#; s#00Z"/></Models>#00Z"></Models>#' \
    press.xml | sed 's#00Z"/><RequiredModel#00Z"><RequiredModel#' > requires.xml
project 1 import cell.busbar requires.xml
says 'M106.*urn:none'
sed 's#<Uri>#<Uri>urn:other</Uri><Uri>#; s#NodeId="ns=1;i=5"#NodeId="ns=2;i=5"#' press.xml > several.xml
project 1 import cell.busbar several.xml
cmp -s cell.busbar before || fail "a refused import has changed the project"

entry model 9.6: namespaces
project 0 import cell.busbar press.xml
project 0 namespaces cell.busbar
says '^ *0 *http://opcfoundation.org/UA/ '
says '^ *1 *http://cell.example/Cell *1.0 *2024-05-06'
says '^ *2 *http://press.example/Press *1.2 *2024-05-06'
project 1 delete cell.busbar http://opcfoundation.org/UA/
project 1 delete cell.busbar http://cell.example/Cell
says 'only the last one'
project 0 delete cell.busbar http://press.example/Press
project 0 namespaces cell.busbar
says_not 'press.example'

entry model 9.4: tree, attributes, fields, values, references
project 0 tree cell.busbar --all
says '^ *1:Cell  *Cell 4  *Object  *ns=1;i=1  *CellType  *The cell at the end of the line$'
says '^ *1:aInt16  *aInt16  *Variable  *Int16  *ns=1;i=104  *rw  *BaseDataVariableType  *-1 (Scalar)  *A number$'
says '^ *1:Table  *Table  *Variable  *Int16\[2\]\[3\]  *ns=1;i=141 .* 2  *2,3$'
says '^ *\[1\]\[2\]  *Int16$'
says '^ *1:AnyRank  .*Int16\[-\] .*-2 (Any)'
says '^ *1:ReadOnly .* r-  '
says '^ *\.Recipe\.Name  *String$'
says '^ *\.Steps\[1\]\.Mode  *Enumeration$'
says '^ *Handle  *UInt16$'
says '^ *Input\[1\] Amounts  *Int32\[3\]  *1  *3  *Amounts of it$'
says '^ *Input\[2\]\.Size  *Int16$'
says '^ *Output\[0\] Result  *Double '
shows "ns=1;i=104"
for attribute in 'NodeId  *ns=1;i=104' 'NodeClass  *Variable' 'BrowseName  *1:aInt16' \
    'DisplayName  *aInt16' 'Description  *A number' 'WriteMask  *0' 'UserWriteMask  *0' \
    'RolePermissions' 'DataType  *Int16' 'ValueRank  *-1 (Scalar)' 'ArrayDimensions' \
    'AccessLevel  *CurrentRead | CurrentWrite (3)' \
    'UserAccessLevel  *CurrentRead | CurrentWrite (3)' 'MinimumSamplingInterval  *0' 'Historizing  *false' \
    'Value  *417'; do
    says "^$attribute\$"
done
says '^<- HasComponent  *Object  *1:Cell  *1:CellType  *ns=1;i=1$'
says '^HasTypeDefinition  *VariableType  *BaseDataVariableType '
shows /Objects/1:Cell
says '^EventNotifier  *0$'
shows "ns=1;i=20"
says '^Executable  *true$'
says '^UserExecutable  *true$'
says '^Input\[2\]  *Recipe  *RecipeType  *-1 (Scalar)  *Recipe of it$'
shows "ns=1;i=1001"
says '^IsAbstract  *false$'
says '^HasComponent  *Method  *1:Start  *Mandatory  *ns=1;i=1002$'
shows i=62 # BaseVariableType
says '^ValueRank  *-2 (Any)$'
says '^IsAbstract  *true$'
shows i=46
says '^Symmetric  *false$'
says '^InverseName  *PropertyOf$'
shows "ns=1;i=3010"
says '^Name  *String  *-1 (Scalar)  *40  *false  *What it is called$'
says '^Mode  *ModeType  *-1 (Scalar)  *0  *false$'
shows "ns=1;i=3012"
says '^B  *Int16  *-1 (Scalar)  *0  *true$'
shows "ns=1;i=3001"
says '^Manual  *1$'
says '^Auto  *5$'
shows i=307 # ApplicationType
says '^DiscoveryServer  *3$'
run 0 --json project show cell.busbar "ns=1;i=140"
says '"Value":\[1,2,3\]'
project 1 show cell.busbar /Objects/1:Press
says 'there is no such node'

entry model App. 5: standard structures
for each in 296:DataType:NodeId 338:BuildDate:UtcTime 887:UnitId:Int32 884:High:Double; do
    shows "i=${each%%:*}"
    field=${each#*:}
    says "^${field%:*}  *${field#*:} "
done

entry model 9.5: targets and arrays
refused i=2258 'M302'
refused "ns=1;i=1001" 'M209\|M504\|no Variable'
last="project map"; says_not 'line 2' # of a table of the command's own
refused "ns=1;i=21" 'M307' '[0]'
refused "ns=1;i=30" 'M319' Handle
refused /Objects/1:Cell/1:Nothing2 'not mapped'
refused "ns=1;i=140" 'M313\|M309' # an array as a whole
refused "ns=1;i=140" 'M309' '[3]'
refused "ns=1;i=160" 'M313' # a structure
refused "ns=1;i=160" 'M309' .Weight
for array in 145 146 147; do
    project 0 array cell.busbar "ns=1;i=$array" 1 3 --first 'Line.Force[0]'
    project 0 map cell.busbar "ns=1;i=$array" 'Line.Force[2]' '[2]'
    refused "ns=1;i=$array" 'M309' '[3]'
done
project 0 array cell.busbar "ns=1;i=144" 2 2 3 --first 'Line.Table[0,0]'
project 0 map cell.busbar "ns=1;i=144" 'Line.Table[1,2]' '[1][2]'
refused "ns=1;i=144" 'M309' '[1][3]'
project 1 array cell.busbar "ns=1;i=147" 2 2 2 --first A # ScalarOrOneDimension
project 0 csv cell.busbar
says ',/Objects/1:Cell/1:AnyRank,,,1,3,,'
says ',/Objects/1:Cell/1:AnyRank,\[2\],Line.Force\[2\],,,,'

entry model 8.2: arrays
for array in 148 149; do
    refused "ns=1;i=$array" 'M308' '[0]'
done
project 0 new limited.busbar --preset rd81opc96
project 0 import limited.busbar "$here/cell.xml"
project 1 map limited.busbar "ns=1;i=150" Line.A '[0]'
says M410
map 140 'Line.Row[2]' '[2]'
map 141 'Line.Table[1,2]' '[1][2]'
map 142 'Line.Cube[1,1,1]' '[1][1][1]'
map 143 'Line.Open' '[0]'

entry model 8.2: structures
map 160 Line.Recipe.Name .Name
map 161 'Line.Recipes[1].Size' '[1].Size'
map 162 'Line.Order.Steps[1].Mode' '.Steps[1].Mode'
map 162 'Line.Order.Amounts[2]' '.Amounts[2]'
refused "ns=1;i=163" 'has optional fields' .A
refused "ns=1;i=164" 'is a Union' .A
refused "ns=1;i=165" "a field's ValueRank" .B

entry model 8.2: enumerations, methods, arguments
map 130 Line.Mode
refused "ns=1;i=131" 'has a value of -1'
map 20 Line.Handle Handle
map 20 Line.Speed 'Input[0]'
map 20 'Line.Amounts[1]' 'Input[1][1]'
map 20 Line.Name 'Input[2].Name'
refused "ns=1;i=20" 'M316\|M317\|no such InputArgument' 'Input[3]'
refused "ns=1;i=50" 'is a Union' 'Input[0].A'
can_have 20 '^Handle  *UInt16  *Line.Handle  *UINT, WORD$'

entry model 8.2: assignment table
can_have 101 '^ *Boolean  *BOOL; any timer or counter .S; any timer or counter .C$'
can_have 103 '^ *Byte  *UINT, WORD; UDINT, DWORD; INT; DINT; TIMER'
can_have 104 '^ *Int16  *INT  *UINT, WORD; UDINT, DWORD; DINT; TIMER'
can_have 105 '^ *UInt16  *UINT, WORD; .*TIMER, RETENTIVETIMER .N; .*COUNTER .N  *UDINT, DWORD; INT; DINT; LTIMER'
can_have 106 '^ *Int32  *DINT; TIME  *UINT, WORD; UDINT, DWORD; INT; '
can_have 107 '^ *UInt32  *UDINT, DWORD; LTIMER'
can_have 110 '^ *Float  *REAL  *LREAL$'
can_have 111 '^ *Double  *LREAL  *REAL$'
can_have 112 '^ *String  *STRING(n); WSTRING(n), ARRAY'
can_have 113 '^ *DateTime  *UDINT, DWORD; DINT; LTIMER'
can_have 121 '^ *LocalizedText  *STRING(n); WSTRING(n), ARRAY'
can_have 130 '^ *Enumeration  *Line.Mode  *DINT  *UINT, WORD; UDINT, DWORD; INT$'
for node in 114 115 116 117 118 119 120 122 123 124 125; do
    refused "ns=1;i=$node" 'M308'
    shows "ns=1;i=$node"
    says '^cannot be mapped: '
done

entry model 8.2: other data types
can_have 132 '^ *Double  *LREAL  *REAL$'
can_have 133 '^ *Double  *LREAL  *REAL$'
refused "ns=1;i=134" 'is abstract'

entry model 8.3: label specification
one_more() { map 104 "$1"; }
one_more LabelName
one_more St.Member
one_more 'St.Inner.Member'
one_more 'Array[0]'
one_more 'St.Array[0,1,2]'
one_more 'Array[1][2][3]'
one_more Timers.N
one_more 'Timers[0,0,0].C'
for label in Line.1 'Line[0].1' K4Line 'K4Line[0]' 'Line[0,0,0,0]'; do
    project 1 map cell.busbar "ns=1;i=104" "$label"
    says 'M314\|not mapped'
done

entry model 9.5: spreadsheets
project 0 map cell.busbar "ns=1;i=104" Line.Speed
project 0 csv cell.busbar --all
says '^NodeId,Path,Part,Label,Rank,Dim1,Dim2,Dim3,Type'
says '/Objects/1:Cell/1:aInt16,,Line.Speed,,,,,Int16'
says '/Objects/1:Cell/1:Order,\.Recipe\.Size,,,,,,Int16'
sed 's#\(/1:aUInt16,,\),#\1Line.Count,#; s#\(/1:aDouble,,\),#\1Line.Force,#' out > table.csv
project 0 csv cell.busbar --unmapped
says '/1:aUInt16,,,'
project 0 csv cell.busbar --in table.csv
project 0 csv cell.busbar --unmapped
says '^NodeId,Path,Part,Label,Rank,Dim1,Dim2,Dim3,Type.$'
says '/1:aSByte,,,'
says_not '/1:aUInt16,,'
project 0 csv cell.busbar
says '/1:aUInt16,,Line.Count,'
says '/1:aDouble,,Line.Force,'
# One part of a node loses its label, the others keep theirs.
cp cell.busbar parts.busbar
project 0 map parts.busbar "ns=1;i=140" 'Line.Row[0]' '[0]' 'Line.Row[1]' '[1]' 'Line.Row[2]' '[2]'
project 0 map parts.busbar "ns=1;i=140" "" '[1]'
says 'has 1 labels less and 0 more'
project 0 csv parts.busbar
says 'Line.Row\[0\]'
says 'Line.Row\[2\]'
says_not 'Line.Row\[1\]'
project 1 map parts.busbar "ns=1;i=140" "" '[1]'
says 'nothing is mapped there'
project 0 map parts.busbar "ns=1;i=140" ""
project 0 csv parts.busbar
says_not 'Line.Row'
# A part of the table adds; only a question takes labels away.
cp cell.busbar before
printf 'Path;Part;Label\r\n/Objects/1:Cell/1:aSByte;;Line.Small\r\n' > part.csv
project 0 csv cell.busbar --in part.csv
says '1 labels of the table'
project 0 csv cell.busbar
says '/1:aUInt16,,Line.Count,'
says '/1:aSByte,,Line.Small,'
cp cell.busbar before
project 1 csv cell.busbar --in part.csv --replace
says 'labels of the project: nothing was changed'
printf 'NodeId,Part,Label\nns=1;i=99,,x\n' > wrong.csv
project 1 csv cell.busbar --in wrong.csv
says 'line 2'
cmp -s cell.busbar before || fail "labels went without a question"
project 0 csv cell.busbar --in part.csv --replace --yes
says '1 labels of the table, 1 in all'
cp before cell.busbar
project 0 compare cell.busbar before
says 'no differences'
project 0 map cell.busbar "ns=1;i=105" Line.Count2
project 1 compare cell.busbar before
says 'http://cell.example/Cell: ns=1;i=105  *Line.Count2  *Line.Count$'
# What the PLC's program does not have is told before it counts.
cat > line.st << 'END'
TYPE LineType : STRUCT
    Speed : INT; Count : UINT; Force : LREAL; Small : LREAL;
END_STRUCT; END_TYPE
{attribute 'publish' := 'publish only'}
VAR_GLOBAL Line : LineType; END_VAR
END
project 1 check cell.busbar --program line.st
says 'M320 ns=1;i=105: .*Line.Count2: the PLC has no label of this name, expected UINT'
says 'M321 ns=1;i=102: .*Line.Small: found LREAL, expected UINT, WORD'
says_not 'ns=1;i=104'
project 1 check cell.busbar --program part.csv

entry model 9.4: merge and names of exports
cp before cell.busbar
project 0 export cell.busbar http://cell.example/Cell
says 'Cell.xml'
project 0 export cell.busbar http://cell.example/Cell
says 'Cell_1.xml'
cmp -s Cell.xml Cell_1.xml || fail "two exports differ"
project 0 new copy.busbar
project 0 import copy.busbar Cell.xml
project 0 csv copy.busbar
cp out with_file
project 0 csv cell.busbar
cmp -s out with_file || fail "the exported mapping is another one"
# Not in the file: stays; in the file: counts; gone with its node or its NodeClass.
project 0 import cell.busbar "$here/cell.xml"
project 0 csv cell.busbar
cmp -s out with_file || fail "a file without mapping has changed it"
sed 's/Data="Line.Force"/Data="Line.Other"/' Cell.xml > changed.xml
project 0 import cell.busbar changed.xml
says 'M210'
project 0 csv cell.busbar
says ',Line.Other,'
sed 's/NodeId="ns=1;i=105"/NodeId="ns=1;i=9105"/' "$here/cell.xml" > gone.xml
project 0 import cell.busbar gone.xml
says 'M315.*i=105\|i=105.*M315'
project 0 csv cell.busbar
says_not 'Line.Count'
sed -e 's/i=104" BrowseName="1:aInt16" DataType="i=4"/i=104" BrowseName="1:aInt16" DataType="i=6"/' \
    -e 's#<Int16\( [^>]*\)>417</Int16>#<Int32\1>417</Int32>#' "$here/cell.xml" > retyped.xml
project 0 import cell.busbar retyped.xml
says 'M316.*i=104\|i=104.*M316'
for uri in http://x.example/CON 'http://x.example/a:b' 'http://x.example/'; do
    sed "s#http://press.example/Press#$uri#" press.xml > named.xml
    project 0 new named.busbar --yes
    project 0 import named.busbar named.xml
    project 0 export named.busbar "$uri"
done
[ -s _1.xml ] && [ -s ab.xml ] && [ -s _2.xml ] || fail "exports have other names: $(ls -- *.xml)"

entry model App. 8: spellings and reports
uri=https://www.mitsubishielectric.com/fa/OPCUA/extension/
# in_file MAPPING CODE [EXIT]: a file whose Speed is mapped like this is imported with that report.
in_file() {
    sed "s#<DisplayName>Speed</DisplayName>#&<Extensions><Extension>$1</Extension></Extensions>#" \
        press.xml > in_file.xml
    project 0 new in_file.busbar --yes
    project "${3:-0}" import in_file.busbar in_file.xml
    [ -z "$2" ] || says "$2"
    project 0 csv in_file.busbar
}
in_file "<DataMapping Data=\"label01\" xmlns=\"$uri\"/>" ''
says ',label01,'
in_file "<DataMapping Data=\"LABEL01\" xmlns=\"$uri\" Sign=\"other\"/>" ''
says ',LABEL01,'
in_file "<DataMapping Data=\"label01\"/>" 'M208'
says_not label01
in_file "<DataMapping data=\"label01\" xmlns=\"$uri\"/>" 'M202' 5
in_file "<datamapping Data=\"label01\" xmlns=\"$uri\"/>" 'M201' 5
in_file "<MethodMapping xmlns=\"$uri\"><Handle Data=\"a\"/></MethodMapping>" 'M209' 5
in_file "<DataMapping xmlns=\"$uri\"><Element Data=\"a\"/></DataMapping>" 'M201' 5
in_file "<DataMapping xmlns=\"$uri\" Data=\"a\"/><DataMapping xmlns=\"$uri\" Data=\"b\"/>" 'M211' 5
# row MAPPING CODE [EXIT]: the same of an array.
row() {
    sed "s#<DisplayName>Row</DisplayName>#&<Extensions><Extension>$1</Extension></Extensions>#" \
        "$here/cell.xml" > row.xml
    project 0 new row.busbar --yes
    project "${3:-0}" import row.busbar row.xml
    [ -z "$2" ] || says "$2"
    project 0 csv row.busbar
}
elements='<Element Num="0" Data="a"/><Element Num="2" Data="b"/>'
for spelling in IsArray isArray; do
    row "<DataMapping $spelling=\"TRUE\" xmlns=\"$uri\">$elements</DataMapping>" ''
    says '/1:Row,\[2\],b,'
done
row "<DataMapping IsArray=\"true\" Data=\"x\" xmlns=\"$uri\">$elements</DataMapping>" M206
says '/1:Row,\[2\],b,'
row "<DataMapping IsArray=\"true\" xmlns=\"$uri\"><Element Data=\"a\"/></DataMapping>" M203 5
row "<DataMapping IsArray=\"true\" xmlns=\"$uri\"><Element Num=\"x\" Data=\"a\"/></DataMapping>" M204 5
project 0 export cell.busbar http://cell.example/Cell mapped.xml
for form in '<DataMapping [^>]*Data="Line.Mode"' '<DataMapping [^>]*IsArray="true"' \
    '<DataMapping [^>]*IsStructure="true"' '<DataMapping [^>]*IsArray="true" IsStructure="true"' \
    '<Field Name="Steps" IsArray="true" IsStructure="true">' '<Argument Num="2" IsStructure="true">' \
    '<Handle Data="Line.Handle"' 'Rank="1" Dim1="3"'; do
    grep -q -e "$form" mapped.xml || fail "no $form was exported"
done

entry model 8.6: files
project 0 export cell.busbar http://cell.example/Cell whole.xml
project 0 new copy.busbar --yes
project 0 import copy.busbar whole.xml
project 0 compare cell.busbar copy.busbar
cp copy.busbar elsewhere.busbar
project 0 check elsewhere.busbar

entry model 4.2: menus, output, status bar
project 0 import cell.busbar "$here/cell.xml"
project 0 check cell.busbar
says '^labels  *[1-9][0-9]* '
says '^characters of labels  *[1-9]'
says '^words of Variables  *[1-9]'
says '^Variables  *50 '
says '^bytes of files  *[1-9]'
says '0 errors, 0 warnings'
sed 's/Data="Line.Mode"/Data="Line.Mode.7"/' whole.xml > wrong.xml
project 0 import copy.busbar wrong.xml
run 1 --json project check copy.busbar
for member in result function cause where content found correctiveAction code; do
    says "\"$member\":\""
done
says '"code":"M314"'
finish
