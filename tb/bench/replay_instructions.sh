#!/bin/sh
# replay_instructions.sh BUILD [all|gate]: host instructions for each replayed request of 32 bytes,
# counted by callgrind as the difference of two trace lengths, so that start-up does not count; and the
# rows that the memory opened for it, which say how much it had to do.
# Each load is there with 1, 4 and 10 masters. "gate" leaves out what opens other numbers of rows with
# other numbers of masters, and the windows that do not make 40 reads in flight in all.
set -eu
load=${1:?usage: replay_instructions.sh BUILD [all|gate]}/tb/bench/bench_replay_load
set=${2:-all}
printf '%-10s %7s %6s %9s %12s %12s\n' load masters window rows/req first next
line() {  # KIND MASTERS WINDOW: runs of 8 000, 24 000 and 64 000 requests
  for n in 8000 24000 64000; do
    valgrind --tool=callgrind --callgrind-out-file=/dev/null "$load" "$1" "$2" "$n" "$3" 2>&1
  done | awk -v kind="$1" -v masters="$2" -v window="$3" '
    / requests in / { n[++runs] = $1; rows[runs] = $6 }
    /Collected/ { host[runs] = $NF }
    END {
      if (runs != 3 || host[3] == "") exit 1
      printf "%-10s %7d %6d %9.3f %12.0f %12.0f\n", kind, masters, window,
             (rows[3] - rows[1]) / (n[3] - n[1]), (host[2] - host[1]) / (n[2] - n[1]),
             (host[3] - host[2]) / (n[3] - n[2])
    }'
}
for masters in 1 4 10; do line dealt $masters $((40 / masters)); done
for masters in 1 4 10; do line random $masters $((40 / masters)); done
[ "$set" = all ] || exit 0
for kind in sequential apart random; do
  for masters in 1 4 10; do line $kind $masters 8; done
done
