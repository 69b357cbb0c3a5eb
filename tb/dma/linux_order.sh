#!/usr/bin/env bash
# A copy with the register accesses of Linux' driver, in their order: it succeeds, and the accesses are those that
# Linux makes (linux_order.txt). Usage: linux_order.sh FOVEA PROGRAM OUT
# The list again from Linux itself: scripts/linux --test compares it, and leaves it in build/linux/linux_order.txt.
set -uo pipefail
fovea=$1 program=$2 out=$3 here=$(dirname "$0")
mkdir -p "$out"
"$fovea" exec --board "$program" --log-registers '^edma\.' --log-registers-kept 10000 >"$out/log" 2>&1 ||
  { echo "status $?"; grep -v ' edma\.' "$out/log"; exit 1; }
grep -q 'a copy as Linux does it: good' "$out/log" || { echo 'no verdict'; exit 1; }
awk -f "$here/linux_order.awk" "$out/log" >"$out/order.txt"
diff "$here/linux_order.txt" "$out/order.txt" || { echo 'other accesses than those of Linux'; exit 1; }
# The comparison can complain: two accesses in the other order, and another value.
grep ' edma\.' "$out/log" | sed -E 'N;s/^(.*S0_EECRH = .*)\n(.*S0_ECRH.*)$/\2\n\1/;P;D' | awk -f "$here/linux_order.awk" |
  diff -q "$here/linux_order.txt" - >/dev/null && { echo 'another order is not found'; exit 1; }
grep ' edma\.' "$out/log" | sed 's/SRC_DST_CIDX77 = 0x00000000/SRC_DST_CIDX77 = 0x00000001/' | awk -f "$here/linux_order.awk" |
  diff -q "$here/linux_order.txt" - >/dev/null && { echo 'another value is not found'; exit 1; }
exit 0
