#!/bin/sh
# Runs busbar-model-bench with a small project, and looks at what it prints; not at how long anything
# took.
# usage: model_bench_test.sh BUSBAR_MODEL_BENCH SOURCE_DIR CMAKE
set -eu
bench=$1 source=$2 cmake=$3

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# has TEXT FILE
has() {
    grep -q -- "$1" "$2" || { echo "not found: $1, in:"; cat "$2"; exit 1; }
}

"$bench" project --objects 2 > project.txt
has "(mapped)  *400 (200)  *4000 (2000)" project.txt
for phase in import check export write verify; do
    has "^$phase, us a node  *[0-9.]*  *[0-9.]* (" project.txt
done
"$bench" project --objects 1 --json > project.json
"$cmake" -D FILE="$work/project.json" -P "$source/tests/programs/check_json.cmake"
has '"nodes": 200, "mapped": 100, "files": 1, "preset": "rd81opc96", ' project.json
has '"import_growth": null, ' project.json
has '"nodes": 2000, "mapped": 1000, "files": 10, "preset": null, ' project.json
has '"verify_us_per_node": .*, "held_bytes": [1-9]' project.json

"$bench" --variables 1000,2000 > growth.txt
for figure in "find a node" "Browse 10,000 references" "translate 1,000 paths of 3"; do
    has "^$figure, [nu]s  *[0-9.]*  *[0-9.]*  *[0-9.]*$" growth.txt
done
