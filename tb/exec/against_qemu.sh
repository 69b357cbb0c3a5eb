#!/usr/bin/env bash
# A newlib program at one build: output, exit status and files equal to those under qemu-system-arm, on
# the board's memory and on flat memory.
# Usage: against_qemu.sh FOVEA QEMU PROGRAM.elf [arguments...]
set -uo pipefail
fovea=$(realpath "$1") qemu=$2 program=$(realpath "$3")
shift 3
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
failures=0
printf 'first\n second line\n\n1.5 2.25\n-7\n' >"$dir/stdin"
for who in qemu board flat; do
  mkdir "$dir/$who"
  echo '40 2' >"$dir/$who/input.txt"
done

config=enable=on,target=native,arg=$(basename "$program")
for a in "$@"; do config+=,arg=$a; done
(cd "$dir/qemu" && QEMU_AUDIO_DRV=none timeout 60 "$qemu" -M versatilepb -cpu arm926 -display none \
  -monitor none -serial none -semihosting-config "$config" -kernel "$program" \
  <"$dir/stdin" >"$dir/qemu.out" 2>"$dir/qemu.err")
want=$?

for who in board flat; do
  options=()
  [ $who = flat ] && options=(--fast-memory)
  timeout 60 "$fovea" exec "${options[@]}" --root "$dir/$who" "$program" -- "$@" \
    <"$dir/stdin" >"$dir/$who.out" 2>"$dir/$who.err"
  got=$?
  if [ $got != $want ]; then
    echo "$who: exit status $got, under qemu $want"
    failures=$((failures + 1))
  fi
  diff "$dir/qemu.out" "$dir/$who.out" >"$dir/diff" || {
    echo "$who: other output (< qemu, > fovea):"
    cat "$dir/diff"
    failures=$((failures + 1))
  }
  diff -r "$dir/qemu" "$dir/$who" || failures=$((failures + 1))
  # The program's lines of the other stream are among ours; qemu has words of its own there. On a busy
  # host a run takes long enough to report its progress.
  while read -r line; do
    grep -qxF -- "$line" "$dir/qemu.err" || {
      echo "$who: on the error stream, and not under qemu: $line"
      failures=$((failures + 1))
    }
  done < <(grep -vE '^(core  |        |The program ran with MMU)|^simulated [0-9.]+ s, ' "$dir/$who.err")
  grep -q 'instructions in [0-9]* clocks' "$dir/$who.err" || {
    echo "$who: no figures"
    failures=$((failures + 1))
  }
done
[ -s "$dir/qemu.out" ] || { echo "no output under qemu"; failures=$((failures + 1)); }
exit $((failures > 0))
