#!/bin/sh
# A replayed request costs the host as much with 10 masters as with one, and in a long trace as in a short
# one, when the memory has the same to do (replay_instructions.sh BUILD gate).
#   replay_gate.sh check BUILD   exit 0: so it is; 1: no
#   replay_gate.sh compare       the same with measured lines from standard input
# A loop over all masters of ten host instructions a turn makes 4 % of a request; what may grow with
# neighbours are the rows that a random load finds closed by others, which the margin has room for.
set -eu
here=$(dirname "$0")
compare() {
  awk -v masters_margin=1.08 -v length_margin=1.02 '
    $1 == "load" { next }
    {
      verdict = "as with one master"
      if ($2 == 1) { one[$1] = $6; verdict = "the measure" }
      else if (!($1 in one)) verdict = "NOTHING TO COMPARE WITH"
      else if ($6 > one[$1] * masters_margin) verdict = "GROWS WITH MASTERS"
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
