#!/usr/bin/env bash
# Programs that know nothing of cameras: the console, what ends a run, its limits, a second file of
# symbols, and `fovea exec --board`.
# Usage: foreign.sh FOVEA OUT SERIAL.elf BOARD.elf NAMES.elf
set -uo pipefail
fovea=$1 out=$2 serial=$3 board=$4 names=$5
rm -rf "$out"
mkdir -p "$out"
failures=0
fail() {
  echo "$*"
  failures=$((failures + 1))
}

# expect NAME STATUS 'pattern'... -- command...
expect() {
  local name=$1 status=$2 got text
  shift 2
  local patterns=()
  while [ "$1" != -- ]; do patterns+=("$1"); shift; done
  shift
  text=$("$@" 2>&1 </dev/null)
  got=$?
  [ "$got" = "$status" ] || fail "$name: exit status $got, expected $status: $text"
  for p in "${patterns[@]}"; do
    grep -qE -- "$p" <<<"$text" || fail "$name: no '$p' in: $text"
  done
}
cat >"$out/serial.yaml" <<Y
camera: {kind: chart, stamp: false}
firmware: {elf: $serial}
run: {until: exit}
Y
run() { "$fovea" run "$out/serial.yaml" --no-frames --max-time 200ms "$@"; }
# figure FOLDER NAME: its value in stats.json
figure() { sed -n "s/^.*\"$2\": {\"value\": \([0-9.e+-]*\),.*$/\1/p" "$out/$1/stats.json"; }
# keys FOLDER TEXT: a dialogue that types it once the program is ready
keys() {
  printf '# typed by a test\nwait ready\\r\\n\nsend %s\n' "$2" >"$out/$1.input"
}

# Input from a file, from a pipe that hesitates, and from a dialogue: the same bytes at the same times.
printf 'Hello, UART0!q' >"$out/typed"
run --console -o "$out/file" <"$out/typed" >"$out/file.txt" 2>/dev/null || fail "file: status $?"
for part in Hel 'lo, UART' '0!q'; do sleep 0.3; printf '%s' "$part"; done |
  run --console -o "$out/pipe" >"$out/pipe.txt" 2>/dev/null || fail "pipe: status $?"
run --console -o "$out/strict" --sync=strict <"$out/typed" >"$out/strict.txt" 2>/dev/null || fail "strict: status $?"
printf 'send Hello, UART0!q\n' >"$out/all.input"
run -o "$out/dialogue" -s uart0.input="$out/all.input" >/dev/null 2>&1 || fail "dialogue: status $?"
printf 'ready\r\nHello, UART0!' >"$out/wanted"
for n in file pipe strict; do
  cmp "$out/wanted" "$out/$n.txt" || fail "$n: the console shows something else"
done
for n in file pipe strict dialogue; do
  cmp "$out/wanted" "$out/$n/uart.log" || fail "$n: uart.log has something else"
  cmp "$out/file/stats.json" "$out/$n/stats.json" || fail "$n: other figures than with a file"
done
grep -q '"ended_by": "exit"' "$out/file/stats.json" || fail "no ended_by"
# Bytes arrive at the line's rate, ten bits of 13 * 16 clocks of 24 MHz each, 86.67 us: the answer to the
# first of fourteen begins after "ready", and the last is over 7 + 14 of them after the start.
printf 'wait ready\\r\\n\nsend Hello, UART0!q\n' >"$out/later.input"
run -o "$out/later" -s uart0.input="$out/later.input" >/dev/null 2>&1 || fail "later: status $?"
awk -v w="$(figure later frame.window)" 'BEGIN { exit !(w > 21 * 86.666e-6 && w < 21.3 * 86.667e-6) }' ||
  fail "the input took $(figure later frame.window) s"

