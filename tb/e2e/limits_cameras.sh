#!/usr/bin/env bash
# `fovea limits` over the number of cameras, with a small picture: those without a picture of their own take the others';
# the edge is where 25 frames a second, divided among the cameras, become too few; the same folder answers further
# questions without a run. A decoder that has to lock again is no failure by default.
# Usage: limits_cameras.sh FOVEA SOURCE OUT
set -uo pipefail
fovea=$1 source=$2 out=$3
rm -rf "$out"
mkdir -p "$out"
cd "$out" || exit 1
failures=0
fail() {
  echo "$*"
  failures=$((failures + 1))
}
# limits NAME EXPERIMENT STATUS OPTIONS...: points of an experiment are kept in a folder of its name.
limits() {
  local name=$1 experiment=$2 status=$3 got
  shift 3
  timeout 120 "$fovea" limits "$source/scripts/experiments/$experiment.yaml" -s video.width=188 -s video.height=48 \
    -s run.frames=12 --probes 0 "$@" -j 2 -o "$experiment" >"$name.out" 2>"$name.err"
  got=$?
  [ "$got" = "$status" ] || fail "$name: status $got, expected $status: $(tail -2 "$name.err")"
}
has() { grep -qF -- "$2" "$1" || fail "$1 lacks '$2': $(cat "$1")"; }
runs() { [ "$(grep -o '^[0-9]* runs made' "$1.out")" = "$2 runs made" ] || fail "$1: $(tail -1 "$1.out"), expected $2"; }
find=(--find cameras.count=1..8)

# Four cameras have 25 / 4 = 6.25 frames a second each, five have 5: of 12 frames, two or three. Ends, 4, 6 and 5 are tried.
limits six four-cameras 0 "${find[@]}" --require 'frame.rate>=6'
has six.out 'cameras.count: 4 is the largest value that meets the conditions'
has six.out 'With 5: camera.2.frame.rate is 4.16667, allowed: at least 6'
runs six 5
has six.err 'take that of another one: 4 that of 0, 5 that of 1, 6 that of 2, 7 that of 3'
five=$(grep -l '"cameras.count": {"value": "5"' four-cameras/points/*/run/config.json)
[ -n "$five" ] || { echo "no run of five cameras"; exit 1; }
has "$five" '"camera.4.file": {"value": '
has "$five" '"origin": "as camera.0.file"'
if grep -q '"camera.5.file"' "$five"; then fail "a camera that is not there has a picture"; fi
# The same again, with one point missing, and when every number or none is enough.
cp six.out first
limits six four-cameras 0 "${find[@]}" --require 'frame.rate>=6'
runs six 0
[ "$(head -2 six.out)" = "$(head -2 first)" ] || fail "another answer: $(cat six.out)"
rm -r "$(dirname "$(dirname "$five")")"
limits six four-cameras 0 "${find[@]}" --require 'frame.rate>=6'
runs six 1
has six.out 'cameras.count: 4 is the largest value'
limits all four-cameras 0 "${find[@]}"
has all.out 'cameras.count: all values that were tried from 1 to 8 meet the conditions'
runs all 0
limits none four-cameras 1 "${find[@]}" --require 'frame.rate>=26'
has none.out 'cameras.count: neither 1 (frame.rate is 25, allowed: at least 26) nor 8 ('
runs none 0

# At each change of the camera the decoder locks again, if only at once, and then waits for its next frame: frames are
# shown again. Two genlocked cameras whose remaps take too long show frames again for no such reason.
limits free four-cameras-free 0 --over tvp5146.relock_fields=0,2
[ "$(grep -c 'It meets the conditions' free.out)" = 2 ] || fail "free: $(cat free.out)"
limits again four-cameras-free 1 --over tvp5146.relock_fields=0,2 --require 'frame.repeated<=0'
runs again 0
figures() { grep -ho "\"$2\": {\"value\": [^,]*" "$1"/points/*/run/stats.json | sed 's/.* //'; }
for count in $(figures four-cameras-free frame.repeated); do [ "$count" -gt 0 ] || fail "no frame is shown again"; done
[ "$(figures four-cameras-free frame.repeated)" = "$(figures four-cameras-free frame.repeated_relock)" ] ||
  fail "for the syncs: $(figures four-cameras-free frame.repeated_relock) of $(figures four-cameras-free frame.repeated)"
limits late two-cameras 1 --over firmware.repeat=400
grep -q 'It does not meet the conditions as it is: .* repeated frame' late.out || fail "late: $(cat late.out)"
[ "$(figures two-cameras frame.repeated_relock)" = 0 ] || fail "late: $(figures two-cameras frame.repeated_relock)"

# A digital camera's frame rate is that of its clock; the display's 29.97 frames a second are those of 27 MHz. A slower
# camera's frames are shown again, a faster one's are dropped.
rate=(-s run.frames=20 -s video.standard=vga_progressive --find video.clock=20MHz..34MHz:7MHz)
limits rate paper-vga 0 "${rate[@]}" --require 'frame.repeated<=1000'
has rate.out 'video.clock: 27MHz is the largest value that meets the conditions'
grep -q 'With 34MHz: [0-9]* dropped frame' rate.out || fail "rate: $(cat rate.out)"
limits rate_kept paper-vga 1 "${rate[@]}"
has rate_kept.out 'video.clock: neither 20MHz ('
runs rate_kept 0

# One run says it too, before it begins.
"$fovea" run "$source/scripts/experiments/two-cameras.yaml" -s video.width=188 -s video.height=48 -s run.frames=1 \
  -s cameras.count=3 --no-frames -o three >three.out 2>three.err || fail "three cameras: $(cat three.err)"
has three.err 'fovea: cameras without a picture of their own take that of another one: 2 that of 0'
[ "$failures" = 0 ] || exit 1
echo "numbers of cameras found"
