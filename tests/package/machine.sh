# What tests/package/debian and tests/package/systemd have in common; both have the same arguments,
# and define inside, which runs a command on the machine.
[ $# -ge 2 ] || { sed -n '2,/^set/s/^# //p' "$0" >&2; exit 2; }
mkdir -p "$1"
root=$(cd "$1" && pwd)
packages=$(cd "$2" && pwd)
unit=$root/lib/systemd/system/busbar-controller.service
before=$(cd "${3:-$2}" && pwd)
failures=0
fail() {
    failures=$((failures + 1))
    echo "FAILED: $*"
}
step() { echo "== $*"; }
variables="PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive"
# shellcheck disable=SC2086
on_root() { chroot "$root" env -i $variables "$@"; }

# A bare Debian 12 in the root, with the package sources of this machine.
make_root() {
    if [ ! -e "$root/bin/sh" ]; then
        step "debootstrap"
        debootstrap --variant=minbase bookworm "$root" > "$root.log"
        cp -r /etc/apt/. "$root/etc/apt/"
        [ ! -e "$root/etc/apt/sources.list.d/debian.sources" ] || rm -f "$root/etc/apt/sources.list"
        cp -r /usr/share/keyrings/. "$root/usr/share/keyrings/" 2> /dev/null || true
    fi
    cp /etc/resolv.conf "$root/etc/resolv.conf" 2> /dev/null || true
}

# put FOLDER NAME...: installs these packages of a folder, with what they depend on.
put() {
    mkdir -p "$root/packages"
    rm -f "$root"/packages/*
    folder=$1
    shift
    files=""
    for name in "$@"; do
        cp "$folder/${name}"_*.deb "$root/packages/"
        files="$files $(cd "$root" && ls packages/"${name}"_*.deb | sed 's|^|/|')"
    done
    # shellcheck disable=SC2086
    inside apt-get install -y -qq --no-install-recommends --allow-downgrades \
        -o Dpkg::Options::=--force-confold $files > "$root.apt" 2>&1 ||
        { cat "$root.apt"; fail "apt-get install $*"; exit 1; }
}
busbar() { inside env HOME=/root busbar "$@"; }

# set_up URL CODE: the first administrator, chief.
set_up() {
    echo "$2" > "$root/root/code"
    echo "patience is all" > "$root/root/password"
    busbar admin setup "$1" chief --user setup --password-file /root/code \
        --new-password-file /root/password --trust > "$root.out" 2>&1 ||
        { cat "$root.out"; fail "no setup"; }
}
chief="--user chief --password-file /root/password"

own_certificate() {
    (cd "$root/var/lib/busbar" && find . -type f -path '*own/certs*' -exec sha256sum {} +)
}

end() {
    [ "$failures" -eq 0 ] || exit 1
    echo "all is well"
}
