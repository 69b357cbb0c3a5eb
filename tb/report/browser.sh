#!/usr/bin/env bash
# Makes runs and their reports and looks at them in headless Chromium. Screenshots stay in OUT.
# Usage: browser.sh FOVEA SOURCE OUT     (status 77: Chromium or Python is missing)
set -euo pipefail
fovea=$1 source=$2 out=$3
for program in chromium python3; do
  command -v "$program" >/dev/null || { echo "warning: $program is not installed (scripts/setup nightly); not tested"; exit 77; }
done
rm -rf "$out"
mkdir -p "$out"
cd "$source"
for name in default paper-pal; do
  "$fovea" run "scripts/experiments/$name.yaml" -s run.frames=3 -o "$out/$name" >/dev/null
done
# A view that is composed of four cameras; pixels that the remap engine moves.
"$fovea" run scripts/experiments/birds-eye.yaml -s run.frames=4 -o "$out/view" >/dev/null
"$fovea" run scripts/experiments/default.yaml -s run.frames=2 -s engine=tlm -s firmware.kernel=engine --profile -o "$out/engine" >/dev/null
# Several cameras in turn; a run that ended before its last frame; one without any frame.
"$fovea" run scripts/experiments/two-cameras.yaml -s run.frames=2 -o "$out/cameras" >/dev/null
"$fovea" run scripts/experiments/default.yaml --max-time 500ms -o "$out/partial" >/dev/null 2>&1 || [ $? = 3 ]
"$fovea" run scripts/experiments/default.yaml -s run.until=time:100ms -o "$out/zero" >/dev/null
python3 tb/report/fixture.py "$out/paper-pal" "$out/all-files"
cp -r "$out/paper-pal" "$out/bare"
rm -r "$out"/bare/{frames,frames.csv,timeline.csv,stalls.csv,host.json}
"$fovea" report "$out/default" -o "$out/one.html"
"$fovea" report "$out/all-files" -o "$out/all.html"
"$fovea" report "$out/bare" -o "$out/bare.html"
"$fovea" report "$out/default" "$out/all-files" -o "$out/two.html"
for name in view engine cameras zero; do "$fovea" report "$out/$name" -o "$out/$name.html"; done
"$fovea" report --partial "$out/partial" -o "$out/partial.html"
# A page is made in two seconds.
start=$(date +%s%N)
"$fovea" report "$out/default" -o "$out/one.html" >/dev/null
ms=$((($(date +%s%N) - start) / 1000000))
[ "$ms" -le 2000 ] || { echo "a report takes $ms ms, more than 2000"; exit 1; }
python3 tb/report/browser_test.py "$out"
