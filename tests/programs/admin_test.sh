#!/bin/sh
# Administers a controller that runs by `busbar admin`, from an account in its file to a stopped
# server.
# usage: admin_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"


as_admin() {
    wanted=$1
    shift
    run "$wanted" --user chief --password-file chief --trust "$@"
}

echo "the chief's pass phrase" > chief
echo "patience is all" > pat
hash=$(quick_hash chief)
cat > controller.toml << EOF
[server]
port = 0
auditing = true
[certificates]
folder = "pki"
[[endpoint]]
policy = "Basic256Sha256"
mode = "SignAndEncrypt"
$quick_logins
[[users.account]]
name = "chief"
password = "$hash"
roles = ["SecurityAdmin", "ConfigureAdmin"]
[[files]]
name = "recipes"
folder = "recipes"
EOF
serve --config controller.toml

# Our certificate is nobody's friend yet.
run 0 cert create
as_admin 4 admin status "$url"

mv pki/rejected/certs/* pki/trusted/certs/

as_admin 0 admin status "$url"
says "Running"
as_admin 0 admin cert show "$url"
says "own"
before=$(sed -n 's/^own .* \([0-9A-F]*\)$/\1/p' out)
says "^Thumbprint:  *$before\$"
as_admin 0 admin cert export "$url"
run 0 cert show ServerCertificate.der
says "^Thumbprint:  *$before\$"
as_admin 2 admin cert export "$url" one two

# A user, with a role and without.
as_admin 0 admin user add "$url" pat --new-password-file pat --description "of the night shift"
as_admin 1 admin user add "$url" pat --new-password-file pat
says "Bad_AlreadyExists"
as_admin 0 admin user list "$url"
says "pat .*of the night shift"
says "chief .*cannot be removed, password is fixed .*of the configuration file"
as_admin 1 admin user remove "$url" chief --yes
as_admin 0 admin user add "$url" sam --new-password-file pat
as_admin 0 admin role grant "$url" sam SecurityAdmin
run 1 --user sam --password-file pat --trust admin user remove "$url" chief --yes
says "Bad_NotSupported"
says "those of the configuration"
run 1 --user sam --password-file pat --trust admin user add "$url" chief --new-password-file pat
says "Bad_AlreadyExists"
run 1 --user sam --password-file pat --trust admin role revoke "$url" chief SecurityAdmin
says "Bad_RequestNotAllowed"
as_admin 0 admin user remove "$url" sam --yes
as_admin 0 admin role revoke "$url" sam SecurityAdmin
run 4 --user pat --password-file pat --trust admin user list "$url"
as_admin 0 admin role grant "$url" pat SecurityAdmin
as_admin 0 admin role list "$url"
says "SecurityAdmin .*user chief (of the file), user pat"
run 0 --user pat --password-file pat --trust admin user list "$url"
as_admin 0 admin role revoke "$url" pat SecurityAdmin # the last rule: chief is one by the file
run 4 --user pat --password-file pat --trust admin user list "$url"
as_admin 0 admin user disable "$url" pat
run 4 --user pat --password-file pat --trust read "$url" i=2259
as_admin 0 admin user enable "$url" pat
run 0 --user pat --password-file pat --trust read "$url" i=2259

# Who did what, to the screen of an administrator and to nobody else's.
follow() {
    timeout 60 "$busbar" --user chief --password-file chief --trust "$@" > audit 2>&1 &
    follower=$!
}
strangers=0
refused() { # a stranger of its own each time: nobody may guess for ever
    strangers=$((strangers + 1))
    run 4 --user stranger$strangers --password-file pat --trust read "$url" i=2259
    sleep 0.1 # or there would be many of them until the first event arrives
    grep -q -s -e "$1" audit
}
follow admin audit "$url" --count 6
await refused 'ActivateSession .* no .*Bad_'
await refused 'OpenSecureChannel .* yes'
for _ in 1 2; do refused x; done # or it would wait for more
wait "$follower" || fail "the one who follows ends with $?"
[ "$(wc -l < audit)" -eq 7 ] || fail "there are not a title and six events: $(cat audit)"
follow --json admin audit "$url" --count 1
await refused '"EventType":.*"ClientUserId":.*"SessionId":.*"StatusCodeId":'
wait "$follower" || fail "the one who follows ends with $?"
run 4 --user pat --password-file pat --trust admin audit "$url" --duration 5
says "this user may not receive audit events"

as_admin 1 admin user remove "$url" pat # nobody says yes
as_admin 0 admin user remove "$url" pat --yes
as_admin 0 --json admin user list "$url"
says '^\[{"name":"chief",.*"description":"of the configuration file"}\]$'

# Settings, in force at once or after a restart; the file stays as the user wrote it.
cp controller.toml before.toml
as_admin 0 admin setting set "$url" limits.sessions 20 plc.scan_ms 50 server.name "Press 4"
says "wait for a restart: plc.scan_ms"
as_admin 0 admin setting list "$url" --changed
says "limits.sessions *20 .*changed"
as_admin 1 admin setting set "$url" limits.sessions 21 plc.scan_ms 0
as_admin 0 --json admin setting list "$url" limits.sessions plc.scan_ms
says '"name":"limits.sessions","value":"20","default":"100","low":1,"high":100000'
says '"name":"plc.scan_ms","value":"50","default":"20".*"isChanged":true,"waitsForRestart":true'
run 4 --user pat --password-file pat --trust admin setting list "$url"
as_admin 0 admin setting reset "$url" plc.scan_ms
cmp -s before.toml controller.toml || fail "the user's file was written"

# Files, there and back, larger than one call carries.
as_admin 0 admin file list "$url"
says "recipes/"
head -c 100000 "$controller" > program
as_admin 0 admin file mkdir "$url" recipes/press
as_admin 0 admin file put "$url" program recipes/press/4.bin
cmp -s program recipes/press/4.bin || fail "the server's file is another one"
as_admin 0 admin file list "$url" recipes/press
says "4.bin *100000"
as_admin 0 admin file get "$url" recipes/press/4.bin back
cmp -s program back || fail "what came back is another one"
as_admin 1 admin file get "$url" recipes/press/4.bin back # nobody says yes
as_admin 1 admin file put "$url" chief recipes/press/4.bin
as_admin 0 admin file put "$url" chief recipes/press/4.bin --yes
cmp -s chief recipes/press/4.bin || fail "it was not replaced"
as_admin 0 admin file move "$url" recipes/press/4.bin recipes/Delete
as_admin 1 admin file put "$url" chief recipes/../chief
as_admin 2 admin file put "$url" chief nothing
as_admin 0 admin file remove "$url" recipes/Delete --yes
as_admin 0 admin file remove "$url" recipes/press --yes
[ -z "$(ls recipes)" ] || fail "there are files left"
run 4 --user pat --password-file pat --trust admin file get "$url" recipes/x x

# A stranger, who was rejected and is trusted.
run 0 --pki other cert create
run 4 --pki other --user chief --password-file chief --trust admin status "$url"
as_admin 0 --json admin trust list "$url"
stranger=$(sed 's/.*"list":"rejected"[^}]*"thumbprint":"\([0-9A-F]*\)".*/\1/' out)
as_admin 0 admin trust move "$url" "$stranger"
run 0 --pki other --user chief --password-file chief --trust admin status "$url"
as_admin 0 admin trust export "$url" "$stranger" stranger.der
as_admin 0 admin trust export "$url" twin.der "$stranger"
cmp -s stranger.der twin.der || fail "the order of FILE and THUMBPRINT matters"
run 0 cert show stranger.der
says "$stranger"
run 2 cert show chief
as_admin 0 admin trust remove "$url" "$stranger" --yes
as_admin 1 admin trust remove "$url" "$stranger" --yes
run 4 --pki other --user chief --password-file chief --trust admin status "$url"
as_admin 1 admin trust add "$url" stranger.der # it is among the rejected ones, and is moved
says "has rejected it: $stranger"
says "trust move $stranger"
as_admin 0 admin trust remove "$url" "$stranger" --yes
as_admin 0 --json admin trust list "$url"
says_not "$stranger"
as_admin 0 admin trust add "$url" stranger.der
as_admin 1 admin trust add "$url" stranger.der
says "among the trusted ones already"
as_admin 0 admin trust show "$url" "$stranger"
for line in 'List:  *trusted' 'Version:  *3' 'Serial: ' 'Signature:  *sha256' 'Key:  *RSA, 2048' \
    'Public key:  *30' 'Extension:  *X509v3 Subject Key Identifier: '; do
    says "^$line"
