#!/usr/bin/env bash
# The bus traces of the tree replay to the figures of traces recorded now; and a changed memory changes
# them. Usage: shipped.sh FOVEA PROJECT_SOURCE OUT
set -uo pipefail
fovea=$1 source=$2 out=$3
rm -rf "$out"
mkdir -p "$out"
failures=0
fail() { echo "$1"; failures=$((failures + 1)); }
"$source/traces/bus/record" "$fovea" "$out" >/dev/null || fail 'recording failed'
for name in paper-pal throughput; do
  shipped=$source/traces/bus/$name.trace
  [ "$(stat -c %s "$shipped")" -le $((2 << 20)) ] || fail "$name: larger than 2 MiB"
  "$fovea" replay "$shipped" -o "$out/$name.shipped" >/dev/null || fail "$name: replay failed"
  "$fovea" replay "$out/$name.trace" -o "$out/$name.now" >/dev/null || fail "$name: replay failed"
  "$fovea" replay "$shipped" -s ddr.CL=4cycles -o "$out/$name.other" >/dev/null ||
    fail "$name: replay failed"
  cmp "$out/$name.shipped/stats.json" "$out/$name.now/stats.json" ||
    fail "$name: the tree's trace is not what 'traces/bus/record' makes now"
  cmp -s "$out/$name.shipped/stats.json" "$out/$name.other/stats.json" &&
    fail "$name: another CL changes nothing"
done
echo "$failures failures"
[ "$failures" = 0 ]
