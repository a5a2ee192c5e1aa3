#!/bin/sh
# What the troubleshooting says is done about certificates, those of clients and that of the server:
# the trouble is there, the remedy is a command that exists, and it helps (W588, 9-3;
# TROUBLESHOOTING.md).
# usage: remedies_certificate_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
takes_long
. "$here/certificates.sh"
. "$here/remedies.sh"

{
    server "$port" pki
    account op '"Operator"'
    machine 'mode = "PROGRAM"'
    printf '[limits.certificates]\ncertificates = 4\nrejected = 2\n'
    printf 'when_rejected_is_full = "discard"\nrejected_per_minute = 1000\n'
} | sed 's/^folder = "pki"/&\ncommon_name = "Press@{address}"/' > controller.toml
press 17 > press.st
# panel CODE: a client that trusts only the server that it was told to.
panel() { run "$1" --pki panel --user op --password-file password read "$url" i=2259; }
# trusts_again: the panel gets the certificate that the server has now.
trusts_again() {
    chief 0 ${ignored:+--ignore $ignored} admin cert export "$url" now.der
    run 0 --pki panel cert trust now.der
}
own() {
    chief 0 ${ignored:+--ignore $ignored} admin cert show "$url"
    sed -n 's/^Thumbprint: *//p' out
}
take() { chief 0 admin trust remove "$url" "$@" --yes; }
ignored=""
begin pki --config controller.toml
entry variables 9-3: remedies
one_step # what is to be there after a power cut is in other scripts

# The panel and the server do not know each other, until each is told.
remedy 9-3.12 9-3.21
told 'the client does not accept the certificate'
told 'Bad_SecurityChecksFailed'
run 0 --pki panel cert create
panel 4
says 'busbar cert trust'
trusts_again
panel 4
says 'have its administrator trust it'
recorded AUTH 0001 'BadCertificateUntrusted'
in_events 85600000
chief 0 admin trust list "$url"
rejected=$(sed -n 's/^rejected .* \([0-9A-F]*\)$/\1/p' out)
chief 0 admin trust show "$url" "$rejected"
chief 0 admin trust move "$url" "$rejected"
panel 0

remedy 9-3.23
told 'the client does not know the certificate any more'
before=$(own)
chief 0 --timeout 100 admin cert regenerate "$url" --yes
await is_running
[ "$(own)" != "$before" ] || fail "it has the same certificate"
recorded CERT 0001 Update_Server
in_events 95D20000
panel 4
trusts_again
panel 0

# Another address, by a setting and by the file.
remedy 9-3.3 9-3.5 9-3.17
told 'the client refuses the certificate'
for address in 127.0.0.2 127.0.0.3; do
    if [ $address = 127.0.0.2 ]; then
        chief 0 admin setting set "$url" server.address $address
    else
        chief 0 admin setting reset "$url" server.address
        sed -i "s/^address = .*/address = \"$address\"/" controller.toml
    fi
    power_cycle
    await logged 'event log: 15020000 Server Certificate Mismatch'
    recorded CERT 0004 Mismatch_Host
    panel 4
    says 'host'
    ignored=host-name
    chief 0 --ignore host-name --timeout 100 admin cert regenerate "$url" --yes
    trusts_again
    ignored=""
    panel 0
    chief 0 admin cert show "$url"
    says "^Subject: .*Press@$address"
    in_events 15020000
    power_cycle
    logged 15020000 && fail "a certificate that was made again does not match"
    panel 0
done
sed -i 's/^address = .*/address = "127.0.0.1"/' controller.toml
power_cycle
chief 0 --ignore host-name --timeout 100 admin cert regenerate "$url" --yes
trusts_again

