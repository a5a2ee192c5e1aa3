#!/bin/sh
# check_facts.sh <schemas> <facts>: runs schemas/normalise/check.mjs; 77 when it cannot.
schemas=$1
facts=${BUSBAR_FACTS:-$2}
if [ ! -f "$facts/ns0_nodes.csv" ]; then
  echo "skipped: no facts to compare with in $facts (BUSBAR_FACTS names another folder)"
  exit 77
fi
if ! command -v node >/dev/null; then
  echo "skipped: the check needs Node.js, which is not installed"
  exit 77
fi
exec node "$schemas/normalise/check.mjs" "$facts" "$schemas"
