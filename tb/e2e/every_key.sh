#!/usr/bin/env bash
# Every key of `fovea params` is changed to another allowed value in a situation in which it should act, and
# something in the results must change. Where a key cannot act, a run must warn of it, and end with status 2
# with --strict. A key that the table lacks is a failure, so is one that `fovea params` says "needs"
# something and that has no line where it lacks that.
# Usage: every_key.sh FOVEA SOURCE OUT PROGRAM [full|quick|idle [COUNT SEED]]
# full: every situation is a run to the first corrected frame; else EARLY and BOOTED below cut most of them short.
# quick: of the keys that act, only those with EARLY, BOOTED or PROGRAM, whose runs need no picture.
# idle: each key that needs something is set in each of the situations of elsewhere(), or drawn pairs of both until COUNT
# runs say that the key has no effect. The results of these must be those without the key.
set -uo pipefail
fovea=$1 source=$2 out=$3 program=$4 mode=${5:-}
rm -rf "$out"
mkdir -p "$out"
cd "$out" || exit 1
front=$source/traces/footage/neozhaoliang-surround/front.png
cat >base.yaml <<'Y'
run: {frames: 1}
video: {width: 48, height: 16}
camera: {kind: chart, stamp: false}
Y
printf 'wait decoder\nsend x\n' >typed.txt
failures=0
fail() {
  echo "$*"
  failures=$((failures + 1))
}

# What a word of the table stands for, beside KEY=VALUE.
situation() {
  local word
  keys=()
  for word; do
    case $word in
      PROGRAM) keys+=(-s firmware.elf="$program" -s "run.until=[uart:finished, time:90ms]") ;;
      # The SDRAM works from 3.4 ms on, and the firmware is in it from 5 ms on: what acts by then needs no picture.
      EARLY) [ "$mode" = full ] || keys+=(-s run.until=time:6ms) ;;
      # By then, the firmware has set the priorities.
      BOOTED) if [ "$mode" = full ]; then keys+=(-s load.start=55ms); else keys+=(-s load.start=15ms -s run.until=time:20ms); fi ;;
      SPHERE) keys+=(-s camera.kind=sphere -s camera.file="$front" -s camera.lens=equisolid) ;;
      LARGER) # the EDMA's kernels take no smaller picture
        keys+=(-s video.width=320 -s video.height=96 -s firmware.lut=fixed_point) ;;
      VIDEO) keys+=(-s camera.kind=video -s camera.file="$front") ;;
      RAM) # bursts in internal RAM
        keys+=(-s load.outstanding=1 -s load.memory=internal_ram -s load.base=0B -s load.size=32KiB
          -s load.gap=1us) ;;
      BUSY) # bursts in SDRAM, most of them in another row than the one before
        keys+=(-s load.outstanding=8 -s load.kind=mixed -s load.pattern=random -s load.priority=0
          -s load.gap=1us) ;;
      *) keys+=(-s "$word") ;;
    esac
  done
}
play() {  # NAME OPTIONS...
  local name=$1
  shift
  timeout 60 "$fovea" run base.yaml "$@" -o "$name" >"$name.out" 2>"$name.err"
  echo $? >"$name.status"
}
# Without the warnings, to which a key without effect adds one.
figures() { python3 -c 'import json, sys; d = json.load(open(sys.argv[1])); del d["warnings"]; print(d)' "$1/stats.json"; }
differ() {
  local f
  for f in stats.json frames.csv timeline.csv stalls.csv uart.log; do
    cmp -s "$1/$f" "$2/$f" || return 0
  done
  ! diff -rq "$1/frames" "$2/frames" >/dev/null
}