remedy 9-3.18
told 'the client says that the certificate has expired'
power_cut
certificate=$(ls pki/own/certs/*.der)
key=$(ls pki/own/private/*.pem)
uri=$(openssl x509 -inform DER -in "$certificate" -noout -ext subjectAltName |
    sed -n 's/.*URI:\([^,]*\).*/\1/p')
openssl req -new -key "$key" -out request -subj '/CN=NxOpcUaServer@127.0.0.1' 2> /dev/null
printf 'subjectAltName=URI:%s,IP:127.0.0.1\n' "$uri" > extensions
openssl x509 -req -in request -days -1 -signkey "$key" -extfile extensions -outform DER \
    -out "$certificate" 2> /dev/null
serve --config controller.toml
await logged 'event log: 35D10000'
recorded CERT 0003 Expired_Server
panel 4
chief 4 admin status "$url"
says 'validity-period'
chief 0 --ignore validity-period --timeout 100 admin cert regenerate "$url" --yes
trusts_again
panel 0
in_events 35D10000
power_cycle
logged 35D10000 && fail "a certificate that was made again has expired"

# Clients of authorities: the certificate of each authority above them, and its list.
application
authority root
authority works root
authority other
client direct root
client below works
revoking root
revoking works
revoking other
remedy 9-3.14
told 'the same with Bad_CertificateChainIncomplete'
told 'the same with Bad_CertificateRevocationUnknown'
is_refused below BadCertificateUntrusted
take "$(thumbprint_of below.pem)"
chief 0 admin trust add "$url" works.pem
is_refused below 'BadCertificateUntrusted\|BadCertificateChainIncomplete'
chief 0 admin trust add "$url" --issuer root.pem
is_refused below 'BadCertificate[A-Za-z]*RevocationUnknown'
chief 0 admin trust add "$url" works.crl root.crl
is_let_in below
chief 0 admin trust list "$url"
for each in $(sed -n 's/^rejected .* \([0-9A-F]*\)$/\1/p' out); do
    take "$each"
done

# An authority has taken the client's certificate back, or the one of the authority below it.
remedy 9-3.15
told 'the same with Bad_CertificateRevoked'
revoking works below
chief 0 admin trust add "$url" works.crl
is_refused below BadCertificateRevoked
client below works
is_let_in below
remedy 9-3.16
told 'the same with Bad_CertificateIssuerRevoked'
revoking root works
chief 0 admin trust add "$url" root.crl
says 'it is revoked'
is_refused below 'BadCertificate[A-Za-z]*'
authority works root
client below works
rm -f works.index
revoking works
chief 0 admin trust add "$url" works.pem works.crl
is_let_in below

remedy 9-3.13
told 'the same with Bad_CertificateInvalid'
client broken
cp broken.der whole.der
size=$(wc -c < whole.der)
{
    head -c $((size - 9)) whole.der
    printf 'damaged'
    tail -c 2 whole.der
} > broken.pki/own/certs/own.der
is_refused broken 'BadCertificateInvalid\|BadCertificateUntrusted\|BadSecurityChecksFailed'
cp whole.der broken.pki/own/certs/own.der
chief 0 admin trust list "$url"
for each in $(sed -n 's/^rejected .* \([0-9A-F]*\)$/\1/p' out); do
    take "$each"
done

remedy 9-3.32
told 'it cannot be moved'
is_refused broken BadCertificateUntrusted
chief 0 admin trust list "$url"
count=$(grep -c '^trusted  *[^c ]\|^trusted  *c[^r]' out)
while [ "$count" -lt 4 ]; do
    count=$((count + 1))
    openssl req -x509 -key other.key -subj "/CN=n$count" -days 20 -out "n$count.pem" 2> /dev/null
    chief 0 admin trust add "$url" "n$count.pem"
done
chief 1 admin trust move "$url" "$(thumbprint_of broken.pem)"
says 'trusted is full: its limit is 4 certificates'
chief 0 admin trust list "$url"
take "$(sed -n 's/^trusted  *n[0-9].* \([0-9A-F]*\)$/\1/p' out | head -n 1)"
chief 0 admin trust move "$url" "$(thumbprint_of broken.pem)"
is_let_in broken

remedy 9-3.33
told 'the certificate is not in `rejected`'
for each in first second third; do
    client $each
    is_refused $each BadCertificateUntrusted
done
recorded CERT 0103 'Discard third'
in_events 95D30000
chief 1 admin trust move "$url" "$(thumbprint_of third.pem)"
take "$(thumbprint_of first.pem)"
is_refused third BadCertificateUntrusted
take "$(thumbprint_of broken.pem)"
chief 0 admin trust move "$url" "$(thumbprint_of third.pem)"
is_let_in third

# All memory was cleared, with certificates.
remedy 9-3.22
chief 0 admin clear "$url" --security --yes
again() { [ "$(grep -c '^ready' log)" -ge 2 ]; }
await again
panel 4
in_trusted() { ls pki/rejected/certs/* > /dev/null 2>&1; }
run 4 --user chief --password-file password --trust admin status "$url"
await in_trusted
mv pki/rejected/certs/* pki/trusted/certs/
await reaches admin status "$url"
recorded CERT 0001 Update_Server
in_events 95D40000
trusts_again
panel 4
chief 0 admin trust list "$url"
for each in $(sed -n 's/^rejected .* \([0-9A-F]*\)$/\1/p' out); do
    chief 0 admin trust move "$url" "$each"
done
panel 0
shut_down
finish
