#!/bin/sh
# The certificate of the server and those of its clients: made, shown, exported, made again,
# trusted, moved, removed, refused, and told when they expire (W588, 3-2-4, 3-2-5 and 5-1-1).
# usage: trust_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
. "$here/certificates.sh"

{
    server "$port" pki | sed 's/^\[limits\]/[limits]\npreset = "nj501"/'
    machine
} > controller.toml
press 17 > press.st

entry variables 3-2-4: automatic certificate
[ -e pki ] && fail "there is a certificate already"
begin pki --config controller.toml
chief 0 admin cert show "$url"
names='CN=NxOpcUaServer@127.0.0.1, O=Omron Corporation, L=Kyoto, ST=Kyoto, C=JP'
says "^Subject:  *$names\$"
says "^Issuer:  *$names\$"
years() {
    sed -n 's/^Valid [a-z]*:  *\(20[0-9]*\)-\(..-..\).*/\1 \2/p' out |
        awk 'NR == 1 { from = $1 } END { print $1 - from }'
}
[ "$(years)" -eq 20 ] || fail "it lasts for $(years) years"
first=$(sed -n 's/^Thumbprint: *//p' out)
server_uri=$(sed -n 's/^Application: *//p' out)

entry variables 3-2-5: own certificate shown
for fact in 'Version:  *3' 'Serial:  *[0-9A-F]\{16,\}' 'Valid from:  *20[0-9-]*T[0-9:]*Z' \
    'Valid to:  *20[0-9-]*T[0-9:]*Z' 'Key:  *RSA, 2048 bits' 'Public key:  *[0-9A-F]\{16\} [0-9A-F]\{16\} ' \
    'Signature:  *sha256WithRSAEncryption' 'Hosts:  *.*127.0.0.1' 'Thumbprint:  *[0-9A-F]\{40\}'; do
    says "^$fact"
done
chief 0 --json admin cert show "$url"
says '"commonName":"NxOpcUaServer@127.0.0.1"'

entry variables 3-2-5: own certificate updated and exported
chief 0 admin cert export "$url"
[ -s ServerCertificate.der ] || fail "there is no ServerCertificate.der"
chief 0 admin cert export "$url" other.der
cmp -s ServerCertificate.der other.der || fail "two exports differ"
run 0 cert show other.der
says "^Thumbprint:  *$first\$"
# A client that trusts what was exported connects.
application
client known
cp known.der pki/trusted/certs/
read_as_known() {
    run "$1" --pki known.pki --user chief --password-file password read "$url" i=2259
}
read_as_known 4
run 0 --pki known.pki cert trust ServerCertificate.der
read_as_known 0

entry variables 3-2-5: own certificate regenerated
chief 0 admin cert regenerate "$url" --days 730 --yes \
    --subject 'CN=NxOpcUaServer@127.0.0.1/O="Works (4), A/B"/OU=Line_4/L=Linz/S=O.-Oe./C=AT'
await has_records "CERT 0001 Update_Server NxOpcUaServer@127.0.0.1 20[0-9T:.-]*Z" 2
chief 0 admin cert show "$url"
says 'O="Works (4), A/B"'
says 'OU=Line_4, L=Linz, ST=O.-Oe., C=AT'
[ "$(years)" -eq 2 ] || fail "it lasts for $(years) years instead of 2"
says_not "$first"
second=$(sed -n 's/^Thumbprint: *//p' out)
# By default it is made of what is shown, for twenty years; what cannot be is refused.
chief 0 admin cert regenerate "$url" --yes
chief 0 admin cert show "$url"
says 'OU=Line_4, L=Linz, ST=O.-Oe., C=AT'
[ "$(years)" -eq 20 ] || fail "it lasts for $(years) years instead of 20"
says_not "$second"
chief 1 admin cert regenerate "$url" --yes --subject 'CN=X/O=Bad#Org/C=DEU'
says 'expected two letters'
chief 2 admin cert regenerate "$url" --yes --days 7306
chief 1 admin cert regenerate "$url"
says 'nothing was done'
# Clients do not know it until they trust it again.
read_as_known 4
chief 0 admin cert export "$url"
run 0 --pki known.pki cert trust ServerCertificate.der
read_as_known 0
rm pki/trusted/certs/known.der

