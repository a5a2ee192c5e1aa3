#!/bin/sh
# Whatever an administrator is refused, the answer says why, and busbar prints it.
# usage: reasons_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"

# refused WHY: the last command was, for this reason, and for nothing that says less.
refused() {
    says "$1"
    says_not 'refuses an argument and does not say which'
    says_not 'the value is too large or too small'
}
# add NAME: a user.
add() { chief 1 admin user add "$url" "$1" --new-password-file password; }

{
    server "$port" pki
    account operator '"Operator"'
    machine 'mode = "PROGRAM"'
} | sed 's/^\[limits\]$/[limits]\npreset = "nj501"/' > controller.toml
press 0 > press.st
begin pki --config controller.toml
echo "Patience123" > good
one_step # what is refused changes nothing

# Names and passwords of users: their rules.
echo "Short1" > short
chief 1 admin user add "$url" night --new-password-file short
refused 'password rules: it must have 8 to 32 characters'
echo "Patience 123" > spaced
chief 1 admin user add "$url" night --new-password-file spaced
refused 'password rules: it has characters other than A to Z, a to z and 0 to 9'
for name in pat "pat of the night shift" observer chief; do
    chief 1 admin user add "$url" "$name" --new-password-file good
    case "$name" in
        pat) refused 'user name rules: "pat" must have 4 to 32 characters' ;;
        observer) refused 'user name rules: "observer" is a reserved name' ;;
        chief) refused 'user "chief" already exists' ;;
        *) refused 'user name rules: "pat of the night shift" has characters other than' ;;
    esac
done
chief 1 admin user remove "$url" nobody --yes
refused 'user "nobody"'
# Which limit is reached.
for i in $(seq 10 29); do
    chief 0 admin user add "$url" "user$i" --new-password-file good
done
chief 1 admin user add "$url" user30 --new-password-file good
refused 'would exceed the limit of 20'
chief 1 admin role grant "$url" user10 Nothing
for i in $(seq 2 33); do
    run 0 --pki "pki$i" cert create
    cp "pki$i"/own/certs/* "c$i.der"
done
for i in $(seq 2 32); do
    chief 0 admin trust add "$url" "c$i.der"
done
chief 1 admin trust add "$url" c33.der
refused 'trusted is full: its limit is 32 certificates'

# The fields of a subject.
chief 1 admin cert regenerate "$url" --subject "CN=X/O=Bad#Org/C=DEU" --yes
refused 'C is "DEU", expected two letters'
chief 1 admin cert regenerate "$url" --subject "CN=X/XX=Y" --yes
refused 'found "XX", expected one of CN, O, OU'

# Settings, by the command and by a Write.
chief 1 admin setting set "$url" limits.sessions 0
refused 'limits.sessions: found 0, expected 1 to'
chief 1 write "$url" "ns=1;s=Settings.limits.sessions" 0
refused 'limits.sessions: found 0, expected 1 to'
chief 1 write "$url" "ns=1;s=Settings.limits.sessions" 0 "ns=1;s=Settings.server.port" 4841
refused 'limits.sessions: found 0, expected 1 to'
chief 1 --json write "$url" "ns=1;s=Settings.limits.sessions" 0
says '"reason":"limits.sessions: found 0'

# Programs and backups.
printf 'VAR_GLOBAL\n    Speed : WRONG;\nEND_VAR\n' > wrong.st
chief 1 admin program download "$url" wrong.st --yes
refused 'wrong.st:2:'
chief 1 admin restore "$url" wrong.st --yes
refused 'backup: is cut or not a backup file: expected a tar'
chief 1 admin shutdown "$url" --reason "$(printf '%300s' | tr ' ' x)" --yes
refused 'a reason of 300 bytes, expected at most 256'

# Who does not administer learns no more than before.
as operator 4 write "$url" "ns=1;s=Settings.limits.sessions" 5
says_not 'reason'
step_ends

# What wants PROGRAM.
chief 0 admin mode "$url" run --yes
chief 1 admin clear "$url" --yes
refused 'the machine is in RUN, where its memory is not cleared'
chief 1 admin user add "$url" night --new-password-file good
refused 'cannot change while the machine is in RUN'
chief 1 admin setting set "$url" server.port 4841
refused 'cannot change while the machine is in RUN'
finish
