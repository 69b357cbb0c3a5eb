#!/usr/bin/env bash
# `fovea trace convert`, `fovea trace info` and `fovea replay --wrap` on the real program: round trips,
# replays of converted traces, wrong input.
# Usage: convert.sh FOVEA PROJECT_SOURCE OUT
set -uo pipefail
fovea=$1 source=$2 out=$3
rm -rf "$out"
mkdir -p "$out"
failures=0
fail() { echo "$1"; failures=$((failures + 1)); }

# expect NAME STATUS 'pattern'... -- command...
expect() {
  local name=$1 status=$2 got text
  shift 2
  local patterns=()
  while [ "$1" != -- ]; do patterns+=("$1"); shift; done
  shift
  text=$("$@" 2>&1)
  got=$?
  [ "$got" = "$status" ] || fail "$name: exit status $got, expected $status: $text"
  if [ "$status" = 2 ] && [ "$(wc -l <<<"$text")" != 1 ]; then fail "$name: not one line: $text"; fi
  for p in "${patterns[@]}"; do
    grep -qE -- "$p" <<<"$text" || fail "$name: no '$p' in: $text"
  done
}
convert() { "$fovea" trace convert "$@"; }
# holds FILE TEXT
holds() { [ "$(cat "$1")" = "$2" ] || fail "$1 holds: $(head -5 "$1")"; }
stats() { "$fovea" replay "$1" -o "$out/replay" >/dev/null && cat "$out/replay/stats.json"; }

# Text: comments and spelling go, the rest stays, also through the binary format, which replays alike.
cat >"$out/a.txt" <<'T'
# dramtrace 1
# master 9 window 48 video
# master 3 window 1 cpu
# a comment
0 9 R 0x1000 64
0  3 W 0x2000 0x20
5000 9 R 0x20 100
7000 3 R 0xFf0 16
T
canonical='# dramtrace 1
# master 0 window 48 video
# master 1 window 1 cpu
0 0 R 0x1000 64
0 1 W 0x2000 32
5000 0 R 0x20 32
5000 0 R 0x40 64
5000 0 R 0x80 4
7000 1 R 0xff0 16'
expect text_text 0 '^6 requests, text to text' -- convert "$out/a.txt" -o "$out/b.txt" --to text
holds "$out/b.txt" "$canonical"
expect text_binary 0 '^6 requests, text to binary' -- convert "$out/a.txt" -o "$out/a.trace" --to binary
expect binary_text 0 -- convert "$out/a.trace" -o "$out/c.txt" --to text
holds "$out/c.txt" "$canonical"
expect binary_again 0 -- convert "$out/c.txt" -o "$out/c.trace" --to binary
cmp "$out/a.trace" "$out/c.trace" || fail 'text, binary, text, binary: two binary files'
[ "$(stats "$out/a.txt")" = "$(stats "$out/a.trace")" ] || fail 'a converted trace replays otherwise'
[ -n "$(stats "$out/a.txt")" ] || fail 'no stats.json'

# A recorded trace through the binary format is the same file, but for one of an earlier version, which becomes one of
# the present version and replays alike; as text it has the times of a replay.
expect recorded 0 -- convert "$source/traces/bus/paper-pal.trace" -o "$out/p.trace" --to binary
expect recorded_again 0 -- convert "$out/p.trace" -o "$out/q.trace" --to binary
cmp "$out/q.trace" "$out/p.trace" || fail 'binary to binary changes a trace'
[ "$(stats "$source/traces/bus/paper-pal.trace")" = "$(stats "$out/p.trace")" ] || fail 'a recorded trace replays otherwise'
expect played 0 'dependences are lost: text has none, and the times are those of a replay with the recorded settings' 'priorities' -- \
  convert "$source/traces/bus/paper-pal.trace" -o "$out/p.txt" --to text
requests=$("$fovea" replay "$source/traces/bus/paper-pal.trace" -o "$out/replay" >/dev/null &&
  grep -oE '"replay.requests": \{"value": [0-9]+' "$out/replay/stats.json" | grep -oE '[0-9]+$')
