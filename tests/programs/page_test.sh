#!/bin/sh
# Runs the commands of a page, from its first line to its last, in an empty folder. Every one has to
# succeed, but for those that end with "# refused".
# usage: page_test.sh PAGE PROGRAM...
# PROGRAM: what the page calls by its name; nothing else of the build is found.
set -eu
page=$1
shift
command -v openssl > /dev/null || ! grep -q '^openssl ' "$page" || {
    echo "there is no openssl to make certificates with"
    exit 77
}

here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
mkdir bin day
for program; do
    ln -s "$program" bin/
done
. "$here/ports.sh"
# The blocks of shell, as commands that are checked; a text of several lines is one command.
{
    echo "pids=''; trap 'kill \$pids 2> /dev/null; wait' EXIT"
    awk '
        /^```$/ { is_code = 0; text = 0 }
        !is_code { if ($0 == "```sh") { is_code = 1 } next }
        /<< .END.$/ { text = 1 }
        text { print; if ($0 == "END") { text = 0 } next }
        /[^&]&$/ { print; print "pids=\"$pids $!\""; next }
        /^export / { print; next }
        /# refused$/ { print "! " $0; print "[ $? -eq 0 ] || { echo \"TAKEN: line " NR "\"; exit 1; }"; next }
        { print; print "[ $? -eq 0 ] || { echo \"FAILED: line " NR "\"; exit 1; }" }' "$page" |
        sed "s/4840/$port/g; s/:5020/:$((port + 1))/; s/:5007/:$((port + 2))/"
} > commands.sh
[ "$(wc -l < commands.sh)" -gt 3 ] || { echo "$page has no commands"; exit 1; }
cd day
PATH=$work/bin:$PATH XDG_DATA_HOME=$PWD/data timeout 300 sh ../commands.sh > ../out 2>&1 || {
    cat ../out ./*.log
    exit 1
}
cat ../out
