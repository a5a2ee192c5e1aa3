# What the scripts share that carry out what the manuals' and our own tables of troubles say; to be
# read after functions.sh. Not a program.
troubleshooting=$here/../../../examples/controller/TROUBLESHOOTING.md

# remedy ROW...: what follows carries out the remedy of these rows of remedies.txt.
remedy() {
    for row; do
        grep -q -e "^$row " "$here/remedies.txt" || fail "no such row: $row"
    done
}
# told CELLS: and that of the row of TROUBLESHOOTING.md that begins like this.
told() {
    found=$(awk -v begin="| $*" 'index($0, begin) == 1 { ++n } END { print n + 0 }' \
        "$troubleshooting")
    [ "$found" -eq 1 ] || fail "$found rows begin with: $*"
}

# in_events CODE [TEXT]: the event is told, with what is to be done.
in_events() {
    cycle_when_due
    await is_event "$1"
    chief 0 admin events "$url" --code "$1"
    says "$1 ${2:-}"
    case $1 in
        9*) ;; # an information
        *) says 'Correction: ' ;;
    esac
}
is_event() { reaches admin events "$url" --code "$1" && grep -q -e "$1" out; }
log_text() {
    cat medium/packages/OPCUA_Server/ExecutionLog/*.log 2> /dev/null | tr '\t\r' '  '
}
# recorded CATEGORY CODE TEXT: it is in the execution log.
recorded() { await has_text " $1 $2 .*$3"; }
has_text() { log_text | grep -q -e "$1"; }
status_is() {
    chief 0 admin status "$url"
    says "^Server operating status: *$1\$"
}
# follows USER NODE...: a client that subscribes until it is killed, whose lines are in "followed".
follows() {
    followed_by=$1
    shift
    rm -f followed # or what the client before has said is taken for what this one says
    timeout 100 "$busbar" --user "$followed_by" --password-file password --trust subscribe "$url" \
        "$@" > followed 2>&1 < /dev/null &
    follower=$!
}
has_followed() { grep -q -s -e "$1" followed; }
ends_following() {
    kill "$follower" 2> /dev/null
    wait "$follower" 2> /dev/null
}
