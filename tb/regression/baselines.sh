#!/usr/bin/env bash
# The shipped experiments are as traces/baselines says; a baseline with another figure is found, and a run that is slower
# than a shipped baseline is blamed on function, line and cause.
# Usage: baselines.sh FOVEA SOURCE OUT FIGURES THROUGHPUT
#   FIGURES     folder with the runs that the test of README.md's table made: default, paper-pal ...
#   THROUGHPUT  a run of throughput
set -euo pipefail
fovea=$1 source=$2 out=$3
rm -rf "$out"
mkdir -p "$out"
for run in "$4"/{default,paper-pal,paper-vga,paper-ntsc}; do ln -s "$run" "$out/"; done
ln -s "$5" "$out/throughput"
"$source/scripts/baselines" --check "$fovea" "$out" >"$out/check.log" || { cat "$out/check.log"; exit 1; }
[ "$(grep -c '^passed: ' "$out/check.log")" = 5 ] || { cat "$out/check.log"; echo "not five baselines were checked"; exit 1; }
# A report of a default run, with its pictures, takes at most two seconds of the processor.
TIMEFORMAT='%U %S'
{ time "$fovea" report "$out/default" -o "$out/report.html" >/dev/null; } 2>"$out/report.time"
grep -q 'data:image/png' "$out/report.html" || { echo "the report has no pictures"; exit 1; }
awk '{ t = $(NF - 1) + $NF } END { printf "a report of default: %.2f s\n", t; exit !(t > 0 && t <= 2) }' "$out/report.time"
# Another digit of one figure.
sed '/frame.remap_time.mean/,/value/s/\(value: [0-9.e-]*\)\([0-9]\)$/\19\2/' "$source/traces/baselines/default.yaml" >"$out/changed.yaml"
if cmp -s "$source/traces/baselines/default.yaml" "$out/changed.yaml"; then echo "no figure was changed"; exit 1; fi
cp -r "$source/traces/baselines/default" "$out/reference"
sed -i 's/^reference: .*/reference: reference/' "$out/changed.yaml"
status=0
"$fovea" check "$out/default" --against "$out/changed.yaml" --across-versions >"$out/changed.log" || status=$?
if [ "$status" != 1 ] || ! grep -q 'FAILED  frame.remap_time.mean' "$out/changed.log"; then
  cat "$out/changed.log"
  echo "another figure was not found: status $status"
  exit 1
fi
# The run has no profile: the way to function and line is named.
grep -q '^function and line are not known, .*: fovea run .*default.yaml .* --profile$' "$out/changed.log" ||
  { cat "$out/changed.log"; echo "no way to the function is named"; exit 1; }
"$fovea" run "$source/scripts/experiments/throughput.yaml" -s run.frames=2 -s firmware.repeat=5 --profile --no-frames \
  -s bus.arm_d.request_latency=9cycles -o "$out/slow" >/dev/null 2>"$out/slow.err"
status=0
"$fovea" check "$out/slow" --against "$source/traces/baselines/throughput.yaml" --across-versions >"$out/slow.log" || status=$?
if [ "$status" != 1 ] ||
  ! grep -qE '^blamed: [a-z0-9_]+ \([a-z0-9_]+\.[a-zA-Z]+:[0-9]+\) waits .* by [a-z_]+, .*culprit ' "$out/slow.log"; then
  cat "$out/slow.log"
  echo "the slower bridge is not blamed on a function, line and cause: status $status"
  exit 1
fi
grep '^blamed' "$out/slow.log"
