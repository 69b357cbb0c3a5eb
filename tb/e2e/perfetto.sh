#!/usr/bin/env bash
# `--perfetto`: the trace says what the run's other files say, changes no figure, stays within its size, and
# the reader that finds so complains about a trace of another run and a damaged one.
# Usage: perfetto.sh FOVEA PROJECT_SOURCE PROGRAMS OUT
set -uo pipefail
fovea=$1 source=$2 programs=$3 out=$4
rm -rf "$out"
mkdir -p "$out"
failures=0
fail() { echo "$1"; failures=$((failures + 1)); }
read_trace() { python3 "$source/tb/e2e/perfetto.py" "$@"; }
cat >"$out/small.yaml" <<'Y'
run: {frames: 3, start_limit: 2s}
camera: {kind: chart, stamp: false}
video: {width: 188, height: 48}
firmware: {kernel: staged}
Y
run() { "$fovea" run "$out/small.yaml" --no-frames "$@" >"$out/text" 2>&1; }
run -o "$out/run" --profile --perfetto "$out/run.pftrace" || fail "run: $(cat "$out/text")"
run -o "$out/without" || fail "without: $(cat "$out/text")"
cmp "$out/run/stats.json" "$out/without/stats.json" || fail 'recording changes the run'
read_trace "$out/run.pftrace" "$out/run" || fail 'the trace does not say what the run says'
run -o "$out/strict" --sync=strict --perfetto "$out/strict.pftrace"
read_trace "$out/strict.pftrace" "$out/strict" || fail 'strict'

# The SDRAM's counters, against the commands on its bus: a load of high priority puts refreshes off.
run -o "$out/loaded" --perfetto "$out/loaded.pftrace" --perfetto-tracks '^SDRAM/' --command-trace "$out/loaded.csv" -s run.frames=1 \
  -s load.outstanding=4 -s load.base=96MiB -s load.size=1MiB -s load.priority=0 -s load.start=220ms
read_trace --counters "$out/loaded.pftrace" "$out/loaded" "$out/loaded.csv" || fail 'the counters do not say what the commands say'
# One command in nine is lost: the reader complains.
sed '2,$ { 0~9d }' "$out/loaded.csv" >"$out/fewer.csv"
! read_trace --counters "$out/loaded.pftrace" "$out/loaded" "$out/fewer.csv" >/dev/null || fail 'the reader finds nothing in other commands'

# Another run's results, and a trace with a byte less.
run -o "$out/other" -s bus.arm_d.request_latency=9cycles
! read_trace "$out/run.pftrace" "$out/other" >"$out/text" || fail 'the reader finds nothing in a trace of another run'
head -c -1 "$out/run.pftrace" >"$out/cut.pftrace"
! read_trace "$out/cut.pftrace" "$out/run" >"$out/text" || fail 'the reader finds nothing in a damaged trace'

# A picture that cannot be written ends the run while it is recorded: with one line and neither trace nor results.
(
  trap '' XFSZ
  ulimit -f 200  # KiB: config.json fits
  "$fovea" run "$out/small.yaml" -o "$out/full" --perfetto "$out/full.pftrace" -s run.frames=6 -s video.width=720 \
    -s video.height=576 >"$out/text" 2>&1
)
[ $? = 2 ] && [ "$(wc -l <"$out/text")" = 1 ] && grep -q "cannot write .*frame_0000" "$out/text" ||
  fail "a picture that cannot be written: $(cat "$out/text")"
[ ! -e "$out/full" ] && [ ! -e "$out/full.pftrace" ] || fail 'a run without pictures leaves results'

# Selection: tracks, from, for, size.
shape() { read_trace --shape "$1"; }
run -o "$out/run" --perfetto "$out/tracks.pftrace" --perfetto-tracks '^frames/|/phases$'
[ "$(shape "$out/tracks.pftrace" | cut -d' ' -f4-)" = 'firmware frames' ] || fail "tracks: $(shape "$out/tracks.pftrace")"
run -o "$out/run" --perfetto "$out/span.pftrace" --perfetto-from 400ms --perfetto-for 2ms --perfetto-tracks '^(masters|SDRAM)/'
read -r packets first last groups <<<"$(shape "$out/span.pftrace")"
[ "$first" -ge 400000000 ] && [ "$last" -lt 402010000 ] && [ "$packets" -gt 100 ] && [ "$groups" = 'SDRAM masters' ] ||
  fail "from, for: $packets $first $last $groups"
