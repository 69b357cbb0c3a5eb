#!/usr/bin/env bash
# Each estimate of `fovea report --text` is within a factor of two of what the run that makes the change saves: with
# pixels that the core moves, and with kernels of the EDMA. Usage: estimates.sh FOVEA SOURCE OUT
set -euo pipefail
fovea=$1 source=$2 out=$3
rm -rf "$out"
mkdir -p "$out"
cd "$source"
run() { "$fovea" run "scripts/experiments/$1.yaml" --no-frames -o "$out/$2" "${@:3}" >/dev/null; }
remap() { python3 -c 'import json,sys; print(json.load(open(sys.argv[1] + "/stats.json"))["frame.remap_time.mean"]["value"] * 1e3)' "$out/$1"; }
status=0
# compare BASE CHANGED PATTERN: the estimate in BASE whose sentence has PATTERN against the run CHANGED
compare() {
  local estimate
  "$fovea" report --text "$out/$1" >"$out/$1.text"
  estimate=$(sed -n "s/^- Estimate: .*$3.* about \([0-9.]* [mu]s\) .*/\1/p" "$out/$1.text")
  [ -n "$estimate" ] || { echo "$2: no estimate"; cat "$out/$1.text"; status=1; return; }
  python3 - "$2" "$estimate" "$(remap "$1")" "$(remap "$2")" <<'PY' || status=1
import sys
name, (number, unit), before, after = sys.argv[1], sys.argv[2].split(), *map(float, sys.argv[3:])
estimate, saved = float(number) * (1e-3 if unit == "us" else 1), before - after
print(f"{name}: estimated {estimate:.3f} ms, saved {saved:.3f} ms ({before:.3f} -> {after:.3f})")
sys.exit(not (saved / 2 <= estimate <= saved * 2))
PY
}
bridge=(-s bus.arm_d.request_latency=2cycles -s bus.arm_d.response_latency=2cycles)
run paper-pal base -s run.frames=3
run paper-pal bridge -s run.frames=3 "${bridge[@]}"
run paper-pal clocks -s run.frames=3 -s clocks.preset=297/270
compare base bridge request_latency
compare base clocks clocks.preset
# The same loop with entries of 32 and of 16 bits.
small=(-s run.frames=2 -s firmware.repeat=2 -s firmware.tables=1)
run throughput strips "${small[@]}" -s firmware.kernel=strips
run throughput offsets16 "${small[@]}" -s firmware.kernel=offsets16
compare strips offsets16 'half as many bytes'
for kernel in staged copy; do
  run throughput $kernel "${small[@]}" -s firmware.kernel=$kernel
  run throughput $kernel.clocks "${small[@]}" -s firmware.kernel=$kernel -s clocks.preset=297/270
  compare $kernel $kernel.clocks clocks.preset
done
exit $status
