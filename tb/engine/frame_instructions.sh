#!/usr/bin/env bash
# Host instructions of the whole simulator for a frame of paper-pal.yaml, by valgrind: with the core's plain loop and no
# engine, and with the engine as transaction-level model. That of a frame is the difference of runs of 3 frames and of 1,
# halved, so that start-up does not count.
# Usage: frame_instructions.sh FOVEA SOURCE OUT [-s KEY=VALUE...]: fails if the engine's frame costs more.
set -uo pipefail
fovea=$1 source=$2 out=$3
shift 3
mkdir -p "$out"
count() { # FRAMES ARGUMENTS...
  local frames=$1
  shift
  valgrind --tool=callgrind --callgrind-out-file=/dev/null "$fovea" run "$source/scripts/experiments/paper-pal.yaml" \
    -s run.frames="$frames" -s firmware.lut=fixed_point --no-frames "$@" -o "$out/run" 2>&1 |
    grep -oE "Collected : [0-9]+" | grep -oE "[0-9]+"
}
frame() { # ARGUMENTS...
  local one three
  one=$(count 1 "$@") && three=$(count 3 "$@") && echo $(((three - one) / 2))
}
loop=$(frame -s engine=none "$@") model=$(frame -s engine=tlm -s firmware.kernel=engine "$@")
[ "${loop:-0}" -gt 0 ] && [ "${model:-0}" -gt 0 ] || { echo "nothing was counted"; exit 1; }
awk -v l="$loop" -v m="$model" 'BEGIN {
  printf "a frame: the loop %d host instructions, engine=tlm %d: %.2f times as many\n", l, m, m / l
  exit !(m <= l) }'
