#!/usr/bin/env bash
# Slow-downs planted into the firmware, its settings and its layout: 'fovea check' blames each on the right function,
# line and cause. Usage: planted.sh FOVEA BUILD SOURCE OUT CASE...  (FOVEA_RUN: another program for the runs)
#   CASE  load, priority, dcache, clock, prefetch, ahead, poll, layout, layout4096
set -uo pipefail
fovea=$1 build=$2 source=$3 out=$4
shift 4
rm -rf "$out"
mkdir -p "$out"
failures=0
fail() { echo "$1"; failures=$((failures + 1)); }

cat >"$out/small.yaml" <<'Y'
run: {frames: 2, start_limit: 2s}
camera: {kind: chart, stamp: false}
video: {width: 128, height: 32}
firmware: {kernel: plain}
Y

# run NAME [-s KEY=VALUE ...]
run() {
  local name=$1
  shift
  "${FOVEA_RUN:-$fovea}" run "$out/small.yaml" --profile --no-frames "$@" -o "$out/$name" >"$out/$name.log" 2>&1 ||
    { fail "$name: $(tail -3 "$out/$name.log")"; return 1; }
}

. "$(dirname "$0")/plant.sh"

# blamed NAME 'function (file:line) what' 'cause'...: the baseline fails, and this is to blame
blamed() {
  local name=$1 text
  shift
  judged=$name
  text=$("$fovea" check "$out/$name" --against "$out/${against:-base}-before.yaml" --junit "$out/$name.xml")
  [ $? = 1 ] || fail "$name: the check does not fail: $text"
  grep '^blamed' <<<"$text"
  for pattern; do
    grep '^blamed: ' <<<"$text" | grep -qE "$pattern" || fail "$name: no '$pattern' in: $text"
  done
  grep -qE 'unexplained: [-+]0 .*\(0\.0 %\)' <<<"$text" || fail "$name: something is unexplained: $text"
}

# expects NAME: the run NAME becomes the baseline NAME-before.yaml
expects() {
  "$fovea" bless "$out/$1" --against "$out/$1-before.yaml" --tolerance 0 --why 'before the plant' >"$out/$1-before.log" 2>&1 ||
    { fail "$1: no baseline: $(cat "$out/$1-before.log")"; return 1; }
}

loop="remap_plain \(remap_plain.c:$(grep -n 'while (lut' "$source/sw/firmware/kernels/remap_plain.c" | cut -d: -f1)\)"
line_of() { grep -nE -m1 "$2" "$1" | cut -d: -f1; }

run base || exit 1
expects base
"$fovea" check "$out/base" --against "$out/base-before.yaml" >/dev/null || fail 'the run itself fails'

for planted; do
  judged=
  case $planted in
    load) # of another row of the picture, in the remap loop
      firmware load kernels/remap_plain.c \
        's/^  while \(lut != end\) (.*)$/  while (lut != end) { (void)*(const volatile uint32_t *)(base + *lut + 8192); \1 }/'
      run load -s firmware.elf="$out/load.elf" && blamed load "^blamed: $loop executes more" 'clocks by dcache' ;;
    priority) # of another master that loads the bus
      load=(-s load.outstanding=2 -s load.base=96MiB -s load.size=1MiB -s load.start=220ms)
      run loaded "${load[@]}" -s load.priority=7 -s priority.arm=1 &&
        expects loaded &&
        run priority "${load[@]}" -s load.priority=0 -s priority.arm=7 &&
        against=loaded blamed priority "^blamed: $loop waits" 'culprit load' ;;
    dcache) # off
      firmware dcache drivers/cp15.c 's/CONTROL_M \| CONTROL_C \| CONTROL_I/CONTROL_M | CONTROL_I/'
      run dcache -s firmware.elf="$out/dcache.elf" &&
        blamed dcache "^blamed: $loop" 'clocks by uncached' ;;
    clock) # of core and SDRAM
      run clock -s clocks.preset=216/172 &&
        blamed clock "^blamed: $loop waits" 'us by dcache' ;;
    # The core has no prefetch of data: PLD does nothing on it (ARM DDI 0198, 4.1). What the firmware has instead is
    # the EDMA, which brings the next window while the core computes, and loads that stand before their use.
    prefetch) # each window is asked for when it is needed
      window=(-s firmware.kernel=staged -s video.width=188 -s video.height=48)
      firmware prefetch kernels/method_staged.c \
        's/^    if \(n \+ TILE_BANKS < tiles->tiles\) (request\(b, stream->next.*)$/    (void)0;/
         s/^    const tile_stream_t \*stream = .*/&\n    if (n >= TILE_BANKS) request(b, stream->next, (int)stream->next_patterns, in);/'
      run staged "${window[@]}" &&
        expects staged &&
        run prefetch "${window[@]}" -s firmware.elf="$out/prefetch.elf" &&
        against=staged blamed prefetch '^blamed: run_tiles \(method_staged.c:[0-9]+\) polls longer in wait_for' ;;
    ahead) # a code is loaded where it is used, not before the store
      codes=(-s firmware.kernel=codes)
      firmware ahead kernels/remap_codes.S \
        '/ldrb r3, \[r2, #1\]!/d; s/^    stmia r0!, \{r4-r11\}$/&\n    ldrb r3, [r2, #1]!/'
      line=$(line_of "$out/ahead.src/remap_codes.S" 'add r3, lr, r3, lsl #4')
      run codes "${codes[@]}" &&
        expects codes &&
        run ahead "${codes[@]}" -s firmware.elf="$out/ahead.elf" &&
        against=codes blamed ahead "^blamed: remap_codes \(remap_codes.S:$line\)" 'clocks by interlock' ;;
    poll) # a hundred reads of the timer, more than what moved code after it may cost
      firmware poll drivers/timer.c 's/^(uint32_t timer_ticks.void. \{).*/\1\n  for (int n = 0; n < 100; ++n) (void)*(volatile uint32_t *)TIMER0_TIM12;\n  return mmio_read32(TIMER0_TIM12);\n}/'
      run poll -s firmware.elf="$out/poll.elf" &&
        blamed poll "^blamed: timer_ticks \(timer.c:$(line_of "$out/poll.src/timer.c" 'void.\*.volatile')\) executes more" 'clocks by uncached' ;;
    layout | layout4096) # bytes of nothing before the first function of .text
      bytes=${planted#layout}
      firmware "$planted" kernels/remap_plain.c \
        "s/^void remap_plain/__asm__(\".section .text.remap_plain\\\\n .space ${bytes:-32}\\\\n .text\");\\n&/"
      # Whatever it changes in the clocks, nothing but addresses is to blame.
      run "$planted" -s firmware.elf="$out/$planted.elf" && {
        judged=$planted
        table=$("$fovea" compare --all "$out/base" "$out/$planted")
        busy=$(sed -n "s/^where the core's clocks went: .* busy \([-+0-9,]* clocks\).*/\1/p" <<<"$table")
        layout=$(sed -n 's/^ *of this by layout (same code at other addresses): //p' <<<"$table")
        [ -n "$busy" ] && [ "$busy" = "$layout" ] || fail "$planted: of '$busy' only '$layout' by layout: $table"
        for moved in remap_plain first_row_sum; do
          grep -qE "^  $moved .* was moved \(layout\)" <<<"$table" || fail "$planted: $moved was not told apart: $table"
        done
        echo "$planted: $busy, all by layout"
      } ;;
    *) fail "no case $planted" ;;
  esac
  [ "$judged" = "$planted" ] || fail "$planted: nothing was judged"
done
echo "$failures failures"
[ "$failures" = 0 ]
