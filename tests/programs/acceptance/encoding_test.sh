#!/bin/sh
# Programs in the encodings of development systems: recognized by their content, told, and named by
# the configuration where the content is not enough.
# usage: encoding_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"

{
    server "$port" pki
    machine 'mode = "RUN"'
} > controller.toml
# program TEXT: a program with this text, in UTF-8, as a comment and as a value.
program() {
    printf '%s\n' "{attribute 'publish' := 'publish only'}" VAR_GLOBAL \
        "    Speed : INT := 17; // $1" "    Note : STRING[60] := '$1';" END_VAR
}
# is ENCODING FILE: what --check says of it.
is() {
    last="--check $2"
    "$controller" --check "$2" > out 2>&1 || fail "--check $2 failed"
    says '2 variables are published'
    says "^  encoding *$1\$"
}
german='Gerät für Öl'
japanese='ポンプの速度'
program "$german" > utf8.st
program "$german" | iconv -f utf-8 -t cp1252 > cp1252.st
program "$japanese" | iconv -f utf-8 -t cp932 > sjis.st
program "$japanese" | iconv -f utf-8 -t utf-16le > plain16.st
{ printf '\377\376'; cat plain16.st; } > marked16.st
is UTF-8 utf8.st
is Windows-1252 cp1252.st
is Shift-JIS sjis.st
is UTF-16LE plain16.st
is UTF-16LE marked16.st
"$controller" --check sjis.st --json > out 2>&1
says '"encoding":"Shift-JIS"'

# Half of a surrogate pair, in the line after the last.
{ cat marked16.st; printf '\000\330'; } > half.st
"$controller" --check half.st > out 2>&1 && fail "a damaged text is accepted"
says '^half.st is refused: half.st:6:1: found a unit that is not UTF-16LE'

cp sjis.st press.st
begin pki --config controller.toml
value Speed 17
value Note "$japanese"
await logged 'press.st was read as Shift-JIS'
# The same bytes are a text of Windows-1252, too, if the configuration says so.
sed 's/^\[machine\].*/&\nencoding = "windows-1252"/' controller.toml > named.toml
mv named.toml controller.toml
cp cp1252.st press.st
power_cycle
value Note "$german"
await logged 'press.st was read as Windows-1252'
sed 's/^encoding = .*/encoding = "koi8-r"/' controller.toml > wrong.toml
"$controller" --config wrong.toml --check > out 2>&1 && fail "an unknown encoding is accepted"
says 'encoding.*expected "utf-8", "utf-16"'
finish
