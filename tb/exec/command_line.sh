#!/usr/bin/env bash
# `fovea exec` towards people: flat binaries, wrong input, failing programs, Ctrl-C, result folders.
# Usage: command_line.sh FOVEA PROGRAMS
set -uo pipefail
fovea=$(realpath "$1") programs=$(realpath "$2")
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
failures=0

# expect NAME STATUS 'pattern'... -- command...
expect() {
  local name=$1 status=$2 got
  shift 2
  local patterns=()
  while [ "$1" != -- ]; do patterns+=("$1"); shift; done
  shift
  text=$("$@" 2>&1 </dev/null)
  got=$?
  if [ "$got" != "$status" ]; then
    echo "$name: exit status $got, expected $status: $text"
    failures=$((failures + 1))
  fi
  for p in "${patterns[@]}"; do
    grep -qE -- "$p" <<<"$text" || {
      echo "$name: no '$p' in: $text"
      failures=$((failures + 1))
    }
  done
}

run() { "$fovea" exec "$@"; }
text=
fails=$programs/fails_arm_O2.elf
expect help 0 'Memory:' '--fast-memory' 'passed to the program' -- run --help
expect arm 5 '^flat$' 'instructions in [0-9]+ clocks' -- run "$programs/flat_arm.bin" --load 0x8000 --entry 0x8000
expect thumb 5 '^flat$' -- run "$programs/flat_thumb.bin" --load 0x80000000 --entry 0x80000000 --thumb
expect fast 5 '^flat$' -- run --fast-memory --load=0 --entry=0 "$programs/flat_arm.bin"
expect no_entry 2 '--entry' -- run "$programs/flat_arm.bin" --load 0x8000
expect odd_entry 2 'aligned' -- run "$programs/flat_arm.bin" --load 0x8000 --entry 0x8002
expect bad_address 2 '8000h' 'ffffffff' -- run "$programs/flat_arm.bin" --load 8000h --entry 0
expect no_program 2 'program' -- run
expect missing 2 'nowhere.elf' -- run "$out/nowhere.elf"
expect not_an_elf 2 'ELF' -- run "$programs/flat_arm.bin"
expect bad_root 2 'folder' -- run --root "$out/nowhere" "$fails"
expect bad_key 2 'ddr.part' -- run -s ddr.prat=x "$fails"
expect bad_cache 2 'powers of two' -- run -s cpu.icache.size=5000B "$fails"
# Exec programs the controller for DDR2; the core alone has no SDRAM, of which the part gives the size only.
expect mobile_memory 2 'ddr.part' 'firmware.elf' 'fovea replay TRACE' -- run -s ddr.part=mt46h32m16lf "$fails"
expect ram_base 5 '^flat$' -- run -s exec.ram_base=0x40000000 --load 0x40100000 --entry 0x40100000 \
  "$programs/flat_arm.bin"
expect bad_ram_base 2 'exec.ram_base' 'auto' -- run -s exec.ram_base=0x1000 "$fails"
expect other_ram_base 2 'segment' 'exec.ram_base' -- run -s exec.ram_base=0x40000000 "$fails"
for memory in '' --fast-memory; do
  expect "flash$memory" 42 '^from flash$' -- run $memory "$programs/flash.elf"
done
expect kept_alone 2 '--log-registers or --gdb' -- run --log-registers-kept=5 "$programs/registers.elf"
expect registers 0 'ns  pc 0x8000000[0-9a-f] \(_start\+0x[0-9a-f]+\) arm_d wrote ddr.PBBPR = 0x00000002 PR_OLD_COUNT=2$' \
  'wrote ddr.SDRCR = 0xffffffff RR=65535 .*  reserved bits 0x3f7f0000$' \
  'read ddr.SDRSTAT = 0x00000004 PHYRDY=1$' 'warning \(firmware\): 1 written to reserved bits of DDR SDRCR' \
  -- run --log-registers . "$programs/registers.elf"
expect other_registers 0 '\(2 earlier accesses are not shown\)' \
  -- run --log-registers 'ddr\.' --log-registers-kept=1 "$programs/registers.elf"
