#!/usr/bin/env bash
# A program that the watchdog resets 24 times: what it finds at each boot, and the same bytes in both
# synchronisations; how many resets a run may have, and how it ends at one more.
# Usage: reset.sh FOVEA PROGRAM OUT
set -uo pipefail
fovea=$1 program=$2 out=$3
rm -rf "$out"
mkdir -p "$out"
cd "$out" || exit 1
printf 'video: {width: 48, height: 16}\ncamera: {kind: chart, stamp: false}\n' >base.yaml
failures=0
fail() {
  echo "$*"
  failures=$((failures + 1))
}
play() {  # NAME STATUS OPTIONS...
  local name=$1 wanted=$2 status=0
  shift 2
  timeout 120 "$fovea" run base.yaml -s firmware.elf="$program" -s "run.until=[uart:finished\\r\\n, time:2s]" \
    "$@" -o "$name" >"$name.out" 2>"$name.err" || status=$?
  [ "$status" = "$wanted" ] || fail "$name: status $status instead of $wanted: $(cat "$name.err")"
}
value() { python3 -c 'import json, sys; d = json.load(open(sys.argv[1])); print(d[sys.argv[2]]["value"])' "$@"; }

load=(-s load.outstanding=4 -s load.kind=mixed -s load.gap=100ns -s load.base=12MiB -s load.size=1MiB)
loads_ram=(-s load.outstanding=1 -s load.memory=internal_ram -s load.base=28KiB -s load.size=4KiB -s load.gap=300ns)
play plain 0 -s run.resets=24
play plain_strict 0 -s run.resets=24 --sync=strict
play load 0 -s run.resets=24 "${load[@]}"
play load_strict 0 -s run.resets=24 "${load[@]}" --sync=strict
play ram 0 -s run.resets=24 "${loads_ram[@]}"
play ram_strict 0 -s run.resets=24 "${loads_ram[@]}" --sync=strict

# The first boot follows power-on (RSTYPE 1), the others the watchdog (4). The program's data are as the loader
# brings them; what it has counted in internal RAM and in SDRAM is as it was left.
for boot in $(seq 0 24); do
  echo "boot $boot: rstype $((boot ? 4 : 1)), initialised 5, sdram $boot"
done >expected.txt
for run in plain load ram; do
  tr -d '\r' <"$run/uart.log" | grep -oE 'boot [0-9]+:.*' >"$run.boots"
  cmp expected.txt "$run.boots" || fail "$run: $(diff expected.txt "$run.boots")"
  [ "$(value "$run/stats.json" soc.resets)" = 24 ] || fail "$run: soc.resets"
  for f in stats.json uart.log stalls.csv timeline.csv frames.csv; do
    cmp "$run/$f" "${run}_strict/$f" || fail "$run: $f depends on the synchronisation"
  done
done
[ "$(grep -c 'the chip was reset at pc .* and booted again (.* of run.resets = 24): the watchdog expired' plain.out)" = 24 ] ||
  fail "plain: not each reset has its line: $(cat plain.out)"

# At the limit and one beyond.
play none 3
grep -q 'guest failed: chip reset: the watchdog expired at pc' none.err || fail "none: $(cat none.err)"
play two 3 -s run.resets=2
grep -q 'chip reset: the watchdog expired (after as many resets as run.resets allows: 2) at pc' two.err ||
  fail "two: $(cat two.err)"
[ "$(grep -c '^boot [0-9]' two/uart.log)" = 3 ] || fail "two: $(cat two/uart.log)"
play one_less 3 -s run.resets=23
play aim 0 -s run.resets=2 -s run.until=reset
grep -q '"ended_by": "reset"' aim/stats.json || fail "aim: not ended by the reset"
[ "$(grep -c '^boot [0-9]' aim/uart.log)" = 3 ] || fail "aim: $(cat aim/uart.log)"
exit $((failures > 0))
