# What the acceptance tests share: a controller as its users have it, with an administrator "chief"
# whose password, as everybody's, is in the file "password". To be read into a script whose
# $controller and $busbar are the programs, after which it runs in a folder of its own.
here=$(cd "$(dirname "$0")" && pwd)
. "$here/../functions.sh"

echo "Patience_123" > password
hash=$(quick_hash password)
. "$here/../ports.sh"

# account NAME ROLES: its table; the roles as TOML has them.
account() {
    printf '[[users.account]]\nname = "%s"\npassword = "%s"\nroles = [%s]\n' "$1" "$hash" "$2"
}
# server PORT FOLDER: the tables of a secure server with its certificates in the folder, and chief.
server() {
    cat << END
[server]
address = "127.0.0.1"
port = $1
[certificates]
folder = "$2"
[[endpoint]]
policy = "Basic256Sha256"
mode = "SignAndEncrypt"
$quick_logins
END
    account chief '"SecurityAdmin", "ConfigureAdmin", "Operator"'
}
# machine LINES: its table.
machine() {
    printf '[machine]\nprogram = "press.st"\nname = "Controller"\nstate = "state"\n'
    printf 'medium = "medium"\nexecution_log = true\n%s\n' "${1:-}"
}
# press SPEED: the program with one variable.
press() {
    cat << END
VAR_GLOBAL
    {attribute 'publish' := 'publish only'}
    Speed : INT := $1;
END_VAR
END
}
node() { echo "nsu=urn:busbar:machine;s=$1"; }

# as USER CODE ARGUMENTS...: busbar's exit code where this user asks. Power is cut
# after each command that may have changed something, before the next one. A command that was
# refused has to leave no trace either, for which a cut is made after it in long runs.
as() {
    user=$1 wanted_by=$2
    shift 2
    cycle_when_due
    run "$wanted_by" --user "$user" --password-file password --trust "$@"
    if ! is_look "$@" && { [ "$wanted_by" -ne 1 ] || is_long_run; }; then
        due=yes
    fi
}
chief() { as chief "$@"; }
# reaches ARGUMENTS...: whether it is done for chief; for await, and within one step.
reaches() { ends_with 0 --user chief --password-file password --trust "$@"; }
value() {
    chief 0 read --value "$url" "$(node "$1")"
    says "^$2\$"
}

# Whether the server is one that clients have all of.
is_running() {
    reaches admin status "$url" && grep -q 'operating status: *Running$' out &&
        grep -q '^state: *Running$' out
}
# restart [USER]: chief or this user restarts the server. Returns when the new one answers: the one
# before does so for another moment.
restart() {
    cycle_when_due
    starts=$(grep -c '^ready' log)
    as "${1:-chief}" 0 admin shutdown "$url" --restart --seconds 0 --yes
    await has_restarted && await is_running
}
has_restarted() { [ "$(grep -c '^ready' log)" -gt "$starts" ]; }

# What a power cut does, and power comes back; other ARGUMENTS than before begin another controller.
power_cut() {
    kill -9 "$pid"
    wait "$pid" 2> /dev/null
    due=""
}
power_cycle() {
    power_cut
    # shellcheck disable=SC2086 # no argument has spaces
    serve ${*:-$served}
}
# hang_up PATTERN: files are read again, which the log says in this way.
hang_up() {
    kill -HUP "$pid"
    await logged "$1"
    due=yes
}
shut_down() {
    kill "$pid"
    await ended
    due=""
}

# begin FOLDER ARGUMENTS...: the first start, with certificates in the folder; it trusts busbar.
begin() {
    folder=$1
    shift
    [ -n "$is_client" ] || run 0 cert create
    is_client=yes
    serve "$@"
    run 4 --user chief --password-file password --trust admin status "$url"
    mv "$folder"/rejected/certs/* "$folder/trusted/certs/"
    due=""
}

# What cannot be taken apart by a power cut stands between these two: all of it is one step.
one_step() {
    cycle_when_due
    is_one_step=yes
}
step_ends() {
    is_one_step=""
    due=yes
}
due="" is_one_step="" is_client=""
is_look() {
    case "$*" in
        read\ * | browse* | subscribe* | *admin\ status* | *admin\ events* | *\ list\ * | *\ show\ * | \
            *project\ status* | *verify* | *compare* | *check*) return 0 ;;
    esac
    return 1
}
cycle_when_due() {
    [ -n "$due" ] && [ -z "$is_one_step" ] || return 0
    kept_last=${last:-}
    power_cycle
    run 0 --user chief --password-file password --trust admin status "$url"
    says '^Server operating status: *Running$'
    says "^Restart due: *no\$"
    last=$kept_last
}

# departs SETTING MANUAL SECTION: the preset names a default of its manual that is not ours, so that
# who wants the manual's sets it.
departs() {
    last="--print-preset nj501"
    "$controller" --print-preset nj501 > out || fail "$last"
    says "\"setting\":\"$1\",\"manual\":\"*$2.*\"section\":\"$3\",\"reason\":\"[a-zA-Z]"
}

# is_long_run: with BUSBAR_TEST_EFFORT=full, as in `tests/run all`, and by ./table. takes_long leaves
# a script out of quick runs.
is_long_run() { [ "${BUSBAR_TEST_EFFORT:-}" = full ] || [ -n "${BUSBAR_SEEN:-}" ]; }
takes_long() {
    is_long_run || {
        echo "left out of quick runs"
        exit 77
    }
}

# entry MODE SECTION: NAME shows this entry of entries.txt with what follows, up to the next one or
# the end (finish); lacks MODE SECTION: NAME -- WHY says that it does less than the manual, and why.
# Both are noted for ./table, which sets BUSBAR_SEEN. An entry can be shown in several parts.
entry_now="" entry_failures=0
note_entry() {
    [ -z "${BUSBAR_SEEN:-}" ] ||
        printf '%s\t%s\t%s\n' "$1" "$2" "$3" >> "$BUSBAR_SEEN/seen.$(basename "$0")"
}
check_entry() {
    sed 's/ | .*//' "$here/entries.txt" | grep -q -x -F -e "$1" || fail "no such entry: $1"
}
entry_ends() {
    [ -n "$entry_now" ] || return 0
    kind=works
    [ "$failures" -eq "$entry_failures" ] || kind=fails
    note_entry "$kind" "$entry_now" "$(basename "$0" _test.sh)"
    entry_now=""
}
entry() {
    entry_ends
    check_entry "$*"
    entry_now=$* entry_failures=$failures
}
lacks() {
    what=${*%% -- *}
    check_entry "$what"
    note_entry lacks "$what" "${*#* -- }"
}
finish() {
    entry_ends
    exit $((failures > 0))
}
