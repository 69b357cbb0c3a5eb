#!/usr/bin/env bash
# The experiment of model/howto/experiment.md runs, and its keys have the origins that the page says.
# Usage: experiment.sh FOVEA SOURCE OUT
set -euo pipefail
fovea=$1 source=$2 out=$3
rm -rf "$out"
"$fovea" run "$source/tb/examples/slow-memory.yaml" -s run.frames=1 --no-frames -o "$out"
grep -q '"frame.displayed": {"value": 1,' "$out/stats.json"
origin() { grep -A 4 "\"$1\"" "$out/config.json" | grep -o '"origin": "[^"]*"' | head -1; }
[[ $(origin clocks.preset) == *slow-memory.yaml:6* ]] || { origin clocks.preset; exit 1; }
[[ $(origin run.frames) == *'command line'* ]] || { origin run.frames; exit 1; }
[[ $(origin lens.mapping) == *paper-pal.yaml* ]] || { origin lens.mapping; exit 1; }
