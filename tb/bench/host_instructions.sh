#!/bin/sh
# host_instructions.sh BUILD [PROGRAM...]: host instructions in Core::run() for each guest
# instruction, counted by callgrind over the first four million core clocks. With PROFILE=profile in the
# environment the core keeps a profile.
set -eu
build=${1:?usage: host_instructions.sh BUILD [PROGRAM...]}/tb/bench
shift
[ $# -gt 0 ] || set -- soft_float integer block_copy remap
for name in "$@"; do
  out=$(valgrind --tool=callgrind --callgrind-out-file=/dev/null \
          --toggle-collect='fovea::cpu::Core::run()' "$build/core_run" "$build/$name.elf" \
          4000000 ${PROFILE-} 2>&1)
  guest=$(printf '%s\n' "$out" | awk '/instructions/ { print $1 }')
  host=$(printf '%s\n' "$out" | awk '/Collected/ { print $NF }')
  awk -v name="$name" -v g="$guest" -v h="$host" \
    'BEGIN { printf "%-11s %9d guest  %11d host  %.2f each\n", name, g, h, h / g }'
done
