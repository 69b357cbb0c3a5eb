#!/usr/bin/env bash
# Transfers of the EDMA beside a program that polls: strict synchronisation gives the same bytes.
# Usage: strict.sh FOVEA PROGRAM OUT
set -uo pipefail
fovea=$1 program=$2 out=$3
rm -rf "$out"
mkdir -p "$out"
cd "$out" || exit 1
cat >small.yaml <<'Y'
run: {frames: 1}
video: {width: 48, height: 16}
camera: {kind: chart, stamp: false}
Y
fail() {
  echo "$*"
  exit 1
}
for sync in default strict; do
  timeout 100 "$fovea" run small.yaml -s firmware.elf="$program" -s 'run.until=[uart:finished, time:90ms]' \
    -s load.outstanding=2 -s load.port=edma_tc0 -s load.memory=internal_ram -s load.base=24KiB -s load.size=4KiB \
    -s load.gap=3us -s load.kind=copy --sync=$sync -o $sync >$sync.log 2>&1 || fail "$sync: status $? $(tail -3 $sync.log)"
done
for f in stats.json stalls.csv timeline.csv uart.log; do
  cmp default/$f strict/$f || fail "$f differs"
done
grep -q '"edma.requests": {"value": 16,' default/stats.json || fail "not the program's 16 requests"
grep -q '"edma.tc0.bytes": {"value": 3072,' default/stats.json || fail "TC0 did not move 3072 bytes"
grep -q '"edma.tc1.bytes": {"value": 128,' default/stats.json || fail "TC1 did not move 128 bytes"
