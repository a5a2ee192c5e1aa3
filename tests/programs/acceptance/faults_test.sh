#!/bin/sh
# Faults of variables mode that users met once and that no other script looks for: each would come
# back here.
# usage: faults_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
takes_long
. "$here/remedies.sh"

# What the README says is typed first: the examples as they are.
mkdir -p examples/controller
cp "$here"/../../../examples/controller/* examples/controller/
"$controller" --config examples/controller/machine.toml --port "$port" > log 2>&1 < /dev/null &
pid=$!
await logged '^ready'
logged 'with the code' || fail "the README's first line gives no code"
shut_down

{
    server "$port" pki
    account op '"Operator"'
    machine 'mode = "PROGRAM"
retained_ms = 3600000'
} > controller.toml
program() {
    cat > press.st << END_OF_PROGRAM
{attribute 'publish' := 'publish only'}
VAR_GLOBAL
    Speed : INT := 17;
    $1
END_VAR
{attribute 'publish' := 'publish only'}
VAR_GLOBAL RETAIN
    Total : DINT;
    ${2:-}
END_VAR
END_OF_PROGRAM
}
program 'Shown : INT; Kept : INT;'
begin pki --config controller.toml
login() { run 0 --user op --password-file password --trust read "$url" i=2259; }

# The log goes on after it was cleared, and can be cleared again.
one_step
for _ in 1 2; do
    login
    recorded AUTH 0002 'Success.*op'
    chief 0 admin log "$url" --clear --yes
    says 'cleared the execution log: [1-9]'
    chief 0 admin log "$url" --code 0002
    says_not '  op *$'
    login
    is_listed() { reaches admin log "$url" --code 0002 && grep -q '0002 .* op *$' out; }
    await is_listed
done
step_ends

# An online edit that hides a variable, or has it kept, does so.
program "{attribute 'publish' := 'do not publish'} Shown : INT;" 'Kept : INT;'
hang_up 'press.st'
is_hidden() { ! reaches read "$url" "$(node Shown)"; }
await is_hidden
chief 1 read "$url" "$(node Shown)"
says Bad_NodeIdUnknown
chief 0 write "$url" "$(node Kept)" 7
power_cycle
value Kept 7
chief 0 write "$url" "$(node Total)" 88
power_cycle
value Total 88

# A name that is too long is refused like any mistake, and keeps nobody from starting.
program "Shown : INT; $(printf 'N%0600d' 0) : INT;"
kill -HUP "$pid"
await logged 'press.st:4:.*; nothing was changed'
value Speed 17
power_cycle
value Speed 17
program "Shown : INT; $(printf 'N%0500d' 0) : INT;"
power_cycle
value "$(printf 'N%0500d' 0)" 0

# The rules for names are told, a preset's too, and where it departs from its manual.
chief 0 admin setting list "$url" users.passwords
says 'users.passwords.min_password_length'
sed 's/^\[limits\]$/[limits]\npreset = "nj501"/' controller.toml > nj501.toml
power_cut
serve --config nj501.toml
chief 0 admin setting list "$url" users.passwords
says 'users.passwords.name_characters *"[0-9A-Za-z]'
says 'users.passwords.reserved_names *\["'
shut_down
"$controller" --print-preset nj501 > out || fail "--print-preset"
last="--print-preset"
for each in machine.use users.anonymous endpoint users.account; do
    says "$each"
done

# Conformance of a controller that waits for its setup.
sed 's/^setup = .*//; /^\[\[users.account\]\]/,/^roles/d; s/^\[users\]$/&\nsetup = true/' \
    controller.toml > setup.toml
"$controller" --print-conformance setup.toml > out 2>&1 || fail "--print-conformance"
last="--print-conformance"
says_not 'no user can log in'

# Anonymous users are let in beside a setup, once there is an administrator.
sed -e 's/^setup = true/&\nanonymous = "read"/' -e 's/^folder = .*/folder = "new-pki"/' \
    setup.toml > anonymous.toml
serve --config anonymous.toml
sed -n 's/.*with the code \([^,]*\),.*/\1/p' log > code
run 4 --trust read "$url" i=2259
run 0 admin setup "$url" first --user setup --password-file code --new-password-file password --trust
run 0 --trust read "$url" i=2259
run 0 --user first --password-file password --trust admin setting set "$url" users.anonymous no
run 4 --trust read "$url" i=2259
shut_down
finish
