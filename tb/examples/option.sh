#!/usr/bin/env bash
# The option of model/howto/add-an-option.md, in a program that has its source and its row: help of three commands, a
# run, a program, a replay, a machine without SDRAM, a wrong value.
# Usage: option.sh FOVEA_WITH_IT FOVEA OUT
set -uo pipefail
with=$1 fovea=$2 out=$3
rm -rf "$out"
mkdir -p "$out"
cd "$out" || exit 1
fail() { echo "$*"; exit 1; }
for command in run exec replay; do
  "$with" $command --help | grep -q -- '--writers' || fail "the help of $command does not list the option"
  "$fovea" $command --help | grep -q -- '--writers' && fail "the program without the row has the option"
done
"$with" man | grep -q 'writers' || fail "the manual does not have the option"
"$with" completion bash | grep -q -- '--writers' || fail "the completion does not know the option"

printf 'run: {frames: 1}\nvideo: {width: 48, height: 16}\ncamera: {kind: chart, stamp: false}\n' >small.yaml
printf 'firmware: {elf: "%s"}\n' "$(dirname "$fovea")/sw/firmware/fovea_firmware.elf" >>small.yaml
"$with" run small.yaml --no-frames --bus-trace run.trace -o plain >plain.txt 2>&1 || fail "no results: $(<plain.txt)"
# A write of the window: one of the slowest requests.
address=$(awk -F, '$2 == "write" {print $6; exit}' plain/slowest.csv)
master=$(awk -F, '$2 == "write" {print $1; exit}' plain/slowest.csv)
[ -n "$address" ] || fail "no master writes"
"$with" run small.yaml --no-frames --writers "$address" -o run >run.txt 2>&1 || fail "no results: $(<run.txt)"
grep -q "^$master wrote the line at 0x.* times" run.txt || fail "the run does not name $master: $(<run.txt)"
cmp plain/stats.json run/stats.json || fail "the option changes the figures"
"$with" replay run.trace --writers "$address" -o replayed >replay.txt 2>&1 || fail "no replay: $(<replay.txt)"
grep -q "wrote the line at 0x" replay.txt || fail "the replay names no master: $(<replay.txt)"

"$with" exec /bin/true --fast-memory --writers 0 2>message
[ $? = 2 ] || fail "a machine without SDRAM takes the option"
grep -q -- "--writers: there is no SDRAM; allowed: without --fast-memory" message || fail "not that: $(<message)"
"$with" run small.yaml --writers nowhere -o wrong 2>message
[ $? = 2 ] && [ ! -e wrong ] && [ "$(wc -l <message)" = 1 ] || fail "a wrong address: $(<message)"
echo "the option of the how-to works"
