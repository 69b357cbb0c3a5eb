#!/usr/bin/env bash
# The remap engine as verilated RTL on the board: the driver's jobs of tb/engine, both kinds of synchronisation, the RTL
# and its model beside each other in both roles, waveforms.
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
good() { # NAME
  grep -q BAD "$1/uart.log" && fail "$1: $(cat "$1/uart.log")"
  [ "$(grep -c good "$1/uart.log")" = 9 ] || fail "$1: not nine good lines: $(cat "$1/uart.log")"
}
value() { grep -o "\"$2\": {\"value\": [0-9]*" "$1/stats.json" | sed 's/.*: //'; }
same() { # NAME OTHER FILES...
  local f
  for f in "${@:3}"; do cmp "$1/$f" "$2/$f" || fail "$f of $1 and $2 differ"; done
}

run rtl -s engine=rtl --waves waves.fst -s waves.trigger=job || fail "rtl: status $? $(tail -3 rtl.log)"
good rtl
run strict -s engine=rtl --sync=strict || fail "strict: status $?"
same rtl strict stats.json stalls.csv timeline.csv uart.log
[ "$(value rtl engine.jobs)" = 6 ] || fail "engine.jobs is $(value rtl engine.jobs)"
[ "$(value rtl engine.write_bytes)" = "$(value rtl bus.remap_engine.write_bytes)" ] || fail "the bytes written differ"
[ "$(wc -c <waves.fst)" -gt 4000 ] || fail "hardly a waveform: $(wc -c <waves.fst) bytes"

run both -s engine=both || fail "both: status $? $(tail -3 both.log)"
good both
same rtl both uart.log stalls.csv timeline.csv
[ "$(value both engine.pair.requests)" -ge 40 ] || fail "engine.pair.requests is $(value both engine.pair.requests)"
run both_strict -s engine=both --sync=strict || fail "both, strict: status $? $(tail -3 both_strict.log)"
same both both_strict stats.json stalls.csv timeline.csv uart.log
run both_tlm -s engine=both_tlm || fail "both_tlm: status $? $(tail -3 both_tlm.log)"
good both_tlm
[ "$(value both_tlm engine.pair.requests)" -ge 40 ] || fail "engine.pair.requests is $(value both_tlm engine.pair.requests)"

# The firmware: the engine makes the picture of its own loop, byte by byte.
firmware() { # NAME arguments...
  timeout 100 "$fovea" run small.yaml "${@:2}" -o "$1" >"$1.log" 2>&1 || fail "$1: status $? $(tail -3 "$1.log")"
}
firmware loop
firmware engine -s engine=both -s firmware.kernel=engine
[ "$(value engine engine.jobs)" -ge 1 ] || fail "the firmware gave the engine nothing to do"
diff -r loop/frames engine/frames || fail "the engine's pictures differ"

# What cannot be recorded.
run none --waves x.fst
[ $? = 2 ] || fail "waveforms without an engine: status $?"
grep -q "key 'engine' is none; allowed: rtl, both, both_tlm" none.log || fail "$(cat none.log)"
run other -s engine=rtl --waves small.yaml
[ $? = 2 ] || fail "waveforms over another file: status $?"
grep -q 'is not an FST file' other.log || fail "$(cat other.log)"
echo precious >precious.fst
ln -sf precious.fst link.fst
run link -s engine=rtl --waves link.fst
[ $? = 2 ] || fail "waveforms through a link: status $?"
grep -q 'is a symbolic link' link.log && [ "$(cat precious.fst)" = precious ] || fail "$(cat link.log)"
echo "the RTL on the board, alone and beside its model: good"
