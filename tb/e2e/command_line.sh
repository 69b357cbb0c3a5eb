#!/usr/bin/env bash
# Wrong input, a failing guest and Ctrl-C, on the real program.
# Usage: command_line.sh FOVEA PROJECT_SOURCE OUT IDLE_LOOP.elf STOPPED_CLOCK.elf WILD_POINTER.elf
set -uo pipefail
fovea=$1 source=$2 out=$3 idle_loop=$4 stopped_clock=$5 wild_pointer=$6
rm -rf "$out"
mkdir -p "$out"
firmware=$(dirname "$fovea")/sw/firmware
failures=0
fail() { echo "$1"; failures=$((failures + 1)); }

# expect NAME STATUS 'pattern'... -- command...
expect() {
  local name=$1 status=$2 got text
  shift 2
  local patterns=()
  while [ "$1" != -- ]; do patterns+=("$1"); shift; done
  shift
  text=$("$@" 2>&1)
  got=$?
  if [ "$got" != "$status" ]; then
    echo "$name: exit status $got, expected $status: $text"
    failures=$((failures + 1))
  fi
  for p in "${patterns[@]}"; do
    if ! grep -qE "$p" <<<"$text"; then
      echo "$name: no '$p' in: $text"
      failures=$((failures + 1))
    fi
  done
}

# The reader of the pipe has seen enough (`| head`): no failure, no signal, no word.
for command in params version man --help 'completion bash'; do
  # shellcheck disable=SC2086 # words
  { sleep 0.1; "$fovea" $command 2>"$out/closed.txt"; echo $? >"$out/closed.status"; } | true
  if [ "$(cat "$out/closed.status")" != 0 ] || [ -s "$out/closed.txt" ]; then
    fail "$command into a closed pipe: exit status $(cat "$out/closed.status"): $(cat "$out/closed.txt")"
  fi
  rm -f "$out/closed.status"
done

cat >"$out/small.yaml" <<'Y'
run: {frames: 2, start_limit: 2s}
camera: {kind: chart, stamp: false}
video: {width: 64, height: 16}
Y
printf 'run:\n  frame: 3\n' >"$out/key.yaml"
printf 'ddr:\n  request_latency: 9\n' >"$out/unit.yaml"
printf 'video:\n  width: 4000\n' >"$out/range.yaml"
head -c 3000 "$source/traces/footage/neozhaoliang-surround/front.png" >"$out/cut.png"
printf 'not an ELF' >"$out/text.elf"
head -c 600 "$firmware/hello.elf" >"$out/cut.elf"
# The entry's segment address moved out of memory: p_vaddr, p_paddr of the first program header.
cp "$firmware/hello.elf" "$out/outside.elf"
printf '\x00\x00\x00\x50\x00\x00\x00\x50' |
  dd of="$out/outside.elf" bs=1 seek=$((52 + 8)) conv=notrunc status=none
printf '\0\0\0\120' | dd of="$out/outside.elf" bs=1 seek=24 conv=notrunc status=none  # and begins there

run() { "$fovea" run "$@" -o "$out/run"; }
# What the firmware refuses is the guest's failure, with its sentence, and not after run.start_limit only.
expect old_page 3 'the firmware stopped: failed: parameter page: unknown version; this firmware reads version 5 at pc .*, 0\.0[0-9]+ s' -- \
  run "$out/small.yaml" -s run.start_limit=60s -s firmware.elf="$firmware/old_page.elf"
expect bad_lens 3 'the firmware stopped: failed: lens: field of view outside' -- \
  run "$out/small.yaml" -s run.start_limit=60s -s lens.mapping=orthographic -s lens.fov=190deg
# Clocks that the PLLs cannot give, with the nearest.
expect no_such_clock 2 "key 'clocks.arm'.*297MHz and 310.5MHz.*243MHz and 256.5MHz" -- \
  run "$out/small.yaml" -s clocks.arm=300MHz -s clocks.ddr=250MHz
