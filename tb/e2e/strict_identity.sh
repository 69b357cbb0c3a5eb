#!/usr/bin/env bash
# Runs an experiment in strict and in default synchronisation and compares what they leave, byte by
# byte. Usage: strict_identity.sh FOVEA EXPERIMENT OUT [-s KEY=VALUE ...]
# DIRECT_SHARE: the least share of the core's requests that the default mode takes without an event, where it is not
# that of a core which corrects the picture itself.
set -euo pipefail
fovea=$1 experiment=$2 out=$3
shift 3
mkdir -p "$out"
"$fovea" run "$experiment" -s run.frames=3 -s ddr.check=commands "$@" -o "$out/default" >/dev/null 2>&1
"$fovea" run "$experiment" -s run.frames=3 -s ddr.check=commands "$@" --sync=strict -o "$out/strict" >/dev/null 2>&1
for f in stats.json frames.csv timeline.csv stalls.csv latency.csv slowest.csv uart.log; do
  cmp "$out/default/$f" "$out/strict/$f"
done
diff -r "$out/default/frames" "$out/strict/frames"
diff -r "$out/default/camera" "$out/strict/camera"
value() { grep -o "\"$2\": {\"value\": [0-9.e-]*" "$1" | sed 's/.*: //'; }
direct=$(value "$out/strict/host.json" sync.direct)
share=$(value "$out/default/host.json" sync.direct_share)
echo "strict: $direct direct accesses; default: direct share $share"
[ "$direct" = 0 ]
awk -v s="$share" -v least="${DIRECT_SHARE:-0.8}" 'BEGIN { exit !(s >= least) }'
# The comparison itself must be able to complain.
cp "$out/strict/stats.json" "$out/changed.json"
sed -i '0,/"value": /s/"value": /"value": 1/' "$out/changed.json"
if cmp -s "$out/default/stats.json" "$out/changed.json"; then echo "cmp cannot fail"; exit 1; fi
