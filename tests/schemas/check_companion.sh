#!/bin/sh
# check_companion.sh <schemas> <folder of reference files>...: runs check_companion.mjs; 77 when it
# cannot. BUSBAR_NODESETS names one more folder.
schemas=$1
shift
if ! command -v node >/dev/null; then
  echo "skipped: the check needs Node.js, which is not installed"
  exit 77
fi
exec node "$schemas/normalise/check_companion.mjs" "$schemas/companion" ${BUSBAR_NODESETS:+"$BUSBAR_NODESETS"} "$@"
