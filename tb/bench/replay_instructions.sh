#!/bin/sh
# replay_instructions.sh BUILD: host instructions for each replayed request of 32 bytes, counted by
# callgrind: the difference of two trace lengths, so that start-up does not count.
set -eu
load=${1:?usage: replay_instructions.sh BUILD}/tb/bench/bench_replay_load
count() {
  valgrind --tool=callgrind --callgrind-out-file=/dev/null "$load" "$1" "$2" "$3" 2>&1 |
    awk '/Collected/ { print $NF }'
}
printf '%-10s %7s %16s %16s\n' load masters 'first 40 000' 'next 160 000'
for kind in sequential apart random; do
  for masters in 1 4 10; do
    a=$(count $kind $masters 10000)
    b=$(count $kind $masters 50000)
    c=$(count $kind $masters 210000)
    awk -v k=$kind -v m=$masters -v a="$a" -v b="$b" -v c="$c" 'BEGIN {
      printf "%-10s %7d %16.0f %16.0f\n", k, m, (b - a) / 40000, (c - b) / 160000 }'
  done
done
