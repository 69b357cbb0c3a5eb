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
"$with" run small.yaml --no-frames --bus-trace run.trace --around 30ms -o plain >plain.txt 2>&1 ||
  fail "no results: $(<plain.txt)"
# A request of the capture, from its list of requests near a time of the window.
from=$(grep -m1 -o '"startup.first_frame": {"value": [0-9.]*' plain/stats.json | grep -o '[0-9.]*$')
"$with" run small.yaml --no-frames --around "${from}s" -o near >near.txt 2>&1 || fail "no list: $(<near.txt)"
address=$(awk -F, '$2 == "write" {print $4; exit}' near/requests.csv)
[ -n "$address" ] || fail "no master writes near ${from} s"
master=$(awk -F, '$2 == "write" {print $1; exit}' near/requests.csv)
"$with" run small.yaml --no-frames --writers "$address" -o run >run.txt 2>&1 || fail "no results: $(<run.txt)"
grep -q "^$master wrote the line at 0x.* times" run.txt || fail "the run does not name $master: $(<run.txt)"
cmp plain/stats.json run/stats.json || fail "the option changes the figures"
"$with" replay run.trace --writers "$address" -o replayed >replay.txt 2>&1 || fail "no replay: $(<replay.txt)"
grep -q "wrote the line at 0x" replay.txt || fail "the replay names nobody: $(<replay.txt)"

"$with" exec /bin/true --fast-memory --writers 0 2>message
[ $? = 2 ] || fail "a machine without SDRAM takes the option"
grep -q -- "--writers: there is no SDRAM; allowed: without --fast-memory" message || fail "not that: $(<message)"
"$with" run small.yaml --writers nowhere -o wrong 2>message
[ $? = 2 ] && [ ! -e wrong ] && [ "$(wc -l <message)" = 1 ] || fail "a wrong address: $(<message)"
echo "the option of the how-to works"