expect clock_beyond 2 "clocks.ddr.*340MHz" -- run "$out/small.yaml" -s clocks.ddr=341MHz
expect free_clocks 0 -- run "$out/small.yaml" -s clocks.arm=135MHz -s clocks.ddr=162MHz --strict
grep -q 'boot: clocks 135000/162000 kHz' "$out/run/uart.log" || fail 'uart.log lacks the clocks'
expect good 0 '^frame rate met: 2 of 2 frames shown' '^budget  40.0 ms a displayed frame: remap 0.[0-9](, other work 0.[1-9])?, idle 39.[0-9]$' -- run "$out/small.yaml"
expect unknown_key 2 'key.yaml:2' 'frame' 'did you mean .run.frames' -- run "$out/key.yaml"
expect missing_unit 2 'unit.yaml:2' 'request_latency' 'cycles.*; a number alone lacks its unit' -- \
  run "$out/unit.yaml"
expect out_of_range 2 'range.yaml:2' 'video.width' '720' -- run "$out/range.yaml"
expect bad_override 2 'run.frames' -- run "$out/small.yaml" -s run.frames=none
expect no_experiment 2 'nowhere.yaml' -- run "$out/nowhere.yaml"
expect no_footage 2 'missing.png' -- run "$out/small.yaml" -s camera.kind=sphere \
  -s camera.file="$out/missing.png"
expect corrupt_footage 2 'cut.png' -- run "$out/small.yaml" -s camera.kind=sphere \
  -s camera.file="$out/cut.png"
expect not_an_elf 2 'text.elf' 'ELF' -- run "$out/small.yaml" -s firmware.elf="$out/text.elf"
expect cut_elf 2 'cut.elf' -- run "$out/small.yaml" -s firmware.elf="$out/cut.elf"
expect other_machine 2 'ARM|class|32' -- run "$out/small.yaml" -s firmware.elf="$fovea"
expect outside_memory 2 '0x50000000' -- run "$out/small.yaml" -s firmware.elf="$out/outside.elf"
expect unwritable 2 '/proc' -- "$fovea" run "$out/small.yaml" -o /proc/fovea_out
if [ -e "$out/run.tmp" ]; then
  echo "a run with wrong input left $out/run.tmp"
  failures=$((failures + 1))
fi
expect mobile_memory 2 'ddr.part' 'firmware.elf' 'fovea replay TRACE' -- run "$out/small.yaml" -s ddr.part=mt46h32m16lf
expect empty_out 2 "output folder ''" -- "$fovea" run "$out/small.yaml" -o ''
commit='[0-9a-f]{12}(, modified)?'
prefix=$(git -C "$source" rev-parse --show-prefix 2>/dev/null) && [ -z "$prefix" ] || commit=unknown  # a copy has none
expect version 0 "^fovea [0-9.]+ \\(commit $commit\\)\$" -- "$fovea" --version
expect bad_until 2 "^fovea: error: key 'run.until': 'uartt:x' is not a condition" -- \
  run "$out/small.yaml" -s run.until=uartt:x -s run.frames=2
run "$out/small.yaml" -s run.until=uartt:x -s run.frames=2 2>&1 | grep warning && fail 'a warning before run.until is refused'

# Keys without effect, and calibrations: OpenCV's file for camera and firmware, of another picture.
# Camera 0 is on that input; of one camera, a second one's is no matter.
expect idle_input 0 "'camera.1.input' is set \(command line\) but has no effect" -- \
  run "$out/small.yaml" -s camera.1.input=vi_2_b
expect no_effect 0 "warning \(configuration\): 'lens.fov' is set \(command line\) but has no effect with lens.mapping = kannala" \
  -- run "$out/small.yaml" -s lens.mapping=kannala_brandt -s lens.fov=10deg
grep -q '"kind": "configuration", "what": "'"'lens.fov'" "$out/run/stats.json" || fail 'no warning in stats.json'
expect no_effect_strict 2 'lens.fov' -- run "$out/small.yaml" -s lens.mapping=kannala_brandt -s lens.fov=10deg --strict
footage=$source/traces/footage
left=(-s camera.kind=sphere -s camera.file="$footage/neozhaoliang-surround/left.png" -s lens.mapping=kannala_brandt
      -s camera.calibration="$footage/neozhaoliang-surround/left.yaml")
