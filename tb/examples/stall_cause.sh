#!/usr/bin/env bash
# The stall cause of model/howto/add-a-stall-cause.md, in a program that has its row and one place that names it: no
# clock of a run changes, and what was charged to `cache_op` for lines that are cleaned is charged to `clean`.
# Usage: stall_cause.sh FOVEA_WITH_IT FOVEA OUT
set -uo pipefail
with=$1 fovea=$2 out=$3
rm -rf "$out"
mkdir -p "$out"
cd "$out" || exit 1
fail() { echo "$*"; exit 1; }
printf 'run: {frames: 2}\nvideo: {width: 320, height: 96}\ncamera: {kind: chart, stamp: false}\n' >small.yaml
elf=$(dirname "$fovea")/sw/firmware/fovea_firmware.elf
for name in with without; do
  program=$fovea
  [ $name = with ] && program=$with
  "$program" run small.yaml -s "firmware.elf=$elf" --no-frames -o $name >$name.txt 2>&1 || fail "$(<$name.txt)"
done
cleaned='^cache_op,\(\.bss\|\.stacks\|\.rodata\|frame_out\),'
grep -q "$cleaned" without/stalls.csv || fail "no line is cleaned: $(<without/stalls.csv)"
diff <(sed "s/$cleaned/clean,\1,/" without/stalls.csv | sort) <(sort with/stalls.csv) || fail "other clocks"
figure() { grep -o "\"cpu.stall.$2\": {\"value\": [0-9]*" $1/stats.json | grep -o '[0-9]*$'; }
both=$(($(figure with clean) + $(figure with cache_op)))
[ "$both" = "$(figure without cache_op)" ] || fail "the two figures are $both clocks together"
[ "$(figure with clean)" -gt 0 ] || fail "nothing is charged to the cause"
[ -z "$(figure without clean)" ] || fail "the program without the row has the cause"
grep -q '"cpu.stall.clean.by.bridge"' with/stats.json || fail "no culprits of the cause"
"$with" report with -o with.html >/dev/null || fail "no page"
grep -q '"clean":"cleaning lines"' with.html || fail "the report has no words for the cause"
echo "the stall cause of the how-to works"
