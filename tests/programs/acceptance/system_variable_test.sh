#!/bin/sh
# The system-defined variable _Card1RestoreCmdTargetOpcuaSPF (W588, A-4): the program says whether a restore
# brings users, roles and certificates back, or reads what it has said.
# usage: system_variable_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"

cat > press.st << 'END'
VAR_GLOBAL
    {attribute 'publish' := 'publish only'}
    Choice : BOOL;
    {attribute 'publish' := 'publish only'}
    Shown : BOOL;
END_VAR
END
{
    server "$port" pki
    machine 'mode = "PROGRAM"'
    cat << 'END'
[[plc.program]]
kind = "copy"
source = "Choice"
target = "_Card1RestoreCmdTargetOpcuaSPF"
[[plc.program]]
kind = "copy"
source = "_Card1RestoreCmdTargetOpcuaSPF"
target = "Shown"
END
} > controller.toml
begin pki --config controller.toml

entry variables A-4: restore command of the card
chief 0 admin user add "$url" pat --new-password-file password
chief 0 admin backup "$url" with_pat.backup
chief 0 admin user remove "$url" pat --yes
# It is FALSE as the program begins, and users stay as they are.
value Shown false
chief 0 admin restore "$url" with_pat.backup --by-variable --yes
says 'restored; _Card1RestoreCmdTargetOpcuaSPF is FALSE: certificates, users, roles and security'
logged 'restored from a backup, without the security profile, as the program says' ||
    fail "the log does not say that the program has decided"
power_cycle
chief 0 admin user list "$url"
grep -q pat out && fail "a user came back though the variable is FALSE"
# The program sets it.
one_step
chief 0 write "$url" "$(node Choice)" true
shown() { reaches read --value "$url" "$(node Shown)" && grep -q '^true$' out; }
await shown
chief 0 admin restore "$url" with_pat.backup --by-variable --yes
says 'restored; it takes effect after a restart'
step_ends
power_cycle
chief 0 admin user list "$url"
says '^pat'
# Clients never see the variable itself, and one way of saying it is enough.
chief 1 read "$url" "$(node _Card1RestoreCmdTargetOpcuaSPF)"
says Bad_NodeIdUnknown
chief 2 admin restore "$url" with_pat.backup --by-variable --without-security-profile --yes
sed -i 's/^target = "_Card1.*/target = "_Card1RestoreCmdTargetOpcua"/' controller.toml
last="another system-defined variable"
"$controller" --check --config controller.toml > out 2>&1 && fail "$last"
says "_Card1RestoreCmdTargetOpcua.*expected a variable's name"
finish
