#!/usr/bin/env bash
# The remap engine on the board: a driver's sequences, the same bytes in strict synchronisation, a board without it.
# Usage: board.sh FOVEA PROGRAM OUT
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
run() { # NAME arguments...
  local name=$1
  shift
  timeout 100 "$fovea" run small.yaml -s firmware.elf="$program" -s 'run.until=[uart:finished, time:90ms]' "$@" \
    -o "$name" >"$name.log" 2>&1
}
value() { grep -o "\"$1\": {\"value\": [0-9]*" tlm/stats.json | sed 's/.*: //'; }

run tlm -s engine=tlm || fail "tlm: status $? $(tail -3 tlm.log)"
grep -q BAD tlm/uart.log && fail "$(cat tlm/uart.log)"
[ "$(grep -c good tlm/uart.log)" = 9 ] || fail "not nine good lines: $(cat tlm/uart.log)"
run strict -s engine=tlm --sync=strict || fail "strict: status $?"
for f in stats.json stalls.csv timeline.csv uart.log; do
  cmp tlm/$f strict/$f || fail "$f differs"
done
# Two whole tables of 117 words, read in bursts of 64 bytes; what was written is what the master wrote.
[ "$(value engine.jobs)" = 6 ] || fail "engine.jobs is $(value engine.jobs)"
[ "$(value engine.map_bytes)" -ge 944 ] || fail "engine.map_bytes is $(value engine.map_bytes)"
[ "$(value engine.write_bytes)" = "$(value bus.remap_engine.write_bytes)" ] || fail "the bytes written differ"
read_bytes=$(($(value engine.map_bytes) + $(value engine.source_bytes)))
[ "$read_bytes" = "$(value bus.remap_engine.read_bytes)" ] || fail "the bytes read differ"

# Sizes: a cache of one line reads more, one line under way at once is slower; the RTL has one cache only.
run cache -s engine=tlm -s engine.cache=32B || fail "cache: status $?"
source_bytes() { grep -o '"engine.source_bytes": {"value": [0-9]*' "$1/stats.json" | sed 's/.*: //'; }
[ "$(source_bytes cache)" -gt "$(source_bytes tlm)" ] || fail "a small cache reads $(source_bytes cache) bytes"
run prefetch -s engine=tlm -s engine.prefetch=1 || fail "prefetch: status $?"
cmp -s prefetch/stats.json tlm/stats.json && fail "engine.prefetch changes nothing"
for key in engine.cache=4KiB engine.prefetch=7; do
  run rtl -s engine=rtl -s $key
  status=$?
  [ $status = 2 ] && grep -qE "key '(${key%=*}|engine)'" rtl.log || fail "$key for the RTL: status $status $(cat rtl.log)"
done

run none || fail "none: status $?"
grep -q 'no engine' none/uart.log || fail "$(cat none/uart.log)"
grep -q "remap engine (hypothetical) at 0x01c6a000 is not there: key 'engine' is none" none.log ||
  fail "the bus error does not name the key: $(cat none.log)"
grep -q '"engine\.' none/stats.json && fail "statistics of an engine that is not there"
echo "jobs, both synchronisations and a board without an engine: good"
