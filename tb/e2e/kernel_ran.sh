#!/usr/bin/env bash
# Results name the remap kernel that ran, and a run warns where it is another one than was asked for; so it does of an
# engine that nothing uses, and of a lens that the firmware does not correct. Usage: kernel_ran.sh FOVEA SOURCE OUT
set -uo pipefail
fovea=$1 source=$2 out=$3
rm -rf "$out"
mkdir -p "$out"
cd "$out" || exit 1
failures=0
fail() { echo "$1"; failures=$((failures + 1)); }
cat >small.yaml <<'Y'
run: {frames: 1, start_limit: 2s}
camera: {kind: chart, stamp: false}
video: {width: 64, height: 16}
firmware: {lut: fixed_point}
Y
# ran NAME STATUS KERNEL WARNING OPTIONS...: KERNEL in stats.json, and that warning alone; '': none
ran() {
  local name=$1 status=$2 kernel=$3 warning=$4 got said
  shift 4
  "$fovea" run small.yaml --no-frames -o "$name" "$@" >"$name.out" 2>"$name.err"
  got=$?
  [ "$got" = "$status" ] || fail "$name: status $got, expected $status: $(cat "$name.err")"
  said=$(grep -o 'warning (.*' "$name.err" | cut -d: -f2-)
  [ "$said" = "${warning:+ $warning}" ] || fail "$name says:$said"
  [ "$status" != 0 ] || [ "$(sed -n 's/^ *"kernel": "\(.*\)",$/\1/p' "$name/stats.json")" = "$kernel" ] ||
    fail "$name: stats.json names $(grep '^ *"kernel"' "$name/stats.json")"
}
# STAGED.md: staged takes no rows shorter than a piece of the EDMA's; fastest is what fits.
refused='firmware.kernel=staged was asked for, and codes ran; uart.log has the reason'
ran fastest 0 codes '' -s firmware.kernel=fastest
ran plain 0 plain '' -s firmware.kernel=plain
ran other_file 0 codes "$refused" -s firmware.kernel=staged -s "firmware.elf=$(dirname "$fovea")/sw/firmware/fovea_firmware.elf"
ran staged 0 codes "$refused" -s firmware.kernel=staged
ran alone 0 codes 'firmware.kernel=engine needs the remap engine, and engine = none: the program takes staged' \
  -s firmware.kernel=engine
ran engine 0 engine '' -s firmware.kernel=engine -s engine=tlm
ran idle 0 plain \
  'engine=tlm has nothing to do: firmware.kernel = plain uses the core; kernels of the engine: engine, engine_grid, engine_radial' \
  -s firmware.kernel=plain -s engine=tlm
ran view 0 strips 'firmware.kernel=staged has no form for several sources: with firmware.view=four_way the program takes strips, as with fastest' \
  -s firmware.kernel=staged -s firmware.view=four_way -s cameras.count=4
ran strict 2 '' '' --strict -s firmware.kernel=engine
grep -q 'needs the remap engine' strict.err || fail "strict: $(cat strict.err)"
ran strict_late 2 '' '' --strict -s firmware.kernel=staged
grep -q "$refused" strict_late.err || fail "strict, by what ran: $(cat strict_late.err)"
"$fovea" report --text fastest >/dev/null || fail 'report'
"$fovea" report fastest -o page.html >/dev/null && grep -q 'Remap kernel' page.html || fail 'the page does not name the kernel'

footage=(-s camera.kind=sphere -s "camera.file=$source/traces/footage/neozhaoliang-surround/front.png")
ran lens 0 plain 'camera.lens = equisolid, but the firmware corrects lens.mapping = kannala_brandt: the picture stays distorted' \
  "${footage[@]}" -s firmware.kernel=plain -s camera.lens=equisolid -s lens.mapping=kannala_brandt
ran fov 0 plain 'camera.fov is set (150deg) and lens.fov is not (180deg): the firmware corrects another lens than the camera has' \
  "${footage[@]}" -s firmware.kernel=plain -s camera.lens=equisolid -s lens.mapping=equisolid -s camera.fov=150deg
echo "$failures failures"
[ "$failures" = 0 ]
