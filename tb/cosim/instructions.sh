#!/usr/bin/env bash
# Host instructions of a clock of the RTL, by valgrind: on the bench of tb/rtl, and as a backend, with adapters and
# protocol checkers. Usage: instructions.sh TEST_PROGRAM MOST: fails if the backend takes more than MOST times as many.
set -uo pipefail
program=$1 most=$2
count() { # TEST FUNCTION: instructions a clock
  valgrind --tool=callgrind --callgrind-out-file=/dev/null --toggle-collect="$2" \
    "$program" --gtest_filter="CostTest.$1" 2>&1 |
    awk '/^clocks: /{c = $2} /Collected : /{i = $4} END {if (c > 0 && i > 0) printf "%.0f\n", i / c}'
}
bench=$(count Bench 'fovea::rtl::EngineBench::run*') backend=$(count Backend 'fovea::engine::ModelBench::run*')
[ "${bench:-0}" -gt 0 ] && [ "${backend:-0}" -gt 0 ] || { echo "nothing was counted"; exit 1; }
awk -v b="$bench" -v a="$backend" -v m="$most" 'BEGIN {
  printf "a clock: %d host instructions on the bench, %d as a backend: %.2f times as many\n", b, a, a / b
  exit !(a <= m * b) }'