done

# A CA and its revocation list, of which there is one at a time.
if command -v openssl > /dev/null; then
    new_key ca.key
    openssl req -x509 -key ca.key -out ca.pem -days 30 \
        -subj "/CN=Works CA" -addext "keyUsage=critical,keyCertSign,cRLSign" 2> /dev/null
    printf '[ca]\ndefault_ca = d\n[d]\ndatabase = index\ndefault_md = sha256\n' > ca.cnf
    : > index
    for days in 20 25; do
        openssl ca -config ca.cnf -gencrl -crldays $days -keyfile ca.key -cert ca.pem \
            -out ca$days.crl 2> /dev/null
    done
    as_admin 1 admin trust add "$url" ca20.crl
    says "add its issuer first"
    as_admin 0 admin trust add "$url" ca.pem ca20.crl --issuer
    as_admin 0 admin trust add "$url" ca25.crl
    as_admin 0 admin trust list "$url"
    says "^issuers .*Works CA"
    says "^issuers crl .*Works CA .*0 revoked"
    [ "$(grep -c '^issuers crl' out)" -eq 1 ] || fail "there are two revocation lists of one CA"
    crl=$(sed -n 's/^issuers crl .* \([0-9A-F]*\)$/\1/p' out)
    as_admin 0 admin trust show "$url" "$crl"
    says '^Issuer:  *CN=Works CA'
    as_admin 0 admin trust export "$url" back.crl "$crl"
    openssl crl -in ca25.crl -outform DER -out ca25.der
    cmp -s ca25.der back.crl || fail "the exported revocation list is another one"
    as_admin 1 admin trust remove "$url" "$crl" # nobody says yes
    as_admin 0 admin trust remove "$url" "$crl" --yes
    as_admin 0 admin trust list "$url"
    grep -q "^issuers crl" out && fail "the revocation list is there still"
    ca=$(sed -n 's/^issuers .* \([0-9A-F]*\)$/\1/p' out)
    as_admin 0 admin trust remove "$url" "$ca" --yes
    # Of several files one is wrong: none is taken.
    as_admin 1 admin trust add "$url" ca.pem stranger.der
    as_admin 2 admin trust add "$url" ca.pem chief
    as_admin 0 admin trust list "$url"
    says_not "Works CA"
