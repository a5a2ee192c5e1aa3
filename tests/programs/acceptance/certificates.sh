# Certificates and revocation lists as a company's CA makes them, with openssl; to be read after
# functions.sh. Not a program.
command -v openssl > /dev/null || {
    echo "there is no openssl to make certificates with"
    exit 77
}

# records PATTERN: how many records of the execution log have it; a tab is a blank.
records() {
    cat medium/packages/OPCUA_Server/ExecutionLog/*.log 2> /dev/null | tr '\t' ' ' | tr -d '\r' |
        grep -c -e "$1"
}
has_records() { [ "$(records "$1")" -eq "$2" ]; }
has_record() { [ "$(records "$1")" -gt 0 ]; }
thumbprint_of() {
    openssl x509 -in "$1" -noout -fingerprint -sha1 | sed 's/.*=//; s/://g'
}
# print_of FILE: the thumbprint of a revocation list.
print_of() { openssl crl -in "$1" -outform DER | openssl dgst -sha1 | sed 's/.*= //'; }

# authority NAME [CA]: NAME.pem and NAME.key, of a CA that is its own issuer or has this one.
authority() {
    request "$1" "/O=Works/CN=$1"
    printf 'basicConstraints=critical,CA:TRUE\nkeyUsage=critical,keyCertSign,cRLSign\n' > extensions
    sign "$1" "${2:-}"
}
# client NAME [CA [DAYS]]: NAME.pem and NAME.key of an application, and the folder NAME.pki for
# busbar --pki.
client() {
    request "$1" "/O=Works of $1/CN=$1"
    cat > extensions << END
basicConstraints=critical,CA:FALSE
keyUsage=critical,digitalSignature,nonRepudiation,keyEncipherment,dataEncipherment
extendedKeyUsage=clientAuth,serverAuth
subjectAltName=URI:$application,DNS:$1.example
END
    sign "$1" "${2:-}" "${3:-30}"
    mkdir -p "$1.pki/own/certs" "$1.pki/own/private"
    openssl x509 -in "$1.pem" -outform DER -out "$1.pki/own/certs/own.der"
    cp "$1.pki/own/certs/own.der" "$1.der"
    cp "$1.key" "$1.pki/own/private/own.pem"
    chmod 600 "$1.pki/own/private/own.pem"
}
request() {
    new_key "$1.key"
    openssl req -new -key "$1.key" -out request -subj "$2" 2> /dev/null
}
sign() {
    if [ -z "$2" ]; then
        set -- "$1" "$1" "${3:-30}" -key "$1.key"
    else
        set -- "$1" "$2" "${3:-30}" -CA "$2.pem" -CAkey "$2.key"
    fi
    name=$1 days=$3
    shift 3
    case $1 in -key) set -- -signkey "$2" ;; esac
    openssl x509 -req -in request -out "$name.pem" -days "$days" -extfile extensions -sha256 \
        -set_serial "0x$(openssl rand -hex 8)" "$@" 2> /dev/null || fail "$name was not signed"
}
# revoking CA [NAME...]: CA.crl, in which these are.
revoking() {
    ca=$1
    shift
    printf '[ca]\ndefault_ca = d\n[d]\ndatabase = %s.index\ndefault_md = sha256\n' "$ca" > ca.cnf
    touch "$ca.index"
    for revoked; do
        openssl ca -config ca.cnf -keyfile "$ca.key" -cert "$ca.pem" -revoke "$revoked.pem" \
            2> /dev/null || fail "$revoked was not revoked"
    done
    openssl ca -config ca.cnf -gencrl -crldays 20 -keyfile "$ca.key" -cert "$ca.pem" \
        -out "$ca.crl" 2> /dev/null || fail "there is no list of $ca"
}
# What busbar's certificate has to name: it says so of the one it makes for itself.
application() {
    run 0 cert show
    application=$(sed -n 's/^Application: *//p' out)
}

# is_let_in NAME, is_refused NAME ERROR: with the certificate of NAME; the execution log says why
# not.
is_let_in() {
    cycle_when_due
    run 0 --pki "$1.pki" --user chief --password-file password --trust read "$url" i=2259
}
is_refused() {
    cycle_when_due
    before=$(records "AUTH 0001 Application ERROR $2\$")
    run 4 --pki "$1.pki" --user chief --password-file password --trust read "$url" i=2259
    await has_more_than "$before" "AUTH 0001 Application ERROR $2\$"
}
has_more_than() { [ "$(records "$2")" -gt "$1" ]; }
