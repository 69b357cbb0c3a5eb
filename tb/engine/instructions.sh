#!/usr/bin/env bash
# Host instructions of a job of the model and of the verilated RTL, by valgrind, with their memories.
# Usage: instructions.sh TEST_PROGRAM OUT LEAST: fails if the RTL takes less than LEAST times as many.
set -uo pipefail
program=$1 out=$2 least=$3
mkdir -p "$out"
count() { # TEST FUNCTION
  valgrind --tool=callgrind --callgrind-out-file="$out/$1.callgrind" --toggle-collect="$2" \
    "$program" --gtest_filter="CostTest.$1" 2>&1 | grep -oE "Collected : [0-9]+" | grep -oE "[0-9]+"
}
model=$(count Model 'fovea::engine::ModelBench::run*') rtl=$(count Rtl 'fovea::rtl::EngineBench::run*')
[ "${model:-0}" -gt 0 ] && [ "${rtl:-0}" -gt 0 ] || { echo "nothing was counted"; exit 1; }
awk -v m="$model" -v r="$rtl" -v l="$least" 'BEGIN {
  printf "model %d instructions, RTL %d: %.1f times as many\n", m, r, r / m
  exit !(r >= l * m) }'