expect calibration_angle 2 'lens.theta_max' 'use lens.theta_max=86deg' -- run "$out/small.yaml" "${left[@]}"
expect calibration 0 -- run "$out/small.yaml" "${left[@]}" -s lens.theta_max=86deg --strict
for key in camera.kb lens.kb; do
  grep -q "\"$key\": {\"value\": \"\[303.34009006384287, 322.29678244636966, .*\"origin\": \".*left.yaml\"" "$out/run/config.json" ||
    fail "config.json: $key is not that of left.yaml"
done
grep -q "\"camera.calibration\": \"$(sha256sum <"$footage/neozhaoliang-surround/left.yaml" | cut -c1-64)\"" "$out/run/config.json" ||
  fail 'config.json: no hash of left.yaml'
expect other_picture 0 "warning.*left.yaml' is of a picture of 960x640.*im_front.jpg" -- \
  run "$out/small.yaml" "${left[@]}" -s lens.theta_max=86deg -s camera.file="$footage/kalibr-parking/im_front.jpg"
expect jump_nowhere 3 '0x70000000' 'prefetch abort' 'at 0x' -- run "$out/small.yaml" \
  -s firmware.elf="$firmware/jump_nowhere.elf"
expect never_a_frame 3 'run.start_limit' 'pc 0x' -- run "$out/small.yaml" \
  -s firmware.elf="$firmware/hello.elf" -s run.start_limit=60ms
expect idle_loop 3 'run.start_limit' 'pc 0x00000000' -- timeout 60 "$fovea" run "$out/small.yaml" \
  -s firmware.elf="$idle_loop" -s run.start_limit=60ms -o "$out/run"
expect stopped_clock 3 'run.start_limit' 'wrote 4 bytes at 0x01c40938' -- timeout 60 "$fovea" run \
  "$out/small.yaml" -s firmware.elf="$stopped_clock" -s run.start_limit=60ms -o "$out/run"
expect chip_reset 3 'guest failed: chip reset: a wrong key .* at pc 0x[0-9a-f]{8} \(restart_as_linux' \
  's after power-up' -- run "$out/small.yaml" -s firmware.elf="$(dirname "$idle_loop")/foreign_sequences.elf"
expect strict_bus_error 3 '^fovea: not modelled: bus error: EMAC' -- run \
  "$out/small.yaml" --strict -s firmware.elf="$(dirname "$idle_loop")/foreign_sequences.elf"
expect params 0 'ddr.request_latency' 'assumed' -- "$fovea" params
# Every figure without a source of its own is printed with its belief interval and the reason.
"$fovea" params --markdown >"$out/params.md"
without=$(grep -E '\| (assumed|family)\b' "$out/params.md" |
  grep -cvE '^\| [^|]+ \| [^|]+ \| [^|]+ \| [^|]+ \.\. [^|]+ \| [^|]*; belief: ')
if [ "$without" != 0 ] || ! grep -q '| assumed (' "$out/params.md" || ! grep -q '| family (' "$out/params.md"; then
  echo "fovea params: $without assumed or family figures without a belief interval"
  failures=$((failures + 1))
fi
expect params_of_masters 0 'bus.arm_d.request_latency' 'bus.vpbe' 'bus.edma_tc3.width' -- "$fovea" params 'bus.*'
expect load_priority 2 "load.1.priority" 'QUEPRI' -- run "$out/small.yaml" -s load.1.outstanding=1 \
  -s load.1.port=edma_tc2 -s load.1.priority=0
expect load_port 2 "load.2.port" 'no other load' -- run "$out/small.yaml" -s load.1.outstanding=1 \
  -s load.1.port=edma_tc2 -s load.2.outstanding=1 -s load.2.port=edma_tc2
expect load_ram 2 "load.base" 'internal RAM of 32 KiB' -- run "$out/small.yaml" \
  -s load.outstanding=1 -s load.memory=internal_ram
expect load_size 2 "load.size" '128' -- run "$out/small.yaml" -s load.outstanding=1 -s load.kind=copy \
  -s load.size=8256B
