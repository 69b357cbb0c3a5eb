#!/usr/bin/env bash
# Builds the firmware, runs it on the modelled board, and compares its timing with the baseline.
# Needs the package fovea, arm-none-eabi-gcc and make. Exit status: that of 'fovea check' (0 passed,
# 1 slower than the baseline allows, 2 wrong input).
# Usage: check.sh                what continuous integration runs
#        check.sh --bless WHY    takes over the new timing, with a reason
set -euo pipefail
case "$#:${1-}" in 0: | 2:--bless) ;; *) echo 'usage: check.sh [--bless WHY]' >&2; exit 2 ;; esac
fovea=${FOVEA:-fovea} build=${BUILD:-build}
cd "$(dirname "$0")"
mkdir -p "$build"
build=$(realpath "$build")
make -sB -C firmware BUILD="$build" FLAGS="${FLAGS-}"
"$fovea" run timing.yaml -s firmware.elf="$build/app.elf" --max-time 1s --no-frames --profile \
  -o "$build/timing" >"$build/run.log"
case ${1-} in
  --bless) exec "$fovea" bless "$build/timing" --against baseline.yaml --why "$2" ;;
esac
"$fovea" check "$build/timing" --against baseline.yaml --junit "$build/timing.xml" \
  --markdown "$build/timing.md" --all ${FOVEA_CHECK_OPTIONS-}
