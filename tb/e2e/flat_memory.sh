#!/usr/bin/env bash
# A run that is longer takes no more memory: peaks of two lengths, both beyond what is kept of the
# latest frames (256 to 511 of them). One record of a frame in the log has more than 100 bytes, a row
# of the timeline more than 160, 40 of them to a frame; BYTES a frame are allowed. Peaks differ by up to 200 kB from run
# to run, as host threads meet in the allocator; so a difference that is too large is measured again, and the smallest
# peak of up to three runs of each length counts. What is kept of each frame raises all of them.
# Usage: flat_memory.sh FOVEA OUT FEW MANY BYTES
set -euo pipefail
fovea=$1 out=$2 few=$3 many=$4 bytes=$5
mkdir -p "$out"
cat >"$out/tiny.yaml" <<'Y'
camera: {kind: chart, stamp: false}
video: {width: 16, height: 16}
Y
peak() {
  "$fovea" run "$out/tiny.yaml" --no-frames -s run.frames="$1" -o "$out/$1" >/dev/null 2>&1
  grep -oE '"peak_rss": \{"value": [0-9]+' "$out/$1/host.json" | grep -oE '[0-9]+$'
}
check_lengths() {
  for n in "$few" "$many"; do
    [ "$(wc -l <"$out/$n/frames.csv")" = $((n + 1)) ] || { echo "frames.csv of $n frames"; exit 1; }
  done
}
smaller() { echo $(($1 < $2 ? $1 : $2)); }
a=$(peak "$few") b=$(peak "$many")
check_lengths
for _ in 1 2; do
  [ $((b - a)) -gt $((bytes * (many - few))) ] || break
  a=$(smaller "$a" "$(peak "$few")") b=$(smaller "$b" "$(peak "$many")")
done
echo "peak $a bytes with $few frames, $b with $many: $(((b - a) / (many - few))) a frame"
[ $((b - a)) -le $((bytes * (many - few))) ]
