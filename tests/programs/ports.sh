# Sets port to the first of eight ports that belong to the script that reads this file, and to the
# programs that it starts: the lock on file descriptor 6 is free again when the last of them has
# ended. Scripts that run beside it get others. Not a program.

command -v flock > /dev/null || { echo "there is no flock"; exit 1; }
ports=${TMPDIR:-/tmp}/busbar-ports-$(id -u)
mkdir -p "$ports"
# Below 32000, so that the kernel does not give them to outgoing connections.
block=$(($$ % 1500))
for tried in $(seq 1501); do
    [ "$tried" -le 1500 ] || { echo "no ports are free"; exit 1; }
    port=$((20000 + block * 8))
    exec 6> "$ports/$port"
    # Another program may listen there: the local address is the second column, LISTEN is 0A.
    if flock -n 6 && ! cat /proc/net/tcp /proc/net/tcp6 2> /dev/null | awk -v first="$port" '
        function number(text, i, sum) {
            for (i = 1; i <= 4; ++i) {
                sum = sum * 16 + index("123456789ABCDEF", substr(text, i, 1))
            }
            return sum
        }
        $4 == "0A" {
            used = number(substr($2, length($2) - 3))
            if (used >= first && used < first + 8) { found = 1 }
        }
        END { exit !found }'; then
        break
    fi
    block=$(((block + 1) % 1500))
done