[ "$(grep -vc '^#' "$out/p.txt")" = "$requests" ] || fail "text has not the $requests requests"
sort -cns "$out/p.txt" 2>/dev/null || fail 'times of a replay do not rise'
# The window begins with the first request, not with power-up: rates are those of the recording, to 1 in 1000.
figures() { "$fovea" replay "$1" -o "$out/replay" >/dev/null && python3 - "$out/replay/stats.json" <<'P'
import json, sys
stats = json.load(open(sys.argv[1]))
print(*(stats[k]["value"] for k in ("replay.time", "replay.bandwidth", "ddr.utilisation", "ddr.headroom")))
P
}
within() { awk '{ for (i = 1; i <= 4; i++) if ($i <= 0 || $i / $(i + 4) > 1.001 || $i / $(i + 4) < 0.999) exit 1 } END { exit NF != 8 }' <<<"$1"; }
both="$(figures "$out/p.txt") $(figures "$source/traces/bus/paper-pal.trace")"
within "$both" || fail "text and recording: $both"
# Whatever the time of the first request is; also in the binary format.
awk '/^#/ { print; next } { $1 += 1e12; printf "%.0f", $1; $1 = ""; print }' "$out/b.txt" >"$out/late.txt"
expect late_binary 0 -- convert "$out/late.txt" -o "$out/late.trace" --to binary
[ "$(stats "$out/b.txt")" = "$(stats "$out/late.txt")" ] || fail 'requests 1 s later have other figures'
[ "$(stats "$out/b.txt")" = "$(stats "$out/late.trace")" ] || fail 'requests 1 s later have other figures in the binary format'
expect late_info 0 '^requests from 1000.000000 ms to 1000.000007 ms' -- "$fovea" trace info "$out/late.txt"
# Settings that differ from the defaults of a replay are named.
"$fovea" trace convert "$source/traces/bus/paper-pal.trace" -o "$out/p.txt" --to text 2>&1 | grep -q 'has no settings' &&
  fail 'settings of the recording are said to be lost, and are the defaults'

# Foreign formats there and back.
printf '0:\twrite\t0x0\n3:\tread\t0x40\n3: (32) read 0x80\n17: write 0xc0\n' >"$out/d.stl"
expect stl 0 '^4 requests, dramsys-stl to text' -- convert "$out/d.stl" -o "$out/d.txt" --to text --clock 300MHz --master gpu --window 5
holds "$out/d.txt" '# dramtrace 1
# master 0 window 5 gpu
0 0 W 0x0 64
10000 0 R 0x40 64
10000 0 R 0x80 32
56666 0 W 0xc0 64'
expect stl_back 0 -- convert "$out/d.txt" -o "$out/e.stl" --to dramsys-stl --clock 300MHz
holds "$out/e.stl" '0: write 0x0
3: read 0x40
3: (32) read 0x80
17: write 0xc0'
said='cannot hold priorities, locks, critical words'
convert "$out/d.txt" -o "$out/e.stl" --to dramsys-stl --clock 300MHz 2>&1 | grep -q "$said" && fail 'it has none'
expect lost 0 "$said" -- convert "$source/traces/bus/paper-pal.trace" -o "$out/p.stl" --to dramsys-stl --clock 300MHz
expect rstl 0 -- convert "$out/e.stl" -o "$out/e.rstl" --to dramsys-rstl --clock 300MHz
holds "$out/e.rstl" '0: write 0x0
3: read 0x40
0: (32) read 0x80
14: write 0xc0'
expect rstl_back 0 -- convert "$out/e.rstl" -o "$out/f.stl" --to dramsys-stl --clock 300MHz
cmp "$out/e.stl" "$out/f.stl" || fail 'relative cycles and back are other cycles'
expect sim3 0 'dramsim3 has no sizes: 1 requests became 1 of 64 bytes' -- convert "$out/d.stl" -o "$out/d.sim3" --to dramsim3 --clock 1250ps
holds "$out/d.sim3" '0x0 WRITE 0
0x40 READ 3
0x80 READ 3
0xc0 WRITE 17'
expect sim3_binary 0 -- convert "$out/d.sim3" -o "$out/d.trace" --to binary --clock 1250ps
expect sim3_replay 0 '^replayed ' -- "$fovea" replay "$out/d.trace" -o "$out/replay"
expect ram2 0 'no times; only the order' -- convert "$out/d.stl" -o "$out/d.ram2" --to ramulator2 --clock 1250ps
holds "$out/d.ram2" 'ST 0x0
LD 0x40
LD 0x80
ST 0xc0'
expect ram 0 'ramulator2 to ramulator,' -- convert "$out/d.ram2" -o "$out/d.ram" --to ramulator
expect ram_back 0 -- convert "$out/d.ram" -o "$out/e.ram2" --to ramulator2
cmp "$out/d.ram2" "$out/e.ram2" || fail 'Ramulator and Ramulator 2 differ'
expect played_foreign 0 'does not tell masters apart' -- convert "$source/traces/bus/paper-pal.trace" -o "$out/p.sim3" --to dramsim3 --clock 243MHz

