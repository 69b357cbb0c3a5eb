#!/usr/bin/env bash
# `fovea run --hazards`: the product's firmware has no coherency hazards, the versions with one cache
# operation left out have theirs, each with its place; and the option changes nothing else.
# Usage: hazards.sh FOVEA EXPERIMENT FIRMWARE_FOLDER OUT
set -euo pipefail
fovea=$1 experiment=$2 firmware=$3 out=$4
mkdir -p "$out"
run() {  # NAME STATUS ELF OPTION...
  local name=$1 status=$2 elf=$3 got=0
  shift 3
  "$fovea" run "$experiment" -s firmware.kernel=plain -s run.frames=4 -s video.width=128 -s video.height=64 -s camera.stamp=false \
    -s "firmware.elf=$firmware/$elf" -s firmware.flow=serial "$@" -o "$out/$name" --no-frames \
    >"$out/$name.out" 2>"$out/$name.err" || got=$?
  [ "$got" = "$status" ] || { echo "$name: status $got instead of $status"; cat "$out/$name.err"; exit 1; }
}
value() { grep -o "\"$2\": {\"value\": [0-9.e-]*" "$out/$1/stats.json" | sed 's/.*: //'; }
is() {  # NAME FIGURE CONDITION
  local got
  got=$(value "$1" "$2")
  [ -n "$got" ] && [ "$got" "${@:3}" ] || { echo "$1: $2 is '$got', not $*"; exit 1; }
}
says() { grep -qE "$2" "$out/$1.err" || { echo "$1: no message like '$2'"; cat "$out/$1.err"; exit 1; }; }

run right 0 fovea_firmware.elf --hazards --strict -s firmware.overlay=true -s firmware.patch=true
for figure in stale_loads dirty_reads buffered_reads overwrites places; do is right "hazard.$figure" -eq 0; done
run double 0 fovea_firmware.elf --hazards --strict -s firmware.flow=double
is double hazard.places -eq 0

# The kernels that share memory with the EDMA maintain the caches themselves.
for kernel in codes staged gather runs copy; do
  run "$kernel" 0 fovea_firmware.elf --hazards --strict -s firmware.kernel=$kernel -s run.frames=2
  is "$kernel" hazard.places -eq 0
  grep -q "kernel: $kernel," "$out/$kernel/uart.log" || { echo "$kernel: $(cat "$out/$kernel/uart.log")"; exit 1; }
done

# So do those of the remap engine, over results that the core has drawn on.
for kernel in engine engine_grid; do
  run "$kernel" 0 fovea_firmware.elf --hazards --strict -s firmware.kernel=$kernel -s run.frames=2 -s engine=tlm \
    -s firmware.overlay=true
  is "$kernel" hazard.places -eq 0
  grep -q "kernel: $kernel," "$out/$kernel/uart.log" || { echo "$kernel: $(cat "$out/$kernel/uart.log")"; exit 1; }
done

# The firmware for several cameras, with kernels for the core and for the EDMA, and the one for views of them.
several=(--hazards --strict -s firmware.flow=double -s tvp5146.relock_fields=0)
for kernel in plain staged; do
  run "cameras_$kernel" 0 fovea_cameras.elf "${several[@]}" -s cameras.count=2 -s firmware.kernel=$kernel
  is "cameras_$kernel" hazard.places -eq 0
  grep -q '2 cameras in turn' "$out/cameras_$kernel/uart.log" || { cat "$out/cameras_$kernel/uart.log"; exit 1; }
done
run views 0 fovea_views.elf "${several[@]}" -s cameras.count=4 -s firmware.view=four_way
is views hazard.places -eq 0
grep -q '4 cameras in one picture' "$out/views/uart.log" || { cat "$out/views/uart.log"; exit 1; }

run stale 0 omit_d_invalidate.elf --hazards
is stale hazard.stale_loads -gt 0
says stale 'warning \(firmware\): coherency hazard: the load at 0x[0-9a-f]+ \([a-z_0-9.]+(\+0x[0-9a-f]+)?\) read 0x8[0-9a-f]{7} at [0-9.]+ ms from a D-cache line that was filled at [0-9.]+ ms; vpfe wrote that memory at [0-9.]+ ms'
run stale_strict 3 omit_d_invalidate.elf --hazards --strict
says stale_strict 'the guest failed: [0-9]+ coherency hazards at [0-9]+ places?'

run dirty 0 omit_d_clean.elf --hazards -s firmware.overlay=true
is dirty hazard.dirty_reads -gt 0
says dirty 'coherency hazard: vpbe read 0x8[0-9a-f]{7} at [0-9.]+ ms, but the bytes that were stored at 0x[0-9a-f]+ \([a-z_]+'

# Who works ahead does not matter, and without the option only its figures and warnings are missing.
run stale_sync 0 omit_d_invalidate.elf --hazards --sync=strict
cmp "$out/stale/stats.json" "$out/stale_sync/stats.json"
run off 0 omit_d_invalidate.elf
if grep -q hazard "$out/off/stats.json"; then echo "figures without the option"; exit 1; fi
figures() { grep '{"value"' "$out/$1/stats.json" | grep -v '"hazard\.' | sed 's/,$//'; }
diff <(figures off) <(figures stale)
for file in frames.csv timeline.csv stalls.csv uart.log; do cmp "$out/off/$file" "$out/stale/$file"; done
