#!/usr/bin/env bash
# Each estimate of `fovea report --text` is within a factor of two of what the run that makes the change saves.
# Usage: estimates.sh FOVEA SOURCE OUT
set -euo pipefail
fovea=$1 source=$2 out=$3
rm -rf "$out"
mkdir -p "$out"
cd "$source"
run() { "$fovea" run scripts/experiments/paper-pal.yaml -s run.frames=3 --no-frames -o "$out/$1" "${@:2}" >/dev/null; }
run base
run bridge -s bus.arm_d.request_latency=2cycles -s bus.arm_d.response_latency=2cycles
run clocks -s clocks.preset=297/270
"$fovea" report --text "$out/base" > "$out/text"
remap() { python3 -c 'import json,sys; print(json.load(open(sys.argv[1] + "/stats.json"))["frame.remap_time.mean"]["value"] * 1e3)' "$out/$1"; }
status=0
while read -r name pattern; do
  estimate=$(sed -n "s/^- Estimate: .*$pattern.* about \([0-9.]*\) ms .*/\1/p" "$out/text")
  [ -n "$estimate" ] || { echo "no estimate for $name"; cat "$out/text"; exit 1; }
  python3 - "$name" "$estimate" "$(remap base)" "$(remap "$name")" <<'PY' || status=1
import sys
name, estimate, before, after = sys.argv[1], *map(float, sys.argv[2:])
saved = before - after
print(f"{name}: estimated {estimate:.2f} ms, saved {saved:.2f} ms ({before:.2f} -> {after:.2f})")
sys.exit(not (saved / 2 <= estimate <= saved * 2))
PY
done <<'LIST'
bridge request_latency
clocks clocks.preset
LIST
exit $status
