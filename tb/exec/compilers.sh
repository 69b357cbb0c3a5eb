#!/usr/bin/env bash
# The program as clang builds it, or as it is optimised by a profile, leaves the bytes of the program as g++ builds it: a
# shipped experiment, a shipped bus trace, a foreign program. Builds it first, unless it is up to date.
# Usage: compilers.sh FOVEA PROJECT_SOURCE PROGRAM.elf OUT [clang|guided]
set -euo pipefail
fovea=$1 source=$2 program=$3 out=$4 preset=${5:-clang}
cd "$source"
if [ "$preset" = guided ]; then
  scripts/guided
else
  cmake --preset "$preset" >/dev/null
  cmake --build --preset "$preset" --target fovea -- --quiet
fi
other=$source/build/$preset/fovea
firmware=$(dirname "$fovea")/sw/firmware/fovea_firmware.elf
rm -rf "$out"
mkdir -p "$out"
# Both are given the same names of files: config.json, which has them, is compared too.
for compiler in gcc other; do
  [ "$compiler" = gcc ] && tool=$fovea || tool=$other
  "$tool" run scripts/experiments/default.yaml -s run.frames=2 -s firmware.elf="$firmware" \
    --bus-trace "$out/$compiler.trace" -o "$out/$compiler/run" >/dev/null
  "$tool" replay traces/bus/paper-pal.trace -o "$out/$compiler/replay" >/dev/null
  "$tool" exec "$program" -o "$out/$compiler/exec" <<<"1 2.5" >"$out/$compiler.out"
done 2>"$out/messages"
cmp "$out/gcc.trace" "$out/other.trace"
cmp "$out/gcc.out" "$out/other.out"
[ -s "$out/gcc.out" ]
rm "$out"/{gcc,other}/*/host.json # times of the host
diff -r "$out/gcc" "$out/other"
for name in run/{stats.json,config.json,frames.csv,timeline.csv,stalls.csv,uart.log} \
  run/frames/frame_00000{0,1}.png replay/{stats.json,timeline.csv} exec/{stats.json,stalls.csv}; do
  [ -s "$out/gcc/$name" ] || { echo "$name is missing"; exit 1; }
done
# They are two programs indeed, and the comparison can complain.
if cmp -s "$fovea" "$other"; then echo "$other is the same program"; exit 1; fi
if [ "$preset" = clang ]; then
  grep -qa 'clang version' <(readelf -p .comment "$other")
  ! grep -qa 'clang version' <(readelf -p .comment "$fovea")
fi
sed -i '0,/"value": /s/"value": /"value": 1/' "$out/other/replay/stats.json"
if diff -rq "$out/gcc" "$out/other" >/dev/null; then echo "the comparison cannot fail"; exit 1; fi
