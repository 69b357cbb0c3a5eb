#!/bin/sh
# against_qemu.sh BUILD [PROGRAM...]: host CPU time of the same program file on qemu-system-arm
# (functional, translated code) and on Fovea's core (cycle counts, caches), best of five each.
set -eu
build=${1:?usage: against_qemu.sh BUILD [PROGRAM...]}/tb/bench
shift
[ $# -gt 0 ] || set -- soft_float integer block_copy remap
best() {  # host CPU seconds, user and system, of a command's fastest run
  for n in 1 2 3 4 5; do
    bash -c 'TIMEFORMAT="%U %S"; time "$@" >/dev/null' best "$@" 2>&1 | tail -n 1
  done | awk '{ t = $1 + $2; if (NR == 1 || t < b) b = t } END { printf "%.3f", b }'
}
for name in "$@"; do
  q=$(best timeout 120 qemu-system-arm -M versatilepb -cpu arm926 -m 32 -display none -serial none \
        -monitor none -semihosting-config enable=on,target=native -kernel "$build/$name.elf")
  f=$(best "$build/core_run" "$build/$name.elf")
  awk -v name="$name" -v q="$q" -v f="$f" \
    'BEGIN { printf "%-11s qemu %7.3f s  core %7.3f s  ratio %.3f\n", name, q, f, q / f }'
done
