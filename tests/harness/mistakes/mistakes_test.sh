#!/bin/sh
# What is printed where a test has a mistake.
# usage: mistakes_test.sh PROGRAM, the tests of mistake_cases.cpp
set -u
program=$1
out=$(mktemp)
trap 'rm -f "$out"' EXIT
failures=0
cases=0
# case NAME TEXT...: the test fails, and what it prints has each text.
case_says() {
    name=$1
    shift
    cases=$((cases + 1))
    if BUSBAR_SEED=77 "$program" "$name" > "$out" 2>&1; then
        echo "FAILED: the test \"$name\" has passed"
        failures=$((failures + 1))
        return
    fi
    # A signal is not an answer.
    if grep -q 'SIGSEGV\|SIGABRT\|terminate called' "$out"; then
        echo "FAILED: the test \"$name\" has crashed"
        failures=$((failures + 1))
    fi
    # Catch2 breaks long lines, also within a word.
    text=$(tr -d ' \n' < "$out")
    for wanted in "$@"; do
        case $text in
            *"$(printf %s "$wanted" | tr -d ' ')"*) ;;
            *)
                echo "FAILED: the test \"$name\" does not print: $wanted"
                cat "$out"
                failures=$((failures + 1))
                ;;
        esac
    done
}
seed='seed 77, which BUSBAR_SEED=77 repeats'
case_says "a source throws" 'DataSource::read threw: sensor 7 is broken' "$seed"
case_says "a source never completes its batch" 'Bad_Timeout' 'client -> ReadRequest ns=1;s=Level' "$seed"
case_says "secured endpoints lack a certificate" 'there is no server: ' 'certificate'
case_says "a fault of a message has a time instead" 'the fault "delay 3 s after 1 s" can never act: '
case_says "a fault names a message that does not exist" 'can never act: ' 'ReadReqest'
case_says "a fault waits for a message that never comes" 'faults that have never acted' 'cut at WriteRequest 1' "$seed"
case_says "a fault edits a field that does not exist" 'faults that have never acted' 'statsu'
case_says "a name is given twice" 'what the test needs has failed: Bad_NodeIdExists'
case_says "a Subscription is lost on the way" 'Bad_ConnectionClosed holds Double 1.5' 'network: cut'
case_says "the node that is looked at is not watched" 'subscribe() has not been called for ns=1;s=Limit'
case_says "the interval is longer than a request may wait" \
    'an interval of 3600.000 s must be above 0 s and below ' "half of the client's request_timeout"
case_says "the least latency is above the greatest" 'min_latency 0.005 s is above max_latency 0.001 s'
case_says "a second server has the same URL" 'opc.tcp://server:4840 has a listener already'
case_says "the URL has a letter less" \
    'there is no listener at opc.tcp://sever:4840; there is opc.tcp://server:4840'
case_says "a value of another type is written" 'Bad_TypeMismatch == Good' 'WriteRequest ns=1;s=Level'
case_says "the value never comes" 'ns=1;s=Level had no value that holds Double 7' \
    '; 1 came, the last Double 1.5' "$seed"
case_says "an Event lacks the field that is asked for" 'Events do not have the field Presure'
case_says "a script that is not followed is not looked at" 'expected WriteRequest, came nothing'
case_says "a replay has another seed" 'the recording has the seed 1, the world 7'

known=$("$program" --list-test-names-only | wc -l)
if [ "$known" -ne "$cases" ]; then
    echo "FAILED: the program has $known tests, of which $cases are run here"
    failures=$((failures + 1))
fi
exit "$failures"
