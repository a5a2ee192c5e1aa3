#!/bin/sh
# The limits of the product of model mode for what a project may hold (SH-082679, 2.1): one more of
# each is told with its code, and the characters that names may have (Appendix 6).
# usage: limits_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
takes_long

press_model '' > press.xml
# As run, for what is large.
run_long() {
    wanted=$1
    shift
    last="busbar $*"
    timeout 250 "$busbar" "$@" > out 2>&1 < /dev/null
    code=$?
    [ $code -eq "$wanted" ] || fail "$last: exit code $code instead of $wanted"
}
fresh() { run 0 project new "$1" --yes --preset rd81opc96; }
# model NAME: the head of a model of that namespace.
model() {
    cat << END
<UANodeSet xmlns="http://opcfoundation.org/UA/2011/03/UANodeSet.xsd">
  <NamespaceUris><Uri>$1</Uri></NamespaceUris>
  <Models><Model ModelUri="$1" Version="1.0" PublicationDate="2024-05-06T00:00:00Z"/></Models>
END
}
# nodes LINES: awk's, as nodes.
nodes() { awk "BEGIN { $1 }"; }
object='"  <UAObject NodeId=\"ns=1;i=%d\" BrowseName=\"1:O%d\"><DisplayName>O</DisplayName><References><Reference ReferenceType=\"i=40\">i=58</Reference><Reference ReferenceType=\"i=47\" IsForward=\"false\">%s</Reference></References></UAObject>\n"'
variable='"  <UAVariable NodeId=\"ns=1;i=%d\" BrowseName=\"1:V%d\" DataType=\"%s\" %s><DisplayName>V</DisplayName><References><Reference ReferenceType=\"i=40\">i=63</Reference><Reference ReferenceType=\"i=47\" IsForward=\"false\">i=85</Reference></References></UAVariable>\n"'
imports() {
    run_long "$1" project import "$2" "$3"
    says "$4"
}

entry model 2.1: models, namespaces, types
fresh files.busbar
for i in $(seq 1 10); do
    model "urn:model:$i" > small.xml
    nodes "printf $object, 1, 1, \"i=85\"" >> small.xml
    echo '</UANodeSet>' >> small.xml
    run 0 project import files.busbar small.xml
done
sed 's/urn:model:10/urn:model:11/' small.xml > one_more.xml
imports 1 files.busbar one_more.xml 'M40[13]'
fresh line.busbar
long=$(printf 'urn:%0130d' 0)
sed "s#http://press.example/Press#$long#" press.xml > long.xml
imports 0 line.busbar long.xml imported
sed "s#http://press.example/Press#${long}0#" press.xml > long.xml
imports 1 line.busbar long.xml M404
fresh line.busbar
{
    cat press.xml
    printf '<!--'
    head -c 20971520 /dev/zero | tr '\0' ' '
    echo '-->'
} > large.xml
imports 1 line.busbar large.xml M402
{
    model urn:deep
    nodes "for (i = 1; i <= 21; ++i) printf $object, i, i, i == 1 ? \"i=85\" : \"ns=1;i=\" i - 1"
    echo '</UANodeSet>'
} > deep.xml
imports 0 line.busbar deep.xml imported
run_long 1 project check line.busbar
says 'M408.*21, at most 20'
fresh line.busbar
{
    model urn:many
    nodes "for (i = 1; i <= 50001; ++i) printf $object, i, i, \"i=85\""
    echo '</UANodeSet>'
} > many.xml
imports 1 line.busbar many.xml M405

entry model 2.1: data types
sed 's#DataType="i=4"#DataType="i=14524"#; /<Value>/d' press.xml > unsupported.xml
fresh line.busbar
run 0 project import line.busbar unsupported.xml
run 0 project check line.busbar
says 'M318.*ns=1;i=5.*FieldMetaData'

entry model 2.1: variables, words, texts
{
    model urn:variables
    nodes "for (i = 1; i <= 3; ++i) printf $variable, i, i, \"i=4\", \"ValueRank=\\\"1\\\" ArrayDimensions=\\\"10240\\\"\"; printf $variable, 4, 4, \"i=12\", \"ValueRank=\\\"1\\\" ArrayDimensions=\\\"8193\\\"\""
    echo '</UANodeSet>'
} > arrays.xml
fresh line.busbar
run_long 0 project import line.busbar arrays.xml
run_long 1 project check line.busbar
says 'M407'
sed 's/8193/8/' arrays.xml > arrays2.xml
run_long 0 project import line.busbar arrays2.xml
# rows COUNT LENGTH: a table of so many labels of that length.
rows() {
    echo 'NodeId,Part,Label'
    nodes "for (i = 0; i < $1; ++i) printf \"ns=1;i=%d,[%d],%s%0${2}d\n\", 1 + i / 10000, i % 10000, \"L\", i"
}
rows 25000 8 > table.csv
run_long 0 project csv line.busbar --in table.csv
rows 25001 8 > table.csv
run_long 0 project csv line.busbar --in table.csv
run_long 1 project check line.busbar
says 'M411.*25001, at most 25000'
rows 4000 700 > table.csv
run_long 0 project csv line.busbar --in table.csv --replace --yes
run_long 1 project check line.busbar
says 'M413'
run 1 project map line.busbar "ns=1;i=1" "$(printf 'L%0800d' 0)" '[0]'
says 'M412\|801'
{
    model urn:variables
    nodes "for (i = 1; i <= 25001; ++i) printf $variable, i, i, \"i=4\", \"\""
    echo '</UANodeSet>'
} > arrays.xml
fresh line.busbar
run_long 0 project import line.busbar arrays.xml
run_long 1 project check line.busbar
says 'M406.*25001, at most 25000'

entry model App. 6: characters
fresh line.busbar
run 0 project import line.busbar press.xml
for label in 'ラベル' Line_1 'Größe'; do
    run 0 project map line.busbar "ns=1;i=5" "$label"
done
for label in 'Line 1' 'Line+1' 'Li!ne' 'Li#ne' 'a@b' 'a~b' '😀' 'a　b'; do
    run 1 project map line.busbar "ns=1;i=5" "$label"
done
run 0 project new free.busbar
run 0 project import free.busbar press.xml
sed 's#http://press.example/Press#http://x.example/a*b?#' press.xml > starred.xml
run 0 project new starred.busbar
run 0 project import starred.busbar starred.xml
run 0 project export starred.busbar 'http://x.example/a*b?'
says 'ab.xml'
finish
