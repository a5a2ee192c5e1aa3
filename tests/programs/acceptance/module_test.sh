#!/bin/sh
# The module of model mode while it runs (SH-082679, 4.1, 8.4, 8.5, 9.13 to 9.15): its first
# project, what it says of itself, projects that are read, written, verified and taken up, or cannot
# be, and the certificates of clients and users.
# usage: module_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
takes_long
. "$here/cell.sh"

cell_program > line.st
{
    server "$port" pki
    cat << 'END'
[labels]
program = "line.st"
[[plc.program]]
kind = "acknowledge"
target = "Line.Handle"
sets = "Line.State"
to = 6
END
} > module.toml

# From nothing to values, in the manual's steps.
entry model 4.1: start-up
run 0 project new line.busbar
run 0 project import line.busbar "$here/cell.xml"
cell_table > cell.csv
run 0 project csv line.busbar --in cell.csv
run 0 project set line.busbar "listener 1.address" 127.0.0.1 "listener 1.port" $port \
    security.allow_certificates yes
run 0 project user line.busbar hmi --new-password-file password --permission client \
    --pbkdf2-iterations 10000
begin pki --config module.toml --project project
one_step
chief 0 project status "$url"
says 'project *none'
chief 0 project write "$url" line.busbar --yes
chief 0 project status "$url"
says 'project *written, an update or restart is due'
chief 0 project update "$url" --yes
in_use() { reaches project status "$url" && grep -q 'project *in use' out; }
await in_use
as hmi 0 write "$url" "$(cell 104)" 12
as hmi 0 read --value "$url" "$(cell 104)"
says '^12$'

entry model 8.3: execution of methods
mix() {
    as hmi "$1" call "$url" "$(cell 1)" "$(cell 20)" 7 '[1, 2, 3]' \
        '{"Name": "Cake", "Size": 1, "Mode": 0}'
}
mix 0
cleared() {
    ends_with 0 --user hmi --password-file password --trust call "$url" "$(cell 1)" "$(cell 20)" 8 \
        '[1, 2, 3]' '{"Name": "Cake", "Size": 1, "Mode": 0}'
}
await cleared # the program clears bit 0, and the Method can be called again

entry model 8.4: discovery, channel, session
run 0 discover "$url" --trust
says 'opc.tcp://'
run 0 endpoints "$url" --trust
says 'SignAndEncrypt'
as hmi 0 read "$url" i=2259
as nobody 4 read "$url" i=2259

entry model 9.14: diagnostics
chief 0 project status "$url"
says 'operationMode  *model mode'
says 'serverStatus  *Running'
says 'version  *[0-9]'
chief 0 read --value "$url" "$(module OperationMode)"
says 'model mode'
chief 0 read --value "$url" "$(module Version)"

entry model App. 3: signals and values
for name in TargetDevice1Status LabelUpdateRunningStatus RevisedSamplingIntervalMinimum \
    ActualSamplingIntervalMinimum; do
    chief 0 read --value "$url" "$(module $name)"
    says '^[0-9]'
done

entry model 9.13: module control
chief 0 project read "$url" read.busbar
cmp -s read.busbar line.busbar || fail "another project was read than written"
chief 0 project verify "$url" line.busbar
says 'no differences'
cp line.busbar other.busbar
run 0 project map other.busbar "ns=1;i=104" Line.DW
chief 1 project verify "$url" other.busbar
says 'ns=1;i=104  *Line.DW  *Line.W$'
# A mapping that is wrong is refused by the tool.
sed 's/Data="Line.W"/Data="Line.W.7"/' line.busbar > wrong.busbar
run 0 project export line.busbar http://cell.example/Cell wrong.xml
sed -i 's/Data="Line.W"/Data="Line.W.7"/' wrong.xml
cp line.busbar wrong.busbar
run 0 project import wrong.busbar wrong.xml
chief 1 project write "$url" wrong.busbar --yes
says 'M314'
says 'nothing was written'
chief 0 project verify "$url" line.busbar
# An update that cannot be done says so, and the old project goes on.
cp line.busbar elsewhere.busbar
run 0 project set elsewhere.busbar "listener 1.address" 192.0.2.77
chief 0 project write "$url" elsewhere.busbar --yes
chief 1 project update "$url" --yes
says '192.0.2.77'
as hmi 0 read "$url" "$(cell 104)"
chief 0 project write "$url" line.busbar --yes
chief 0 project update "$url" --yes
await in_use
# Labels that are not the PLC's: each is told with node, expected and found type, the project does
# not count, whichever way it would, and the one before stays in force.
cp line.busbar unlike.busbar
run 0 project map unlike.busbar "ns=1;i=104" Line.S
run 0 project map unlike.busbar "ns=1;i=105" Line.Gone
run 0 project map unlike.busbar "ns=1;i=106" Line.UDW
chief 0 project write "$url" unlike.busbar --yes
chief 1 project labels "$url"
says 'i=104  *Line.S  *INT.*  *STRING(7)  *refused'
says 'i=105  *Line.Gone  *.*the PLC has no label of this name  *refused'
says 'i=106  *Line.UDW  *DINT.*  *UDINT, DWORD  *converted'
chief 1 project update "$url" --yes
says '2 of its labels cannot be used'
# told 'an update or restart is refused, as labels of the project cannot be used'
logged 'Line.S of ns=1;i=104: found STRING(7), expected INT; Line.Gone of ns=1;i=105' ||
    fail "the refusal does not name the labels"
