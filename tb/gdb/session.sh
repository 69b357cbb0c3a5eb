#!/usr/bin/env bash
# Scripted sessions of gdb-multiarch with `fovea exec`.
# Usage: session.sh FOVEA GDB PROGRAM.elf MAPPED.elf
set -uo pipefail
fovea=$(realpath "$1") gdb=$2 program=$(realpath "$3") mapped=$(realpath "$4")
# shellcheck source=tb/gdb/session_tools.sh
. "$(dirname "$(realpath "$0")")/session_tools.sh"

# Looking: every stop, and the same figures as without a debugger.
"$fovea" exec "$program" -o plain >plain.out 2>/dev/null
begin look exec "$program" -o look
debug "$program" <<'G'
break leaf
continue
backtrace
info registers r0 cpsr control
stepi
finish
next
tbreak branch
delete 1
hbreak main.c:1
watch watched
rwatch limit
continue
continue
delete
info mem
monitor time
monitor stats cpu.inst
monitor stats ddr.bursts
monitor params ddr.part
monitor regs ddr.SDBCR
x/i $pc
detach
G
end 35 'Breakpoint 1, leaf \(n=n@entry=0\)' '#1 .* in branch \(n=5\)' '#2 .* in main' \
  'control +0x50078' 'Value returned is \$1 = 1' 'Hardware watchpoint' 'Old value = 0' \
  'New value = 35' '0x00000000 0x08000000 rw' '[0-9]+\.[0-9]{3} ns, core clock [0-9]+' \
  'cpu.instructions = [0-9]+' 'ddr.bursts = [1-9]' 'ddr.part = mt47h64m16' 'SDBCR = 0x[0-9a-f]{8} .*CL=5' 'detached'
cmp plain.out look.out || fail 'look: other output'
cmp plain/stats.json look/stats.json || fail 'look: other figures than without a debugger'

# Changing: memory, a register, and the place where the program goes on.
for memory in '' --fast-memory; do
  begin "patch$memory" exec $memory "$program"
  debug "$program" <<'G'
break main
continue
set var limit = 7
break leaf if n == 6
continue
print n
set var $r0 = 100
print $r0
delete
awatch watched
continue
info registers spsr
set var $spsr = 0x10
print/x $spsr
set var $far = 0x1234
print/x $far
set var $control = $control | 0x4000
print/x $control & 0x4000
print/x $sp_svc == $sp
set var $sp_irq = 0x4000
print/x $sp_irq
delete
tbreak printf
continue
up
print watched
continue
G
  # 1 + 4 + 7 + 10 + 13 + 16, and leaf(100) for leaf(6); the status is its low seven bits.
  end 96 '\$1 = 6' '\$2 = 100' 'Old value' '\$3 = 0x10' '\$4 = 0x1234' '\$5 = 0x4000' \
    '\$6 = 0x1' '\$7 = 0x4000' '\$8 = 452'
  grep -q 'sum 352 watched 452 limit 7' "patch$memory.out" || fail "patch: $(cat "patch$memory.out")"
done

# Several watchpoints at one instruction, and one where a breakpoint stops already.
begin several exec "$program"
debug "$program" <<'G'
set var limit = 9
load
compare-sections
break store_pair
continue
watch pair.first
watch pair.second
awatch pair.third
continue
continue
continue
delete
break *store_here
watch pair.second
continue
continue
print pair.second
delete
info registers banked
detach
G
end 35 'Start address 0x' '"?\.text"?,.*: matched' 'pair.first$' 'New value = 11' 'New value = 12' 'New value = 13' 'New value = 22' '= 22$' \
  'sp_irq +0x'
[ "$(grep -cE '^(Hardware|$).*watchpoint [0-9]+: pair' several.gdb)" = 8 ] ||
  fail "several: not each watchpoint once: $(cat several.gdb)"
grep -q 'MIS-MATCHED' several.gdb && fail "several: load: $(cat several.gdb)"
grep -q 'ttbr' several.gdb && fail "several: more than one group: $(cat several.gdb)"

# A program that fails stops at the instruction that does, for the debugger.
for memory in '' --fast-memory; do
  begin "fails$memory" exec $memory "$program" load
  debug "$program" <<'G'
continue
backtrace
info registers pc cpsr
monitor where
monitor set ddr.PBBPR=1
continue
G
  end 3 'data abort with no handler' 'Program received signal SIGABRT' '#1 .* in main' \
    'cpsr +0x[0-9a-f]*d3 ' 'core: has failed at 0x' 'exited with code 03'