expect no_registers 2 'regular expression' -- run --log-registers '(' "$programs/registers.elf"
expect nested 2 'not a regular expression \(missing \)' -- run --log-registers "$(printf '(%.0s' {1..9000})" "$programs/registers.elf"
expect backtracking 2 'matches no register' -- timeout 20 "$fovea" exec --log-registers '(.*.*)*x$' "$programs/registers.elf"
expect nothing_to_log 2 '--fast-memory' -- run --fast-memory --log-registers . "$programs/registers.elf"
expect no_dma 2 '--hazards: there is no DMA; allowed: with --board' -- run --hazards "$programs/registers.elf"
expect no_effect 0 "'ddr.scheduler' is set but has no effect with --fast-memory" -- \
  run --fast-memory -s ddr.scheduler=fcfs "$fails"
expect no_effect_strict 2 'no effect' -- run --strict --fast-memory -s ddr.scheduler=fcfs "$fails"
expect quotes 2 'quotes' -- run "$fails" "a \"'"
expect long_line 0 'command line of' -- run "$fails" "$(printf 'x%.0s' {1..300})"
for memory in '' --fast-memory; do
  expect "load$memory" 3 '^load$' 'the guest failed: data abort with no handler' 'main' 'read 4 bytes at 0x50000000' \
    -- run $memory "$fails" load
  expect "jump$memory" 3 'the guest failed' -- run $memory "$fails" jump
  expect "null$memory" 3 'the guest failed: jumped to 0 from 0x[0-9a-f]+ \(main\+0x[0-9a-f]+\); undefined' \
    -- run $memory "$fails" null
  expect "sleep$memory" 3 'waits for an interrupt' 'main' -- run $memory "$fails" sleep
  expect "file$memory" 7 -- run $memory --root "$out" "$fails" file
  "$fovea" exec $memory "$fails" loop -o "$out/loop" >"$out/loop.txt" 2>&1 &
  pid=$!
  sleep 1
  kill -INT $pid
  wait $pid
  got=$?
  [ $got = 130 ] || { echo "loop$memory: exit status $got: $(cat "$out/loop.txt")"; failures=$((failures + 1)); }
  grep -q '"complete": false' "$out/loop/stats.json" || failures=$((failures + 1))
done

# Output that nobody takes: the program is told and ends, and so is the user.
for memory in '' --fast-memory; do
  timeout 60 "$fovea" exec $memory "$fails" talk >/dev/full 2>"$out/full.txt"
  got=$?
  [ $got = 2 ] && grep -q "output cannot be written" "$out/full.txt" || {
    echo "full$memory: exit status $got: $(cat "$out/full.txt")"
    failures=$((failures + 1))
  }
  timeout 60 "$fovea" exec $memory "$fails" talk 2>"$out/broken.txt" | head -1 >"$out/line.txt"
  got=${PIPESTATUS[0]}
  [ $got = 2 ] && [ "$(cat "$out/line.txt")" = talk ] || {
    echo "broken pipe$memory: exit status $got: $(cat "$out/broken.txt")"
    failures=$((failures + 1))
  }
  # Ctrl-C while it waits for input is no end of the input.
  mkfifo "$out/input"
  exec 9<>"$out/input"
  "$fovea" exec $memory "$fails" ask <"$out/input" -o "$out/ask" >"$out/ask.txt" 2>&1 &
  pid=$!
  sleep 1
  kill -INT $pid
  wait $pid
  got=$?
  exec 9>&-
  rm "$out/input"
  [ $got = 130 ] && grep -q '"complete": false' "$out/ask/stats.json" || {
    echo "ask$memory: exit status $got: $(cat "$out/ask.txt")"
    failures=$((failures + 1))
  }
done