says 'despite-labels'
chief 1 project restart "$url" --yes --seconds 0
says 'Line.Gone'
as hmi 0 read --value "$url" "$(cell 104)"
says '^12$'
step_ends
power_cycle
logged 'Line.S of ns=1;i=104: found STRING(7)' || fail "the start does not say why"
one_step
chief 0 project status "$url"
says 'written, an update or restart is due'
as hmi 0 read "$url" "$(cell 104)"
# It can count before the PLC has its program: 8.3 says what its nodes answer then.
chief 0 project update "$url" --yes --despite-labels
await in_use
as hmi 3 read "$url" "$(cell 104)"
chief 0 project write "$url" line.busbar --yes
chief 0 project update "$url" --yes
await in_use

entry model 8.5: operation
starts=$(grep -c '^ready' log)
chief 0 project restart "$url" --yes --seconds 0
await has_restarted # the one before still answers for a moment
await in_use
chief 0 project verify "$url" line.busbar

entry model 9.15: certificates
run 0 --pki user cert create
find user -name '*.der' | head -n 1 > found
read -r certificate < found
key=$(find user -name '*.pem' | grep -i -e key -e private | head -n 1)
with_certificate() {
    run "$1" --user-certificate "$certificate" --user-key "$key" --trust read "$url" "$(cell 104)"
}
with_certificate 4
# It was rejected, so that it is moved and not added.
chief 1 admin trust add --users "$url" "$certificate"
run 0 cert show "$certificate"
chief 0 admin trust move --users "$url" "$(sed -n 's/^Thumbprint: *//p' out)"
with_certificate 0
chief 0 admin trust list --users "$url"
says 'trusted'
chief 0 admin trust list "$url"
chief 0 admin cert show "$url"
says '^own'
chief 0 --timeout 100 admin cert request "$url" request.der
[ -s request.der ] || fail "no request was written"
step_ends
power_cycle
await in_use
as hmi 0 read "$url" "$(cell 104)"
with_certificate 0

entry model 8.1: ServiceResult
# Who is connected while it stops: Writes are refused as a whole, Reads go on.
requests=$(dirname "$busbar")/acceptance-requests
held() {
    REQUESTS_USER=hmi REQUESTS_PASSWORD=$(cat password) timeout 60 "$requests" "$url" "$@" > held 2>&1
}
mkdir -p requests_pki/trusted/certs
cp pki/own/certs/*.der requests_pki/trusted/certs/
held read 1 i=2258
mv pki/rejected/certs/* pki/trusted/certs/
trusted_now() { held read 1 i=2258; }
await trusted_now
run 0 --json --user hmi --password-file password --trust read "$url" i=2255
index=$(($(sed 's/.*"value":\[//' out | tr ',' '\n' | grep -n cell.example | cut -d: -f1) - 1))
held held 8 "ns=$index;i=104" &
holder=$!
sleep 3
one_step
chief 0 project stop "$url" --yes --seconds 30
says 'project restart'
wait $holder
grep -q '^Bad_Shutdown:$' held || fail "a Write while it stops: $(cat held)"
grep -q '^Good: 1 Good$' held || fail "a Read while it stops: $(cat held)"

entry model 9.13: module control
# The controller goes on, so that the tool brings the server back.
stopped() { reaches admin status "$url" && grep -q '^Server operating status: *Shutdown$' out; }
await stopped
says '^End point: *---$'
ends_with 0 --user hmi --password-file password --trust read "$url" "$(cell 104)" &&
    fail "a server that was stopped is read"
says Bad_ServerHalted
chief 0 project restart "$url" --yes --seconds 0
says 'restarts'
await in_use
chief 0 project status "$url"
says 'serverStatus  *Running'
as hmi 0 read "$url" "$(cell 104)"
shut_down
finish
