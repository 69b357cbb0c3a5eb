#!/usr/bin/env bash
# Scripted sessions of gdb-multiarch with `fovea run`: peripherals, other masters, lost connections.
# Usage: board_session.sh FOVEA GDB FIRMWARE.elf
set -uo pipefail
fovea=$(realpath "$1") gdb=$2 firmware=$(realpath "$3")
# shellcheck source=tb/gdb/session_tools.sh
. "$(dirname "$(realpath "$0")")/session_tools.sh"

cat >small.yaml <<'Y'
run: {frames: 2, start_limit: 2s}
camera: {kind: chart, stamp: false}
video: {width: 64, height: 16}
Y
"$fovea" run small.yaml -o plain --no-frames >plain.out 2>&1
grep -q SystemC plain.out && fail "run: a message of the kernel: $(cat plain.out)"
# Where a buffer of the firmware lies, and so many bytes behind that.
address() { printf '0x%08x' $((0x$(arm-none-eabi-nm "$firmware" | awk -v s="$1" '$3 == s { print $1 }') + ${2-0})); }
frames_in=$(address frame_in) frames_out=$(address frame_out)
same() { cmp plain/stats.json "$1/stats.json" || fail "$1: other figures than without a debugger"; }

# Into an interrupt handler, peripherals.
begin board run small.yaml -o board --no-frames
debug "$firmware" <<'G'
break main
continue
delete
break irq_dispatch
continue
backtrace
info registers cpsr control
info registers sp_irq spsr_irq
x/4xb 0x01c40000
set var *(int *)0x01c40000 = 1
print/x *(unsigned *)0x80000000
monitor regs aintc
monitor stats ddr.read
delete
detach
G
end 0 'main \(\)' 'irq_dispatch \(\)' '#1 .* irq_entry' 'cpsr +0x[0-9a-f]*2 ' 'aintc.IRQ0 = 0x' \
  'sp_irq +0x8' 'Cannot access memory at address 0x1c40000' 'ddr.read_bytes = [0-9]+' 'detached'
same board

# Stops before `main`, among writes to clocks, memory controller and timers: each makes the core look
# around where it would not without a debugger.
begin early run small.yaml -o early --no-frames
debug "$firmware" <<'G'
stepi 300
watch *(unsigned *)0x7f00
break pll_init
continue
stepi 5000
delete
break ddr_init
continue
stepi 2000
delete
tbreak timer_start
continue
stepi 40
monitor time
detach
G
end 0 'ddr_init \(' 'timer_start \(\)' ', core clock [0-9]+' 'detached'
same early

# Another master's access: the camera fills a buffer while the core sleeps, the display reads one.
begin dma run small.yaml -o dma --no-frames
debug "$firmware" <<G
break main
continue
monitor where
watch *(int *)&frame_in[0]
continue
monitor where
delete
monitor watch dma $frames_out,0x200000 r vpbe
monitor watch dma $frames_out,0x200000 r no_master
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
  "vpfe wrote $frames_in"' at [0-9]+\.[0-9]{3} ns' 'Old value = 0' 'core: waits for an interrupt' \
  "sdram 1: write of vpfe, 64 bytes at $frames_in, bank" 'next command ACT for vpfe' \
  'no such master; allowed: arm_i' "$frames_out,2097152 r vpbe" "vpbe read ${frames_out%???}[0-9a-f]* at" \
  'vpbe \(priority 0\):' "    read of 64 bytes at ${frames_out%???}.* ns\\): " 'irq_dispatch \(\)'
same dma

# The D-cache hides what the camera writes: no watchpoint in GDB's sense, and not silence either. Of
# one burst's watchpoints each is told, those at one address together.
begin hidden run small.yaml -o hidden --no-frames
debug "$firmware" <<G
break main
continue
tbreak pipeline_done
continue
set var frame_in[0x40] = ~frame_in[0x40]
set var frame_in[0x80] = ~frame_in[0x80]
print \$before = frame_in[0x40]
watch frame_in[0x40]
continue
print \$before == frame_in[0x40]
delete
awatch frame_in[0x80]
awatch *(short *)&frame_in[0x80]
awatch frame_in[0x83]
monitor watch dma $(address frame_in 0xc0),4 w
continue
continue
continue
monitor watch clear
delete
detach
G
end 0 'Program received signal SIGTRAP' '= 1$'
said() { sed -n '/^\$1 = /,$p' hidden.gdb |
  grep -E '^(vpfe wrote|the core does not|Program received)|^Hardware access .*: '; }