# acts KEY VALUE SITUATION...: the results differ; fails likewise, but the run ends with status 3.
# idle KEY VALUE SITUATION...: the run warns.
# tested KEY TEST: shown elsewhere, as it needs a program or a device of its own.
table() {
  cat <<'T'
acts aintc.capture level PROGRAM
acts board.cpld true PROGRAM
acts board.cpld_switch 0 PROGRAM board.cpld=true
idle board.cpld_switch 0
acts birds_eye.car_length 2m cameras.count=4 firmware.view=birds_eye
idle birds_eye.car_length 2m
acts birds_eye.car_width 6m cameras.count=4 firmware.view=birds_eye
idle birds_eye.car_width 6m
acts birds_eye.height 24m cameras.count=4 firmware.view=birds_eye
idle birds_eye.height 24m
acts birds_eye.width 8m cameras.count=4 firmware.view=birds_eye
idle birds_eye.width 8m
acts bus.arm_d.request_latency 4cycles EARLY
acts bus.arm_d.response_latency 4cycles EARLY
acts bus.arm_d.width 16bit EARLY
acts bus.arm_i.request_latency 4cycles EARLY
acts bus.arm_i.response_latency 4cycles EARLY
acts bus.arm_i.width 16bit EARLY
acts bus.config.fast_latency 50ns EARLY
acts bus.config.slow_latency 130ns EARLY
acts bus.timeline_interval 100us EARLY
acts bus.vpbe.request_latency 9cycles
acts bus.vpbe.response_latency 9cycles
acts bus.vpbe.width 16bit
acts bus.vpfe.request_latency 9cycles
acts bus.vpfe.response_latency 9cycles
acts bus.vpfe.width 16bit
tested camera.calibration unit.calibration
idle camera.calibration none.yaml
acts camera.file chess SPHERE
idle camera.file none.png
acts camera.fov 150deg SPHERE
idle camera.fov 150deg
acts camera.kb [300,300,480,320,0,0,0,0] SPHERE camera.lens=kannala_brandt
idle camera.kb [300,300,480,320,0,0,0,0]
acts camera.kb_height 600px SPHERE camera.lens=kannala_brandt
idle camera.kb_height 600px
acts camera.kb_width 900px SPHERE camera.lens=kannala_brandt
idle camera.kb_width 900px
acts camera.kind sphere camera.file=FRONT
acts camera.lens linear SPHERE
idle camera.lens linear
acts camera.motion_amplitude 9deg SPHERE camera.motion_period=3
idle camera.motion_amplitude 9deg
acts camera.motion_period 3 SPHERE camera.motion_amplitude=9deg
idle camera.motion_period 3
acts camera.stamp true video.width=320 video.height=240
acts camera.video_fov 90deg VIDEO camera.lens=equisolid
acts camera.0.mount.height 3m cameras.count=4 firmware.view=birds_eye
idle camera.0.mount.height 3m
acts camera.0.mount.pitch 20deg cameras.count=4 firmware.view=birds_eye
idle camera.0.mount.pitch 20deg
acts camera.0.mount.roll 40deg cameras.count=4 firmware.view=birds_eye
idle camera.0.mount.roll 40deg
acts camera.0.mount.x 0m cameras.count=4 firmware.view=birds_eye
idle camera.0.mount.x 0m
acts camera.0.mount.y 2m cameras.count=4 firmware.view=birds_eye
idle camera.0.mount.y 2m
acts camera.0.mount.yaw 40deg cameras.count=4 firmware.view=birds_eye
idle camera.0.mount.yaw 40deg
acts camera.0.input vi_4_a
idle camera.0.input vi_4_a video.standard=vga_progressive EARLY
acts camera.0.connected false
idle camera.0.connected false video.standard=vga_progressive EARLY
acts camera.0.genlocked false camera.0.phase=7ms
idle camera.0.genlocked false video.standard=vga_progressive EARLY
acts camera.0.phase 7ms camera.0.genlocked=false
idle camera.0.phase 7ms video.standard=vga_progressive EARLY
acts camera.0.clock_offset 500ppm camera.0.genlocked=false
idle camera.0.clock_offset 500ppm video.standard=vga_progressive EARLY
tested camera.0.standard e2e.cameras
idle camera.0.standard 525/60 video.standard=vga_progressive EARLY
tested cameras.count e2e.cameras
tested cameras.genlocked e2e.cameras
idle cameras.genlocked false
acts cameras.multiplexer gpio cameras.count=2
idle cameras.multiplexer gpio
acts fault.kind unplugged firmware.program=cameras fault.start=50ms
tested fault.camera e2e.cameras
tested fault.start e2e.cameras
tested fault.end e2e.cameras
acts fault.wrong_bits 2 fault.kind=sync_noise fault.every=3 fault.start=50ms fault.end=5s
acts fault.every 5 fault.kind=sync_noise fault.start=50ms fault.end=5s
acts fault.lines 6 fault.kind=missing_lines fault.start=50ms fault.end=5s
acts fault.samples 800 fault.kind=short_lines fault.start=50ms fault.end=5s
acts fault.drift 900ppm fault.kind=clock_drift fault.start=50ms fault.end=5s
acts fault.select_line 1 fault.kind=stuck_select fault.select_level=1 cameras.count=4 cameras.multiplexer=gpio fault.start=50ms fault.end=5s
acts fault.select_level 1 fault.kind=stuck_select cameras.count=4 cameras.multiplexer=gpio fault.start=50ms fault.end=5s
idle fault.select_line 1 fault.kind=unplugged
idle fault.select_level 1
idle fault.camera 0 fault.kind=stuck_select cameras.count=4 cameras.multiplexer=gpio
idle fault.wrong_bits 2 fault.kind=short_lines
idle fault.every 5 fault.kind=unplugged
idle fault.lines 6 fault.kind=sync_noise
idle fault.samples 800 fault.kind=missing_lines
idle fault.drift 900ppm
idle fault.camera 0
idle fault.start 1s
idle fault.end 2s
idle camera.video_fov 90deg
acts clocks.arm 270MHz EARLY
acts clocks.crossbar 150MHz EARLY
acts clocks.ddr 216MHz EARLY
acts clocks.preset 297/270 EARLY
acts clocks.preset 270/216 clocks.ddr=162MHz EARLY
acts clocks.preset 297/270 clocks.arm=270MHz EARLY
idle clocks.preset 297/270 clocks.arm=270MHz clocks.ddr=216MHz
acts cpu.ahb_ratio 3 EARLY
acts cpu.cache_op_cycles 2cycles
acts cpu.dcache.size 4KiB
acts cpu.fill_latency 2cycles EARLY
acts cpu.icache.size 4KiB
acts cpu.invalidate_all_cycles 128cycles EARLY
acts cpu.shifted_address_cycle false
acts cpu.tcm.banks 1 RAM EARLY
acts cpu.tcm.banks 1 cpu.tcm.own_conflict=1cycles EARLY
idle cpu.tcm.banks 1
acts cpu.tcm.dma_latency 3cycles RAM EARLY
idle cpu.tcm.dma_latency 3cycles
acts cpu.tcm.dma_word_clocks 3cycles RAM EARLY
idle cpu.tcm.dma_word_clocks 3cycles
acts cpu.tcm.first dma RAM EARLY
idle cpu.tcm.first dma
acts cpu.tcm.own_conflict 1cycles EARLY
acts cpu.tcm.wait_states 1cycles EARLY
acts cpu.test_clean_cycles 3cycles PROGRAM
acts cpu.walk_cycles 4cycles EARLY
tested ddr.check dram.check
tested ddr.clock_restart dram.rows
acts ddr.command_fifo 1 EARLY
acts ddr.grade 37e clocks.preset=432/340 EARLY
acts ddr.ideal row_timing EARLY
acts ddr.part mt47h32m16 EARLY
acts ddr.read_fifo 64B BUSY EARLY
acts ddr.refresh.gap 1 BUSY EARLY
acts ddr.refresh.must 0 EARLY
acts ddr.refresh.need 0 EARLY
tested ddr.refresh.release dram.refresh
acts ddr.request_latency 9cycles EARLY
tested ddr.retention dram.rows
acts ddr.return_latency 3cycles EARLY
acts ddr.scheduler fcfs EARLY
acts ddr.ti_open_row ready BUSY EARLY
idle ddr.ti_open_row ready ddr.scheduler=fcfs
idle ddr.ti_open_row ready ddr.scheduler=frfcfs
acts ddr.write_fifo 64B BUSY EARLY
acts edma.completion_clocks 64 PROGRAM
acts edma.event_clocks 64 PROGRAM
acts edma.request_clocks 128 PROGRAM
acts edma.reset_priority 0 PROGRAM
acts edma.tc.burst 64B PROGRAM
acts edma.tc.depth 1 PROGRAM
acts edma.tc.fifo 128B PROGRAM
acts edma.tc.outstanding 1 PROGRAM
acts engine tlm EARLY
tested engine.cache engine.board
tested engine.prefetch engine.board
idle engine.cache 1KiB
idle engine.prefetch 1
tested waves.skip cosim.rtl
tested waves.from cosim.rtl
tested waves.length cosim.rtl
tested waves.file cosim.board
tested waves.trigger cosim.board
idle waves.file x.fst
idle waves.trigger job
idle waves.skip 1
idle waves.from 1ms
idle waves.length 1ms
acts firmware.baud 57600 EARLY
acts firmware.elf PROGRAM run.until=time:50ms
acts firmware.flow serial
acts firmware.display_phase free
acts firmware.program cameras
acts firmware.check_capture true firmware.program=cameras
acts firmware.watchdog 0s firmware.program=cameras
idle firmware.watchdog 1s
idle firmware.program cameras PROGRAM
acts firmware.kernel ldm
acts firmware.lut soft_float
acts firmware.overlay true
acts firmware.patch true
acts firmware.repeat 2
acts firmware.tables 2
acts firmware.view four_way cameras.count=4
acts cameras.quad true cameras.count=4 firmware.view=four_way video.width=0 video.height=0 EARLY
tested lens.calibration unit.calibration
idle lens.calibration none.yaml
acts pll.go_time 5us EARLY
acts pll.lock_time 50us EARLY
acts pll.reset_type 2 PROGRAM
acts priority.arm 0
acts priority.vpbe 7
acts priority.vpfe 7
acts psc.transition_time 2us EARLY
acts run.frames 2
idle run.frames 2 run.until=time:60ms
acts run.frames 2 run.until=[frames,time:10s]
fails run.start_limit 10ms
idle run.start_limit 10ms run.until=time:60ms
idle run.start_limit 10ms run.until=[frames,time:10s]
tested run.resets e2e.reset
acts run.until time:50ms
acts switches.shift_x right
acts switches.shift_y up
acts system.bootcfg 1 PROGRAM
tested system.reset_time e2e.reset
acts system.vtp_time 3us EARLY
acts tvp5146.count_capture 10ms firmware.program=cameras
idle tvp5146.count_capture 10ms video.standard=vga_progressive EARLY
tested tvp5146.count_lines video.decoder_625
idle tvp5146.count_lines 4 video.standard=vga_progressive EARLY
acts tvp5146.crop_525 studio video.standard=ntsc
idle tvp5146.crop_525 studio
fails tvp5146.i2c_address 92
idle tvp5146.i2c_address 92 video.standard=vga_progressive EARLY
acts tvp5146.output_at_reset true PROGRAM
idle tvp5146.output_at_reset true video.standard=vga_progressive EARLY
acts tvp5146.phase 1ms
acts tvp5146.unlocked_output noise camera.0.connected=false
idle tvp5146.unlocked_output noise video.standard=vga_progressive EARLY
acts tvp5146.relock_fields 11
idle tvp5146.relock_fields 11 video.standard=vga_progressive EARLY
acts tvp5146.rom_version 1 PROGRAM
idle tvp5146.rom_version 1 video.standard=vga_progressive EARLY
acts tvp5146.standard 625/50 video.standard=ntsc
idle tvp5146.standard 625/50 video.standard=vga_progressive EARLY
acts uart0.input typed.txt PROGRAM
acts video.clock 30MHz video.standard=vga_progressive
idle video.clock 30MHz
acts video.height 24
acts video.standard ntsc
acts video.width 64
acts vpss.base_px_525 122 video.standard=ntsc
idle vpss.base_px_525 122
acts vpss.base_px_625 127
idle vpss.base_px_625 127 video.standard=ntsc
acts vpss.base_py_525 17 video.standard=ntsc
idle vpss.base_py_525 17
acts vpss.base_py_625 23
idle vpss.base_py_625 23 video.standard=ntsc
acts vpss.burst 32B
tested vpss.miscctl_6 video.display_625
tested vpss.osd_latch video.display_625
acts vpss.read_ahead_lines 2
acts vpss.read_outstanding 1
acts vpss.venc_clk_sel halves
tested vpss.write_buffer_bursts video.capture
T
  # The lens: all of it lies idle without one.
  local key value
  while read -r key value rest; do
    echo "acts lens.$key $value $rest"
    echo "idle lens.$key $value lens.mapping=none"
  done <<'T'
centre_x 8px
centre_y 4px
fov 120deg
focal 300px
in_aspect 1.5
kb [250,250,480,320,0,0,0,0] lens.mapping=kannala_brandt
kb_height 600px lens.mapping=kannala_brandt
kb_width 800px lens.mapping=kannala_brandt
out_aspect 1.5
out_focal 20px
roi [8,2,24,12]
paper_literal_focal true
theta_max 1deg lens.mapping=kannala_brandt
T
  # The same keys in the row of a camera: e2e.effects (CameraRowTest), e2e.cameras.
  for key in file kind motion_period motion_amplitude stamp lens fov kb kb_width kb_height video_fov calibration; do
    echo "tested camera.0.$key e2e.effects"
  done
  for key in mapping fov focal out_focal roi centre_x centre_y shift_x shift_y in_aspect out_aspect kb kb_width \
    kb_height calibration theta_max paper_literal_focal pair; do
    echo "tested camera.0.lens.$key e2e.effects"
  done
  echo 'acts lens.mapping linear'
  echo 'acts lens.pair B lens.shift_x=1px'
  echo 'acts lens.shift_x 7px'
  echo 'acts lens.shift_y 5px'
  # Synthetic loads, all alike; ports that nothing else uses.
  local load
  for load in load load.1 load.2 load.3; do
    echo "acts $load.outstanding 1 EARLY"
    while read -r key value; do
      echo "acts $load.$key $value $load.outstanding=2 $load.kind=mixed $load.pattern=random EARLY"
      echo "idle $load.$key $value"
    done <<'T'
base 33556480B
bytes 16B
gap 3us
kind read
pattern sequential
port edma_tc1
size 64KiB
start 50ms
end 4ms
T
    echo "acts $load.memory internal_ram $load.outstanding=1 $load.base=0B $load.size=16KiB EARLY"
    echo "idle $load.memory internal_ram"
    echo "acts $load.priority 0 $load.outstanding=8 EARLY"
    echo "idle $load.priority 0"
  done
  local port
  for port in edma_tc0 edma_tc1 edma_tc2 edma_tc3 load remap_engine; do
    for key in request_latency response_latency width; do
      value=9cycles
      [ $key = width ] && value=16bit
      echo "acts bus.$port.$key $value load.outstanding=1 load.port=$port EARLY"
      echo "idle bus.$port.$key $value"
    done
    [ $port = load ] || echo "acts priority.$port 0 load.outstanding=8 load.port=$port load.gap=1us BOOTED"
  done
}