# What ends a run.
keys halt h; keys sleep w; keys idle i; keys quit q; keys five x; keys abort a
until_() { local input=$1; shift; rm -rf "$out/r"; run -o "$out/r" -s uart0.input="$out/$input.input" -s run.until="$@"; }
expect halt 0 'ended by halt after 0\.00[0-9]+ s, .* at pc 0x[0-9a-f]+ \(halt' -- until_ halt halt
expect sleep 0 'ended by halt after 0\.00[0-9]+ s, .* \(sleep' -- until_ sleep '[exit, halt]'
expect idle 3 'run.until = halt not met within --max-time at pc 0x[0-9a-f]+ \(idle' -- until_ idle halt
expect text 0 'ended by uart:ready after' -- until_ quit 'uart:ready'
expect text_list 0 'ended by uart:ready' -- until_ quit '[uart:never, "uart:ready", time:100ms]'
expect escape 0 'ended by uart:y' -- until_ quit 'uart:y\x0d\n'
expect symbol 0 'ended by pc:quit after .* at pc 0x[0-9a-f]+ \(quit\)' -- until_ quit pc:quit
expect second 0 'ended by pc:quit after .* at pc 0x[0-9a-f]+ \(quit\)' -- until_ quit '[pc:fail, pc:quit]'
expect offset 0 'ended by pc:quit\+4 after .* \(quit\+0x4\)' -- until_ quit pc:quit+4
expect five 3 'the program ended with status 5' -- until_ five exit
expect abort 3 'data abort' 'read 4 bytes at 0x50000000' '\(abort' -- until_ abort exit
expect unheard 0 'warning: uart0.input is not over: .*quit.input:2: wait ready' -- until_ quit time:100us
expect instructions 3 'not met within --max-instructions' -- until_ halt exit --max-instructions 5000
n=$(figure r cpu.instructions)
[ "$n" -ge 5000 ] && [ "$n" -lt 5100 ] || fail "--max-instructions 5000: $n"
expect instructions_zero 2 'max-instructions' -- until_ halt exit --max-instructions 0
expect time_unit 2 "--max-time" 'unit' -- "$fovea" run "$out/serial.yaml" --max-time 20 -o "$out/r"

# The figures cover the whole run, to the picosecond, also of a core that sleeps: 24 MHz from power-up.
expect time 0 'ended by time:2ms after 0.002000 s' -- until_ sleep time:2ms
[ "$(figure r frame.window)" = 0.002 ] || fail "time:2ms: a window of $(figure r frame.window) s"
[ "$(figure r cpu.cycles)" = 48000 ] || fail "time:2ms: $(figure r cpu.cycles) clocks"
[ "$(figure r cpu.idle)" -gt 20000 ] || fail "time:2ms: $(figure r cpu.idle) clocks idle"
sum=0
for f in issue idle stall.{interlock,icache,dcache,write_buffer,uncached,tlb,tcm,cache_op,drain,bus_sync}; do
  sum=$((sum + $(figure r cpu.$f)))
done
[ "$sum" = 48000 ] || fail "the clocks by cause add up to $sum"
expect time_more 0 'ended by' -- until_ sleep time:2000000001ps
[ "$(figure r cpu.cycles)" = 48000 ] || fail "a picosecond more: $(figure r cpu.cycles) clocks"

# Wrong input.
for wrong in nothing 'time' 'time:' 'time:3' 'pc:nowhere' 'pc:quit+x' 'uart:' 'uart:\y' 'exit:1' '[exit' '[exit,]' '["exit]'; do
  expect "wrong $wrong" 2 "run.until" -- until_ quit "$wrong"
done
printf 'send a\nsay b\n' >"$out/bad.input"
expect wrong_step 2 'bad.input:2' 'allowed: wait TEXT, send TEXT, at TIME' -- until_ bad exit
expect gdb 2 'pc .*--gdb' -- until_ quit pc:quit --gdb :0

# A list with a comma in a text, in YAML.
cat >"$out/list.yaml" <<Y
include: serial.yaml
run: {until: ['uart:Hello, U', "time:50ms"]}
Y
rm -rf "$out/r"
"$fovea" run "$out/list.yaml" --no-frames -o "$out/r" --console <"$out/typed" >/dev/null 2>"$out/list.txt"
grep -q 'ended by uart:Hello, U' "$out/list.txt" || fail "list: $(cat "$out/list.txt")"

# Names from a second file.
expect unnamed 3 'at pc 0x90000000,' -- until_ abort exit -s firmware.elf="$names"
expect named 3 'at pc 0x90000000 \(far_away\)' -- until_ abort exit -s firmware.elf="$names" --symbols "$names.far"
expect no_symbols 2 'nowhere.elf' -- until_ abort exit --symbols "$out/nowhere.elf"

