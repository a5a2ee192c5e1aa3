#!/bin/sh
# NodeSet2 files with what vendors' files have wrong: refused with line and reason, or repaired and
# told, by the configuration and by `busbar project`.
# usage: nodesets_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"

# variable ID ATTRIBUTES VALUE: with a type definition, below Objects.
variable() {
    printf '<UAVariable NodeId="ns=1;s=%s" BrowseName="1:%s" %s><References>' "$1" "$1" "$2"
    printf '<Reference ReferenceType="i=40">i=63</Reference>'
    printf '<Reference ReferenceType="i=35" IsForward="false">i=85</Reference></References>'
    printf '<Value>%s</Value></UAVariable>\n' "$3"
}
# file LINES: a model, whose first node is in line 5.
file() {
    cat << END
<UANodeSet xmlns="http://opcfoundation.org/UA/2011/03/UANodeSet.xsd">
<NamespaceUris><Uri>urn:oven</Uri></NamespaceUris>
<Models><Model ModelUri="urn:oven" Version="1" PublicationDate="2026-01-01T00:00:00Z">
<RequiredModel ModelUri="http://opcfoundation.org/UA/" PublicationDate="${2:-2020-01-01T00:00:00Z}"/></Model></Models>
$1
</UANodeSet>
END
}
oven() { echo "nsu=urn:oven;s=$1"; }
lists='<ListOfInt32><Int32>1</Int32><Int32>2</Int32><Int32>3</Int32><Int32>4</Int32></ListOfInt32>'

# Six defects in one file, and a matrix that is written as a list.
file "$(variable Level 'DataType="Double" AccessLevel="3"' '<Int32>7</Int32>')
$(variable Name 'DataType="i=6"' '<String>seven</String>')
$(variable Grid 'DataType="i=6" ValueRank="2" ArrayDimensions="2,2"' "$lists")
<UAObject NodeId=\"ns=1;s=Door\" BrowseName=\"1:Door\"><References>
<Reference ReferenceType=\"Organizes\" IsForward=\"false\">i=85</Reference>
<Reference ReferenceType=\"i=35\">ns=1;s=Nowhere</Reference></References></UAObject>" \
    2099-01-01T00:00:00Z > oven.xml
file "$(variable Grid 'DataType="i=6" ValueRank="2" ArrayDimensions="2,2"' "$lists")" > grid.xml
file "$(variable Level 'DataType="i=11"' '<Int32>7</Int32>')" > value.xml

# config STRICT FILE: a server with one of them.
config() {
    server "$port" certificates | sed "s|^\[server\]|&\nnodesets = [\"$2\"]\nnodesets_strict = $1|"
}
# refused PATTERN: it does not start with the file, and says why.
refused() {
    last="a start with $1"
    timeout 60 "$controller" --config c.toml > out 2>&1 < /dev/null &&
        fail "$last: it started"
    says "$2"
}

config true oven.xml > c.toml
refused oven.xml 'oven.xml:5: ns=1;s=Level: found "Double", expected a NodeId or one of the'
says 'nodesets_strict = false in \[server\] the controller repairs'
config true value.xml > c.toml
refused value.xml 'value.xml:5: ns=1;s=Level: found a value <Int32>, expected one of the DataType'

# A list of the right length is a matrix either way.
config true grid.xml > c.toml
begin certificates --config c.toml
chief 0 read --value "$url" "$(oven Grid)"
says '^\[\[1,2\],\[3,4\]\]$'
chief 0 read --value "$url" "$(oven Grid)" --range 0:1,1
says '^\[\[2\],\[4\]\]$'
shut_down

# With the switch it serves what is there, and tells each repair with line and rule, and the counts.
config false oven.xml > c.toml
serve --config c.toml
for line in 'oven.xml:4: .* requires .*, and went on (rule older-model)' \
    'oven.xml:5: ns=1;s=Level: took "Double", which has no <Alias>, for i=11 (rule alias)' \
    'oven.xml:5: ns=1;s=Level: converted a value <Int32> .* (rule value-converted)' \
    'oven.xml:6: ns=1;s=Name: left out a value <String>, .* (rule value-removed)' \
    'oven.xml:8: ns=1;s=Door: took BaseObjectType .* (rule type-definition)' \
    'oven.xml:10: ns=1;s=Door: left out a reference to .*Nowhere, which is nowhere (rule dangling' \
    'repaired 2 times alias: ' 'repaired 1 time value-removed: '; do
    logged "$line" || fail "the log has no $line"
done
chief 0 read --value "$url" "$(oven Level)"
says '^7$'
one_step # no value of a model outlives a power cut
chief 0 write "$url" "$(oven Level)" 8.5
chief 0 read --value "$url" "$(oven Level)"
says '^8.5$'
step_ends
chief 0 read "$url" "$(oven Name)"
says_not 'seven'
chief 0 browse "$url" "$(oven Door)"
shut_down

# The same for a project, whose file is a sound one afterwards.
run 0 project new line.busbar
run 1 project import line.busbar oven.xml
says 'M102 .*oven.xml:5: ns=1;s=Level: '
says '\-\-lenient repairs'
run 0 project import line.busbar oven.xml --lenient
says 'M112 oven.xml:10: ns=1;s=Door: .* (rule dangling-reference)'
says 'repaired: 1 time type-definition: '
says 'imported urn:oven: 4 nodes'
run 0 project check line.busbar
run 0 project export line.busbar urn:oven sound.xml
run 0 project new again.busbar
run 0 project import again.busbar sound.xml
says_not 'M1[01]2'
finish
