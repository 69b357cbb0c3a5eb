#!/usr/bin/env bash
# What does not go with a camera at the digital port is refused with one line that names the key, before anything runs;
# a kernel that knows one size of pictures is replaced, and the firmware says so.
# Usage: digital_refusals.sh FOVEA SOURCE OUT
set -uo pipefail
fovea=$1 experiment=$2/scripts/experiments/default.yaml out=$3
failures=0
camera=(-s video.standard=svga_progressive -s camera.kind=chart -s run.frames=1)
fail() {
  echo "$*"
  failures=$((failures + 1))
}
refused() { # KEY WHAT-IS-ALLOWED OPTIONS...
  local key=$1 allowed=$2 text got
  shift 2
  rm -rf "$out"
  text=$("$fovea" run "$experiment" "${camera[@]}" "$@" -o "$out" 2>&1)
  got=$?
  if [ $got != 2 ] || [ -e "$out" ] || [ "$(wc -l <<<"$text")" != 1 ] ||
    [[ $text != "fovea: error: key '$key': "*"$allowed with video.standard = "* ]]; then
    fail "$*: status $got: $text"
  fi
}
refused cameras.count 'allowed: 1' -s cameras.count=2
refused fault.kind 'allowed: none' -s fault.kind=missing_lines
refused firmware.view 'allowed: single' -s firmware.view=four_way
refused firmware.program 'allowed: auto or one_camera' -s firmware.program=cameras
refused firmware.display_phase 'allowed: locked' -s firmware.display_phase=free
refused video.width 'allowed: up to 640' -s video.standard=vga_progressive -s video.width=720

replaced() { # KERNEL WHAT-IS-TAKEN OPTIONS...
  local kernel=$1 taken=$2 says got
  shift 2
  rm -rf "$out"
  "$fovea" run "$experiment" "${camera[@]}" -s video.width=240 -s video.height=200 -s firmware.kernel="$kernel" "$@" \
    --no-frames -o "$out" >"$out.txt" 2>&1
  got=$?
  [ $got = 0 ] || fail "kernel $kernel: status $got: $(tail -3 "$out.txt")"
  for says in "kernel $kernel: camera and display have different sizes" "$taken"; do
    grep -qF "$says" "$out/uart.log" || fail "kernel $kernel lacks '$says': $(cat "$out/uart.log")"
  done
}
replaced copy 'kernel: codes, '
for kernel in engine engine_grid engine_radial; do replaced $kernel 'kernel: staged, ' -s engine=tlm; done
[ $failures = 0 ]
