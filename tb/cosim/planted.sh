#!/usr/bin/env bash
# A difference between the RTL of the remap engine and its model, planted: what the run leaves and says.
# Usage: planted.sh PLANTED PROGRAM OUT, with PLANTED the program of planted_main.cpp
set -uo pipefail
planted=$1 program=$2 out=$3
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
run() { # NAME WRITE arguments...
  timeout 100 "$planted" "$2" run small.yaml -s firmware.elf="$program" -s 'run.until=[uart:finished, time:90ms]' \
    "${@:3}" -o "$1" >"$1.log" 2>&1
}
number() { # NAME: of the first match of the pattern in the log
  grep -oE "$2" "$1.log" | head -1 | grep -oE '[0-9.]+' | head -1
}

# Without a difference: all requests agree, and the last lines say so.
run good 0 -s engine=both || fail "good: status $? $(tail -3 good.log)"
requests=$(grep -o '"engine.pair.requests": {"value": [0-9]*' good/stats.json | grep -o '[0-9]*$')
grep -qE "^engine +$requests requests of RTL and model are equal in data" good.log || fail "$(cat good.log)"
grep -qE 'at the same clock|in time' good.log || fail "nothing about times: $(cat good.log)"

for engine in both both_tlm; do
  run $engine 20 -s engine=$engine --waves $engine.fst
  [ $? = 1 ] || fail "$engine: not status 1: $(tail -3 $engine.log)"
  grep -qE '^fovea: remap engine: RTL and model differ: writes, number 19: byte 0x8[0-9a-f]{7} is 0x[0-9a-f]{2}; its '\
'twin.s 0x[0-9a-f]{2}, job [1-9] \(tag 0x[0-9a-f]{2}\), pixel \([0-9]+, [0-9]+\) of the result; at [0-9.]+ ms$' \
    $engine.log || fail "$(cat $engine.log)"
  grep -q 'own defect' $engine.log && fail "$engine: called an own defect"
  grep -q '"complete": false' $engine/stats.json || fail "$engine: no partial results: $(ls $engine)"
  # The waveforms end within 1 us behind the difference: bytes 17 to 24 of the header, big-endian (GTKWave, fstapi.c).
  at=$(number $engine 'at [0-9.]+ ms$')
  end=$((16#$(od -A n -t x1 -j 17 -N 8 $engine.fst | tr -d ' \n')))
  awk -v at="$at" -v end="$end" 'BEGIN { exit !(end >= at * 1e9 && end <= at * 1e9 + 1.01e6) }' ||
    fail "$engine: the waveforms end at $end ps, the difference is at $at ms"
  [ ! -e $engine.fst.hier ] || fail "$engine: the file of waveforms was not closed"
done
echo "a difference is found, said and left for inspection"
