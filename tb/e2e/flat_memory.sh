#!/usr/bin/env bash
# A run that is longer takes no more memory: the most that is allocated at one time in runs of two lengths, both beyond
# what is kept of the latest frames (256 to 511 of them). It is reached when the results are written, while all that is
# kept of the frames is still there. One record of a frame in the log has more than 100 bytes, a row of the timeline
# more than 160, 40 of them to a frame; BYTES a frame are allowed.
# Usage: flat_memory.sh FOVEA HEAP_PEAK_LIBRARY OUT FEW MANY BYTES
set -euo pipefail
fovea=$1 library=$2 out=$3 few=$4 many=$5 bytes=$6
mkdir -p "$out"
cat >"$out/tiny.yaml" <<'Y'
camera: {kind: chart, stamp: false}
video: {width: 16, height: 16}
Y
peak() {
  HEAP_PEAK="$out/peak" LD_PRELOAD="$library" "$fovea" run "$out/tiny.yaml" --no-frames -s run.frames="$1" \
    -o "$out/$1" >/dev/null 2>&1
  cat "$out/peak"
  rm "$out/peak"
}
a=$(peak "$few") b=$(peak "$many")
for n in "$few" "$many"; do
  [ "$(wc -l <"$out/$n/frames.csv")" = $((n + 1)) ] || { echo "frames.csv of $n frames"; exit 1; }
done
echo "peak $a bytes with $few frames, $b with $many: $(((b - a) / (many - few))) a frame"
[ $((b - a)) -le $((bytes * (many - few))) ]
