#!/bin/sh
# gate.sh complains about one instruction more in each handler, a program that is missing or unknown;
# it does not pass what it cannot compare.
set -u
gate=$(dirname "$0")/gate.sh
record=$(mktemp "${TMPDIR:-/tmp}/fovea_gate.XXXXXX")
trap 'rm -f "$record"' EXIT
printf 'gcc-1 soft 20.00\ngcc-1 copy 10.00\ngcc-2 soft 5.00\n' >"$record"
status=0
expect() {  # EXIT SENTENCE MEASURED
  out=$(printf "$3" | "$gate" compare "$record" "${4:-gcc-1}")
  got=$?
  [ $got -eq "$1" ] || { echo "$2: exit $got, expected $1: $out"; status=1; }
}
same='copy 1 guest 1 host 10.00 each\n'
expect 0 'as recorded' "soft 1 guest 1 host 20.00 each\n$same"
expect 0 'within the margin' "soft 1 guest 1 host 20.59 each\n$same"
expect 1 'one more in each handler' "soft 1 guest 1 host 20.61 each\n$same"
expect 1 'one program of two' "soft 1 guest 1 host 20.00 each\ncopy 1 guest 1 host 10.31 each\n"
expect 0 'fewer' "soft 1 guest 1 host 15.00 each\n$same"
expect 1 'a program is missing' "$same"
expect 1 'a program is new' "soft 1 guest 1 host 20.00 each\nremap 1 guest 1 host 3.00 each\n$same"
expect 77 'another compiler' "$same" gcc-3
exit $status