client zeta
client alpha '' 60
client third '' 40


entry variables 3-2-5: rejected automatically
client nobody
is_refused nobody BadCertificateUntrusted
chief 0 admin trust list "$url"
says '^rejected  *nobody  *Works of nobody '
chief 0 admin trust remove "$url" "$(thumbprint_of nobody.pem)" --yes

entry variables 3-2-5: add
chief 0 admin trust add "$url" zeta.der
await has_records 'CERT 0100 Add zeta 20[0-9T:.-]*Z CLIENT TRUSTED$' 1
chief 0 admin trust add "$url" alpha.pem third.der
await has_records 'CERT 0100 Add alpha .* CLIENT TRUSTED$' 1
is_let_in zeta
chief 1 admin trust add "$url" zeta.der
says 'zeta.der: the server has it among the trusted ones already'
chief 1 admin trust add "$url" third.pem zeta.der
echo "no certificate" > nothing.der
chief 2 admin trust add "$url" nothing.der
says 'nothing.der: neither a certificate nor a revocation list'
chief 1 admin trust add "$url" missing.der
says 'missing.der'

entry variables 3-2-5: trusted list
names_shown() { sed -n 's/^trusted  *\([a-z]*\)  .*/\1/p' out | tr '\n' ' '; }
for order in 'name:alpha busbar third zeta' 'validity:zeta third alpha busbar' \
    'organization:busbar alpha third zeta'; do
    chief 0 admin trust list "$url" --sort "${order%%:*}"
    shown=$(names_shown)
    [ "$shown" = "${order#*:} " ] || fail "by ${order%%:*}: $shown"
done
chief 0 admin trust list "$url" --descending
[ "$(names_shown)" = 'zeta third busbar alpha ' ] || fail "descending: $(names_shown)"
says '^LIST  *COMMON NAME  *ORGANIZATION  *DOMAIN  *VALID TO  *THUMBPRINT$'
says '^trusted  *zeta  *Works of zeta  *zeta.example  *20[0-9-]*  *[0-9A-F]\{40\}$'

entry variables 3-2-5: delete, move, details
zeta=$(thumbprint_of zeta.pem)
chief 0 admin trust show "$url" "$zeta"
says '^List:  *trusted$'
says '^Subject:  *O=Works of zeta, CN=zeta$'
says '^Serial: '
chief 0 admin trust export "$url" back.der "$zeta"
cmp -s back.der zeta.der || fail "the exported certificate is another one"
chief 1 admin trust remove "$url" "$zeta"
says 'nothing was done'
chief 0 admin trust remove "$url" "$zeta" --yes
await has_records 'CERT 0101 Delete zeta .* CLIENT TRUSTED$' 1
is_refused zeta BadCertificateUntrusted
chief 0 admin trust list "$url"
says '^rejected  *zeta '
chief 1 admin trust add "$url" zeta.der
says 'the server has rejected it'
says "admin trust move $zeta"
chief 0 admin trust move "$url" "$zeta"
await has_records 'CERT 0102 Move zeta .* CLIENT REJECTED->TRUSTED$' 1
is_let_in zeta
chief 0 admin trust remove "$url" "$zeta" --yes
is_refused zeta BadCertificateUntrusted
chief 0 admin trust remove "$url" "$zeta" --yes
await has_records 'CERT 0101 Delete zeta .* CLIENT REJECTED$' 1
chief 1 admin trust remove "$url" "$zeta" --yes
says 'no such certificate'

