#!/usr/bin/env bash
# What does not fit a quad processor is refused with one line that names the key, before anything runs.
# Usage: quad_refusals.sh FOVEA SOURCE OUT
set -uo pipefail
fovea=$1 experiment=$2/scripts/experiments/birds-eye-quad.yaml out=$3
failures=0
refused() { # KEY WHAT-IS-ALLOWED OPTIONS...
  local key=$1 allowed=$2 text got
  shift 2
  rm -rf "$out"
  text=$("$fovea" run "$experiment" -s run.frames=1 "$@" -o "$out" 2>&1)
  got=$?
  if [ $got != 2 ] || [ -e "$out" ] || [[ $text != "fovea: error: key '$key': "*"$allowed"* ]] ||
    [ "$(wc -l <<<"$text")" != 1 ]; then
    echo "$*: status $got: $text"
    failures=$((failures + 1))
  fi
}
refused fault.camera '0 with cameras.quad' -s fault.kind=unplugged -s fault.camera=1
refused camera.1.standard 'that of camera 0' -s camera.1.standard=525/60
refused cameras.quad 'with the whole picture' -s video.width=716
refused cameras.quad 'with the whole picture' -s video.height=572
refused cameras.quad 'cameras.count = 4' -s cameras.count=3
refused cameras.quad 'genlocked' -s camera.2.genlocked=false
refused cameras.quad 'four_way or birds_eye' -s firmware.view=single
refused cameras.multiplexer 'decoder with cameras.quad' -s cameras.multiplexer=gpio
refused cameras.multiplexer 'decoder with firmware.view' -s cameras.quad=false -s cameras.multiplexer=gpio
[ $failures = 0 ]
