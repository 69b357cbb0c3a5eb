#!/bin/sh
# Host instructions for each pair that paper-pal remaps with its own kernel, the core's loop, against those of the
# commit in speed_reference.txt, which is older than the EDMA and the checker of hazards: what is off costs nothing.
#   pair_gate.sh check FOVEA   measures (minutes); exit 0: not more, by at most 1 %; 1: more, or nothing was measured
#   pair_gate.sh compare       the same with the table of speed_ratios.sh from standard input
#   pair_gate.sh test          the comparison can complain
set -eu
here=$(dirname "$0")
compare() {
  awk '$1 == "board.paper-pal" && $2 > 0 && $3 > 0 { n = 1; bad = $3 > 1.01 * $2; print $3 " host instructions a pair, " $2 " before" }
    END { if (!n) print "nothing was measured"; exit bad || !n }'
}
case ${1-} in
  check) { "$here/speed_ratios.sh" "$2" board || true; } | compare ;;  # its own floor is another question
  compare) compare ;;
  test)
    echo 'board.paper-pal 2430.00 2454.00 101.0 %' | compare
    if echo 'board.paper-pal 2430.00 2455.00 101.0 %' | compare; then echo 'too many are not seen'; exit 1; fi
    if echo '' | compare; then echo 'a missing measurement is not seen'; exit 1; fi ;;
  *) echo "usage: pair_gate.sh check FOVEA | compare | test" >&2; exit 2 ;;
esac