want="vpfe wrote $(address frame_in 0x40) at NS
the core does not see it: its D-cache or buffers hold other bytes there
Program received signal SIGTRAP, Trace/breakpoint trap.
Hardware access (read/write) watchpoint 4: frame_in[0x80]
Hardware access (read/write) watchpoint 5: *(short *)&frame_in[0x80]
Hardware access (read/write) watchpoint 6: frame_in[0x83]
vpfe wrote $(address frame_in 0x80) at NS
Hardware access (read/write) watchpoint 4: frame_in[0x80]
Hardware access (read/write) watchpoint 5: *(short *)&frame_in[0x80]
vpfe wrote $(address frame_in 0x83) at NS
Hardware access (read/write) watchpoint 6: frame_in[0x83]
vpfe wrote $(address frame_in 0xc0) at NS
Program received signal SIGTRAP, Trace/breakpoint trap."
[ "$(said | sed 's/ at [0-9.]* ns/ at NS/')" = "$want" ] || fail "hidden: $(cat hidden.gdb)"

# Stepped through the time of the same write, the core stops at the boundary behind it.
begin awake run small.yaml -o awake --no-frames -s load.outstanding=1 -s load.gap=20us
debug "$firmware" <<'G'
break main
continue
monitor watch dma 0x82000000,0x4000000 r load
continue
monitor where
stepi
monitor where
detach
G
end 0 'load read 0x82' 'Program received signal SIGTRAP' 'core: at the instruction at'

# The kernel's own pace in every access finds the same stops at the same times.
stops() { grep -E '^(vpfe|vpbe|load) (wrote|read)|^[0-9.]+ ns, core|^pc ' "$1.gdb"; }
for sync in default strict; do
  begin "sync_$sync" run small.yaml --sync=$sync -o "sync_$sync" --no-frames -s load.outstanding=2 -s load.gap=20us
  debug "$firmware" <<G
break main
continue
delete
monitor watch dma 0x82000000,0x4000000 r load
continue
monitor time
info registers pc
stepi 500
monitor time
continue
monitor time
info registers pc
monitor watch clear
monitor watch dma $frames_in,4 w vpfe
continue
monitor time
info registers pc
monitor watch clear
monitor watch dma $frames_out,0x200000 r vpbe
continue
monitor time
detach
G
  end 0 'load read' 'vpfe wrote' 'vpbe read'
done
[ "$(stops sync_default)" = "$(stops sync_strict)" ] ||
  fail "sync: default $(stops sync_default); strict $(stops sync_strict)"
cmp sync_default/stats.json sync_strict/stats.json || fail 'sync: other figures'

# Transfer controllers, which work ahead of the kernel: stops, times, and what waits for whom then are those of its own
# pace. In a copy the core computes at first; in a gather it sleeps, and the path acts in the instant of a stop.
for kernel in copy gather; do
  for sync in default strict; do
    begin "edma_${kernel}_$sync" run small.yaml --sync=$sync -o "edma_${kernel}_$sync" --no-frames \
      -s firmware.kernel=$kernel -s firmware.lut=fixed_point -s video.width=160 -s video.height=48
    debug "$firmware" <<G
break pipeline_take
continue
delete
monitor watch dma $frames_out,4 w edma_tc0_write
print *(int *)$frames_out == 0
continue
monitor where
print *(int *)$frames_out == *(int *)$frames_in && *(int *)$frames_out != 0
monitor watch clear
monitor watch dma $frames_out,0x200000 w edma_tc0_write
$(for _ in $(seq 40); do printf 'continue\nmonitor where\n'; done)
monitor watch clear
detach
G
    end 0 "^edma_tc0_write wrote $frames_out at [0-9]+\.[0-9]{3} ns" '^edma_tc0_write \(priority 7\):' \
      "^    write of 32 bytes at ${frames_out%???}[0-9a-f]* since [0-9.]+ ns" '^edma_tc0_read \(priority 7\):' \
      '^sdram [1-9]: write of edma_tc0_write, 32 bytes at 0x8'
    [ "$(grep -c '^edma_tc0_write wrote ' "$name.gdb")" = 41 ] || fail "$name: not 41 stops"
  done
  diff <(sed '/^\$[12] = /d' "edma_${kernel}_default.gdb") <(sed '/^\$[12] = /d' "edma_${kernel}_strict.gdb") ||
    fail "$kernel: other stops, or others wait, than at the kernel's own pace"
  cmp "edma_${kernel}_default/stats.json" "edma_${kernel}_strict/stats.json" || fail "$kernel: other figures"