# Byte addresses are the same requests as those of their blocks, which is said.
printf '0x8 R\n0x47 W\nfff R\n' >"$out/bytes.ram"
printf '0x0 R\n0x40 W\nfc0 R\n' >"$out/blocks.ram"
expect bytes 0 '3 addresses are no multiples of the request.s size: their low bits do not count' -- \
  convert "$out/bytes.ram" -o "$out/bytes.txt" --to text
expect blocks 0 -- convert "$out/blocks.ram" -o "$out/blocks.txt" --to text
cmp "$out/bytes.txt" "$out/blocks.txt" || fail 'byte addresses are other requests than those of their blocks'
# A mark of UTF-8 in front.
for file in blocks.ram b.txt; do
  { printf '\xef\xbb\xbf'; cat "$out/$file"; } >"$out/marked.txt"
  expect "marked_$file" 0 -- convert "$out/marked.txt" -o "$out/unmarked.txt" --to text
  cmp "$out/unmarked.txt" "$out/${file/ram/txt}" || fail "$file with a mark is another trace"
done
expect marked_replay 0 '^replayed ' -- "$fovea" replay "$out/marked.txt" -o "$out/replay"
# What is not read is refused by its name, or by its line.
printf '3 20734016\n1 20846400\n' >"$out/cpu.trace"
expect cpu 2 "cpu.trace':1: it is a line of a CPU trace of Ramulator" -- convert "$out/cpu.trace" -o "$out/x" --to text
expect cpu_replay 2 'CPU trace of Ramulator' -- "$fovea" replay "$out/cpu.trace" -o "$out/replay"
printf 'gem5\x12\x0a' >"$out/packets"
gzip -nk "$out/packets"
for file in packets packets.gz; do
  expect "gem5_$file" 2 "$file': it is a packet trace of gem5" -- convert "$out/$file" -o "$out/x" --to text
done
gzip -nk "$out/blocks.ram"
expect packed 2 'packed by gzip; unpack it first' -- convert "$out/blocks.ram.gz" -o "$out/x" --to text

# Addresses beyond the memory.
printf '0x8000040 R\n0x12345680 W\n' >"$out/far.ram"
expect beyond 2 ':1: 64 bytes at 0x08000040 are outside the memory of 128 MiB' '--wrap' -- convert "$out/far.ram" -o "$out/x" --to text
expect wrap 0 -- convert "$out/far.ram" -o "$out/far.txt" --to text --wrap
grep -v '^#' "$out/far.txt" >"$out/far.lines"
holds "$out/far.lines" '0 0 R 0x40 64
0 0 W 0x2345680 64'
expect size 0 -- convert "$out/far.ram" -o "$out/big.txt" --to text --size 512MiB
expect big 2 'line 3 .*outside the SDRAM of 128 MiB' -- "$fovea" replay "$out/big.txt" -o "$out/replay"
expect big_text 2 'line 3: .*outside the memory of 128 MiB' -- convert "$out/big.txt" -o "$out/x" --to binary
expect big_wrap 0 -- "$fovea" replay "$out/big.txt" --wrap -o "$out/replay"
cp "$out/replay/stats.json" "$out/wrapped.json"
[ "$(stats "$out/far.txt")" = "$(cat "$out/wrapped.json")" ] || fail 'replay --wrap is not convert --wrap'