done
begin left exec "$program" load
debug "$program" <<'G'
detach
G
end 3

# Ctrl-C while the program waits for console input, which comes later or not at all.
mkfifo typed
exec 8<>typed
for memory in '' --fast-memory; do
  input=typed begin "input$memory" exec $memory "$program" input
  debug_until '^waiting' "$program" <<'G'
continue
backtrace
monitor where
monitor time
detach
G
  echo 'a line' >&8
  end 35 'Program received signal SIGINT' 'in main' 'core: waits for console input since' \
    '^[0-9.]+ ns, core clock [0-9]+$' 'detached'
  grep -q '^read a line' "input$memory.out" || fail "input: $(cat "input$memory.out")"
done
input=typed begin unfed exec "$program" input
debug_until '^waiting' "$program" <<'G'
continue
kill
G
end 3 'SIGINT'
exec 8>&-

# A second debugger is turned away, and the first goes on.
begin two exec "$program"
"$gdb" -nx -batch -ex "target remote 127.0.0.1:$port" -ex 'shell sleep 3' -ex 'detach' "$program" \
  >two.first 2>&1 </dev/null &
first=$!
sleep 1
debug "$program" <<'G'
info registers pc
G
wait $first
end 35 'Remote connection closed|Connection (reset|closed)'
grep -q detached two.first || fail "two: $(cat two.first)"

# Ctrl-C, leaving, coming back, and an end by the debugger.
begin stop exec "$program" wait
debug_until '^waiting' "$program" <<'G'
continue
print waiting > 1000
detach
G
debug "$program" <<'G'
print waiting > 1000
set var released = 1
break leaf
continue
detach
G
end 35 'Program received signal SIGINT' '\$1 = 1' 'Breakpoint 1, leaf'
begin kill exec --fast-memory "$program" wait -o kill
debug "$program" <<'G'
stepi
kill
G
end 3
grep -q 'stopped by the debugger' kill.err || fail "kill: $(cat kill.err)"
grep -q '"complete": false' kill/stats.json || fail 'kill: the run is called complete'

# No debugger attaches: Ctrl-C still ends it. The port is for this host, and one debugger.
begin alone exec "$program"
kill -INT $pid
: >alone.gdb
end 130
"$fovea" exec --gdb :70000 "$program" 2>port.err
[ $? = 2 ] && grep -q ':65535' port.err || fail "port: $(cat port.err)"

# MMU and caches on: virtual addresses, code and data changed in every copy.
"$fovea" exec "$mapped" >mapped_plain.out 2>/dev/null
grep -q 'first 5 second 5 window 0' mapped_plain.out || fail "mapped: $(cat mapped_plain.out)"
for memory in '' --fast-memory; do
  begin "mapped$memory" exec $memory "$mapped" -o "mapped$memory"
  debug "$mapped" <<'G'
break stop_here
continue
x/wx 0x40000010
x/wx 0x01000010
x/wx 0x40200000
set var *(int *)0x40000020 = 99
x/wx 0x01000020
set var *(int *)constant = 0xe3a00007
watch *(int *)0x40000030
continue
info registers control ttbr
continue
G
  end 0 '0x40000010:.*0x12345678' '0x1000010:.*0x12345678' 'Cannot access memory at address 0x40200000' \
    '0x1000020:.*0x00000063' 'New value = 99' 'control +0x5107d'
  grep -q 'first 5 second 7 window 99' "mapped$memory.out" || fail "mapped: $(cat "mapped$memory.out")"
done

# Where the core stands on its own.
begin where exec "$program"
debug "$program" <<'G'
break leaf
continue
stepi 3
monitor where
monitor watch
monitor nonsense
detach
G
end 35 'core: at the instruction at 0x' 'monitor watch dma 0xADDR' 'nothing is watched'
begin where_fast exec --fast-memory "$program"
debug "$program" <<'G'
break leaf
continue
monitor where
monitor watch
monitor registers
detach
G
end 35 'memory answers at once' 'no other masters' 'no registers to log'

# The log of an exec's only block, on the error stream or in the folder.
"$fovea" exec --log-registers . "$program" >/dev/null 2>log.err
[ $? = 35 ] || fail "log: $(cat log.err)"
exit $((failures > 0))
