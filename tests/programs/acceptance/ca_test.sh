#!/bin/sh
# Clients whose certificates a CA signed: what has to be registered for whom (W588, A-3-2), in
# the six cases of the manual's table, and what the tool does for it (A-3-3).
# usage: ca_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
. "$here/certificates.sh"

{
    server "$port" pki
    machine
} > controller.toml
press 17 > press.st
begin pki --config controller.toml
application
authority root
authority works root
client direct root
client below works
client stolen works
revoking root
revoking works stolen

# take FILE...: out of all lists.
take() {
    for taken; do
        case $taken in
            *.crl) print=$(print_of "$taken") ;;
            *) print=$(thumbprint_of "$taken") ;;
        esac
        chief 0 admin trust remove "$url" "$print" --yes
    done
}

entry variables A-3: CA-signed certificates
# Nothing is registered: none of them is known, and each is among the rejected ones then.
is_refused direct BadCertificateUntrusted
is_refused below BadCertificateUntrusted
chief 0 admin trust list "$url"
says '^rejected *direct '
says '^rejected *below '
take direct.pem below.pem

# By a root only: its certificate and its list.
one_step
chief 0 admin trust add "$url" root.pem
is_refused direct BadCertificateIssuerRevocationUnknown
chief 0 admin trust add "$url" root.crl
is_let_in direct
step_ends
is_let_in direct
is_refused below BadCertificateUntrusted
take below.pem root.pem

# By an intermediate CA: the CA is trusted, all above it are issuers, each with its list.
one_step
chief 0 admin trust add "$url" works.pem works.crl
is_refused below BadCertificateUntrusted
take below.pem
chief 0 admin trust add "$url" root.pem --issuer
is_refused below BadCertificateIssuerRevocationUnknown
chief 0 admin trust add "$url" root.crl
step_ends
is_let_in below
is_refused direct BadCertificateUntrusted
is_refused stolen BadCertificateRevoked
chief 0 admin trust list "$url"
says '^trusted *works '
says '^issuers *root '
says '^rejected *stolen '
says '^trusted crl .*CN=works.* 1 revoked .*works \['
says '^issuers crl .*CN=root.* 0 revoked .*root \['
take stolen.pem direct.pem

# By both, client and CA, of the same two kinds.
one_step
chief 0 admin trust add "$url" below.der
is_let_in below
take below.pem works.pem root.pem
chief 0 admin trust add "$url" direct.der root.pem root.crl
is_let_in direct
take direct.pem root.pem
step_ends

# By the client alone, all CAs are issuers: another one of the same CA is not let in.
chief 4 admin trust add "$url" direct.der
says 'admin trust add --issuer'
one_step
chief 0 admin trust add "$url" --issuer root.pem root.crl
chief 0 admin trust add "$url" direct.der
step_ends
is_let_in direct
one_step
chief 4 admin trust add "$url" below.der
chief 0 admin trust add "$url" --issuer works.pem works.crl
chief 0 admin trust add "$url" below.der
step_ends
is_let_in below
client other works
is_refused other BadCertificateUntrusted

# Revoked meanwhile: the new list takes the place of the old one, and a client that was trusted is
# no more.
one_step
revoking works below
chief 0 admin trust add "$url" works.crl
says "removed $(thumbprint_of below.pem) .* from trusted: it is revoked"
is_refused below BadCertificateUntrusted
step_ends
is_refused below BadCertificateUntrusted
chief 0 admin trust list "$url"
[ "$(grep -c '^issuers crl .*CN=works' out)" -eq 1 ] || fail "a CA has two revocation lists"

# What a CA signed for the server itself is taken once the server has the CA.
one_step
authority town
chief 0 admin cert request "$url" request.der
openssl req -in request.der -inform DER -out request 2> /dev/null
application=$(openssl req -in request -noout -text | sed -n 's/.*URI:\([^,]*\).*/\1/p')
cat > extensions << END
basicConstraints=critical,CA:FALSE
keyUsage=critical,digitalSignature,nonRepudiation,keyEncipherment,dataEncipherment
extendedKeyUsage=clientAuth,serverAuth
subjectAltName=URI:$application,DNS:localhost,IP:127.0.0.1
END
sign own town 30
openssl x509 -in own.pem -outform DER -out own.der
chief 4 admin cert install "$url" own.der
says 'add the CA that signed it first: busbar admin trust add --issuer FILE'
step_ends
shut_down
finish
