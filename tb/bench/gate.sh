#!/bin/sh
# Host instructions for each guest instruction (host_instructions.sh) against recorded ones.
#   gate.sh check BUILD RECORD KEY     exit 0: as recorded; 1: a program needs more; 77: not compared
#   gate.sh compare RECORD KEY         the same with measured lines from standard input
#   gate.sh record BUILD RECORD KEY    replaces the lines of KEY
# KEY names both compilers: other ones make other code, which nothing is recorded for. For one KEY the
# counts are the same on each run; the margin of 3 % leaves room for other inlining after a change
# elsewhere. One host instruction more in each handler is 4 % of soft_float and integer.
set -eu
here=$(dirname "$0")
margin=1.03
compare() {  # RECORD KEY
  grep -q "^$2 " "$1" || { echo "not compared: other compiler ($2)"; exit 77; }
  awk -v key="$2" -v margin=$margin -v record="$1" '
    BEGIN { while ((getline line < record) > 0) { split(line, f, " "); if (f[1] == key) want[f[2]] = f[3] } }
    {
      if (!($1 in want)) { printf "%s: nothing recorded\n", $1; bad = 1; next }
      seen[$1] = 1
      verdict = $6 > want[$1] * margin ? "TOO MANY" : $6 * margin < want[$1] ? "fewer: record anew" : "as recorded"
      printf "%-11s %.2f host instructions each, recorded %.2f: %s\n", $1, $6, want[$1], verdict
      if (verdict == "TOO MANY") bad = 1
    }
    END {
      for (name in want) if (!(name in seen)) { printf "%s: not measured\n", name; bad = 1 }
      exit bad
    }'
}
case ${1-} in
  check)
    grep -q "^$4 " "$3" || { echo "not compared: other compiler ($4)"; exit 77; }
    "$here/host_instructions.sh" "$2" | compare "$3" "$4" ;;
  compare) compare "$2" "$3" ;;
  record)
    lines=$("$here/host_instructions.sh" "$2" | awk -v key="$4" '{ print key, $1, $6 }')
    { grep -v "^$4 " "$3" || true; printf '%s\n' "$lines"; } >"$3.new"
    mv "$3.new" "$3" ;;
  *) echo "usage: gate.sh check|compare|record ..." >&2; exit 2 ;;
esac
