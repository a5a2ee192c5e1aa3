#!/bin/sh
# Lets the example client meet an example server, who do not know each other at first.
# usage: first_test.sh SERVER FIRST_CLIENT FOLDER
# FOLDER: where the server has its certificates.
set -eu
server=$1 client=$2 folder=$3

work=$(mktemp -d)
trap 'kill "$serving" "$watching" 2>/dev/null || true; wait; rm -rf "$work"' EXIT
serving="" watching=""
here=$(cd "$(dirname "$0")" && pwd)
cd "$work"
. "$here/ports.sh"
export FIRST_SERVER_PASSWORD="a pass phrase" POLL_SERVER_PASSWORD="a pass phrase"
export FIRST_CLIENT_PASSWORD="a pass phrase"

# wait_for COMMAND...: until it succeeds.
wait_for() {
    for _ in $(seq 600); do
        "$@" && return 0
        sleep 0.1
    done
    echo "in vain waited for: $*"
    cat ./*.log
    exit 1
}

# trust FOLDER: moves what was rejected there to what is trusted.
has_rejected() { ls "$1"/rejected/certs/*.der > list.txt 2>&1; }
trust() {
    wait_for has_rejected "$1"
    mv "$1"/rejected/certs/*.der "$1"/trusted/certs/
}

"$server" "$port" > server.log 2>&1 &
serving=$!
# Its folders are there before it has a key and listens.
wait_for grep -q 'ready at' server.log

# The client does not know the server and stops.
if "$client" "opc.tcp://localhost:$port" 1 > client.log 2>&1; then
    echo "the client accepted a stranger"
    exit 1
fi
grep -q Bad_CertificateUntrusted client.log
trust first_client_pki

# Now the server does not know the client, which tries again until somebody has trusted it.
"$client" "opc.tcp://localhost:$port" 2 > values.log 2>&1 &
watching=$!
trust "$folder"
wait "$watching"
grep -q 'Speed *1480' values.log

kill "$serving"
wait "$serving"
echo "both met"
