#!/usr/bin/env bash
# The command of model/howto/add-a-command.md, in a program that has its source and its row: help, completion, a run's
# figure, an error of one line.
# Usage: command.sh FOVEA_WITH_IT FOVEA OUT
set -uo pipefail
with=$1 fovea=$2 out=$3
rm -rf "$out"
mkdir -p "$out"
cd "$out" || exit 1
fail() { echo "$*"; exit 1; }
"$with" --help | grep -q '^  figure  *Print one figure' || fail "the help does not list the command"
"$fovea" --help | grep -q '^  figure ' && fail "the program without the row has the command"
"$with" man | grep -q 'fovea figure' || fail "the manual does not have the command"
"$with" completion bash | grep -q '^ *figure) options=' || fail "the completion does not know the command"
"$fovea" completion bash | grep -q '^ *figure) options=' && fail "the completion of the program without it knows it"
printf 'run: {frames: 1}\nvideo: {width: 48, height: 16}\ncamera: {kind: chart, stamp: false}\n' >small.yaml
"$fovea" run small.yaml --no-frames -s run.until=time:6ms -o run >run.txt 2>&1 || fail "no results: $(<run.txt)"
clocks=$(grep -o '"cpu.cycles": {"value": [0-9]*' run/stats.json | grep -o '[0-9]*$')
[ "$("$with" figure run cpu.cycles)" = "$clocks cycles" ] ||
  fail "it prints '$("$with" figure run cpu.cycles)'; stats.json has $clocks"
"$with" figure run cpu.cycels 2>message
[ $? = 2 ] || fail "a figure that is not there ends with another status than 2"
[ "$(wc -l <message)" = 1 ] && grep -q "'cpu.cycels'" message || fail "not one line about the figure: $(<message)"
echo "the command of the how-to works"
