#!/bin/sh
# A unit takes the place of another one: program, settings of files too, values of RETAIN variables,
# users, roles and certificates come with a backup, but not the certificate of the server (seed 000,
# 8-2-1, 8-2-2 and 8-2-4). After each step the power goes.
# usage: backup_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/../functions.sh"

says() { grep -q -s -e "$1" out || fail "\"$1\" is not in the output of: $last"; }
as() {
    who=$1 wanted=$2
    shift 2
    run "$wanted" --user "$who" --password-file password --trust "$@"
}
value() {
    as chief 0 read --value "$url" "nsu=urn:busbar:machine;s=$1"
    says "^$2\$"
}
power_cycle() {
    kill -9 "$pid"
    wait "$pid" 2> /dev/null
    serve --config "$1/controller.toml"
}

echo "patience is all" > password
hash=$(quick_hash password)
port=$((20000 + $$ % 12000))
# unit NAME PORT MORE: its configuration; each has an administrator of its own file.
unit() {
    mkdir "$1"
    cat > "$1/controller.toml" << END
[server]
port = $2
[certificates]
folder = "$1/pki"
[[endpoint]]
policy = "Basic256Sha256"
mode = "SignAndEncrypt"
$quick_logins
[[users.account]]
name = "chief"
password = "$hash"
roles = ["SecurityAdmin", "ConfigureAdmin", "Operator"]
[machine]
program = "$1/press.st"
state = "$1/state"
medium = "$1/medium"
retained_ms = 100
$3
END
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
trusted() {
    as chief 4 admin status "$url"
    mv "$1"/pki/rejected/certs/* "$1/pki/trusted/certs/"
}

unit first $port 'name = "Press 4"
execution_log = true
execution_log_records = 100'
unit second $((port + 1)) 'execution_log_files = 7'
program first/press.st 17
program second/press.st 99

run 0 cert create
serve --config first/controller.toml
trusted first
as chief 0 admin setting set "$url" limits.sessions 30
as chief 0 admin mode "$url" program --yes
as chief 0 admin user add "$url" pat --new-password-file password
as chief 0 admin role grant "$url" pat Operator
program sent.st 18
as chief 0 admin program download "$url" sent.st --yes
await logged 'downloaded: sent.st'
as chief 0 admin mode "$url" run --yes
as chief 0 write "$url" "nsu=urn:busbar:machine;s=Total" 77
is_saved() { as chief 0 read --value "$url" "nsu=urn:busbar:machine;s=Total"; grep -q '^77$' out; }
await is_saved
power_cycle first
as chief 0 write "$url" "nsu=urn:busbar:machine;s=Total" 78
is_saved() { as chief 0 read --value "$url" "nsu=urn:busbar:machine;s=Total"; grep -q '^78$' out; }
await is_saved
as chief 0 admin cert show "$url"
own=$(sed -n 's/^own .* \([0-9A-F]*\)$/\1/p' out)
as chief 0 admin backup "$url" press.backup
as chief 0 admin verify "$url" press.backup
says '^Program *none'
power_cycle first
as chief 0 admin verify "$url" press.backup
kill -9 "$pid"
wait "$pid" 2> /dev/null

# The other unit, with another file.
serve --config second/controller.toml
trusted second
value Speed 99
as chief 1 admin verify "$url" press.backup
says '^Server settings *settings.json'
says '^Program *program.received'
head -c 900 press.backup > damaged
as chief 1 admin restore "$url" damaged --yes
says 'nothing was changed: backup: '
power_cycle second
value Speed 99
as chief 0 admin restore "$url" press.backup --yes
says 'restored'
power_cycle second
[ "${url##*:}" = $port ] || fail "it does not listen where the first one did: $url"
as chief 0 admin verify "$url" press.backup
as chief 0 admin setting list "$url" machine. limits.sessions
says 'machine.execution_log_records *100 '
says 'machine.execution_log_files *24 '
says 'machine.name *"Press 4"'
says 'limits.sessions *30 '
as chief 0 admin program show "$url"
says 'sent.st'
value Speed 18
value Total 78
as pat 0 read --value "$url" i=2259
as chief 0 admin cert show "$url"
grep -q "$own" out && fail "a backup has the certificate of the server"
as chief 0 admin program restore "$url" --yes
power_cycle second
value Speed 99
value Total 78

# Clear All Memory: program and settings of the unit's own file, and values as declared.
as chief 0 admin mode "$url" program --yes
as chief 0 admin clear "$url" --yes
power_cycle second
[ "${url##*:}" = $((port + 1)) ] || fail "it does not listen where its file says: $url"
value Total 5
as chief 0 admin setting list "$url" machine.execution_log_files
says 'machine.execution_log_files *7$'
kill "$pid"
await ended
exit $((failures > 0))
