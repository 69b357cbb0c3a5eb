#!/usr/bin/env bash
# The period of the firmware's watchdog at its limit: the longest gap between two services is measured, which is a table
# in double precision, or the time until the first frame of two free-running cameras with ten fields to lock. With a
# period that is longer the program is not reset, with one that is shorter it is.
# Usage: watchdog.sh FOVEA OUT
set -uo pipefail
fovea=$1 out=$2
rm -rf "$out"
mkdir -p "$out"
cd "$out" || exit 1
cat >base.yaml <<'EOF'
camera: {kind: chart, stamp: false}
cameras: {count: 2, genlocked: false}
camera.1: {phase: 27ms}
video: {width: 160, height: 96}
EOF
failures=0
fail() {
  echo "$*"
  failures=$((failures + 1))
}
play() {  # NAME STATUS OPTIONS...
  local name=$1 wanted=$2 status=0
  shift 2
  timeout 120 "$fovea" run base.yaml --no-frames "$@" -o "$name" >"$name.out" 2>"$name.err" || status=$?
  [ "$status" = "$wanted" ] || fail "$name: status $status instead of $wanted: $(cat "$name.err")"
}

# The longest gap in whole microseconds, and the time in ms at which it ends.
longest() {
  python3 - "$1" <<'EOF'
import re, sys
times = []
for line in open(sys.argv[1]):
    if match := re.match(r'([0-9.]+) ns .* wrote timer2.WDTCR = 0xda7e4000 ', line):
        times.append(float(match.group(1)))
gap, at = max((b - a, b) for a, b in zip(times, times[1:]))
print(int(gap / 1e3), int(at / 1e6), len(times))
EOF
}
watched() {  # NAME PERIOD OPTIONS...
  local name=$1 period=$2
  shift 2
  play "$name" 0 "$@" -s firmware.watchdog="$period" --log-registers '^timer2.WDTCR$' --log-registers-kept 100000
  read -r gap at services < <(longest "$name/registers.log")
  echo "$name: served $services times, at most $gap us apart, at $at ms"
}
try() {  # NAME OPTIONS...
  local name=$1 gap at services
  shift
  watched "$name" 2s "$@"
  [ "$services" -gt 10 ] || fail "$name: served $services times"
  # That a stall is said at half the period moves the rest by some microseconds.
  watched "${name}_again" "$((gap + 20))us" "$@"
  play "${name}_longer" 0 "$@" -s firmware.watchdog="$((gap + 2))us"
  play "${name}_shorter" 3 "$@" -s firmware.watchdog="$((gap - 1))us"
  grep -q 'chip reset: the watchdog expired at pc' "${name}_shorter.err" ||
    fail "${name}_shorter: $(cat "${name}_shorter.err")"
  grep -qa 'watchdog: the program goes on' "${name}_longer/uart.log" ||
    [ "$name" = table ] || fail "${name}_longer: the stall is not said"
}
try table -s firmware.lut=soft_float -s video.width=240 -s video.height=184 -s run.frames=2
try relock -s tvp5146.relock_fields=10 -s run.frames=8
exit $((failures > 0))