# Wrong input: one line, status 2, and no file.
expect no_command 2 -- "$fovea" trace
expect no_to 2 '--to is required' -- convert "$out/a.txt" -o "$out/x"
expect bad_to 2 'dramsim3' -- convert "$out/a.txt" -o "$out/x" --to dramsim4
expect unknown 2 "LICENSE':2: it is 'Apache License', a line of none of the known trace formats; formats: binary, text" -- convert "$source/LICENSE" -o "$out/x" --to text
cp "$out/d.stl" "$out/d.unclear"
expect unclear 2 'dramsys-rstl' -- convert "$out/d.unclear" -o "$out/x" --to text --clock 1GHz
expect clear 0 -- convert "$out/d.unclear" -o "$out/unclear.txt" --to text --clock 1GHz --from dramsys-rstl
expect no_clock 2 '--clock is needed, as dramsys-stl counts cycles' -- convert "$out/d.stl" -o "$out/x" --to text
expect bad_clock 2 "--clock '800' is not allowed; allowed: a frequency" -- convert "$out/d.stl" -o "$out/x" --to text --clock 800
expect zero_clock 2 "--clock '0ps'" -- convert "$out/d.stl" -o "$out/x" --to text --clock 0ps
expect vain_clock 2 '--clock has no effect' -- convert "$out/a.txt" -o "$out/x" --to binary --clock 1GHz
expect vain_bytes 2 '--bytes has no effect' -- convert "$out/a.txt" -o "$out/x" --to binary --bytes 32
expect vain_master 2 '--master has no effect' -- convert "$out/a.txt" -o "$out/x" --to binary --master a
expect vain_window 2 '--window has no effect' -- convert "$out/a.txt" -o "$out/x" --to binary --window 4
expect label 2 "--master 'a b'" -- convert "$out/d.ram" -o "$out/x" --to text --master 'a b'
expect cause 2 "--master 'refresh'" -- convert "$out/d.ram" -o "$out/x" --to text --master refresh
expect window 2 '--window 49' -- convert "$out/d.ram" -o "$out/x" --to text --window 49
expect bytes 2 '--bytes 0 ' -- convert "$out/d.ram" -o "$out/x" --to text --bytes 0
expect odd_bytes 2 'powers of two' -- convert "$out/d.ram" -o "$out/x" --to ramulator2 --bytes 48
expect odd_size 2 "--size '100MiB'" -- convert "$out/d.ram" -o "$out/x" --to text --size 100MiB
expect wrong_from 2 ':1: ' -- convert "$out/d.ram" -o "$out/x" --to text --from text
expect missing 2 'missing.stl' -- convert "$out/missing.stl" -o "$out/x" --to text --clock 1GHz
echo dear >"$out/letter"
expect letter 2 'letter.*is not a trace' -- convert "$out/a.txt" -o "$out/letter" --to text
[ "$(cat "$out/letter")" = dear ] || fail 'a letter was overwritten'
[ ! -e "$out/x" ] && [ ! -e "$out/x.tmp" ] || fail 'a refused conversion left a file'
printf '# dramtrace 1\n# master 0 window 1 a\n0 0 R 0x0 4\n0 0 R 0x0\n' >"$out/bad.txt"
cp "$out/b.txt" "$out/keep.txt"
expect late 2 "bad.txt':4: a record is" -- convert "$out/bad.txt" -o "$out/keep.txt" --to text
cmp "$out/b.txt" "$out/keep.txt" || fail 'a conversion that failed destroyed an earlier file'
expect foreign_replay 2 "'fovea trace convert' reads" -- "$fovea" replay "$out/d.stl" -o "$out/replay"

expect info 0 '^text$' '^video +48 +4 ' -- "$fovea" trace info "$out/a.txt"
expect info_binary 0 '^binary, version 5$' 'requests wait for others' 'SDRAM 243 MHz' 'arm_d' -- \
  "$fovea" trace info "$source/traces/bus/paper-pal.trace"
expect info_foreign 0 '^dramsys-stl' -- "$fovea" trace info "$out/d.stl"
for help in 'trace --help' 'trace convert --help' 'trace info --help' 'replay --help'; do
  "$fovea" $help | awk -v c="$help" 'length > 80 { print c ": " $0; bad = 1 } END { exit bad }' || fail 'help is too wide'
done

# Memory does not grow with the file: five times as many lines, one master behind the other. In
# both, a master has more records than are held for it (65536).
peak() {  # MASTERS LINES: peak resident bytes of a replay
  awk -v masters="$1" -v lines="$2" 'BEGIN {
    print "# dramtrace 1"
    for (m = 0; m < masters; m++) print "# master " m " window 8 m" m
    for (i = 0; i < lines; i++) printf "0 %d R 0x%x 32\n", int(i * masters / lines), i % 65536 * 32
  }' >"$out/long.txt"
  "$fovea" replay "$out/long.txt" -o "$out/replay" >/dev/null || echo fail
  grep -oE '"peak_rss": \{"value": [0-9]+' "$out/replay/host.json" | grep -oE '[0-9]+$'
}
short=$(peak 3 300000) long=$(peak 3 1500000)
[ -n "$short" ] && [ "$long" -lt $((short * 5 / 4)) ] ||
  fail "replay of five times as many lines: peak memory $short and $long bytes"
echo "$failures failures"
[ "$failures" = 0 ]
