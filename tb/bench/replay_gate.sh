#!/bin/sh
# A replayed request costs the host as much with 10 masters as with one, and in a long trace as in a short
# one, when the memory has the same to do (replay_instructions.sh BUILD gate).
#   replay_gate.sh check BUILD   exit 0: so it is; 1: no
#   replay_gate.sh compare       the same with measured lines from standard input
# Margins: a loop over all masters of ten host instructions a turn is a hundred of some 2500 and shows in
# `dealt`. A random load has more banks to choose from with several masters, which has its price.
set -eu
here=$(dirname "$0")
compare() {
  awk -v length_margin=1.02 '
    BEGIN { margin["dealt"] = 1.05; margin["random"] = 1.08 }
    $1 == "load" { next }
    {
      verdict = "as with one master"
      if ($2 == 1) { one[$1] = $6; verdict = "the measure" }
      else if (!($1 in one) || !($1 in margin)) verdict = "NOTHING TO COMPARE WITH"
      else if ($6 > one[$1] * margin[$1]) verdict = "GROWS WITH MASTERS"
      if ($6 > $5 * length_margin) verdict = "GROWS WITH LENGTH"
      if ($2 == 10) ten[$1] = 1
      if (verdict ~ /^[A-Z ]+$/) bad = 1
      printf "%-8s %2d masters, %2d reads in flight each: %d host instructions, in a longer trace %d: %s\n",
             $1, $2, $3, $5, $6, verdict
    }
    END {
      for (kind in one) { kinds++; if (!(kind in ten)) { print kind ": not measured with ten"; bad = 1 } }
      if (!kinds) { print "nothing measured"; bad = 1 }
      exit bad
    }'
}
case ${1-} in
  check) lines=$("$here/replay_instructions.sh" "$2" gate) && printf '%s\n' "$lines" | compare ;;
  compare) compare ;;
  *) echo "usage: replay_gate.sh check BUILD | compare" >&2; exit 2 ;;
esac