run -o "$out/run" --perfetto "$out/ring.pftrace" --perfetto-size 1
bytes=$(stat -c %s "$out/ring.pftrace")
[ "$bytes" -le $((1300 * 1024)) ] && [ "$bytes" -gt $((600 * 1024)) ] || fail "size: $bytes bytes"
grep -qE 'lacks requests, transfers and functions from [0-9.]+ s on .*--perfetto-size [0-9]+ holds all' "$out/text" ||
  fail "nothing said of what the size left out: $(cat "$out/text")"
# What is full keeps the beginning, and tracks of few events go on; the size that is named holds all.
read -r packets first last groups <<<"$(shape "$out/run.pftrace")"
read -r some begin end rest <<<"$(shape "$out/ring.pftrace")"
[ "$some" -lt "$packets" ] && [ "$begin" = "$first" ] && [ "$end" = "$last" ] && [ "$rest" = "$groups" ] ||
  fail "size: $some packets from $begin to $end of $rest, in all $packets from $first to $last of $groups"
frames() { read_trace --slices 'frames/3 display' "$1"; }
[ -n "$(frames "$out/run.pftrace")" ] || fail 'no displayed frame in the trace'
diff <(frames "$out/run.pftrace") <(frames "$out/ring.pftrace") || fail 'size: the displayed frames end early'
enough=$(grep -oE 'size [0-9]+ holds all' "$out/text" | grep -oE '[0-9]+')
run -o "$out/run" --perfetto "$out/ring.pftrace" --perfetto-size "$enough"
grep -q lacks "$out/text" && fail "--perfetto-size $enough does not hold all"
run -o "$out/run" --perfetto "$out/newest.pftrace" --perfetto-size 1 --perfetto-trigger dropped
grep -qE 'lacks [0-9]+ older packets, up to' "$out/text" || fail "with a trigger: $(cat "$out/text")"
read -r some begin end rest <<<"$(shape "$out/newest.pftrace")"
[ "$some" -lt "$packets" ] && [ "$end" = "$last" ] || fail "with a trigger: $some of $packets packets, up to $end of $last"
# An interrupt line that is high throughout, as the core masks it, ends with the recording.
run -o "$out/masked" --perfetto "$out/masked.pftrace" -s firmware.elf="$programs/masked_alarms.elf" -s run.until=time:8ms \
  --perfetto-from 6ms --perfetto-for 1ms --perfetto-tracks '^interrupts/'
[ "$(read_trace --slices 'interrupts/IRQ of the core' "$out/masked.pftrace")" = '6000000 7000000 IRQ of the core' ] ||
  fail "masked: $(read_trace --slices 'interrupts/IRQ of the core' "$out/masked.pftrace")"
# The trigger: one frame after the other is shown twice. The recording ends with the first that is.
run -o "$out/run" --perfetto "$out/trigger.pftrace" --perfetto-trigger repeated -s firmware.flow=serial \
  -s run.frames=8 --perfetto-tracks '^frames/'
repeats=$(awk -F, 'NR > 1 && $11 == 1 { print int($9); exit }' "$out/run/frames.csv")
[ -n "$repeats" ] || fail 'no frame is repeated'
last=$(shape "$out/trigger.pftrace" | cut -d' ' -f3)
[ "$last" = "$repeats" ] || fail "trigger: the last event is at $last ns, the repeated frame ends at $repeats"

expect() { # NAME PATTERN -- OPTIONS: refused with one line
  local name=$1 pattern=$2 text status
  shift 3
  text=$("$fovea" run "$out/small.yaml" -o "$out/refused" "$@" 2>&1)
  status=$?
  [ "$status" = 2 ] && [ "$(wc -l <<<"$text")" = 1 ] && grep -qE "$pattern" <<<"$text" || fail "$name: status $status: $text"
}
echo dear >"$out/letter"
expect letter 'not a Perfetto trace' -- --perfetto "$out/letter"
expect folder 'output folder' -- --perfetto "$out/refused/x"
expect regex "perfetto-tracks '\\('" -- --perfetto "$out/x" --perfetto-tracks '('
expect from 'perfetto-from' -- --perfetto "$out/x" --perfetto-from never
expect alone 'with --perfetto FILE' -- --perfetto-size 3
expect size 'perfetto-size' -- --perfetto "$out/x" --perfetto-size 0
expect event 'perfetto-trigger' -- --perfetto "$out/x" --perfetto-trigger doom
exit $((failures > 0))