fi

# Another certificate, while it runs. It names what we connect to, or we would refuse it.
host=${url#opc.tcp://}
host=${host%:*}
as_admin 0 admin cert regenerate "$url" --subject "CN=Press 4/O=Works" --days 365 \
    --host "$host" --host press-4.example --yes
await ends_with 4 --user chief --password-file chief admin cert show "$url" # nobody trusts it yet
as_admin 0 admin cert show "$url"
says "Press 4"
grep -q -e "$before" out && fail "the certificate is the old one"
# The next one has the subject of the one before, and lasts for twenty years.
as_admin 0 admin cert regenerate "$url" --subject "CN=Press 4@192.0.2.50/O=Works/L=Kyoto/C=JP" \
    --days 365 --host 192.0.2.50 --host "$host" --yes
await ends_with 4 --user chief --password-file chief admin cert show "$url"
as_admin 1 admin cert regenerate "$url" --subject "CN=X/C=DEU" --yes
says 'expected two letters'
as_admin 0 admin cert regenerate "$url" --host 192.0.2.51 --host "$host" --yes
await ends_with 4 --user chief --password-file chief admin cert show "$url"
as_admin 0 --json admin cert show "$url"
says 'CN=Press 4@192.0.2.51'
says 'L=Kyoto'
says 'C=JP'
years=$(($(sed -n 's/.*"valid[A-Za-z]*":"\([0-9]*\)-.*"valid[A-Za-z]*":"\([0-9]*\)-.*/\2 - \1/p' out)))
[ "$years" -eq 20 ] || fail "the certificate is for $years years: $(cat out)"
as_admin 0 admin cert request "$url" request.der
[ -s request.der ] || fail "there is no request"

as_admin 0 admin shutdown "$url" --seconds 1 --reason "maintenance" --yes
await ended && wait "$pid" || fail "the controller ends with $?"
pid=""
logged "maintenance" || fail "the log does not say why"

# What was changed outlives it, until somebody forgets it.
serve --config controller.toml
as_admin 0 admin setting list "$url" --changed
says "Press 4"
# A change that would let it serve no more is refused.
as_admin 1 admin setting set "$url" server.address 203.0.113.9
says 'cannot listen on 0 of 203.0.113.9'
kill "$pid" && wait "$pid"
"$controller" --config controller.toml --forget-changes || fail "nothing is forgotten"
serve --config controller.toml
as_admin 0 admin setting list "$url" --changed
says "No settings were changed"
kill "$pid" && wait "$pid"
pid=""

# A controller that nobody administers yet: whoever knows the code it prints makes the first
# administrator, from any client, and then it is over.
cat > new.toml << EOF
[server]
port = 0
[certificates]
folder = "new"
[[endpoint]]
policy = "Basic256Sha256"
mode = "SignAndEncrypt"
[limits]
first_login_delay_ms = 0
max_login_delay_ms = 0
[users]
setup = true
EOF
serve --config new.toml
sed -n 's/.*with the code \([^,]*\),.*/\1/p' log > code
[ -s code ] || fail "there is no code"
kill "$pid" && wait "$pid"
serve --config new.toml
logged 'with the code' && fail "the code is shown again"
grep -q -r -F -e "$(cat code)" new && fail "the code is kept"
run 4 --user setup --password-file chief --trust admin status "$url"
run 0 --user setup --password-file code --trust admin status "$url"
# One that was cut short after the user was added can be run again.
run 1 --user setup --password-file code --trust admin user add "$url" "$(printf %0300d 0)" --new-password-file chief
says 'user name rules'
run 0 --user setup --password-file code --trust admin user add "$url" chief --new-password-file pat
run 0 --user setup --password-file code --trust admin setup "$url" chief --new-password-file chief
await logged 'the setup is over'
await ends_with 4 --user setup --password-file code --trust admin status "$url"
as_admin 0 admin user list "$url"
says "chief"
run 4 --pki third --user chief --password-file chief --trust admin status "$url"
as_admin 0 admin shutdown "$url" --seconds 0 --yes
await ended && wait "$pid" || fail "the controller ends with $?"
serve --config new.toml
as_admin 0 admin status "$url"
run 4 --user setup --password-file code --trust admin status "$url"

# Everything is as on the first day: another certificate, another code, nobody trusted.
as_admin 1 admin reset "$url"
says "nothing was done"
thumbprint() { sed -n 's/.*own certificate .*, \([0-9A-F]*\): .*/\1/p' log | tail -n 1; }
before=$(thumbprint)
as_admin 0 admin reset "$url" --yes
says 'starts again'
told_ready() { [ "$(grep -c '^ready' log)" -eq "$1" ]; }
await told_ready 2
logged 'with the code' || fail "there is no new code"
url=$(sed -n 's/.* variables at \(opc.tcp:[^ ]*\)$/\1/p' log | tail -n 1)
[ -e new/users.json ] && fail "the users are not forgotten"
[ -z "$(find new/trusted -type f)" ] || fail "certificates are not forgotten"
[ "$(thumbprint)" != "$before" ] || fail "the certificate is the one before"
as_admin 4 admin status "$url"
# It can be set up again, without anybody at the machine but who reads the code.
sed -n 's/.*with the code \([^,]*\),.*/\1/p' log > code
run 0 --user setup --password-file code --trust admin setup "$url" chief --new-password-file chief
await logged 'the setup is over'
as_admin 0 admin status "$url"
exit $((failures > 0))