elsewhere() {
  cat <<'T'

PROGRAM
SPHERE lens.mapping=equisolid
VIDEO lens.mapping=linear
video.standard=ntsc
video.standard=mt9v125
video.standard=svga_progressive
cameras.count=2
cameras.count=4 firmware.view=four_way
firmware.program=cameras
fault.kind=sync_noise fault.start=50ms
lens.mapping=none
load.3.outstanding=2 load.3.port=edma_tc1
load.3.outstanding=2 load.3.memory=internal_ram load.3.base=0B load.3.size=32KiB load.3.gap=1us
clocks.arm=270MHz clocks.ddr=216MHz
ddr.scheduler=closed_page
T
  local kernel
  for kernel in $("$fovea" params firmware.kernel | grep -o 'plain, [a-z0-9_, ]*[a-z]' | head -1 | tr -d ,); do
    echo "LARGER firmware.kernel=$kernel"
    [[ $kernel != engine* ]] || echo "LARGER firmware.kernel=$kernel engine=tlm"
  done
}

# unchanged KEY VALUE SITUATION...: says whether the run said that the key has no effect.
unchanged() {
  local key=$1 value=$2 rest=${*:3} base
  situation "${@:3}"
  base=${bases["=$rest"]:-}
  if [ -z "$base" ]; then
    base=base$number
    number=$((number + 1))
    bases["=$rest"]=$base
    play "$base" "${keys[@]}"
    [ "$(cat "$base.status")" = 0 ] || fail "the situation ($rest) fails: $(tail -1 "$base.err")"
    figures "$base" >"$base.figures"
  fi
  rm -rf changed
  play changed "${keys[@]}" -s "$key=$value"
  grep -q "'$key' is set .* but has no effect" changed.err || return 1
  [ "$(cat changed.status)" = 0 ] || return 1  # refused, by name, such as a file that is not there
  figures changed >changed.figures
  if ! cmp -s "$base.figures" changed.figures || ! diff -rq "$base/frames" changed/frames >/dev/null ||
    ! cmp -s "$base/frames.csv" changed/frames.csv || ! cmp -s "$base/stalls.csv" changed/stalls.csv; then
    fail "$key=$value ($rest) is said to have no effect, and changes the results"
  fi
}

