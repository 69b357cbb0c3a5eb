#!/bin/sh
# Host instructions of the core with a profile against those without (host_instructions.sh).
#   profile_gate.sh check BUILD    exit 0: at most 30 % more for each program; 1: one needs more
#   profile_gate.sh compare        the same with measured lines from standard input: first without, then with
set -eu
here=$(dirname "$0")
most=1.30
compare() {
  awk -v most=$most '
    !($1 in without) { without[$1] = $6; ++n; next }
    {
      seen[$1] = 1
      ratio = $6 / without[$1]
      printf "%-11s %.2f host instructions each, with a profile %.2f: %.3f times as many%s\n", $1,
             without[$1], $6, ratio, (ratio > most ? ": TOO MANY" : "")
      if (ratio > most) bad = 1
    }
    END {
      if (!n) { print "nothing was measured"; bad = 1 }
      for (name in without) if (!(name in seen)) { printf "%s: not measured with a profile\n", name; bad = 1 }
      exit bad
    }'
}
case ${1-} in
  check) { "$here/host_instructions.sh" "$2"; PROFILE=profile "$here/host_instructions.sh" "$2"; } | compare ;;
  compare) compare ;;
  *) echo "usage: profile_gate.sh check|compare ..." >&2; exit 2 ;;
esac
