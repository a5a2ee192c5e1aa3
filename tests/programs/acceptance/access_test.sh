#!/bin/sh
# Who comes in, and as what: tokens whose roles count by rules only, guesses at passwords and setup
# codes, and changes of passwords by many beside the logins of others.
# usage: access_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
requests=$(dirname "$busbar")/acceptance-requests

new_key issuer.key
openssl rsa -in issuer.key -pubout -out issuer.pem 2> /dev/null
new_key other.key
{
    server "$port" pki
    cat << END
[users.tokens]
issuer = "https://login.example/plant"
algorithm = "RS256"
key_file = "issuer.pem"
audience = "press"
[[users.tokens.role]]
name = "Operator"
access = "write"
END
    machine 'mode = "PROGRAM"'
} > controller.toml
press 0 > press.st
begin pki --config controller.toml
"$requests" "$url" read 1 i=2259 > /dev/null 2>&1 # it makes its certificate
mkdir -p requests_pki/trusted/certs
cp pki/own/certs/own.der requests_pki/trusted/certs/
cp requests_pki/own/certs/own.der pki/trusted/certs/requests.der

chief 0 --json read "$url" i=2255
due=""
index=$(($(sed 's/.*"value":\[//' out | tr ',' '\n' | grep -n 'urn:busbar:machine' | cut -d: -f1) - 1))
speed="ns=$index;s=Speed"

base64url() { openssl base64 -A | tr '+/' '-_' | tr -d '='; }
# token ROLES [KEY [AUDIENCE [SECONDS [ALGORITHM]]]]: signed by the key, valid for that time.
token() {
    head=$(printf '{"alg":"%s","typ":"JWT"}' "${5:-RS256}" | base64url)
    body=$(printf '{"iss":"https://login.example/plant","sub":"tess","aud":"%s","exp":%s,"roles":[%s]}' \
        "${3:-press}" $(($(date +%s) + ${4:-600})) "$1" | base64url)
    signature=$(printf '%s.%s' "$head" "$body" | openssl dgst -sha256 -sign "${2:-issuer.key}" | base64url)
    printf '%s.%s.%s' "$head" "$body" "$signature"
}
# asks TOKEN REQUEST...: what came of it is in out.
asks() {
    tess=$1
    shift
    last="with a token: $*"
    REQUESTS_TOKEN=$tess timeout 60 "$requests" "$url" "$@" > out 2>&1 < /dev/null
}
get_rejected_list="call 1 i=12637 i=12777"
security_admin=i=15704

# Roles of the configuration count, those that the issuer says beside them do not, whatever they are.
greedy=$(token '"Operator","SecurityAdmin","ConfigureAdmin"')
asks "$greedy" write 1 "$speed"
says '^Good: 1 Good$'
# shellcheck disable=SC2086 # words
asks "$greedy" $get_rejected_list
says '^Good: 1 Bad_'
asks "$greedy" rule $security_admin 1 tess
says '^Good: 1 Bad_'
asks "$(token '"SecurityAdmin"')" write 1 "$speed"
says_not ' Good'
# A rule of an administrator lets one count, from the next login on.
REQUESTS_USER=chief REQUESTS_PASSWORD=$(cat password) "$requests" "$url" rule $security_admin 3 plant-admins \
    > out 2>&1
says '^Good: 1 Good$'
# shellcheck disable=SC2086 # words
asks "$(token '"plant-admins"')" $get_rejected_list
says '^Good: 1 Good$'
# shellcheck disable=SC2086 # words
asks "$greedy" $get_rejected_list
says '^Good: 1 Bad_'
# Tokens that are wrong let nobody in; after five the client is locked out with tokens.
for wrong in "$(token '"Operator"' other.key)" "$(token '"Operator"' issuer.key mixer)" \
    "$(token '"Operator"' issuer.key press -600)" "$(token '"Operator"' issuer.key press 600 none)" \
    "$(token '"Operator"' | sed 's/[^.]*$//')"; do
    asks "$wrong" read 1 "$speed"
    says '^Bad_IdentityToken'
done
asks "$(token '"Operator"')" read 1 "$speed"
says '^Bad_UserAccessDenied'

# Wrong old passwords are guesses: five, and the user is locked out there, others are not.
echo "Patience_456" > other
for who in pat sam ann bob cat dan; do
    chief 0 admin user add "$url" $who --new-password-file other
    due=""
done
# change USER N OLD NEW: in one Call.
change() {
    last="ChangePassword by $1, $2 times"
    REQUESTS_USER=$1 REQUESTS_PASSWORD=$(cat other) timeout 100 "$requests" "$url" password "$2" "$3" "$4" \
        > out 2>&1 < /dev/null
}
change pat 20 Guess_12345 Patience_789
says '^Good: 5 Bad_IdentityTokenInvalid, 15 Bad_UserAccessDenied$'
change pat 1 Patience_456 Patience_789
says '^Bad_UserAccessDenied'
change sam 1 Patience_456 Patience_789
says '^Good: 1 Good$'
chief 0 admin status "$url"

# Many who change their passwords keep no login waiting for long.
many=""
for who in ann bob cat dan; do
    REQUESTS_USER=$who REQUESTS_PASSWORD=$(cat other) timeout 100 "$requests" "$url" \
        password 40 Patience_456 Patience_789 > "many.$who" 2>&1 < /dev/null &
    many="$many $!"
done
for i in 1 2 3; do
    chief 0 admin status "$url"
done
# shellcheck disable=SC2086 # words
wait $many
for who in ann bob cat dan; do
    grep -q '^Good: .*1 Good' "many.$who" || fail "$who: $(cat "many.$who")"
done
shut_down

# Strangers who guess at the code of a setup do not keep its owner out.
cat > setup.toml << END
[server]
address = "127.0.0.1"
port = 0
[certificates]
folder = "setup"
[limits]
first_login_delay_ms = 0
max_login_delay_ms = 0
[users]
setup = true
[machine]
program = "press.st"
state = "setup-state"
medium = "setup-medium"
[[endpoint]]
policy = "Basic256Sha256"
mode = "SignAndEncrypt"
END
serve --config setup.toml
sed -n 's/.*with the code \([^,]*\),.*/\1/p' log > code
echo "ABCDE-ABCDE-ABCDE-ABCDE" > guess
for stranger in 1 2 3 4 5; do # 20 failures lock an address out, but for codes
    for i in 1 2 3 4 5; do
        run 4 --pki "stranger$stranger" --user setup --password-file guess --trust admin status "$url"
    done
done
# The one who has guessed five times is locked out, even with the code.
run 4 --pki stranger1 --user setup --password-file code --trust admin setup "$url" chief \
    --new-password-file password
run 0 --pki owner --user setup --password-file code --trust admin setup "$url" chief \
    --new-password-file password
says 'chief administers the server from now on'
shut_down
finish
