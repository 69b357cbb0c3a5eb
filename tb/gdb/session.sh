#!/usr/bin/env bash
# Scripted sessions of gdb-multiarch with `fovea exec` and `fovea run`.
# Usage: session.sh FOVEA GDB PROGRAM.elf FIRMWARE.elf
set -uo pipefail
fovea=$(realpath "$1") gdb=$2 program=$(realpath "$3") firmware=$(realpath "$4")
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
cd "$out" || exit 1
failures=0
fail() { echo "$*"; failures=$((failures + 1)); }

# begin NAME command...: starts fovea; afterwards $pid and $port are its.
begin() {
  name=$1
  shift
  "$fovea" "$@" --gdb :0 >"$name.out" 2>"$name.err" </dev/null &
  pid=$!
  for _ in $(seq 100); do
    port=$(sed -n 's/.*target remote 127.0.0.1:\([0-9]*\).*/\1/p' "$name.err")
    [ -n "$port" ] && return
    sleep 0.05
  done
  port=9
  fail "$name: fovea does not listen: $(cat "$name.err")"
}
# debug FILE [SECONDS]: runs gdb with the commands of standard input, also behind a command that fails;
# Ctrl-C after so many seconds.
debug() {
  local commands=(-ex 'set pagination off' -ex 'set confirm off')
  commands+=(-ex "target remote 127.0.0.1:$port")
  while IFS= read -r line; do commands+=(-ex "$line"); done
  timeout --foreground -s INT -k 20 "${2:-20}" "$gdb" -nx -batch "${commands[@]}" "$1" >>"$name.gdb" 2>&1
}
# end STATUS 'pattern'...: how fovea ends, and what gdb must have said.
end() {
  local want=$1 got
  shift
  wait $pid
  got=$?
  [ $got = "$want" ] || fail "$name: exit status $got, expected $want: $(cat "$name.err")"
  for p in "$@"; do
    grep -qE -- "$p" "$name.gdb" || fail "$name: no '$p' in: $(cat "$name.gdb")"
  done
}

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
monitor params ddr.part
monitor regs ddr.SDBCR
x/i $pc
detach
G
end 35 'Breakpoint 1, leaf \(n=n@entry=0\)' '#1 .* in branch \(n=5\)' '#2 .* in main' \
  'control +0x50078' 'Value returned is \$1 = 1' 'Hardware watchpoint' 'Old value = 0' \
  'New value = 35' '0x00000000 0x08000000 rw' '[0-9]+\.[0-9]{3} ns, core clock [0-9]+' \
  'cpu.instructions = [0-9]+' 'ddr.part = mt47h64m16' 'SDBCR = 0x[0-9a-f]{8} .*CL=5' 'detached'
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
  end 96 '\$1 = 6' '\$2 = 100' 'Old value' '\$3 = 0x10' '\$4 = 0x1234' '\$5 = 0x1' \
    '\$6 = 0x4000' '\$7 = 452'
  grep -q 'sum 352 watched 452 limit 7' "patch$memory.out" || fail "patch: $(cat "patch$memory.out")"
done

# Ctrl-C, leaving, coming back, and an end by the debugger.
begin stop exec "$program" wait
debug "$program" 1 <<'G'
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

# Nobody attaches: Ctrl-C still ends it. The port is for this host, and one debugger.
begin alone exec "$program"
kill -INT $pid
: >alone.gdb
end 130
"$fovea" exec --gdb :70000 "$program" 2>port.err
[ $? = 2 ] && grep -q ':65535' port.err || fail "port: $(cat port.err)"

# The board: into an interrupt handler, peripherals, same figures.
cat >small.yaml <<'Y'
run: {frames: 2, start_limit: 2s}
camera: {kind: chart, stamp: false}
video: {width: 64, height: 16}
Y
"$fovea" run small.yaml -o board_plain --no-frames >/dev/null 2>&1
begin board run small.yaml -o board --no-frames
debug "$firmware" <<'G'
break main
continue
delete
break irq_dispatch
continue
backtrace
info registers cpsr control
x/4xb 0x01c40000
set var *(int *)0x01c40000 = 1
print/x *(unsigned *)0x80000000
monitor regs aintc
monitor stats ddr.read
delete
detach
G
end 0 'main \(\)' 'irq_dispatch \(\)' '#1 .* irq_entry' 'cpsr +0x[0-9a-f]*2 ' 'aintc.IRQ0 = 0x' \
  'Cannot access memory at address 0x1c40000' 'ddr.read_bytes = [0-9]+' 'detached'
# Another master's access: the camera fills a buffer while the core sleeps, the display reads one.
begin dma run small.yaml -o dma --no-frames
debug "$firmware" <<'G'
break main
continue
monitor where
watch *(int *)&frame_in[0]
continue
monitor where
delete
monitor watch dma 0x80341000,0x200000 r vpbe
monitor watch dma 0x80341000,0x200000 r nobody
monitor watch
continue
monitor where
monitor watch clear
break irq_dispatch
continue
monitor where
detach
G
end 0 'core: at the instruction at 0x8' 'no master has a request under way' \
  'vpfe wrote 0x80015000 at [0-9]+\.[0-9]{3} ns' 'Old value = 0' 'core: waits for an interrupt' \
  'sdram 1: write of vpfe, 64 bytes at 0x80015000, bank' 'next command ACT for vpfe' \
  'no such master; allowed: arm_i' '0x80341000,2097152 r vpbe' 'vpbe read 0x80341[0-9a-f]* at' \
  'vpbe: read of 64 bytes at 0x80341' 'irq_dispatch \(\)'
cmp board_plain/stats.json dma/stats.json || fail 'dma: other figures than without a debugger'

# Switched off, the debugger's watchpoints see the core alone.
begin core run small.yaml -o core --no-frames
debug "$firmware" <<'G'
break main
continue
awatch *(int *)&frame_in[0]
monitor watch-masters off
monitor regs timer3
continue
bt 1
detach
G
end 0 'do not see'
grep -q 'vpfe wrote' core.gdb && fail "core: a master stops it: $(cat core.gdb)"

cmp board_plain/stats.json board/stats.json || fail 'board: other figures than without a debugger'
exit $((failures > 0))
