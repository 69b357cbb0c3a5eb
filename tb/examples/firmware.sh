#!/usr/bin/env bash
# The program of model/howto/firmware.md runs on the board, two ways.
# Usage: firmware.sh FOVEA SOURCE PROGRAM OUT
set -euo pipefail
fovea=$1 source=$2 program=$3 out=$4
rm -rf "$out"
mkdir -p "$out"
"$fovea" exec --board "$program" >"$out/output" 2>"$out/figures"
grep -Eq '^sum 332833500 in [1-9][0-9]* ticks$' "$out/output" || { cat "$out/output"; exit 1; }
ticks=$(sed -n 's/.* in \([0-9]*\) ticks/\1/p' "$out/output")
# The loop is 1000 rounds of at least five instructions at 297 MHz: no fewer than 404 ticks of 24 MHz.
[ "$ticks" -ge 404 ] || { echo "$ticks ticks are too few"; exit 1; }