expect load_end 2 "load.end" 'later than the load' -- run "$out/small.yaml" -s load.outstanding=1 \
  -s load.start=2ms -s load.end=2ms
expect region_of_486 2 "video.height" '0 with video.standard = ntsc_486' -- run "$out/small.yaml" \
  -s video.standard=ntsc_486 -s video.width=0 -s video.height=400

# A wild pointer: its warnings are counted, a few of them shown and kept.
"$fovea" run "$out/small.yaml" -s firmware.elf="$wild_pointer" -s run.start_limit=20ms -o "$out/wild" \
  >/dev/null 2>"$out/wild.err"
status=$?
lines=$(wc -l <"$out/wild.err") bytes=$(stat -c %s "$out/wild/stats.json")
counted=$(grep -oE '"count": [0-9]+' "$out/wild/stats.json" | awk '{ s += $2 } END { print s + 0 }')
if [ "$status" != 3 ] || [ "$lines" -gt 60 ] || [ "$bytes" -gt 200000 ] || [ "$counted" -lt 10000 ]; then
  echo "wild pointer: status $status, $lines lines, stats.json $bytes bytes, $counted warnings counted"
  failures=$((failures + 1))
fi

# A film that names other files; a host without memory.
printf '#EXTM3U\n#EXT-X-TARGETDURATION:9\n#EXTINF:9,\n%s\n#EXT-X-ENDLIST\n' \
  "$source/traces/footage/udacity-road/solidWhiteRight.mp4" >"$out/list.mp4"
expect playlist 2 'list.mp4' 'playlist' -- run "$out/small.yaml" -s camera.kind=video \
  -s camera.file="$out/list.mp4"
out_of_memory() { (ulimit -v 150000 && exec "$fovea" run "$out/small.yaml" -o "$out/run"); }
expect out_of_memory 2 'out of memory|the host refused' -- out_of_memory

# Ctrl-C while footage is decoded, by a decoder that hangs.
mkdir -p "$out/bin"
printf '#!/bin/sh\necho $$ >"%s"\nexec sleep 1000\n' "$out/decoder.pid" >"$out/bin/ffmpeg"
chmod +x "$out/bin/ffmpeg"
cp "$out/list.mp4" "$out/film.mp4"
PATH="$out/bin:$PATH" "$fovea" run "$out/small.yaml" -s camera.kind=video -s camera.file="$out/film.mp4" \
  -o "$out/decoding" >"$out/decoding.text" 2>&1 &
pid=$!
for _ in {1..600}; do
  [ -s "$out/decoder.pid" ] && break
  sleep 0.1
done
kill -TERM "$pid"
wait "$pid"
status=$?
if [ "$status" != 143 ] || [ -e "$out/decoding.tmp" ] || [ -e "$out/decoding" ] ||
  kill -0 "$(cat "$out/decoder.pid")" 2>/dev/null || ! grep -q 'no results' "$out/decoding.text"; then
  echo "SIGTERM while decoding: exit status $status, or something is left: $(cat "$out/decoding.text")"
  failures=$((failures + 1))
fi

# Ctrl-C: a valid partial result.
"$fovea" run "$out/small.yaml" -s run.frames=100000 -o "$out/stopped" >/dev/null 2>&1 &
pid=$!
for _ in {1..1200}; do  # until it has shown whole frames, however slow the host
  [ -e "$out/stopped.tmp/frames/frame_000003.png" ] && break
  sleep 0.1
done
kill -INT "$pid"
wait "$pid"
status=$?
if [ "$status" != 130 ] || ! grep -q '"complete": false' "$out/stopped/stats.json" ||
  ! grep -q '"cpu.cycles"' "$out/stopped/stats.json" ||
  ! grep -oE '"frame.rate": \{"value": [0-9.e+-]+' "$out/stopped/stats.json" |
    awk '{ off = $3 - 25; ok = off * off < 1e-18 } END { exit !ok }'; then
  echo "Ctrl-C: exit status $status, or no partial result with the rate of its whole frames"
  failures=$((failures + 1))
fi
echo "$failures failures"
[ "$failures" = 0 ]
