#!/usr/bin/env bash
# From the Debian package to a verdict on another project's firmware: the recipe of scripts/ci-example with
# the unpacked package alone. Usage: package.sh BUILD SOURCE OUT
set -uo pipefail
build=$1 source=$2 out=$3
rm -rf "$out"
mkdir -p "$out"
failures=0
fail() { echo "$1"; failures=$((failures + 1)); }

cpack --config "$build/CPackConfig.cmake" -G DEB -B "$out/deb" >"$out/cpack.log" 2>&1 || { cat "$out/cpack.log"; exit 1; }
rm -rf "$out/deb/_CPack_Packages"
deb=$(ls "$out"/deb/fovea_*.deb)
depends=$(dpkg-deb -f "$deb" Depends)
for library in libc6 libsqlite3-0 libyaml-cpp; do
  [[ $depends == *$library* ]] || fail "the package does not depend on $library: $depends"
done
commit=$(tr - . <"$build/fovea.commit")
[[ $(dpkg-deb -f "$deb" Version) == *+"$commit" ]] || fail "version $(dpkg-deb -f "$deb" Version), not of commit $commit"

# A machine without Fovea's sources: the package below a folder, a copy of the recipe.
# The steps' processor time, in ms, from what `times` says of this shell's children that have ended: wall time would
# also count what else the machine does.
spent() { awk 'NR == 2 { split($1, u, /[ms]/); split($2, s, /[ms]/); printf "%d", 1e3 * (60 * (u[1] + s[1]) + u[2] + s[2]) }' "$1"; }
begin=$(date +%s%N)
times >"$out/times.begin"
dpkg -x "$deb" "$out/root" || exit 1
cp -r "$out/root/usr/share/doc/fovea/ci-example" "$out/repository"
export FOVEA=$out/root/usr/bin/fovea BUILD=$out/app
cd "$out/repository" || exit 1
[ "$("$FOVEA" version)" = "$("$build/fovea" version)" ] || fail "version: $("$FOVEA" version)"
# The example's own baseline is of the package of another commit: still right, and taken over.
FOVEA_CHECK_OPTIONS=--across-versions ./check.sh >"$out/shipped.log" 2>&1 ||
  fail "the shipped baseline is out of date: $(cat "$out/shipped.log")"
./check.sh >"$out/other.log" 2>&1
[ $? = 2 ] || fail "another commit's baseline is not refused: $(cat "$out/other.log")"
./check.sh --bless 'this commit' >"$out/bless.log" 2>&1 || fail "bless: $(cat "$out/bless.log")"
./check.sh >"$out/same.log" 2>&1 || fail "the same firmware: status $?: $(cat "$out/same.log")"
cp "$BUILD/timing.xml" "$out/same.xml"
FLAGS=-DSLOW ./check.sh >"$out/slow.log" 2>&1
status=$?
end=$(date +%s%N)
times >"$out/times.end"
[ "$status" = 1 ] || fail "a slower firmware: status $status: $(cat "$out/slow.log")"
grep -q 'FAILED  cpu.cycles' "$out/slow.log" || fail "no cpu.cycles: $(cat "$out/slow.log")"
grep -q '^blamed: [a-z_]* (main.c:[0-9]*) ' "$out/slow.log" || fail "no function and line: $(cat "$out/slow.log")"
grep -q '^- \*\*who\*\*: `[a-z_]* (main.c:' "$BUILD/timing.md" || fail "no five lines: $(cat "$BUILD/timing.md")"
ms=$(($(spent "$out/times.end") - $(spent "$out/times.begin")))
echo "from package to five verdicts: $ms ms of processor time, $(((end - begin) / 1000000)) ms in all"
[ "$ms" -gt 0 ] && [ "$ms" -le 60000 ] || fail "from package to verdicts: $ms ms of processor time, more than a minute or none"
xmllint --noout --schema "$source/tb/regression/junit.xsd" "$BUILD/timing.xml" 2>"$out/xml.log" ||
  fail "JUnit XML: $(cat "$out/xml.log")"
# The schema is able to complain.
for wrong in 's/ tests="[0-9]*"//' 's/ skipped="0"//' 's/<failure type="[a-z]*"/<failure/' 's/ time="0"/ time="1e3"/' \
  's/testcase/test/'; do
  sed "$wrong" "$BUILD/timing.xml" >"$out/wrong.xml"
  cmp -s "$BUILD/timing.xml" "$out/wrong.xml" && fail "the file has nothing for $wrong"
  xmllint --noout --schema "$source/tb/regression/junit.xsd" "$out/wrong.xml" 2>/dev/null && fail "the schema accepts $wrong"
done
# A reader of its own sees the verdicts of the console, and complains of what a server would drop.
read_junit() { python3 "$source/tb/regression/junit_reader.py" "$@"; }
read_junit "$BUILD/timing.xml" >"$out/junit.txt" || fail "JUnit XML: $(cat "$out/junit.txt")"
[ "$(grep -c '^failed ' "$out/junit.txt")" = "$(grep -c '^  FAILED ' "$out/slow.log")" ] &&
  grep -q '^failed fovea.timing cpu.cycles: ' "$out/junit.txt" ||
  fail "JUnit XML is read as: $(cat "$out/junit.txt")"
read_junit "$out/same.xml" >"$out/junit.txt" || fail "JUnit XML: $(cat "$out/junit.txt")"
grep -q '^passed fovea.timing frame.window$' "$out/junit.txt" && ! grep -v '^passed ' "$out/junit.txt" ||
  fail "JUnit XML of what passed is read as: $(cat "$out/junit.txt")"
for wrong in 's/ classname="[^"]*"//' 's/failures="[0-9]*"/failures="0"/' 's/ message="[^"]*"//' 's/<testcase name="[^"]*"/<testcase name="x"/' \
  's/testsuite>/testsuit>/' 's/failure>/fault>/;s/<failure/<fault/' 's/ time="0"/ time=""/' 's/<testsuites>/\xff<testsuites>/' 's/<testsuite [^>]*>/<testsuite>/'; do
  sed "$wrong" "$BUILD/timing.xml" >"$out/wrong.xml"
  cmp -s "$BUILD/timing.xml" "$out/wrong.xml" && fail "the file has nothing for $wrong"
  read_junit "$out/wrong.xml" >"$out/wrong.txt" && fail "the reader accepts $wrong"
done
# The package brings firmware, experiments and footage.
"$FOVEA" run "$out/root/usr/share/fovea/scripts/experiments/default.yaml" -s video.width=64 -s video.height=16 \
  -s camera.stamp=false -s run.frames=1 --no-frames -o "$out/default" >"$out/default.log" 2>&1 ||
  fail "default: $(cat "$out/default.log")"
man=$(gzip -dcf "$out"/root/usr/share/man/man1/fovea.1*) || fail 'no manual page'
[[ $man == *'fovea check'* ]] || fail 'the manual page lacks fovea check'
# The servers' files start the same script.
for file in "$source"/scripts/ci-example/{github/.github/workflows/timing.yml,gitlab/.gitlab-ci.yml}; do
  grep -q './check.sh' "$file" || fail "$file does not run check.sh"
done
echo "$failures failures"
[ "$failures" = 0 ]