done
grep -q '^core: waits for an interrupt' edma_gather_default.gdb || fail 'gather: the core does not sleep'
# The burst that stops the copy has arrived by then, and had not before.
[ "$(grep -E '^\$[12] = ' edma_copy_default.gdb)" = $'$1 = 1\n$2 = 1' ] || fail "copy: $(cat edma_copy_default.gdb)"

# Switched off, the debugger's watchpoints see the core alone.
begin core run small.yaml -o core --no-frames
debug "$firmware" <<'G'
break main
continue
awatch *(int *)&frame_in[0]
monitor watch-masters off
continue
detach
G
end 0 'do not see'
grep -q 'vpfe wrote' core.gdb && fail "core: a master stops it: $(cat core.gdb)"
same core

# Registers of peripherals, set as by the core: with side effects, at this time, and not when gated.
begin set run small.yaml -o set --no-frames
debug "$firmware" <<'G'
break irq_dispatch
continue
delete
monitor registers log ^(aintc|timer0)
monitor set timer3.PRD12=77
monitor set timer0.TCR.NONE=1
monitor set timer0.TCR.ENAMODE12=4
monitor set timer0.TCR
monitor set nowhere.X=1
monitor set gpio.SET_DATA01=nothing
monitor set uart0.SCR=0x5a
monitor set uart0.RBR_THR=0x7e
stepi 8
monitor registers
monitor registers log off
monitor registers log (
detach
G
end 0 'the clock of timer3 is gated' 'timer0.TCR has no field NONE' \
  'timer0.TCR.ENAMODE12: allowed: 0 to 3' 'the value is decimal or begins with 0x' \
  'no such register; blocks: ddr' 'uart0.SCR = 0x0000005a' "'\(' is not a regular expression" \
  'pc 0x8[0-9a-f]* \(.*\) arm_d read aintc\.IRQ' 'the log is off'

grep -q '~' set/uart.log || fail "set: the UART has not sent it: $(cat set/uart.log)"
grep -q '~' plain/uart.log && fail 'set: the firmware sends it by itself'

# Ctrl-C while the core waits for an interrupt; what is set then comes with the next event.
begin sleep run small.yaml -o sleep --no-frames -s run.frames=100000
debug_until 'frame [1-9]' "$firmware" <<'G'
continue
monitor where
monitor set uart0.SCR=0x3c
stepi
monitor regs uart0.SCR
kill
G
end 3 'SIGINT' 'written when the simulation comes to' 'uart0.SCR = 0x0000003c'

# A connection that ends without a word, halted: nothing runs until the next debugger comes.
begin lost run small.yaml -o lost --no-frames
raw() {  # raw BYTES...: a debugger that says these bytes, hears what comes, and is gone
  exec 9<>"/dev/tcp/127.0.0.1/$port" || return 1
  printf '%b' "$1" >&9
  timeout 0.3 cat <&9 >>lost.raw
  exec 9>&-
}
raw '+$?#3f'
raw '$m0,100#garbage$Z0,#\x03\x7d\xff$vCont;c'
raw '\x03\x03---+++$$$$##'
sleep 0.5
debug "$firmware" <<'G'
monitor time
info registers pc
break main
continue
detach
G
end 0 '^41\.666 ns, core clock 1$' 'pc +0x0 ' 'Breakpoint 1, main' 'detached'
grep -qa 'T02' lost.raw || fail "lost: no answer: $(cat lost.raw)"
same lost

# The log of a whole run, and of one that fails.
"$fovea" run small.yaml -o logged --no-frames --log-registers '^psc\.MDCTL|i2c' \
  --log-registers-kept 100 >/dev/null 2>logged.err || fail "logged: $(cat logged.err)"
same logged
[ "$(grep -c ' arm_d ' logged/registers.log)" = 100 ] || fail 'logged: not 100 lines'
grep -q 'earlier accesses are not shown' logged/registers.log || fail 'logged: nothing was left out'
grep -qE '^[0-9]+\.[0-9]{3} ns  pc 0x[0-9a-f]{8} \(.*\) arm_d (read|wrote) i2c\.[A-Z0-9]+ = 0x' \
  logged/registers.log || fail "logged: $(head -3 logged/registers.log)"
grep -q 'timer' logged/registers.log && fail 'logged: other blocks'
"$fovea" run small.yaml -o bad --log-registers '(' 2>bad.err
[ $? = 2 ] && grep -q 'regular expression' bad.err || fail "bad: $(cat bad.err)"
[ -e bad ] && fail 'bad: leaves a folder'
exit $((failures > 0))