# MMU and caches on from the start: the same output, in less time; the summary has time and clock.
expect hint 0 's at 297 MHz$' 'ran with MMU and caches off' -- run "$programs/heap_arm_O2.elf" -o "$out/off"
for program in heap_arm_O2 heap_thumb_O2; do
  expect "caches_$program" 0 -- run --caches "$programs/$program.elf" -o "$out/on"
  grep -q 'caches off' <<<"$text" && { echo "caches_$program: a hint"; failures=$((failures + 1)); }
  "$fovea" exec -q --caches "$programs/$program.elf" >"$out/on.txt" 2>"$out/on.err" </dev/null
  "$fovea" exec --quiet "$programs/$program.elf" >"$out/off.txt" 2>"$out/off.err" </dev/null
  cmp "$out/on.txt" "$out/off.txt" || failures=$((failures + 1))
  [ -s "$out/off.txt" ] && [ ! -s "$out/on.err" ] && [ ! -s "$out/off.err" ] || {
    echo "quiet: $(cat "$out/on.err" "$out/off.err")"
    failures=$((failures + 1))
  }
  run --fast-memory --caches "$programs/$program.elf" 2>/dev/null </dev/null | cmp - "$out/off.txt" ||
    failures=$((failures + 1))
done
count() { sed -n 's/.*"'"$2"'": {"value": \([0-9]*\).*/\1/p' "$out/$1/stats.json"; }
# What all blocks of the machine count is there, as on the board.
for key in bus.arm_d.transactions bus.config.reads ddr.activates ddr.arm_d.wait.read.service; do
  grep -q "\"$key\": " "$out/off/stats.json" || {
    echo "stats.json of a program has no $key"
    failures=$((failures + 1))
  }
done
[ "$(count off cpu.icache.accesses)" = 0 ] && [ "$(count on cpu.icache.accesses)" -gt 0 ] &&
  [ "$(count on cpu.dcache.reads)" -gt 0 ] &&
  [ "$(count on cpu.cycles)" -lt "$(($(count off cpu.cycles) / 3))" ] || {
  echo "caches: $(count off cpu.cycles) clocks without, $(count on cpu.cycles) with"
  failures=$((failures + 1))
}
expect caches_thumb 5 '^flat$' -- run --caches "$programs/flat_thumb.bin" --load 0x80000000 --entry 0x80000000 --thumb
# The last 32 KiB of RAM hold the translation table.
expect caches_room 5 '^flat$' -- run --caches "$programs/flat_arm.bin" --load 0x7ff7000 --entry 0x7ff7000
expect caches_no_room 2 'last 32768 bytes' -- run --caches "$programs/flat_arm.bin" --load 0x7ff8000 --entry 0x7ff8000
expect refused_name 7 "the file '/tmp/[^']*' is refused; allowed: names relative to --root" -- \
  run --root "$out" "$fails" tmpnam
[ "$(grep -c 'is refused' <<<"$text")" = 1 ] || { echo "refused_name: said more than once"; failures=$((failures + 1)); }
grep -q '"sha256": {' "$out/on/config.json" && grep -q "\"program\": \"$(sha256sum <"$programs/heap_thumb_O2.elf" | cut -c1-64)\"" "$out/on/config.json" ||
  { echo 'config.json does not hold the hash of the program'; failures=$((failures + 1)); }
grep -q '"command": "exec"' "$out/on/config.json" && grep -q '"input": "heap_thumb_O2.elf"' "$out/on/config.json" ||
  { echo 'config.json does not name the program'; failures=$((failures + 1)); }

# Equal runs, equal bytes; a slower SDRAM, more clocks.
for n in 1 2 slow; do
  slower=()
  [ $n = slow ] && slower=(-s ddr.request_latency=16cycles)
  expect "time_$n" 0 '^0 s' -- run "$programs/time_arm_O2.elf" -o "$out/$n" "${slower[@]}"
done
cmp "$out/1/stats.json" "$out/2/stats.json" || failures=$((failures + 1))
cycles() { sed -n 's/.*"cpu.cycles": {"value": \([0-9]*\).*/\1/p' "$1/stats.json"; }
instructions() { sed -n 's/.*"cpu.instructions": {"value": \([0-9]*\).*/\1/p' "$1/stats.json"; }
# The program counts turns of a fixed time: with a slower memory there are fewer.
[ "$(instructions "$out/slow")" -lt "$(instructions "$out/1")" ] || {
  echo "slow: $(instructions "$out/slow") instructions, not fewer than $(instructions "$out/1")"
  failures=$((failures + 1))
}
[ "$(cycles "$out/1")" -gt 5900000 ] || {  # 20 ms at 297 MHz
  echo "time: $(cycles "$out/1") clocks"
  failures=$((failures + 1))
}
exit $((failures > 0))
