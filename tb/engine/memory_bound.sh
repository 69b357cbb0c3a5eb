#!/usr/bin/env bash
# scripts/memory-bound on a small picture: its table, its comparison with the page, runs that fail.
# Usage: memory_bound.sh FOVEA SOURCE OUT
set -uo pipefail
fovea=$1 source=$2 out=$3
rm -rf "$out"
mkdir -p "$out"
cd "$out" || exit 1
fail() {
  echo "$*"
  exit 1
}
study() {
  "$source/scripts/memory-bound" --fovea "$fovea" --experiment "$source/scripts/experiments/paper-pal.yaml" -j 1 \
    -s video.width=96 -s video.height=64 -s camera.kind=chart -s camera.stamp=false -s firmware.repeat=1 \
    --lenses 180 --latencies 2 --caches 32B "$@"
}
study --check >table 2>difference
[ $? = 1 ] || fail "--check finds the page's table: $(cat difference)"
# 719 lines instead of 192 (lines_read and lines_needed of tb/rtl): (719 * 32 + 144 + 12288) / (192 * 32 + 144 + 12288).
grep -qE '^\| 180° \| 2 clocks \| 1\.91 / [0-9]+ \|$' difference || fail "no such row: $(cat difference)"
study -s no.key=1 >/dev/null 2>wrong
[ $? = 1 ] && grep -q "no.key" wrong || fail "a run that fails: $(cat wrong)"
study -s engine=none >/dev/null 2>wrong
[ $? = 1 ] && grep -q "another kernel" wrong || fail "a board without an engine: $(cat wrong)"
study -j 0 >/dev/null 2>wrong
[ $? = 2 ] || fail "-j 0: $(cat wrong)"
echo "table, comparison, failures: good"
