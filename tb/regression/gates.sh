#!/usr/bin/env bash
# Gates for programs of exec and for replays, and two programs held against each other without a baseline.
# Usage: gates.sh FOVEA BUILD SOURCE OUT
set -uo pipefail
fovea=$1 build=$2 source=$3 out=$4
rm -rf "$out"
mkdir -p "$out/tmp"
failures=0
fail() { echo "$1"; failures=$((failures + 1)); }
# expect STATUS COMMAND...: output and messages go to $out/log
expect() {
  local want=$1 status=0
  shift
  "$@" >"$out/log" 2>&1 || status=$?
  [ "$status" = "$want" ] || { fail "status $status, not $want: $*: $(cat "$out/log")"; return 1; }
}
says() { grep -qE -- "$1" "$out/log" || fail "no '$1' in: $(cat "$out/log")"; }
cd "$out" || exit 1

# A program of exec, in a folder that is named as its baseline.
cat >app.c <<'C'
#include <stdlib.h>
static volatile int sink;
__attribute__((noinline)) static void work(int n) { while (n--) sink += n; }
int main(int argc, char **argv) { work(argc > 1 ? atoi(argv[1]) : 100); return 0; }
C
arm-none-eabi-gcc -g -O1 -mcpu=arm926ej-s --specs=rdimon.specs app.c -o app.elf || exit 1
mkdir slow
sed 's/sink += n/sink += n, sink += n/' app.c >slow/app.c
arm-none-eabi-gcc -g -O1 -mcpu=arm926ej-s --specs=rdimon.specs slow/app.c -o slow/app.elf || exit 1
expect 0 "$fovea" exec -q --profile -o base app.elf 3000
expect 0 "$fovea" bless base --against base.yaml --why first && says 'reference in base-reference'
for line in 'program: app.elf' 'arguments: \["3000"\]'; do grep -qx "$line" base.yaml || fail "no '$line': $(cat base.yaml)"; done
expect 0 "$fovea" check base --against base.yaml
expect 0 "$fovea" exec -q --profile -o slower slow/app.elf 3000
expect 1 "$fovea" check slower --against base.yaml && says 'FAILED  cpu.cycles' && says '^blamed: work \(app.c(:[0-9]+)?\) executes more'
expect 0 "$fovea" exec -q -o other app.elf 3001
expect 2 "$fovea" check other --against base.yaml && says "is of program 'app.elf 3001', base.yaml is for program 'app.elf 3000'"
expect 0 "$fovea" exec -q --caches -o cached app.elf 3000
expect 2 "$fovea" check cached --against base.yaml && says "'app.elf 3000' with --caches"

# A replay.
cat >small.yaml <<'Y'
run: {frames: 2, start_limit: 2s}
camera: {kind: chart, stamp: false}
video: {width: 128, height: 32}
firmware: {kernel: plain}
Y
firmware=$build/sw/firmware/fovea_firmware.elf
expect 0 "$fovea" run small.yaml -s firmware.elf="$firmware" --no-frames --bus-trace small.trace -o small
expect 0 "$fovea" replay small.trace -o replay
expect 0 "$fovea" bless replay --against replay.yaml --why first
grep -qx 'trace: small.trace' replay.yaml || fail "no trace: $(cat replay.yaml)"
expect 0 "$fovea" check replay --against replay.yaml
# Eight times as many refreshes make the remaps longer by more than one per cent.
expect 0 "$fovea" replay small.trace -s ddr.tREFI=237cycles -o slow_replay
expect 1 "$fovea" check slow_replay --against replay.yaml && says 'FAILED  frame.remap_time' && says 'ddr.tREFI: .* -> 237 cycles'
expect 2 "$fovea" check small --against replay.yaml && says "is of experiment 'small', replay.yaml is for trace 'small.trace'"
expect 0 "$fovea" replay small.trace --memory-only -o memory
expect 2 "$fovea" check memory --against replay.yaml && says "'small.trace' with --memory-only"
# Every command that takes a folder says of what kind these are, or works.
expect 1 "$fovea" compare small replay && says '^A  small: experiment .small.' && says '^B  replay: trace .small.trace.' &&
  says ' parameters exist in one of the two only; --all lists them'
expect 0 "$fovea" report base --text
expect 0 "$fovea" report replay --text
expect 0 "$fovea" trend base replay small --database t.db --commit c && says 't.db: app.elf 3000 of commit c' &&
  says 't.db: small.trace of commit c'
expect 2 "$fovea" limits small.yaml --over clocks.ddr=243MHz -o base

# Two programs.
. "$(dirname "$0")/plant.sh"
firmware load kernels/remap_plain.c \
  's/^  while \(lut != end\) (.*)$/  while (lut != end) { (void)*(const volatile uint32_t *)(base + *lut + 8192); \1 }/'
export TMPDIR=$out/tmp
expect 0 "$fovea" check small.yaml "$firmware" "$firmware" && says '^passed: small by .*fovea_firmware.elf against .*fovea_firmware.elf: '
expect 1 "$fovea" check small.yaml "$firmware" load.elf --markdown mr.md -s run.frames=1 -o kept &&
  says '^FAILED: small by load.elf against .*fovea_firmware.elf: ' && says 'FAILED  frame.remap_time.mean' && says '^blamed: remap_plain \(remap_plain.c:[0-9]+\) executes more'
[ "$(grep -c '^- \*\*' mr.md)" = 5 ] && grep -q '^- \*\*who\*\*: `remap_plain (remap_plain.c:' mr.md || fail "$(cat mr.md)"
[ -f kept/a/stats.json ] && [ -f kept/b/profile.csv ] || fail 'the results are not kept'
grep -q '"run.frames": {"value": "1"' kept/b/config.json || fail '-s has no effect'
expect 2 "$fovea" check small.yaml nowhere.elf "$firmware" && says '^fovea: nowhere.elf: error: .*nowhere.elf'
expect 2 "$fovea" check small.yaml "$firmware" "$firmware" -s no.key=1 && says 'no.key'
arm-none-eabi-gcc -nostdlib -mcpu=arm926ej-s -Wl,-Ttext=0x80100000 -x assembler -o abort.elf - <<<'.global _start
_start: .word 0xe7f000f0' || exit 1
expect 3 "$fovea" check small.yaml "$firmware" abort.elf && says '^fovea: abort.elf: the guest failed'
# Stopped: both runs end, and nothing is left.
"$fovea" check small.yaml "$firmware" "$firmware" -s run.frames=100000 >stop.log 2>&1 &
pid=$!
for _ in $(seq 100); do [ -n "$(ls tmp)" ] && pgrep -P $pid >children && break; sleep 0.05; done
sleep 0.3
kill -TERM $pid
wait $pid
status=$?
[ "$status" = 143 ] || fail "stopped: status $status: $(cat stop.log)"
while read -r child; do kill -0 "$child" 2>/dev/null && fail "run $child goes on"; done <children
[ -s children ] || fail 'no run was seen'
[ -z "$(ls tmp)" ] || fail "left: $(ls tmp)"
echo "$failures failures"
[ "$failures" = 0 ]