entry variables 3-2-5: revocation lists
authority works
authority deep
revoking works
revoking deep
chief 1 admin trust add "$url" works.crl
says 'does not have the issuer'
chief 0 admin trust add "$url" works.pem works.crl
await has_records 'CERT 0200 Add_Crl works .*crl works 20[0-9T:.-]*Z CLIENT TRUSTED$' 1
chief 0 admin trust list "$url"
says '^LIST  *ISSUER  *REVOKED  *VALID FROM  *NEXT UPDATE  *FILE  *THUMBPRINT$'
says '^trusted crl  *O=Works, CN=works  *0 revoked  *20[0-9-]*  *20[0-9-]*  *works '
crl=$(sed -n 's/^trusted crl .* \([0-9A-F]*\)$/\1/p' out)
chief 0 admin trust show "$url" "$crl"
says '^Next update:  *20'
chief 0 admin trust remove "$url" "$crl" --yes
await has_records 'CERT 0201 Delete_Crl works .*crl works 20[0-9T:.-]*Z CLIENT TRUSTED$' 1

entry variables 3-2-5: issuers
chief 0 admin trust add "$url" --issuer deep.pem deep.crl
await has_records 'CERT 0100 Add deep .* CLIENT ISSUER$' 1
await has_records 'CERT 0200 Add_Crl deep .*crl deep .* CLIENT ISSUER$' 1
chief 0 admin trust list "$url"
says '^issuers  *deep '
says '^issuers crl  *O=Works, CN=deep '
crl=$(sed -n 's/^issuers crl .* \([0-9A-F]*\)$/\1/p' out)
chief 0 admin trust show "$url" "$(thumbprint_of deep.pem)"
says '^CA:  *CA:TRUE'
chief 0 admin trust remove "$url" "$crl" --yes
await has_records 'CERT 0201 Delete_Crl deep .*crl deep .* CLIENT ISSUER$' 1
chief 0 admin trust remove "$url" "$(thumbprint_of deep.pem)" --yes
await has_records 'CERT 0101 Delete deep .* CLIENT ISSUER$' 1
# Among the issuers though it is trusted, too.
chief 0 admin trust add "$url" --issuer works.pem works.crl
await has_records 'CERT 0200 Add_Crl works .*crl works .* CLIENT ISSUER$' 1
chief 0 admin trust list "$url"
says '^issuers crl  *O=Works, CN=works '
shut_down

entry variables 5-1-1: application authentication
serve --config controller.toml
client stranger
is_refused stranger BadCertificateUntrusted
await logged 'event log: 85600000 OPC UA Client Connection Rejected: 02'
mv pki/rejected/certs/*stranger* pki/trusted/certs/
is_let_in stranger

entry variables 5-1-1: expired client
client short
openssl x509 -req -in request -out short.pem -days -1 -extfile extensions -signkey short.key \
    2> /dev/null || fail "openssl makes no certificate that has expired"
cp short.pem pki/trusted/certs/short.pem
power_cycle
await logged 'event log: .*xpire'
await has_records 'CERT 0104 Expired_Client short 20[0-9T:.-]*Z CLIENT TRUSTED$' 1
shut_down

# The server's own certificate, a day before and after: a notice once each, in both logs.
entry variables 5-1-1: notices of an expiring server certificate
own=$(ls pki/own/certs/*.der)
key=$(ls pki/own/private/*.pem)
for days in 20 -1; do
    openssl req -new -key "$key" -out request -subj '/CN=NxOpcUaServer@127.0.0.1' 2> /dev/null
    printf 'subjectAltName=URI:%s,IP:127.0.0.1,DNS:localhost\n' "$server_uri" > extensions
    openssl x509 -req -in request -days $days -signkey "$key" -extfile extensions \
        -outform DER -out "$own" 2> /dev/null
    serve --config controller.toml
    case $days in
        20) code=35D20000 record='CERT 0002 Notify_Server' ;;
        *) code=35D10000 record='CERT 0003 Expired_Server' ;;
    esac
    await logged "event log: $code"
    await has_records "$record NxOpcUaServer@127.0.0.1 20[0-9T:.-]*Z" 1
    kill "$pid"
    await ended
done
finish
