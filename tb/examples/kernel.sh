#!/usr/bin/env bash
# The kernel of model/howto/add-a-kernel.md: a copy of the firmware gets its source and its row, nothing else, and is
# built; beside it lies a host program with the row. The picture is that of the loop `plain`.
# Usage: kernel.sh FOVEA_WITH_IT FOVEA SOURCE OUT
set -uo pipefail
with=$1 fovea=$2 source=$3 out=$4
rm -rf "$out"
mkdir -p "$out/tree/model" "$out/tree/sw"
cd "$out" || exit 1
fail() { echo "$*"; exit 1; }
cp -r "$source/model/contract" tree/model && cp -r "$source"/sw/{firmware,lens,remap} tree/sw || fail "no copy"
cp "$source/tb/examples/kernel/two_rows.c" tree/sw/firmware/kernels || fail "no source of the kernel"
patch --silent tree/model/contract/param_page.h "$source/tb/examples/kernel/param_page.diff" || fail "no row"
{
  echo 'cmake_minimum_required(VERSION 3.25)'
  echo 'project(with_kernel NONE)'
  echo 'add_subdirectory(sw/firmware)'
} >tree/CMakeLists.txt
{ cmake -S tree -B . -G Ninja && ninja sw/firmware/fovea_firmware.elf; } >build.txt 2>&1 || fail "$(tail -20 build.txt)"
ln -f "$with" fovea 2>/dev/null || cp "$with" fovea
cat >small.yaml <<'Y'
run: {frames: 2}
camera: {kind: chart, stamp: false}
video: {width: 252, height: 40}
firmware: {lut: fixed_point}
Y
./fovea params firmware.kernel | grep -q 'engine_radial, two_rows' || fail "the key does not allow the kernel"
"$fovea" params firmware.kernel | grep -q two_rows && fail "the program without the row knows the kernel"
for kernel in two_rows plain copy; do
  ./fovea run small.yaml -s firmware.kernel=$kernel -o $kernel >$kernel.txt 2>$kernel.err || fail "$(<$kernel.err)"
  grep -q "^kernel: $kernel, " $kernel/uart.log || fail "$(<$kernel/uart.log)"
done
[ "$(find plain/frames -name '*.png' | wc -l)" = 2 ] || fail "plain has not shown two pictures"
diff -rq plain/frames two_rows/frames || fail "the pictures are not those of the kernel 'plain'"
diff -rq plain/frames copy/frames >/dev/null && fail "a kernel that does not correct shows the same: no test"
cmp -s plain/stats.json two_rows/stats.json && fail "another loop takes the same time"
./fovea run small.yaml --no-frames -s firmware.kernel=two_rows -s firmware.tables=2 -o turns >turns.txt 2>turns.err ||
  fail "$(<turns.err)"
grep -q '^kernel two_rows: tables in turn leave' turns/uart.log && grep -q '^kernel: plain, ' turns/uart.log ||
  fail "refused, it is not replaced by the kernel in its row: $(<turns/uart.log)"
grep -q 'firmware.kernel=two_rows was asked for, and plain ran' turns.err || fail "the run is silent: $(<turns.err)"
echo "the kernel of the how-to works"
