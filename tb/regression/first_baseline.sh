#!/usr/bin/env bash
# A first baseline that one can live with: programs that differ in nothing but their layout pass it, a remap that is a
# little more than one per cent slower does not, and neither does a later first frame.
# Usage: first_baseline.sh FOVEA BUILD SOURCE OUT few|all KERNEL...; few: one variant of each kind
set -uo pipefail
fovea=$1 build=$2 source=$3 out=$4 variants=$5
shift 5
rm -rf "$out"
mkdir -p "$out"
failures=0
fail() { echo "$1"; failures=$((failures + 1)); }

cat >"$out/small.yaml" <<'Y'
run: {frames: 2, start_limit: 2s}
camera: {kind: chart, stamp: false}
video: {width: 188, height: 48}
Y
. "$(dirname "$0")/plant.sh"

# run NAME KERNEL [ELF]
run() {
  "$fovea" run "$out/small.yaml" --no-frames -s firmware.kernel="$2" -s firmware.elf="$out/${3:-$1}.elf" \
    -o "$out/$2.$1" >"$out/$2.$1.log" 2>&1 || { fail "$1, $2: $(tail -3 "$out/$2.$1.log")"; return 1; }
}
# relinked NAME 'sed program': the firmware linked by a changed command
relinked() {
  local link
  link=$(grep -- ' -o .*fovea_firmware.elf' "$out/commands" | sed 's/^[^&]*&& //')
  eval "$(sed -E "s|-Wl,-Map=[^ ]*||; s|-o [^ ]*fovea_firmware.elf|-o $out/$1.elf|; $2" <<<"$link")" || fail "$1: cannot be linked"
}
# status KERNEL NAME [BASE]: of the check of a run against the first baseline of the run BASE
status() {
  "$fovea" check "$out/$1.$2" --against "$out/$1.${3:-base}-first.yaml" >"$out/$1.$2.check"
  echo $?
}
# first KERNEL NAME: begins a baseline with a run
first() {
  "$fovea" bless "$out/$1.$2" --against "$out/$1.$2-first.yaml" --why first >"$out/$1.$2.bless" 2>&1 ||
    fail "$1, $2: no baseline: $(cat "$out/$1.$2.bless")"
}
figure() { grep -o "\"$2\": {\"value\": [0-9.e-]*" "$1/stats.json" | sed 's/.* //'; }

relinked base ''
# Code that is linked and not run, before and behind the other code.
cat >"$out/unused.c" <<'C'
int unused_code(int n) { while (n > 3) n = n * 5 % 17 + (n >> 1); return n; }
C
arm-none-eabi-gcc -mcpu=arm926ej-s -marm -O2 -ffreestanding -c "$out/unused.c" -o "$out/unused.o" || exit 1
relinked dead_before "s|^([^ ]*gcc) |\1 $out/unused.o -Wl,--undefined=unused_code |"
relinked dead_behind "s|\$| $out/unused.o -Wl,--undefined=unused_code|"
# The same objects in the opposite order.
objects=$(grep -- ' -o .*fovea_firmware.elf' "$out/commands" | grep -o '[^ ]*fovea_firmware/[^ ]*\.obj')
relinked order "s#$(echo $objects | sed 's/[.]/\\./g')#$(tac <<<"$objects" | tr '\n' ' ')#"
cmp -s "$out/base.elf" "$out/order.elf" && fail 'order: the same program'
firmware string app/main.c "s/running/now running/"
case $variants in
  few) variants='dead_before order string text32' ;;
  all) variants='dead_before dead_behind order string text32 text4096' ;;
  *) fail "'$variants' is neither few nor all" ;;
esac
for bytes in $(grep -o 'text[0-9]*' <<<"$variants" | tr -d tex); do
  firmware "text$bytes" kernels/remap_plain.c \
    "s/^void remap_plain/__asm__(\".section .text.remap_plain\\\\n .space $bytes\\\\n .text\");\\n&/"
done

for kernel; do
  run base "$kernel" || exit 1
  first "$kernel" base
  for harmless in $variants; do
    run "$harmless" "$kernel" && [ "$(status "$kernel" "$harmless")" = 0 ] ||
      fail "$kernel, $harmless: a false alarm: $(cat "$out/$kernel.$harmless.check")"
  done
done

# A remap whose rows begin with a loop of n turns, which moves no code: with the largest n that is within one per cent of
# the baseline's time the check passes, with one more it fails.
firmware turns kernels/remap_plain.c \
  's/^void remap_plain/static const volatile uint32_t turns = 0x5eed0001;\n&/
   s/^  while \(lut != end\)/  for (uint32_t n = turns; n; --n) __asm__ volatile("");\n&/'
# turned N: the program with n = N
turned() {
  python3 - "$out/turns.elf" "$out/turns$1.elf" "$1" <<'P'
import struct, sys
program, mark = open(sys.argv[1], "rb").read(), struct.pack("<I", 0x5eed0001)
assert program.count(mark) == 1, "the number of turns is not in its place"
open(sys.argv[2], "wb").write(program.replace(mark, struct.pack("<I", int(sys.argv[3]))))
P
}
# judge N: runs it; sets `judged` to the status of its check
judge() { turned "$1" && run "turns$1" plain && judged=$(status plain "turns$1" turns1); }
turned 1 && run turns1 plain || exit 1
first plain turns1
n=1 high=33 # the first passes, the second must not; turns are not of equal length, because some hide behind writes
judge $high && [ "$judged" = 1 ] || fail "$high turns pass"
while [ $((high - n)) -gt 1 ]; do
  middle=$(((n + high) / 2))
  judge $middle || break
  if [ "$judged" = 0 ]; then n=$middle; else high=$middle; fi
done
base=$(figure "$out/plain.turns1" frame.remap_time.mean)
more=$(figure "$out/plain.turns$((n + 1))" frame.remap_time.mean)
echo "$n turns pass; $((n + 1)) turns are $(awk -v a="$base" -v b="$more" 'BEGIN { printf "%.3f", 100 * (b / a - 1) }') % more and fail"
awk -v a="$base" -v b="$more" 'BEGIN { exit !(b > 1.01 * a && b < 1.02 * a) }' || fail 'the step is not at one per cent'
grep -q 'FAILED  frame.remap_time' "$out/plain.turns$((n + 1)).check" || fail "$(cat "$out/plain.turns$((n + 1)).check")"

# A start that is longer than the wait for the camera.
firmware start app/main.c 's/^  uart_puts\("running/  for (volatile uint32_t n = 0; n < 10000000; ++n) {}\n&/'
run start plain && [ "$(status plain start)" = 1 ] && grep -q 'FAILED  startup.first_frame' "$out/plain.start.check" ||
  fail "a longer start passes: $(cat "$out/plain.start.check")"
echo "$failures failures"
[ "$failures" = 0 ]
