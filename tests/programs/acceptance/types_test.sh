#!/bin/sh
# Types of the 3rd edition and of vendors: served, read and written, also in structures, kept over a
# power cut and in a backup.
# usage: types_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"

{
    server "$port" pki
    account designer '"Engineer"'
    machine 'mode = "RUN"
types = "built-in"'
} > controller.toml
cat > press.st << 'END'
TYPE
    Level : INT (0..100);
    Base EXTENDS Root : STRUCT Width : INT := 3; END_STRUCT
    Axis EXTENDS Base : STRUCT
        Home, Limit : BIT;
        Label : WSTRING[4] := "axis";
        Stop : LTIME := LTIME#2ms;
        Mode : (Idle, Run := 5) := Run;
        Place : STRUCT X : INT; Y : WCHAR := "y"; END_STRUCT;
    END_STRUCT
    Root : STRUCT Id : Lib.Number := 7; END_STRUCT
END_TYPE
{attribute 'publish' := 'publish only'}
VAR_GLOBAL RETAIN
    Text : WSTRING[4] := "温度";
    Letter : WCHAR := "ä";
    Since : LTIME := LT#1s500us;
    Day : LDATE := LD#2026-11-29;
    Noon : LTOD := LTOD#12:00:00;
    Moment : LDT := LDT#2026-11-29-06:00:00;
    Fill : Level := 50;
    First : Axis;
    State : (Off, On, Failed := 9) := On;
    Inner : STRUCT A : INT := 4; B : STRUCT C : BOOL; END_STRUCT; END_STRUCT;
    Number : Lib.Number := 8;
END_VAR
NAMESPACE Lib
    TYPE Number : DINT; END_TYPE
END_NAMESPACE
END
"$controller" --config controller.toml --check press.st > out 2>&1 || fail "the program is not whole"
says '11 variables are published'

begin pki --config controller.toml
value Text 温度
value Letter ä
value Since 1000.5
value Day 2026-11-29T00:00:00Z
value Noon 1601-01-01T12:00:00Z
value Moment 2026-11-29T06:00:00Z
value State On
value Number 8
chief 0 --json read --value "$url" "$(node First)"
says '"Id":7,"Width":3,"Home":false,"Limit":false,"Label":"axis","Stop":2'
says '"Mode":5,"Place":{"X":0,"Y":"y"}'
chief 0 --json read --value "$url" "$(node Inner)"
says '"A":4,"B":{"C":false}'

# writes NAME VALUE [SHOWN]: the value is written and is the variable's then.
writes() {
    chief 0 write "$url" "$(node "$1")" "$2"
    value "$1" "${3:-$2}"
}
# refuses NAME VALUE: it is out of range.
refuses() {
    chief 1 write "$url" "$(node "$1")" "$2"
    says 'Bad_OutOfRange'
}
# A text is as long as its units of UTF-16, not as its bytes, and a subrange is one for clients.
one_step
writes Text '温度😀'
refuses Text abcde
refuses Text '温度計😀'
writes Letter 度
refuses Letter ab
writes Since 0.25
writes Noon 1601-01-01T23:59:59Z
writes Moment 2026-11-30T06:00:00Z
writes Fill 100
refuses Fill 101
value Fill 100
writes State 9 Failed
chief 0 write "$url" "$(node Inner)" '{"A":5,"B":{"C":true}}'
axis='{"Id":1,"Width":2,"Home":true,"Limit":false,"Label":"温度😀","Stop":3,"Mode":0,'
axis="$axis\"Place\":{\"X\":4,\"Y\":\"z\"}}"
chief 0 write "$url" "$(node First)" "$axis"
refuses First "$(echo "$axis" | sed 's/温度/温度計/')"
step_ends

# is_kept: all of it, wherever it comes from.
is_kept() {
    value Text '温度😀'
    value Letter 度
    value Since 0.25
    value Fill 100
    value State Failed
    chief 0 --json read --value "$url" "$(node First)"
    says '"Id":1,"Width":2,"Home":true,"Limit":false,"Label":"温度😀","Stop":3'
    says '"Mode":0,"Place":{"X":4,"Y":"z"}'
    chief 0 --json read --value "$url" "$(node Inner)"
    says '"A":5,"B":{"C":true}'
}
power_cycle
is_kept
chief 0 admin backup "$url" press.backup
chief 0 write "$url" "$(node Text)" x
chief 0 write "$url" "$(node Fill)" 1
chief 0 write "$url" "$(node Inner)" '{"A":0,"B":{"C":false}}'
chief 0 admin restore "$url" press.backup --yes
is_kept
finish