# The terminal has its mode back however the run ends, and keys reach the program.
if command -v script >/dev/null; then
  terminal() {  # NAME HOW [keys]
    local name=$1 how=$2 typed=$3
    rm -f "$out/$name.after"
    { sleep 1; printf "$typed"; for _ in {1..100}; do [ -s "$out/$name.after" ] && break; sleep 0.1; done; } |
      script -qec "bash -c 'stty -g >$out/$name.before; $how; echo \$? >$out/$name.status; stty -g >$out/$name.after'" \
        /dev/null >"$out/$name.screen" 2>&1
    cmp -s "$out/$name.before" "$out/$name.after" || fail "$name: the terminal is not as it was"
  }
  line="$fovea run $out/serial.yaml --no-frames --max-time 20s --console -o $out"
  terminal keys "$line/keys" 'ABC\003q'
  [ "$(cat "$out/keys.status")" = 0 ] || fail "keys: status $(cat "$out/keys.status")"
  grep -q $'ABC\003' "$out/keys.screen" || fail "keys: not sent back: $(cat -v "$out/keys.screen")"
  "$fovea" run "$out/serial.yaml" --no-frames -o "$out/again" -s uart0.input="$out/keys/uart0.input" \
    >/dev/null 2>&1
  cmp "$out/keys/stats.json" "$out/again/stats.json" || fail "what was typed does not repeat"
  terminal leave "$line/leave" '\001x'
  [ "$(cat "$out/leave.status")" = 130 ] || fail "leave: status $(cat "$out/leave.status")"
  declare -A ended=([INT]=130 [TERM]=143 [HUP]=129 [QUIT]=131 [ABRT]=134)
  for s in "${!ended[@]}"; do
    # With its standard input named, a process in the background keeps the terminal.
    terminal "signal_$s" "exec 3<&0; $line/s <&3 & p=\$!; sleep 1; stty -g >$out/signal_$s.raw; kill -$s \$p; wait \$p" ''
    [ "$(cat "$out/signal_$s.status")" = "${ended[$s]}" ] || fail "signal_$s: status $(cat "$out/signal_$s.status")"
    cmp -s "$out/signal_$s.before" "$out/signal_$s.raw" && fail "signal_$s: the terminal was not in raw mode"
  done
  terminal guest "$line/guest" 'a'
  [ "$(cat "$out/guest.status")" = 3 ] || fail "guest: status $(cat "$out/guest.status")"
fi

# Bare-metal programs with peripherals.
expect board 7 '^main: 2 arguments, one two$' '^uart: 4 bytes in [0-9]+ us$' 'instructions in [0-9]+ clocks' -- \
  "$fovea" exec --board --max-time 1s "$board" one two
expect board_uart 0 '^ping$' 'ended by halt after .* \(' -- "$fovea" exec --board --max-time 1s "$board" uart
expect board_clock 7 '^PLLM of PLLC2: 0x12$' -- "$fovea" exec --board -s clocks.preset=216/172 --max-time 1s "$board" one two
expect board_limit 3 'not met within --max-time' -- "$fovea" exec --board --max-time 20ms "$board" loop
expect board_serial 3 'not met within --max-time' -- "$fovea" exec --board --max-time 20ms "$serial"
out_=$(printf 'pq' | "$fovea" exec --board --console --max-time 1s "$serial" 2>/dev/null)
[ "$out_" = "$(printf 'ready\r\np')" ] || fail "exec --board --console: '$out_'"
expect board_start 0 'instructions in' -- "$fovea" exec --board --max-time 1s "$names.start"
expect board_flat 2 '--board' -- "$fovea" exec --board --load 0 --entry 0 "$serial"
expect board_fast 2 '--fast-memory' -- "$fovea" exec --board --fast-memory "$board"
expect board_alone 2 '--console' -- "$fovea" exec --console "$board"
expect limit_time 3 '--max-time reached' -- "$fovea" exec --max-time 5ms "$names.loop"
expect limit_fast 3 '--max-time reached' -- "$fovea" exec --fast-memory --max-time 5ms "$names.loop"
rm -rf "$out/r"
expect limit_instructions 3 '--max-instructions reached' -- "$fovea" exec --max-instructions 100000 "$names.loop" -o "$out/r"
n=$(figure r cpu.instructions)
[ "$n" -ge 100000 ] && [ "$n" -lt 100400 ] || fail "exec --max-instructions 100000: $n"
exit $((failures > 0))
