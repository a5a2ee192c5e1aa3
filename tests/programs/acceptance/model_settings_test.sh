#!/bin/sh
# Users, network, security, certificate and discovery of a project of model mode (SH-082679, 9.7 to
# 9.11): what can be chosen, what is refused with which reason, and what a server makes of it.
# usage: model_settings_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
. "$here/cell.sh"

set_value() { run 0 project set line.busbar "$@"; }
# wrong PATTERN NAME VALUE...: is refused with this, and nothing changes.
wrong() {
    pattern=$1
    shift
    cp line.busbar before
    "$busbar" project set line.busbar "$@" > out 2>&1 && fail "was set: $*"
    last="project set $*"
    says "$pattern"
    cmp -s line.busbar before || fail "a refused value has changed the project: $*"
}
user() {
    wanted_of_user=$1 name=$2
    echo "$3" > secret
    shift 3
    run "$wanted_of_user" project user line.busbar "$name" --new-password-file secret \
        --pbkdf2-iterations 10000 "$@"
}
run 0 cert create
is_client=yes
run 0 project new line.busbar --preset rd81opc96
set_value "listener 1.address" 127.0.0.1 "listener 1.port" $port

entry model 9.7: users
user 0 hmi Secret123 --permission client
user 0 engineer Secret456 --permission tool
user 0 boss Secret789 --permission "tool and client"
user 1 weak secret
user 1 weak Sec1
user 1 weak "$(printf 'Aa1%030d' 0)"
user 1 'wrong name' Secret123
grep -q Secret line.busbar && fail "the project has a password"
run 0 project show line.busbar
says 'user 1.name *hmi'
says 'user 1.permission *client'
says 'user 2.permission *tool$'
says 'user 3.permission *tool and client'
set_value "user 2.permission" client
user 0 hmi Secret321 # another password
wrong 'each name once' "user 2.name" hmi
set_value "user 2" ""
run 0 project show line.busbar
says_not engineer

entry model 9.8: network
run 0 project show line.busbar
says "^end point: opc.tcp://127.0.0.1:$port\$"
wrong 'network' "listener 2.address" 127.0.0.9 "listener 2.port" 4850 "listener 2.use" administration
set_value "listener 2.address" 192.168.4.41 "listener 2.port" 4841 "listener 2.use" administration
set_value network.host_name PRESS4 network.gateway 192.168.4.1
wrong 'upper-case' network.host_name press
wrong 'address' "listener 1.address" 300.1.1.1
wrong 'port' "listener 1.port" 70000
run 0 project show line.busbar
says "^end point: opc.tcp://PRESS4:$port\$"
says_not 'end point: .*:4841'
set_value "listener 2" "" network.gateway ""

entry model 9.9: security
wrong 'None where there are no policies' security.policies ""
wrong 'Sign or SignAndEncrypt where there are' security.mode None
wrong 'policies' security.policies Basic1024
wrong 'a way for clients to log in' security.allow_passwords no
set_value security.policies "" security.mode None
set_value security.policies Aes256_Sha256_RsaPss security.mode SignAndEncrypt \
    security.trust_all_clients yes
cell_program > line.st
cell_controller '' '' | sed 's/^anonymous.*/anonymous = "no"/' > module.toml
serve_cell line.busbar
run 0 endpoints "$url" --trust
says 'SignAndEncrypt  *Aes256_Sha256_RsaPss '
says_not 'Basic256Sha256\|None\|Sign  '
run 0 --user hmi --password-file secret --trust read "$url" i=2258
run 4 --trust read "$url" i=2258 # anonymous
echo wrong > other
run 4 --user hmi --password-file other --trust read "$url" i=2258
kill "$pid"
await ended
set_value security.policies "Aes256_Sha256_RsaPss, Basic256Sha256" security.mode Sign \
    security.allow_anonymous yes security.allow_passwords no security.trust_all_clients no \
    certificate.server_name LINE4 certificate.organization ACME certificate.unit PRESS \
    certificate.locality KOBE certificate.state HYOGO certificate.country JP
rm -rf pki
cell_controller '' '' | sed '/^trust_all/d; s/^anonymous.*/anonymous = "no"/' > module.toml
serve_cell line.busbar
run 0 endpoints "$url" --trust
for each in 'Sign  *Aes256_Sha256_RsaPss ' 'SignAndEncrypt  *Basic256Sha256 '; do
    says "$each"
done
run 4 --trust read "$url" i=2258 # whose certificate nobody has trusted
mv pki/rejected/certs/* pki/trusted/certs/
await ends_with 0 --trust read "$url" i=2258
kill "$pid"
await ended

entry model 9.10: own certificate
wrong 'upper-case' certificate.country de
wrong 'letters, digits' certificate.organization 'A-B'
for each in 'CN=LINE4' 'O=ACME' 'OU=PRESS' 'L=KOBE' 'ST=HYOGO\|S=HYOGO' 'C=JP'; do
    grep -a -q -e "own certificate.*$each" log || fail "the certificate has no $each: $(grep 'own' log)"
done

entry model 9.11: discovery
wrong '10 to 600' discovery.interval_s 5
wrong 'letters, digits' discovery.url opc.tcp://a_b:4840
wrong 'opc.tcp' discovery.url http://lds:4840
set_value discovery.url "opc.tcp://127.0.0.1:$((port + 1))" discovery.interval_s 10
serve_cell line.busbar
await logged 'discovery'
set_value discovery.url ""
kill "$pid"
await ended
finish