declare -A listed bases idle
number=0
if [ "$mode" = idle ]; then
  mapfile -t changes < <(table | sed -n 's/^idle \(\S* \S*\).*/\1/p' | grep -v '^load\(\.[12]\)\?\.' | sort -u)
  mapfile -t situations < <(elsewhere)
  all=$((${#changes[@]} * ${#situations[@]})) count=${6:-} tried=0 said=0
  RANDOM=${7:-1}
  while [ "$tried" -lt "$all" ] && [ "$said" -lt "${count:-$all}" ]; do
    number_of=$((count ? (RANDOM * 32768 + RANDOM) % all : tried))
    tried=$((tried + 1))
    # shellcheck disable=SC2086 # words
    unchanged ${changes[number_of / ${#situations[@]}]} ${situations[number_of % ${#situations[@]}]} && said=$((said + 1))
  done
  echo "$tried keys in a situation, $said said to have no effect, $failures failures"
  [ "$said" -gt 0 ] || failures=1
  exit $((failures > 0))
fi
while read -r what key value rest; do
  listed[$key]=1
  [ "$what" = tested ] && continue
  [ "$mode $what" = 'quick acts' ] && [[ ! $rest =~ EARLY|BOOTED|PROGRAM ]] && continue
  rest=${rest/FRONT/$front}
  [ "$key $value" = 'camera.file chess' ] && value=${front%front.png}left.png
  [ "$key" = firmware.elf ] && value=$program rest=${rest/PROGRAM/}
  # shellcheck disable=SC2086 # words
  situation $rest
  if [ "$what" = idle ]; then
    idle[$key]=1
    play idle "${keys[@]}" -s "$key=$value" --strict
    if ! grep -q "'$key' is set .* but has no effect" idle.err || [ "$(cat idle.status)" != 2 ]; then
      fail "$key=$value ($rest) has no effect, and nothing says so: $(cat idle.err)"
    fi
    continue
  fi
  base=${bases["=$rest"]:-}
  if [ -z "$base" ]; then
    base=base$number
    number=$((number + 1))
    bases["=$rest"]=$base
    play "$base" "${keys[@]}"
    [ "$(cat "$base.status")" = 0 ] || fail "the situation ($rest) fails: $(tail -1 "$base.err")"
  fi
  rm -rf changed
  play changed "${keys[@]}" -s "$key=$value"
  status=$(cat changed.status)
  if [ "$what" = fails ]; then
    [ "$status" = 3 ] || fail "$key=$value ($rest) does not fail: status $status"
  elif [ "$status" != 0 ]; then
    fail "$key=$value ($rest): status $status: $(tail -1 changed.err)"
  elif grep -q "'$key' is set .* but has no effect" changed.err; then
    fail "$key=$value ($rest) should act, and is said to have no effect"
  elif ! differ "$base" changed; then
    fail "$key=$value ($rest) changes nothing"
  fi
done < <(table | { if [ -n "${ONLY:-}" ]; then grep -E "$ONLY"; else cat; fi; })

# No key is forgotten, and none that is gone is listed.
"$fovea" params | sed '1d; /^$/,$d' >params.txt
while read -r key line; do
  [ -n "${listed[$key]:-}" ] || fail "$key is in no line of the table"
  [[ $line != *'; needs '* ]] || [ -n "${idle[$key]:-}" ] || fail "$key needs something, and no line lacks it"
  unset "listed[$key]"
done <params.txt
for key in "${!listed[@]}"; do fail "$key is no key"; done
echo "$(wc -l <params.txt) keys, $failures failures"
exit $((failures > 0))
