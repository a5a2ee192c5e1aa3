#!/bin/sh
# A unit takes the place of another one: program, settings of files too, values of RETAIN variables,
# users, roles and certificates come with a backup, but not the certificate of the server (W588,
# 8-2-1, 8-2-2 and 8-2-4). After each step the power goes.
# usage: backup_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"

# unit NAME PORT MORE: its configuration; each has an administrator of its own file.
unit() {
    mkdir "$1"
    {
        server "$2" "$1/pki"
        printf '[machine]\nprogram = "%s/press.st"\nstate = "%s/state"\n' "$1" "$1"
        printf 'medium = "%s/medium"\nretained_ms = 100\n%s\n' "$1" "$3"
    } > "$1/controller.toml"
}
program() {
    cat > "$1" << END
{attribute 'publish' := 'publish only'}
VAR_GLOBAL
    Speed : INT := $2;
END_VAR
{attribute 'publish' := 'publish only'}
VAR_GLOBAL RETAIN
    Total : DINT := 5;
END_VAR
END
}

unit first "$port" 'name = "Press 4"
execution_log = true
execution_log_records = 100'
unit second $((port + 1)) 'execution_log_files = 7'
program first/press.st 17
program second/press.st 99

entry variables 8-2: backup, restore, verify
begin first/pki --config first/controller.toml
chief 0 admin setting set "$url" limits.sessions 30
chief 0 admin mode "$url" program --yes
chief 0 admin user add "$url" pat --new-password-file password
chief 0 admin role grant "$url" pat Operator
program sent.st 18
chief 0 admin program download "$url" sent.st --yes
await logged 'downloaded: sent.st'
chief 0 admin mode "$url" run --yes
chief 0 write "$url" "nsu=urn:busbar:machine;s=Total" 77
is_saved() { chief 0 read --value "$url" "nsu=urn:busbar:machine;s=Total"; grep -q '^77$' out; }
await is_saved
power_cycle
chief 0 write "$url" "nsu=urn:busbar:machine;s=Total" 78
is_saved() { chief 0 read --value "$url" "nsu=urn:busbar:machine;s=Total"; grep -q '^78$' out; }
await is_saved
chief 0 admin cert show "$url"
own=$(sed -n 's/^own .* \([0-9A-F]*\)$/\1/p' out)
chief 0 admin backup "$url" press.backup
chief 0 admin verify "$url" press.backup
says '^Program *none'
power_cycle
chief 0 admin verify "$url" press.backup
power_cut

# The other unit, with another file.
begin second/pki --config second/controller.toml
value Speed 99
chief 1 admin verify "$url" press.backup
says '^Server settings *settings.json'
says '^Program *program.received'
head -c 900 press.backup > damaged
chief 1 admin restore "$url" damaged --yes
says 'nothing was changed'
says '^  backup: '
power_cycle
value Speed 99
# By a command file of the card that leaves the security profile out: this unit's users stay.
printf '[Restore]\nUserProgram=yes\nOpcuaSPF=no\n' > RestoreCommand.ini
chief 0 admin restore "$url" press.backup --command RestoreCommand.ini --yes
power_cycle
value Speed 18
as pat 4 read --value "$url" i=2259
chief 1 admin verify "$url" press.backup
says '^Server settings *none'
says '^Users *users.json'
chief 0 admin verify "$url" press.backup --without-security-profile
# With it.
records=$(cat second/medium/packages/OPCUA_Server/ExecutionLog/*.log 2> /dev/null | wc -l)
chief 0 admin restore "$url" press.backup --yes
says 'restored'
power_cycle
[ "$(cat second/medium/packages/OPCUA_Server/ExecutionLog/*.log 2> /dev/null | wc -l)" -ge "$records" ] ||
    fail "a restore takes the execution log"
[ "${url##*:}" = $port ] || fail "it does not listen where the first one did: $url"
chief 0 admin verify "$url" press.backup
chief 0 admin setting list "$url" machine. limits.sessions
says 'machine.execution_log_records *100 '
says 'machine.execution_log_files *24 '
says 'machine.name *"Press 4"'
says 'limits.sessions *30 '
chief 0 admin program show "$url"
says 'sent.st'
value Speed 18
value Total 78
as pat 0 read --value "$url" i=2259
chief 0 admin cert show "$url"
grep -q "$own" out && fail "a backup has the certificate of the server"
chief 0 admin program restore "$url" --yes
power_cycle
value Speed 99
value Total 78

# What the backup says counts, though the file says otherwise by now and nobody has read that.
cp second/controller.toml before.toml
printf '[plc]\nscan_ms = 40\n' >> second/controller.toml
power_cycle
chief 0 admin mode "$url" program --yes
chief 0 admin backup "$url" forty.backup
one_step
sed -i 's/scan_ms = 40/scan_ms = 50/' second/controller.toml
chief 0 admin restore "$url" forty.backup --yes
says 'restored'
step_ends
power_cycle
chief 0 admin setting list "$url" plc.scan_ms
says 'plc.scan_ms *40 '
cp before.toml second/controller.toml
power_cycle
chief 0 admin mode "$url" run --yes

entry variables 8-3: clear
# Only in PROGRAM; without the security profile users, certificates and the logs stay, and it is the
# program and the settings of the unit's own file again, and values as declared.
chief 1 admin clear "$url" --yes
says 'the machine is in RUN, where its memory is not cleared'
chief 0 admin mode "$url" program --yes
chief 0 admin cert show "$url"
own=$(sed -n 's/^own .* \([0-9A-F]*\)$/\1/p' out)
one_step
chief 0 admin clear "$url" --yes
says 'all memory was cleared; it takes effect after a restart of the controller, which is due'
again() { [ "$(grep -c '^ready' log)" -ge "$1" ]; }
await again 2 # it is reset in the same dialogue
step_ends
power_cycle
[ "${url##*:}" = $((port + 1)) ] || fail "it does not listen where its file says: $url"
value Total 5
chief 0 admin setting list "$url" machine.execution_log_files
says 'machine.execution_log_files *7$'
chief 0 admin cert show "$url"
says "$own"
as pat 0 read --value "$url" i=2259
chief 0 admin events "$url" --code 95D00000
says '95D00000'
# With it: another certificate, and nobody is trusted or known but the file's own account.
chief 0 admin mode "$url" program --yes
one_step
chief 0 admin clear "$url" --security --yes
says 'trusts no client: .*`busbar admin setup`'
await again 2
run 4 --user chief --password-file password --trust admin status "$url"
mv second/pki/rejected/certs/* second/pki/trusted/certs/
run 0 --user chief --password-file password --trust admin cert show "$url"
grep -q "$own" out && fail "the certificate of the server was not cleared"
as pat 4 read --value "$url" i=2259
chief 0 admin events "$url" --code 95D40000
says '95D40000 OPC UA Server Certificate and Security Profile Cleared'
made=$(sed -n '/95D40000/,$p' second/state/events/events.log | grep -c 95D20000)
[ "$made" -eq 1 ] || fail "$made events of a new certificate after a clear"
step_ends
shut_down
finish
