#!/usr/bin/env bash
# A key of the EDMA's internal RAM is said to have no effect only with kernels whose runs have no transaction of the EDMA,
# on a chip with a remap engine and on one without: of each kernel that there is, the run's traffic tells.
# Usage: kernel_keys.sh FOVEA OUT
set -uo pipefail
fovea=$1 out=$2
rm -rf "$out"
mkdir -p "$out"
cd "$out" || exit 1
failures=0
fail() { echo "$1"; failures=$((failures + 1)); }
cat >small.yaml <<'Y'
run: {frames: 1}
camera: {kind: chart, stamp: false}
video: {width: 320, height: 96}
firmware: {lut: fixed_point}
Y
kernels=$("$fovea" params firmware.kernel | grep -o 'plain, [a-z0-9_, ]*[a-z]' | head -1 | tr -d ,)
[ "$(wc -w <<<"$kernels")" -ge 14 ] || fail "few kernels: $kernels"
moving=0 still=0
for engine in none tlm; do
  for kernel in $kernels; do
    name=$kernel-$engine
    "$fovea" run small.yaml --no-frames -s "firmware.kernel=$kernel" -s "engine=$engine" -s cpu.tcm.first=dma \
      -o "$name" >"$name.out" 2>"$name.err" || { fail "$name: $(tail -1 "$name.err")"; continue; }
    transactions=$(grep -oE '"bus\.edma_tc[0-9]\.transactions": \{"value": [0-9]+' "$name/stats.json" |
      awk '{sum += $NF} END {print sum + 0}')
    idle=$(grep -c "'cpu.tcm.first' is set.*has no effect" "$name.err")
    if [ "$transactions" -gt 0 ]; then
      moving=$((moving + 1))
      [ "$idle" = 0 ] || fail "$name: the key is said to have no effect, and the EDMA has $transactions transactions"
    else
      still=$((still + 1))
      [ "$idle" = 1 ] || [ "$engine" = tlm ] || fail "$name: no word of a key that can have no effect"
    fi
  done
done
[ "$moving" -ge 8 ] && [ "$still" -ge 6 ] || fail "the EDMA moves pixels in $moving runs and not in $still"
echo "$moving runs with the EDMA, $still without, $failures failures"
[ "$failures" = 0 ]
