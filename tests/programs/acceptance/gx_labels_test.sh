#!/bin/sh
# The list of global labels that GX Works exports: a program of variables mode, and the labels of a
# project of model mode.
# usage: gx_labels_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"

collection=$here/../collection
{
    server "$port" pki
    machine 'strict = false' # a later one may leave out more
} > controller.toml

# Japanese, in Shift-JIS: the names are as the tool shows them.
cp "$collection/gxworks_japanese.csv" press.st
begin pki --config controller.toml
logged 'press.st was read as Shift-JIS' || fail "the log does not have the encoding"
value 速度 0
value 状態 '\[0, 0, 0, 0\]'
value 上限 1000

# English, with commas, initial values and what is not served.
cp "$collection/gxworks3_global.csv" press.st
power_cycle
logged 'nWrong' || fail "the log does not have what is left out"
value nSpeed -5
value rLimit 1.5
value sName Press
chief 1 read "$url" "$(node nHidden)"
shut_down

# Model mode: the labels are looked up before they count.
press_model "" > press.xml
run 0 project new line.busbar
run 0 project import line.busbar press.xml
run 0 project map line.busbar "ns=1;i=5" nSpeed
run 0 project check line.busbar --program "$collection/gxworks3_unicode.csv"
run 0 project map line.busbar "ns=1;i=5" 速度
run 0 project check line.busbar --program "$collection/gxworks_japanese.csv"
run 0 project check line.busbar --program "$collection/gxworks_japanese.csv" --encoding shift-jis
run 1 project check line.busbar --program "$collection/gxworks3_unicode.csv"
says 'M320 .*the PLC has no label of this name'
run 1 project check line.busbar --program "$collection/gxworks_japanese.csv" --encoding utf-8
says 'csv:1:2: found a'
run 2 project check line.busbar --program "$collection/gxworks_japanese.csv" --encoding latin
says 'expected utf-8, utf-16'
finish
