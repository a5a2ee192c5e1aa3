#!/bin/sh
# Values of a Modbus device as its user names them: types, orders of words, decimal digits, scales,
# both ways of counting, units behind a gateway, and as many values in a request as the protocol has.
# usage: modbus_values_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"
responder=$(dirname "$controller")/busbar-plc-responder
[ -x "$responder" ] || { echo "there is no busbar-plc-responder"; exit 77; }

plc_port=$((port + 1))
mkfifo plc.in
"$responder" modbus --listen "127.0.0.1:$plc_port" --units 1,7 \
    --set holding:100=0x47F1 --set holding:101=0x2000 --set holding:102=0x2000 --set holding:103=0x47F1 \
    --set holding:104=0xF147 --set holding:105=0x0020 --set holding:106=0x0020 --set holding:107=0xF147 \
    --set holding:110=0x0102 --set holding:111=0x0304 --set holding:112=0x0506 --set holding:113=0x0708 \
    --set holding:120=0x1234 --set holding:121=0x5678 --set holding:122=0x12AF \
    --set holding:130=0x4F69 --set holding:131=0x6C00 --set holding:10=0x3600 \
    --set input:20=0xFFFE --set input:21=0xEE90 --set discrete:0=1 --set coil:5=1 \
    < plc.in > plc.out 2>&1 &
plc=$!
exec 7> plc.in
trap 'kill -9 $plc 2> /dev/null; kill $pid 2> /dev/null; wait' EXIT
await grep -q 'ready at' plc.out

cat > line.csv << 'END'
name,at,access,raw_low,raw_high,low,high,unit,description
Abcd,holding:100:float:ABCD,write,,,,,,
Cdab,holding:102:float:CDAB,write,,,,,,
Badc,holding:104:float:BADC,write,,,,,,
Dcba,holding:106:float:DCBA,write,,,,,,
Long,holding:110:int64,write,,,,,,
LongDown,holding:110:uint64:CDAB,read,,,,,,
Digits,holding:120:bcd16,write,,,,,,
MoreDigits,holding:120:bcd32,read,,,,,,
NoDigits,holding:122:bcd16,read,,,,,,
Name,holding:130:text20,write,,,,,,
Signed,input:20:int32,read,,,,,,
Bit,holding:30.15,write,,,,,,
Temperature,40011,write,0,27648,0,400,CEL,Oil
ByOffset,holding:10,read,,,,,,
ByNumber,400011,read,,,,,,
InputByNumber,30022,read,,,,,,
DiscreteByNumber,10001,read,,,,,,
CoilByNumber,00006,write,,,,,,
OfSeven,7/holding:10,read,,,,,,
OfNone,9/holding:10,read,,,,,,
END
coils=1969 registers=126
{
    head -n 1 line.csv
    awk -v coils=$coils -v registers=$registers 'BEGIN {
        for (i = 0; i <= 2000; ++i) printf "C%d,coil:%d,write,,,,,,\n", i, 1000 + i
        for (i = 0; i < registers; ++i) printf "R%d,holding:%d,write,,,,,,\n", i, 1000 + i
    }'
} > many.csv
{
    server "$port" pki
    for name in line many; do
        echo '[[backend]]'
        echo "name = \"$name\""
        echo 'protocol = "modbus"'
        echo "address = \"127.0.0.1:$plc_port\""
        echo 'unit = 1'
        [ $name = many ] || echo 'gateway = true'
        echo "table = \"$name.csv\""
    done
} > controller.toml

ask() { "$busbar" --user chief --password-file password --trust "$@" > out 2>&1; }
node() { echo "nsu=urn:busbar:backends;s=$1"; }
# has NAME VALUE: what a Read gives.
has() {
    last="read of $1"
    ask read --value "$url" "$(node "line.$1")"
    says "^$2\$"
}
# is NAME STATUS
is() {
    last="read of $1"
    ask read "$url" "$(node "line.$1")"
    says "$2"
}
# put NAME VALUE
put() { run 0 --user chief --password-file password --trust write "$url" "$(node "line.$1")" "$2"; }
# register PLACE VALUE: what the device has.
register() {
    echo "get $1" >&7
    last="$1 in the device"
    await sh -c "tail -n 1 plc.out | grep -q '^$2\$'"
}
online() { ask read "$url" "$(node "$1 Connection.State")" && grep -q ' 2 ' out; }

begin pki --config controller.toml
await online line
await online many

# Words in each order, read and written.
for name in Abcd Cdab Badc Dcba; do
    has $name 123456
    put $name 1.5
done
register holding:100 $((0x3FC0))
register holding:103 $((0x3FC0))
register holding:104 $((0xC03F))
register holding:107 $((0xC03F))
has Long 72623859790382856
has LongDown 506660481457717506
put Long 1
register holding:113 1
has Signed -70000
has Name Oil
put Name 'Öl, 10 °C'
has Name 'Öl, 10 °C'

# Decimal digits.
has Digits 1234
has MoreDigits 12345678
is NoDigits 'Bad_DecodingError'
put Digits 9876
register holding:120 $((0x9876))
ask write "$url" "$(node line.Digits)" 10000 && fail "five digits"
says 'Bad_OutOfRange'

# A bit of a register leaves the others alone.
echo 'set holding:30 0x00FF' >&7
put Bit true
register holding:30 $((0x80FF))

# A scale makes an AnalogItem of a number, in both directions.
has Temperature 200
put Temperature 100
register holding:10 6912
ask write "$url" "$(node line.Temperature)" 1000 && fail "more than the machine has a number for"
says 'Bad_OutOfRange'
ask browse "$url" "$(node line.Temperature)"
says EURange
says EngineeringUnits

# Both ways of counting name the same places.
has ByOffset 6912
has ByNumber 6912
has InputByNumber 61072
has DiscreteByNumber true
has CoilByNumber true
put CoilByNumber false
register coil:5 0

# Units behind the gateway: one that is there, and one that is not.
has OfSeven 6912
is OfNone 'Bad_NoCommunication\|Bad_DeviceFailure\|Bad_CommunicationError'

# requests COUNT COMMAND NAMES...: how many requests one Read or Write of these takes.
count() {
    ask read --value "$url" "$(node 'many Connection.Requests')"
    cat out
}
requests() {
    wanted=$1
    shift
    before=$(count)
    last="$*"
    # shellcheck disable=SC2046 # many words
    case $1 in
        read) ask read --value "$url" $(names "$2" "$3") || fail "not all are read" ;;
        write) ask write "$url" $(names "$2" "$3" 1) || fail "not all are written" ;;
    esac
    after=$(count)
    [ $((after - before)) -eq "$wanted" ] || fail "$((after - before)) requests, not $wanted"
}
# names PREFIX COUNT [VALUE]: the first of these variables.
names() {
    awk -v prefix="$1" -v count="$2" -v value="${3:-}" 'BEGIN {
        for (i = 0; i < count; ++i) printf "nsu=urn:busbar:backends;s=many.%s%d %s\n", prefix, i, value }'
}
requests 1 read C 2000
requests 2 read C 2001
requests 1 read R 125
requests 2 read R 126
requests 1 write C 1968
requests 2 write C 1969
requests 1 write R 123
requests 2 write R 124
requests 1 write C 1
requests 1 write R 1
register coil:2968 1
register coil:2969 0
register holding:1123 1
register holding:1124 0
finish
