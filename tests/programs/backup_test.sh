#!/bin/sh
# Backup, verification, restore and Clear All Memory of a machine by `busbar admin` (W588, 8-2
# and 8-3), with the restarts between them.
# usage: backup_test.sh CONTROLLER BUSBAR PROGRAM
set -u
controller=$1 busbar=$2 program=$3
here=$(cd "$(dirname "$0")" && pwd)
. "$here/functions.sh"

# as USER CODE ARGUMENTS...: all have one password.
as() {
    user=$1 wanted=$2
    shift 2
    run "$wanted" --user "$user" --password-file password --trust "$@"
}

account() {
    printf '[[users.account]]\nname = "%s"\npassword = "%s"\nroles = ["%s"]\n' "$1" "$hash" "$2"
}

restart() {
    kill "$pid"
    wait "$pid"
    serve --config controller.toml
}

add_pat() {
    sed -i 's/^\[machine\]$/[machine]\nmode = "PROGRAM"/' controller.toml
    restart
    as chief 0 admin user add "$url" pat --new-password-file password
    sed -i '/^mode = "PROGRAM"$/d' controller.toml
    restart
}

# What lies in the folder of certificates, without what comes and goes by itself.
contents() { (cd pki && find . -type f ! -path './rejected/*' -exec cksum {} + | sort -k 3); }

