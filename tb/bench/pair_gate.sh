#!/bin/sh
# Host instructions for each pair that paper-pal and default remap with the kernel plain, the core's loop, against those
# of the commit in speed_reference.txt, which is older than the EDMA and the checker of hazards: what is off costs
# nothing.
#   pair_gate.sh check FOVEA   measures (minutes); exit 0: not more, by at most 1 %; 1: more, or not all was measured
#   pair_gate.sh compare       the same with the table of speed_ratios.sh from standard input
#   pair_gate.sh test          the comparison can complain
# KERNEL: another kernel for default, to see what it costs; the reference is that of plain.
set -eu
here=$(dirname "$0")
compare() {
  awk '
    ($1 == "board.paper-pal" || $1 == "board.default") && $2 > 0 && $3 > 0 {
      n++
      over = $3 > 1.01 * $2
      if (over) bad = 1
      print $1 ": " $3 " host instructions a pair, " $2 " before" (over ? ": TOO MANY" : "")
    }
    END { if (n != 2) { print "not all was measured"; bad = 1 }; exit bad }'
}
case ${1-} in
  check) { "$here/speed_ratios.sh" "$2" board default || true; } | compare ;;  # its own floors are another question
  compare) compare ;;
  test)
    paper='board.paper-pal 2430.00 2454.00 101.0 %' default='board.default 2576.00 2601.00 101.0 %'
    try() {  # STATUS LINE...
      want=$1 got=0
      shift
      text=$(printf '%s\n' "$@" | compare) || got=$?
      [ $got = "$want" ] || { echo "status $got instead of $want for: $*: $text"; exit 1; }
    }
    try 0 "$paper" "$default"
    try 1 'board.paper-pal 2430.00 2455.00 101.0 %' "$default"
    try 1 "$paper" 'board.default 2576.00 2602.00 101.0 %'
    try 1 "$paper"
    try 1 "$default"
    try 1 '' ;;
  *) echo "usage: pair_gate.sh check FOVEA | compare | test" >&2; exit 2 ;;
esac
