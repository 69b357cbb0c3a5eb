#!/usr/bin/env bash
# .ci/run and the programs in scripts over stand-ins of cmake and fovea: what they start with which
# arguments. Usage: scripts.sh SOURCE
set -uo pipefail
source=$1
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
mkdir -p "$dir/tree/scripts/experiments" "$dir/tree/build/release" "$dir/bin" "$dir/elsewhere"
cp "$source"/scripts/{run,build,test,figures,kernels,linux,sanitize,nightly,package,baselines} "$dir/tree/scripts/"
mkdir -p "$dir/tree/sw"
cp -r "$source/sw/python" "$dir/tree/sw/"
mkdir "$dir/tree/.ci"
cp "$source/.ci/run" "$dir/tree/.ci/"
cp "$source/CMakeLists.txt" "$dir/tree/"
touch "$dir/tree/scripts/experiments/default.yaml" "$dir/elsewhere/mine.yaml"
printf '#!/bin/sh\necho "setup $*" >>"%s/calls"\n' "$dir" >"$dir/tree/scripts/setup"
for name in cmake ctest ffmpeg; do printf '#!/bin/sh\necho "%s $*" >>"%s/calls"\n' $name "$dir" >"$dir/bin/$name"; done
cat >>"$dir/bin/ctest" <<'E'
[ "$CTEST_FAILS" != "$2" ] || echo '1/1 Test #1: unit.common ......***Failed    0.01 sec'
[ -z "$CTEST_SLEEPS" ] || [ "$2" != build/asan ] || sleep "$CTEST_SLEEPS"
printf '1/1 Test of %s\n\n100%% tests passed, 0 tests failed out of 1\n\nTotal Test time (real) = 1 sec\n' "$2"
[ "$CTEST_FAILS" != "$2" ]
E
export CTEST_SLEEPS='' CTEST_FAILS=''
printf '#!/bin/sh\necho "fovea $*" >>"%s/calls"\n' "$dir" >"$dir/tree/build/release/fovea"
chmod +x "$dir/bin/"* "$dir/tree/scripts/"* "$dir/tree/build/release/fovea"
export PATH=$dir/bin:$PATH
cd "$dir/elsewhere" || exit 1
failures=0
fail() { echo "$1"; failures=$((failures + 1)); }

# calls NAME STATUS 'expected last call' -- command...; an empty expectation means no call at all
calls() {
  local name=$1 status=$2 want=$3 got
  shift 4
  : >"$dir/calls"
  "$@" >"$dir/text" 2>&1
  got=$?
  [ "$got" = "$status" ] || fail "$name: exit status $got, expected $status: $(cat "$dir/text")"
  [ "$(tail -1 "$dir/calls")" = "$want" ] || fail "$name: '$(tail -1 "$dir/calls")', expected '$want'"
}
tree=$dir/tree default=$dir/tree/scripts/experiments/default.yaml
calls plain 0 "fovea run $default" -- "$tree/scripts/run"
calls set 0 "fovea run $default -s run.frames=1" -- "$tree/scripts/run" -s run.frames=1
calls set_a_file 0 "fovea run $default -s camera.calibration=left.yaml" -- \
  "$tree/scripts/run" -s camera.calibration=left.yaml
calls named 0 'fovea run mine.yaml --mp4' -- "$tree/scripts/run" mine.yaml --mp4
calls named_last 0 'fovea run -s run.frames=1 mine.yaml' -- "$tree/scripts/run" -s run.frames=1 mine.yaml
calls misspelt 0 'fovea run none.yaml' -- "$tree/scripts/run" none.yaml
cp "$source/scripts/linux" "$tree/scripts/"
for script in run build test figures linux sanitize nightly package baselines; do
  calls "help_$script" 0 '' -- "$tree/scripts/$script" --help
  grep -q "Usage: scripts/$script" "$dir/text" || fail "help of $script: $(cat "$dir/text")"
done
calls baselines_argument 2 '' -- "$tree/scripts/baselines" --quick
calls figures_argument 2 '' -- "$tree/scripts/figures" --quick
calls test 0 'ctest --test-dir build/release --output-on-failure -j '"$(nproc)"' -LE nightly -R unit' -- \
  "$tree/scripts/test" -R unit

# A clone that was moved is configured anew, another one is not.
# A run needs no tests, but leaves them in a build folder that has them.
asked() { grep -qx "$2" "$dir/calls" || fail "$1: no '$2' in $(cat "$dir/calls")"; }
rm -f "$tree/build/release/CMakeCache.txt"
calls new_run 0 "fovea run $default" -- "$tree/scripts/run"
asked new_run 'setup run'
asked new_run 'cmake --preset release -D FOVEA_TESTS=OFF'
echo 'FOVEA_TESTS:BOOL=ON' >"$tree/build/release/CMakeCache.txt"
printf 'CMAKE_HOME_DIRECTORY:INTERNAL=%s\n' "$tree" >>"$tree/build/release/CMakeCache.txt"
calls run_after_tests 0 "fovea run $default" -- "$tree/scripts/run"
asked run_after_tests 'cmake --preset release'
calls kernels 2 'fovea params' -- "$tree/scripts/kernels"
asked kernels 'setup run'
asked kernels 'cmake --build --preset release --target fovea fovea_firmware_all -- --quiet'
grep -q 'has no parameter firmware.kernel' "$dir/text" || fail "kernels: $(cat "$dir/text")"
calls build 0 'cmake --build --preset release -- --quiet' -- "$tree/scripts/build"
asked build 'setup test'
asked build 'cmake --preset release'