echo "patience is all" > password
hash=$(quick_hash password)
{
    cat << END
[server]
port = 0
[certificates]
folder = "pki"
[machine]
program = "$program"
state = "state"
medium = "medium"
[[endpoint]]
policy = "Basic256Sha256"
mode = "SignAndEncrypt"
$quick_logins
END
    account chief SecurityAdmin
    account boss ConfigureAdmin
    account engineer Engineer
} > controller.toml
serve --config controller.toml
run 0 cert create
as chief 4 admin status "$url"
mv pki/rejected/certs/* pki/trusted/certs/
as chief 0 admin cert show "$url"
own=$(sed -n 's/^own .* \([0-9A-F]*\)$/\1/p' out)
as chief 0 admin setting set "$url" limits.sessions 30

# A backup, for the administrator alone; nobody else reads it here either.
for user in boss engineer; do
    as $user 1 admin backup "$url" press.backup
    says 'SecurityAdmin'
done
as chief 0 admin backup "$url" press.backup
says 'backed up to press.backup'
[ "$(stat -c %a press.backup)" = 600 ] || fail "others may read the backup"
as chief 1 admin backup "$url" press.backup # nobody says yes
as chief 0 admin backup "$url" press.backup --yes
as chief 1 admin backup "$url" nowhere/press.backup
as chief 0 admin verify "$url" press.backup
says '^Users *none'
says_not 'settings.json'

# Any tool opens it, checks it and puts it together again.
tar tf press.backup > names || fail "tar does not list the backup"
[ "$(head -n 2 names | tr '\n' ' ')" = "SHA256SUMS manifest.json " ] || fail "it begins otherwise"
grep -q '^files/settings.json$' names || fail "the backup has no settings"
mkdir opened
tar xf press.backup -C opened || fail "tar does not unpack the backup"
(cd opened && sha256sum --quiet -c SHA256SUMS) || fail "sha256sum finds it damaged"
[ "$(stat -c %a opened/files/settings.json)" = 600 ] || fail "others may read what was unpacked"
tar --format=ustar -cf again.backup -C opened -T names
as chief 0 admin verify "$url" again.backup
ln -sf /etc/passwd opened/files/settings.json
tar --format=ustar -cf again.backup -C opened -T names
as chief 1 admin restore "$url" again.backup --yes
says 'nothing was changed'
says 'found a link'

# What was changed since; users change in PROGRAM only.
as chief 0 admin setting set "$url" limits.sessions 20
add_pat
as chief 1 admin verify "$url" press.backup
says '^Server settings *settings.json'
says '^Users *users.json'
as chief 1 --json admin verify "$url" press.backup
says '{"name":"Users","differences":\["users.json"\]}.*"isSame":false}$'
as chief 1 admin verify "$url" press.backup --without-security-profile
says_not '^Users'

# What is damaged, and what nobody is sure of, changes nothing.
contents > before
head -c 500 press.backup > damaged
as chief 1 admin restore "$url" damaged --yes
says 'nothing was changed'
says '^  backup: '
as chief 1 admin restore "$url" controller.toml --yes
as chief 1 admin restore "$url" press.backup
says 'nothing was done'
as chief 1 admin restore "$url" nowhere --yes
as boss 1 admin restore "$url" press.backup --yes
as chief 1 admin clear "$url" --yes # in RUN
says 'machine is in RUN'
as chief 1 admin clear "$url" --security --yes
contents | cmp - before || fail "something was changed"

# Restored, which counts after the restart.
as chief 0 admin restore "$url" press.backup --yes
says 'restored; .*a restart of the controller, which is due'
logged 'restored from a backup; it takes effect after a restart' || fail "the log does not say so"
restart
as chief 0 admin verify "$url" press.backup
as chief 0 admin setting list "$url" --changed
says 'limits.sessions *30 '
as chief 0 admin user list "$url"
says_not 'pat'

# Without the security profile the users are those of before.
add_pat
as chief 0 admin setting set "$url" limits.sessions 20
as chief 0 admin setting set "$url" users.passwords.needs_letters_and_digit true
printf '[Restore]\nUserProgram=yes\nOpcuaSPF=perhaps\n' > RestoreCommand.ini
as chief 2 admin restore "$url" press.backup --command RestoreCommand.ini \
    --without-security-profile --yes
as chief 1 admin restore "$url" press.backup --command RestoreCommand.ini --yes
says 'RestoreCommand.ini:3: OpcuaSPF: found perhaps'
sed -i 's/perhaps/no/' RestoreCommand.ini
as chief 0 --json admin restore "$url" press.backup --command RestoreCommand.ini --yes
says '^{"done":"restored; '
restart
as chief 0 admin verify "$url" press.backup --without-security-profile
as chief 1 admin verify "$url" press.backup
says '^Server settings *none'
says '^Security settings *security-settings.json'
as chief 0 admin setting list "$url" --changed
says 'limits.sessions *30 '
says 'users.passwords.needs_letters_and_digit *true '
as chief 0 admin user list "$url"
says 'pat'

# So is one that an earlier release made.
as chief 0 admin setting set "$url" limits.sessions 20
as chief 1 admin verify "$url" "$here/earlier.backup" --without-security-profile
says '^Server settings *settings.json'
as chief 0 admin restore "$url" "$here/earlier.backup" --without-security-profile --yes
restart
as chief 0 admin verify "$url" "$here/earlier.backup" --without-security-profile
as chief 0 admin setting list "$url" --changed
says 'limits.sessions *30 '

# A backup for others has no security profile, which stays when it is restored.
as chief 0 admin backup "$url" given.backup --without-security-profile
grep -q -a -e '"pat"' -e needs_letters given.backup && fail "the security profile is given away"
as chief 0 admin restore "$url" given.backup --yes
says 'restored; the file has no security profile: '
restart
as chief 0 admin user list "$url"
says 'pat'

# Cleared in PROGRAM mode: the settings, which has the controller in RUN again.
as chief 0 admin setting set "$url" machine.mode PROGRAM
restart
as chief 1 admin clear "$url"
says 'nothing was done'
as chief 0 admin clear "$url" --yes
says 'all memory was cleared; .*which is due'
restart
as chief 0 admin setting list "$url" --changed
says 'users.passwords.needs_letters_and_digit *true '
says_not 'limits.sessions'
as chief 0 admin user list "$url"
says 'pat'
grep -q 95D40000 state/events/events.log && fail "an event says that security was cleared"

# With security: the certificate is another one, and nobody is trusted.
as chief 0 admin setting set "$url" machine.mode PROGRAM
restart
as chief 0 admin clear "$url" --security --yes
restart
as chief 4 admin status "$url"
cleared() { grep -q 95D40000 state/events/events.log; }
await cleared
mv pki/rejected/certs/* pki/trusted/certs/
as chief 0 admin user list "$url"
says_not 'pat'
as chief 0 admin setting list "$url" --changed
says 'No settings were changed'
as chief 0 admin cert show "$url"
grep -q "$own" out && fail "the certificate of the server was not cleared"

# And back, but for the certificate.
as chief 0 admin restore "$url" press.backup --yes
says 'is due in a few seconds'
# Nobody has to do anything for the restart.
await logged '^starting again'
new_url() { url=$(sed -n '/^starting again/,$s/.* variables at \(opc.tcp:[^ ]*\)$/\1/p' log); [ -n "$url" ]; }
await new_url
as chief 0 admin verify "$url" press.backup
as chief 0 admin setting list "$url" --changed
says 'limits.sessions *30 '
as chief 0 admin cert show "$url"
grep -q "$own" out && fail "a backup has the certificate of the server"
exit $((failures > 0))
