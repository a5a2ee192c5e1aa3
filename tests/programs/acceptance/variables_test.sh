#!/bin/sh
# The variables that a machine publishes: the controller's folder, their attributes, types and
# restrictions, and the publish attribute (W588, 3-3-1, 6-2-1 and 6-2-2).
# usage: variables_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"

log_text() { cat medium/packages/OPCUA_Server/ExecutionLog/*.log 2> /dev/null | tr '\t\r' '  '; }
# recorded TEXT: the execution log has such a record.
recorded() { await has_record "$1"; }
has_record() { log_text | grep -q -e "$1"; }
# attributes NAME: all that the node says.
attributes() {
    chief 0 read --all "$url" "$(node "$1")"
}
# writes NAME VALUE [SHOWN]: the value is written and is the variable's then.
writes() {
    chief 0 write "$url" "$(node "$1")" "$2"
    value "$1" "${3:-$2}"
}
unpublished() {
    chief 1 read "$url" "$(node "$1")"
    says 'Bad_NodeIdUnknown'
}

{
    server "$port" pki
    machine
} | sed -e 's/^\[limits\]$/[limits]\npreset = "nj501"/' -e 's/^name = "Controller"/name = "Press"/' \
    > controller.toml
cat > press.st << 'END'
TYPE
    Color : (Red := 0, Green := 1, Blue := 7);
    Inner : STRUCT A : INT; B : ARRAY [0..2] OF BOOL; END_STRUCT;
    Outer : STRUCT I : Inner; J : ARRAY [0..1] OF Inner; T : STRING[10]; E : Color; END_STRUCT;
    Four : STRUCT O : Outer; END_STRUCT;
    Five : STRUCT F : Four; END_STRUCT;
    Either : UNION R : REAL; D : DINT; END_UNION;
    HasUnion : STRUCT U : Either; END_STRUCT;
    HasMatrix : STRUCT M : ARRAY [0..1, 0..1] OF INT; END_STRUCT;
    Padded : STRUCT B : BOOL; L : LREAL; END_STRUCT;
END_TYPE
{attribute 'publish' := 'publish only'}
VAR_GLOBAL
    aBool : BOOL;
    aSint : SINT;
    anInt : INT;
    aDint : DINT;
    aLint : LINT;
    aUsint : USINT;
    aUint : UINT;
    aUdint : UDINT;
    aUlint : ULINT;
    aByte : BYTE;
    aWord : WORD;
    aDword : DWORD;
    aLword : LWORD;
    aReal : REAL;
    aLreal : LREAL;
    aTime : TIME;
    aDate : DATE;
    aTod : TIME_OF_DAY;
    aDt : DATE_AND_TIME;
    aString : STRING[20];
    row : ARRAY [0..3] OF INT;
    matrix : ARRAY [0..1, 0..2] OF DINT;
    cube : ARRAY [0..1, 0..1, 0..1] OF BYTE;
    part : Outer;
    parts : ARRAY [0..1] OF Inner;
    shade : Color;
    largest : ARRAY [0..63] OF Padded;
    zBase : ARRAY [2..5] OF INT;
    zBytes : ARRAY [0..512] OF INT;
    zDeep : Five;
    zElements : ARRAY [0..1024] OF BOOL;
    zMatrix : HasMatrix;
    zPadded : ARRAY [0..64] OF Padded;
    zParts : ARRAY [0..1, 0..1] OF Inner;
    zUnion : HasUnion;
END_VAR
{attribute 'publish' := 'publish only'}
VAR_GLOBAL CONSTANT
    fixed : INT := 5;
END_VAR
VAR_GLOBAL
    {attribute 'publish' := 'do not publish'}
    hidden : INT;
    silent : INT;
    {attribute 'publish' := 'input'}
    inward : INT;
    {attribute 'publish' := 'output'}
    outward : INT;
END_VAR
END
begin pki --config controller.toml

entry variables 3-3-1: publish attribute
# Input, output and publish only are the same to a client; the two others do not exist.
one_step
for name in anInt inward outward; do
    writes $name 7
done
step_ends
unpublished hidden
unpublished silent
chief 0 browse "$url" "$(node Controller/GlobalVars)"
says 'inward'
says_not 'hidden'
says_not 'silent'

entry variables 6-2-1: controller folder
chief 0 browse "$url" /Objects
says ' 4:Press  *Object '
chief 0 browse "$url" "$(node Controller/)" --depth 2
for name in DeviceState ErrorState Mode UnpublishedVariablesStatus NumberOfPublishedVariables \
    NumberOfValueAttributes GlobalVars; do
    says "4:$name "
done
value Controller/DeviceState/ErrorState 'NoError'
value Controller/DeviceState/Mode 'RUN'
value Controller/DeviceState/UnpublishedVariablesStatus 8
value Controller/DeviceState/NumberOfPublishedVariables 30
value Controller/DeviceState/NumberOfValueAttributes 192

entry variables 6-2-2: name, type, constant, publish
attributes fixed
says '^BrowseName  *"4:fixed"$'
says '^DisplayName  *"fixed"$'
says '^DataType  *Int16 (i=4)$'
says '^AccessLevel .*(1)$'
chief 1 write "$url" "$(node fixed)" 6
says 'Bad_NotWritable'
value fixed 5
attributes anInt
says '^AccessLevel .*(3)$'

entry variables 6-2-2: types
one_step
# type NAME DATATYPE LARGEST [SHOWN]
type() {
    attributes "$1"
    says "^DataType .*(i=$2)\$"
    writes "$1" "$3" "${4:-$3}"
}
type aBool 1 true
type aSint 2 -128
type aUsint 3 255
type aByte 3 255
type anInt 4 -32768
type aUint 5 65535
type aWord 5 65535
type aDint 6 -2147483648
type aUdint 7 4294967295
type aDword 7 4294967295
type aLint 8 -9223372036854775808
type aUlint 9 18446744073709551615
type aLword 9 18446744073709551615
type aReal 10 -0.5
type aLreal 11 2.5
type aTime 11 1500
type aString 12 'pärts' 'pärts'
value aDate 1970-01-01T00:00:00Z # IEC 61131-3 counts dates from it
value aDt 1970-01-01T00:00:00Z
type aDt 13 2026-11-21T06:00:00Z
type aDate 13 2026-11-21T00:00:00Z
type aTod 13 1601-01-01T06:00:00Z
step_ends

entry variables 6-2-2: arrays
one_step
writes row '[1, 2, 3, -4]' '\[1, 2, 3, -4\]'
chief 0 write "$url" "$(node matrix)" '[[1,2,3],[4,5,6]]'
chief 0 read --value "$url" "$(node matrix)"
says '6'
attributes matrix
says '^ArrayDimensions  *\[2, 3\]$'
attributes cube
says '^ArrayDimensions  *\[2, 2, 2\]$'
# An array is one node, and is of its size.
chief 0 browse "$url" "$(node row)"
says_not 'row\['
unpublished 'row[0]'
chief 1 write "$url" "$(node row)" '[1, 2]'
value row '\[1, 2, 3, -4\]'

entry variables 6-2-2: structures
chief 0 write "$url" "$(node part)" \
    '{"I":{"A":1,"B":[true,false,true]},"J":[{"A":2,"B":[false,false,false]},{"A":3,"B":[true,true,true]}],"T":"lid","E":7}'
chief 0 --json read --value "$url" "$(node part)"
says '"A":3'
says '"T":"lid"'
chief 0 write "$url" "$(node parts)" \
    '[{"A":4,"B":[true,true,false]},{"A":5,"B":[false,true,false]}]'
chief 0 --json read --value "$url" "$(node parts)"
says '"A":5'
chief 0 browse "$url" "$(node part)"
says_not 'part\.'
unpublished part.I
chief 2 write "$url" "$(node part)" 5

entry variables 6-2-2: enumerations
type shade 6 7
type shade 6 -3
step_ends

entry variables 6-2-2: restrictions, order, registration, online
for name in zBase zBytes zDeep zElements zMatrix zPadded zParts zUnion; do
    unpublished $name
done
chief 0 read "$url" "$(node largest)"
recorded 'SERVER 0101 InvalidDataType zBase SubscriptOfArray'
recorded 'zBytes MaxSize 1026Byte'
recorded 'zDeep NestedStructre'
recorded 'zElements MaxArrayElements'
recorded 'zMatrix MultiDimensionalArray'
recorded 'zPadded MaxSize 1040Byte'
recorded 'zParts MultiDimensionalArray'
recorded 'zUnion Union'
# Sizes as the CPU counts them.
recorded 'SERVER 0111 PublishedVariable aBool 2Byte 1 0'
recorded 'SERVER 0111 PublishedVariable largest 1024Byte 128 2'
recorded 'SERVER 0111 PublishedVariable part 28Byte 14 4'
recorded 'SERVER 0110 NumOfVariables Variables=30, Values=192, DataTypes=3'
# In the order of their names, whatever their case.
log_text | awk '$5 == "SERVER" && $6 == "0004" { n = 0 } $6 == "0111" { name[n++] = $8 }
    END { for (i = 0; i < n; i++) print name[i] }' > order
[ "$(wc -l < order)" -eq 30 ] || fail "$(wc -l < order) records instead of 30"
tr 'A-Z' 'a-z' < order | sort -c || fail "the records are not in the order of the names"
chief 0 admin events "$url" --code 35D40000
says '35D40000 Unsupported Data Type'
# Added online: only that is checked and recorded, and clients go on.
one_step
before=$(log_text | grep -c ' SERVER 0111 ')
sed -i "s/    aBool : BOOL;/    aBool : BOOL; aNew : ARRAY [0..16] OF BOOL; zNew : ARRAY [1..2] OF INT;/" press.st
hang_up 'edited online: press.st'
value Controller/DeviceState/NumberOfPublishedVariables 31
recorded 'SERVER 0111 PublishedVariable aNew 4Byte 17 0'
recorded 'zNew SubscriptOfArray'
[ "$(log_text | grep -c ' SERVER 0111 ')" -eq $((before + 1)) ] ||
    fail "more than what was added is recorded"
step_ends

entry variables A-1: start-up times
# As many as there can be, of the type that the manual measures with; busbar-bench startup has
# times.
{
    printf "{attribute 'publish' := 'publish only'}\nVAR_GLOBAL\n"
    seq 10000 | sed 's/.*/    v& : INT := &;/'
    echo END_VAR
} > press.st
power_cycle
value Controller/DeviceState/NumberOfPublishedVariables 10000
value v10000 10000
value Controller/DeviceState/UnpublishedVariablesStatus 0
shut_down
finish
