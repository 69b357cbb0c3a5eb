#!/bin/sh
# trace_instructions.sh BUILD [FOVEA]: host instructions for each record of a text trace, counted by
# callgrind as the difference of two lengths: for reading it, and with FOVEA (a program, also an older
# one) for `FOVEA replay` as a whole.
#   trace_instructions.sh check BUILD   reading is below the limits (exit 0) or not (1)
# Limits: 15 % above what was measured (330, 359 and 490; stamped lines have more digits).
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
make() {  # KIND MASTERS LINES
  awk -v kind="$1" -v masters="$2" -v lines="$3" 'BEGIN {
    print "# dramtrace 1"
    for (m = 0; m < masters; m++) print "# master " m " window 8 m" m
    seed = 1
    for (i = 0; i < lines; i++) {
      m = i % masters
      seed = (seed * 16807) % 2147483647
      if (kind == "sequential") printf "0 %d R 0x%x 32\n", m, m * 1048576 + int(i / masters) * 32 % 1048576
      else printf "%d %d %s 0x%x 32\n", kind == "stamped" ? i * 60000 : 0, m, seed % 4 ? "R" : "W", seed % 2097152 * 32
    }
  }'
}
count() { valgrind --tool=callgrind --callgrind-out-file=/dev/null "$@" 2>&1 | awk '/Collected/ { print $NF }'; }
per_record() {  # COMMAND... with FILE as the last word's stand-in: of runs of 40 000 and 130 000 records
  short=$(count "$@" "$work/short.txt" $more)
  long=$(count "$@" "$work/long.txt" $more)
  echo $(((long - short) / 90000))
}
mode=measure
[ "$1" = check ] && { mode=check; shift; }
build=$1 fovea=${2-}
printf '%-12s %7s %8s %8s\n' load masters read replay
status=0
for load in 'sequential 1 380' 'random 1 413' 'stamped 4 563'; do  # KIND MASTERS LIMIT
  set -- $load
  make "$1" "$2" 40000 >"$work/short.txt"
  make "$1" "$2" 130000 >"$work/long.txt"
  more=
  read=$(per_record "$build/tb/bench/bench_trace_read")
  replay=-
  if [ -n "$fovea" ]; then
    more="-o $work/out"
    replay=$(per_record "$fovea" replay)
  fi
  printf '%-12s %7d %8d %8s\n' "$1" "$2" "$read" "$replay"
  [ "$mode" = measure ] || [ "$read" -le "$3" ] || { echo "reading costs more than $3"; status=1; }
done
exit $status
