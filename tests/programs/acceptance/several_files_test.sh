#!/bin/sh
# Programs in several files: a folder, a list of files, a .plcproj of TwinCAT.
# usage: several_files_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"

# object KIND NAME TEXT: a file of TwinCAT.
object() {
    printf '<TcPlcObject><%s Name="%s"><Declaration><![CDATA[%s]]></Declaration></%s></TcPlcObject>\n' \
        "$1" "$2" "$3" "$1"
}
mkdir -p line/DUTs line/GVLs
object DUT ST_Base "TYPE ST_Base : STRUCT Id : UDINT := 7; END_STRUCT END_TYPE" > line/DUTs/ST_Base.TcDUT
object DUT ST_Axis "TYPE ST_Axis EXTENDS ST_Base : STRUCT
Pos : ARRAY [0..GVL.N-1] OF INT := [GVL.N(5)]; END_STRUCT END_TYPE" > line/DUTs/ST_Axis.TcDUT
object GVL GVL "VAR_GLOBAL CONSTANT
N : INT := 3; END_VAR
{attribute 'OPC.UA.DA' := '1'}
VAR_GLOBAL
  Axis : ST_Axis;
  Timer : TON;
END_VAR" > line/GVLs/GVL.TcGVL
echo "VAR_GLOBAL Unlisted : INT; END_VAR" > line/unlisted.st
cat > line/Line.plcproj << 'END'
<Project xmlns="http://schemas.microsoft.com/developer/msbuild/2003"><ItemGroup>
<Compile Include="duts\ST_Axis.TcDUT" /><Compile Include="DUTs\ST_Base.TcDUT" />
<Compile Include="GVLs\GVL.TcGVL" /><Compile Include="PlcTask.TcTTO" />
</ItemGroup></Project>
END

# What a .plcproj lists is one program, and so is a folder with it.
for path in line line/ line/Line.plcproj; do
    "$controller" --check "$path" > out 2>&1
    says '1 variables are published'
    says '^  not published  Timer  GVLs/GVL.TcGVL:6:3: .*is of the type TON, which is not declared'
    "$controller" --check "$path" --json > out
    says '"published":\[{"name":"Axis","size":12,"values":4}\]'
    run 1 program check "$path" --preset nj501
    says '^  variables *1 of 10000$'
    says '^  structures *1 of 100$'
    says '^  not published  Timer '
done
# Without the list all files of the folder are; a list of files on the command line is one, too.
mkdir plain
cp -r line/DUTs line/GVLs line/unlisted.st plain
run 1 program check plain --json
says '"file":"plain".*"notPublished":\[{"name":"Timer"'
run 1 program check line/GVLs/GVL.TcGVL line/DUTs/ST_Base.TcDUT line/DUTs/ST_Axis.TcDUT --together
says '^  published *Axis  12 bytes'
run 0 program check line/DUTs/ST_Base.TcDUT line/unlisted.st
run 1 program check line/DUTs/ST_Base.TcDUT line/GVLs/GVL.TcGVL line/unlisted.st
says '^  not published  Axis .*ST_Axis, which is not declared'
run 2 program check line --preset rd81

# What the list names outside of its folder, what is missing and what is no program, is told.
cp -r line out_of
object GVL Out "VAR_GLOBAL Secret : INT; END_VAR" > secret.TcGVL
ln -s ../../secret.TcGVL out_of/GVLs/Link.TcGVL
printf 'PK\003\004' > out_of/GVLs/Zip.TcGVL
sed -i 's|</ItemGroup>|<Compile Include="..\\secret.TcGVL" /><Compile Include="GVLs\\Link.TcGVL" />\
<Compile Include="GVLs\\None.TcGVL" /><Compile Include="GVLs\\Zip.TcGVL" />&|' out_of/Line.plcproj
"$controller" --check out_of > out 2>&1 && fail "a program without some of its files is good"
says '\.\./secret.TcGVL: is outside of the folder'
says 'GVLs/Link.TcGVL: is a link to a file outside of the folder'
says 'GVLs/None.TcGVL: the file is missing'
says 'GVLs/Zip.TcGVL:1:1: found a ZIP archive'
says '1 variables are published'
grep -q Secret out && fail "a file outside of the folder is read"
run 1 program check out_of --strict
says 'out_of is refused: \.\./secret.TcGVL: is outside of the folder'

# A controller runs such a program, and takes up what changes in one of its files.
{
    server "$port" pki
    machine 'mode = "PROGRAM"' | sed 's|"press.st"|"line"|'
} > controller.toml
begin pki --config controller.toml
value Axis '.*"Id":7,"Pos":\[5,5,5\]}'
logged 'not published.*Timer\|0101.*Timer' || fail "the log does not tell of what is not published"
chief 0 admin program show "$url"
says '^from: *line$'
object DUT ST_Base "TYPE ST_Base : STRUCT Id : UDINT := 8; END_STRUCT END_TYPE" > line/DUTs/ST_Base.TcDUT
chief 0 admin program show "$url"
says '^from: *line, which has changed since'
chief 0 admin program check "$url" line
says 'line is right'
mkdir next
echo "{attribute 'publish' := 'publish only'} VAR_GLOBAL Next : INT := N; END_VAR" > next/a.st
echo "VAR_GLOBAL CONSTANT N : INT := 4; END_VAR" > next/b.st
chief 0 admin program download "$url" next --yes
value Next 4
chief 0 admin program show "$url"
says '^program: *next$'
chief 0 admin program restore "$url" --leave-out --yes
await reaches read --value "$url" "$(node Axis)"
shut_down

# The configuration may list the files.
sed -i 's|^program = .*|program = ["next/b.st", "next/a.st"]|' controller.toml
serve --config controller.toml
value Next 4
"$controller" --config controller.toml --explain machine.program > out
says '\["next/b.st", "next/a.st"\]'
"$controller" --config controller.toml --check > out
says 'next/b.st next/a.st: 1 variables are published'
finish