# Sanitizers: only the layers that are named, all folders of the model.
mkdir -p "$tree/build/asan"
ln -s ../release/fovea "$tree/build/asan/fovea"
calls sanitize 0 'fovea run scripts/experiments/default.yaml -s run.frames=1 -o build/asan/board' -- \
  "$tree/scripts/sanitize" dram
grep -q '^cmake --preset asan -D FOVEA_ONLY=model/common;.*sw/fovea;tb/dram;$' "$dir/calls" ||
  fail "sanitize: $(cat "$dir/calls")"
calls sanitize_build 0 'cmake --build --preset asan -- --quiet' -- "$tree/scripts/sanitize" --build
asked sanitize_build 'cmake --preset asan -D FOVEA_ONLY=.*;tb/unit;tb/dram;tb/exec;'
# What every change has to pass, and the time of each step. The output ends with the sum of the tests.
last_asan='fovea run scripts/experiments/default.yaml -s run.frames=1 -o build/asan/board'
every="ctest --test-dir build/release --output-on-failure -j $(nproc) -LE nightly"
calls ci 0 "$last_asan" -- "$tree/.ci/run"
for step in 'first run' build tests sanitizers together; do
  grep -Eqx "ci: $step [0-9]+ s( of 1500 s)?" "$dir/text" || fail "ci: no time of '$step' in $(cat "$dir/text")"
done
asked ci "$every"
asked ci 'fovea run .*/scripts/experiments/default.yaml -s run.frames=1 -o build/first-run'
asked ci 'cmake --build --preset asan -- --quiet'
[ "$(grep -v '^ci: ' "$dir/text" | tail -4 | tr '\n' ';')" = \
  'Of the tests of the release build:;100% tests passed, 0 tests failed out of 1;;Total Test time (real) = 1 sec;' ] ||
  fail "ci: the output does not end with the tests' sum: $(cat "$dir/text")"
CTEST_FAILS=build/release calls ci_test_fails 1 "$every" -- "$tree/.ci/run"
CTEST_FAILS=build/asan calls ci_sanitizer_fails 1 "$last_asan" -- "$tree/.ci/run"
# Sanitizers that have too little time, or take too long.
sed -i 's/^limit=.*/limit=259/' "$tree/.ci/run"
calls ci_slow 0 "$every" -- "$tree/.ci/run"
grep -q '^ci: sanitizers left out' "$dir/text" || fail "ci_slow: $(cat "$dir/text")"
! grep -q asan "$dir/calls" || fail "ci_slow: $(cat "$dir/calls")"
sed -i 's/^limit=.*/limit=24/; s/^least_left=[0-9]*/least_left=1/' "$tree/.ci/run"
CTEST_SLEEPS=30 calls ci_stopped 0 \
  "${every/release/asan} -E ^exec\\.heap\\..*\\.O0\$|^exec\\.command_line\$|^unit\\.(writers|page_names|limits)\$" \
  -- "$tree/.ci/run"
grep -Eq '^ci: sanitizers stopped after the [1-4] s' "$dir/text" || fail "ci_stopped: $(cat "$dir/text")"
CTEST_FAILS=build/asan CTEST_SLEEPS=30 calls ci_stopped_late 1 "$(tail -1 "$dir/calls")" -- "$tree/.ci/run"
grep -q '^ci: a test failed before the sanitizers were stopped' "$dir/text" || fail "ci_stopped_late: $(cat "$dir/text")"
sed -i 's/^limit=.*/limit=-1/' "$tree/.ci/run"
calls ci_limit 1 "$every" -- "$tree/.ci/run"
grep -q '^ci: took longer than allowed' "$dir/text" || fail "ci_limit: $(cat "$dir/text")"
calls no_check 1 'setup nightly' -- "$tree/scripts/nightly" unknown

printf 'CMAKE_HOME_DIRECTORY:INTERNAL=%s\n' "$tree" >"$tree/build/release/CMakeCache.txt"
calls stays 0 'cmake --build --preset release --target fovea -- --quiet' -- "$tree/scripts/build" fovea
grep -qx 'cmake --preset release' "$dir/calls" || fail "stays: $(cat "$dir/calls")"
printf 'CMAKE_HOME_DIRECTORY:INTERNAL=/another/place\n' >"$tree/build/release/CMakeCache.txt"
calls moved 0 'cmake --build --preset release -- --quiet' -- "$tree/scripts/build"
grep -qx 'cmake --preset release --fresh' "$dir/calls" || fail "moved: $(cat "$dir/calls")"
grep -q "belongs to '/another/place'" "$dir/text" || fail "moved: $(cat "$dir/text")"
echo "$failures failures"
[ "$failures" = 0 ]
