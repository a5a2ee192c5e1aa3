#!/bin/sh
# `busbar check` against a controller: no finding, what its reports say, and what is not a finding.
# usage: check_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"

press 3 > press.st
{
    server "$port" certs
    machine
} > machine.toml
begin certs --config machine.toml

# Nothing is found, nothing is written: the value stays.
chief 0 check "$url" --rule-timeout 30 --junit results.xml
says '^[0-9]* rules: .*[0-9]* passed$'
says_not 'failed'
says 'Read: .*passed'
grep -q '<testsuites name="busbar check" tests="[0-9]*" failures="0"' results.xml ||
    fail "no JUnit file"
grep -q '<testcase classname="Read" name="read-nothing"' results.xml || fail "no rule in it"
value Speed 3

# Where a Variable may be written, it has its value again.
chief 0 check "$url" --rule write --allow-write "$(node Speed)"
says '^12 rules: 12 passed$'
value Speed 3
chief 0 check "$url" --rule write
says 'not applicable  write-value: no node may be written'

# Some rules, by id and by group, and as JSON.
chief 0 --json check "$url" --rule read-nothing,register --skip register-nothing
says '"id":"read-nothing","service":"Read",.*"wanted":"Bad_NothingToDo".*"outcome":"passed"'
says '"id":"register-readable"'
says_not '"id":"browse-nothing"'
says_not '"id":"register-nothing"'

# The list needs no server.
run 0 check --list
says '^read-nothing  *Read .*Bad_NothingToDo *Part 4, 5.11.2.3$'
run 0 --json check --list --rule browse-nothing
says '^\[{"id":"browse-nothing".*"source":"Part 4, 5.9.2.3"}\]$'

# What is not a finding has other exit codes.
run 2 check "$url" --rule read-nothng
says 'read-nothng: there is no such rule'
says 'read-nothing'
run 2 check "$url" --rule-timeout 0
run 3 check "opc.tcp://127.0.0.1:$((port + 7))" --timeout 5
kill "$pid"
await ended
finish
