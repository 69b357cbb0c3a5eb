#!/usr/bin/env bash
# The program as clang builds it leaves the bytes of the program as g++ builds it: a shipped experiment,
# a shipped bus trace, a foreign program. Builds it first, unless it is up to date.
# Usage: compilers.sh FOVEA PROJECT_SOURCE PROGRAM.elf OUT
set -euo pipefail
fovea=$1 source=$2 program=$3 out=$4
cd "$source"
cmake --preset clang >/dev/null
cmake --build --preset clang --target fovea -- --quiet
clang=$source/build/clang/fovea
firmware=$(dirname "$fovea")/sw/firmware/fovea_firmware.elf
rm -rf "$out"
mkdir -p "$out"
# Both are given the same names of files: config.json, which has them, is compared too.
for compiler in gcc clang; do
  [ "$compiler" = gcc ] && tool=$fovea || tool=$clang
  "$tool" run scripts/experiments/default.yaml -s run.frames=2 -s firmware.elf="$firmware" \
    --bus-trace "$out/$compiler.trace" -o "$out/$compiler/run" >/dev/null
  "$tool" replay traces/bus/paper-pal.trace -o "$out/$compiler/replay" >/dev/null
  "$tool" exec "$program" -o "$out/$compiler/exec" <<<"1 2.5" >"$out/$compiler.out"
done 2>"$out/messages"
cmp "$out/gcc.trace" "$out/clang.trace"
cmp "$out/gcc.out" "$out/clang.out"
[ -s "$out/gcc.out" ]
rm "$out"/{gcc,clang}/*/host.json # times of the host
diff -r "$out/gcc" "$out/clang"
for name in run/{stats.json,config.json,frames.csv,timeline.csv,stalls.csv,uart.log} \
  run/frames/frame_00000{0,1}.png replay/{stats.json,timeline.csv} exec/{stats.json,stalls.csv}; do
  [ -s "$out/gcc/$name" ] || { echo "$name is missing"; exit 1; }
done
# They are two programs indeed, and the comparison can complain.
grep -qa 'clang version' <(readelf -p .comment "$clang")
! grep -qa 'clang version' <(readelf -p .comment "$fovea")
sed -i '0,/"value": /s/"value": /"value": 1/' "$out/clang/replay/stats.json"
if diff -rq "$out/gcc" "$out/clang" >/dev/null; then echo "the comparison cannot fail"; exit 1; fi
