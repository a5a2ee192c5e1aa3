# A controller of model mode with the cell of cell.xml mapped to labels, whom everybody may read and
# write without security. To be read after functions.sh.

cell_program() {
    cat << 'END'
TYPE RecipeType : STRUCT
    Name : STRING[32]; Size : INT; Mode : DINT;
END_STRUCT; END_TYPE
TYPE LineType : STRUCT
    Bit : BOOL; W : INT := 5; UW : UINT; DW : DINT; UDW : UDINT; F : REAL; D : LREAL; T : TIME;
    S : STRING[7]; Wide : ARRAY[0..7] OF UTF16_UNIT;
    Tim : TIMER; LTim : LTIMER; Cnt : COUNTER;
    Row : ARRAY[0..2] OF INT; Table : ARRAY[0..1, 0..2] OF INT;
    Recipe : RecipeType; Recipes : ARRAY[0..1] OF RecipeType;
    Handle : WORD := 16#FFFE; State : INT; Speed : INT; Amounts : ARRAY[0..2] OF DINT; Name : STRING[20];
    Many : ARRAY[0..19] OF INT; ManyHandle : WORD; Count : UINT;
END_STRUCT; END_TYPE
VAR_GLOBAL {attribute 'publish' := 'publish only'} Line : LineType; END_VAR
VAR_GLOBAL
    Secret : INT;
END_VAR
VAR_GLOBAL CONSTANT {attribute 'publish' := 'publish only'} Fixed : INT := 3; END_VAR
END
}
# cell_table: the mapping, as a spreadsheet has it.
cell_table() {
    echo 'NodeId,Part,Label'
    for each in 101:Bit 102:W 103:UW 104:W 105:W 106:DW 107:UDW 108:DW 109:UDW 110:D 111:F \
        112:S 121:Wide 130:Mode; do
        label=${each#*:}
        echo "ns=1;i=${each%%:*},,Line.${label%Mode}$([ "$label" = Mode ] && echo Recipe.Mode)"
    done
    for i in 0 1 2; do
        echo "ns=1;i=140,[$i],Line.Row[$i]"
        echo "ns=1;i=141,[0][$i],\"Line.Table[0,$i]\""
        echo "ns=1;i=141,[1][$i],\"Line.Table[1,$i]\""
        echo "ns=1;i=20,Input[1][$i],Line.Amounts[$i]"
    done
    for part in Name Size Mode; do
        echo "ns=1;i=160,.$part,Line.Recipe.$part"
    done
    echo 'ns=1;i=161,[1].Size,Line.Recipes[1].Size'
    echo 'ns=1;i=20,Handle,Line.Handle'
    echo 'ns=1;i=20,Input[0],Line.Speed'
    echo 'ns=1;i=20,Input[2].Name,Line.Name'
    echo 'ns=1;i=40,Handle,Line.ManyHandle'
    for i in $(seq 0 19); do
        echo "ns=1;i=40,Input[$i],Line.Many[$i]"
    done
    echo 'ns=1;i=170,,Line.W'
}
# cell_project FILE [OPTIONS...]: that of everybody.
cell_project() {
    [ -n "$is_client" ] || run 0 cert create
    is_client=yes
    file=$1
    shift
    run 0 project new "$file" --yes "$@"
    run 0 project set "$file" "listener 1.address" 127.0.0.1 "listener 1.port" $port \
        security.policies "" security.mode None security.allow_anonymous yes \
        security.trust_all_clients yes
    run 0 project import "$file" "$here/cell.xml"
    cell_table > cell.csv
    run 0 project csv "$file" --in cell.csv
}
# cell_controller LABELS LIMITS: its configuration, with more lines in these tables.
cell_controller() {
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
[limits]
$2
[users]
anonymous = "write"
[labels]
program = "line.st"
utc_offset_minutes = 0
$1
[plc]
scan_ms = ${scan_ms:-20}
[[plc.program]]
kind = "increment"
target = "${moves:-Line.Count}"
END
}
# serve_cell FILE: with this project, as it was written before.
serve_cell() {
    mkdir -p project/project
    cp "$1" project/project/project.busbar
    serve --config module.toml --project project
}
cell() { echo "nsu=http://cell.example/Cell;i=$1"; }
module() { echo "/Objects/1:Module/1:$1"; }
# get NODE PATTERN: its value is this.
get() {
    run 0 --trust read --value "$url" "$1"
    says "$2"
}
# put NODE VALUE...: is written, and read again.
put() {
    run 0 --trust write "$url" "$@"
}
# code_of STATUS: busbar's exit code.
code_of() {
    [ "$1" = Bad_NoCommunication ] && echo 3 || echo 1
}
# put_refused STATUS NODE VALUE
put_refused() {
    status=$1
    shift
    run "$(code_of "$status")" --trust write "$url" "$@"
    says "$status"
}
get_refused() {
    run "$(code_of "$1")" --trust read "$url" "$2"
    says "$1"
}
