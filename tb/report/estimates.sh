#!/usr/bin/env bash
# Each estimate that `fovea report --text` prints is within a factor of two of what the run that makes the change saves:
# for loops that read the look-up table, loops that read a shorter form of it, kernels of the EDMA, and the remap engine.
# Usage: estimates.sh FOVEA BUILD SOURCE OUT [KERNEL...]
set -uo pipefail
fovea=$1 build=$2 source=$3 out=$4
shift 4
kernels=("$@")
[ $# -gt 0 ] || kernels=(plain strips codes staged copy gather engine)
rm -rf "$out"
mkdir -p "$out"
cd "$source" || exit 1
failures=0
fail() { echo "$1"; failures=$((failures + 1)); }
. "$source/tb/regression/plant.sh"

# run NAME KERNEL OPTION...: two remaps of each frame, with its own table
run() {
  local name=$1 options=(-s firmware.kernel="$2")
  [ "$2" != engine ] || options+=(-s engine=tlm)
  "$fovea" run scripts/experiments/throughput.yaml --no-frames -s run.frames=2 -s firmware.repeat=2 -s firmware.tables=1 \
    "${options[@]}" "${@:3}" -o "$out/$name" >"$out/$name.log" 2>&1 || fail "$name: $(tail -2 "$out/$name.log")"
}
remap() { python3 -c 'import json,sys; print(json.load(open(sys.argv[1] + "/stats.json"))["frame.remap_time.mean"]["value"] * 1e3)' "$out/$1"; }
# compare NAME CHANGED ESTIMATE
compare() {
  python3 - "$2" "$3" "$(remap "$1")" "$(remap "$2")" <<'PY' || fail "$2: the estimate is wrong"
import sys
name, (number, unit), before, after = sys.argv[1], sys.argv[2].split(), *map(float, sys.argv[3:])
estimate, saved = float(number) * (1e-3 if unit == "us" else 1), before - after
print(f"{name}: estimated {estimate:.3f} ms, saved {saved:.3f} ms ({before:.3f} -> {after:.3f})")
sys.exit(not (saved / 2 <= estimate <= saved * 2))
PY
}
# A loop of the same instructions that reads half as many bytes of its table.
half() {
  case $1 in
    strips) run "$2" offsets16 ;;  # entries of 16 bits instead of 32
    plain)  # every second entry, also for the pair behind it; the loop's instructions stay
      firmware half kernels/remap_plain.c \
        's/^  while \(lut != end\) .*/  static const uint32_t *halved;\n  for (uint32_t n = 0; halved != lut \&\& n < pairs \/ 2; ++n) ((volatile uint32_t *)lut)[n] = lut[2 * n];\n  halved = lut;\n  end = out + pairs;\n  __asm__ volatile(\n      "1: ldr ip, [%1]; ldr ip, [%2, ip]; str ip, [%0], #4; cmp %4, %0; b 2f;"\n      "2: ldr ip, [%1], #4; ldr ip, [%3, ip]; str ip, [%0], #4; cmp %4, %0; bne 1b"\n      : "+r"(out), "+r"(lut) : "r"(base), "r"(base + 4), "r"(end) : "ip", "cc", "memory");/'
      run "$2" plain -s firmware.elf="$out/half.elf" ;;
    *) fail "$1: nothing to compare the estimate for half a table with" ;;
  esac
}

for kernel in "${kernels[@]}"; do
  run "$kernel" "$kernel"
  "$fovea" report --text "$out/$kernel" >"$out/$kernel.text" 2>&1
  estimates=0
  while read -r line; do
    estimate=$(sed -n 's/.* about \([0-9.]* [mu]s\) .*/\1/p' <<<"$line")
    case $line in
      *bus.arm_d.request_latency*) change=bridge
        run "$kernel.bridge" "$kernel" -s bus.arm_d.request_latency=2cycles -s bus.arm_d.response_latency=2cycles ;;
      *clocks.preset=297/270*) change=clocks; run "$kernel.clocks" "$kernel" -s clocks.preset=297/270 ;;
      *'half as many bytes'*) change=half; half "$kernel" "$kernel.half" ;;
      *) fail "$kernel: no run for this estimate: $line"; continue ;;
    esac
    compare "$kernel" "$kernel.$change" "$estimate"
    estimates=$((estimates + 1))
  done < <(grep '^- Estimate: ' "$out/$kernel.text")
  [ "$estimates" -gt 0 ] || fail "$kernel: no estimate: $(cat "$out/$kernel.text")"
done
echo "$failures failures"
[ "$failures" = 0 ]
