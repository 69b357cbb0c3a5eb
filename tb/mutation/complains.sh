#!/usr/bin/env bash
# scripts/mutate on the project tiny/: it kills every change of the well tested part, names the survivors of the
# other one and fails; an entry of equivalent.toml hides one change and no other.
# Usage: complains.sh SOURCE OUT
set -euo pipefail
source=$1 out=$2
tiny=$source/tb/mutation/tiny
rm -rf "$out"
mkdir -p "$out"
cp -r "$tiny" "$out/tiny"

fail() { echo "complains.sh: $1"; cat "$out/log"; exit 1; }
mutate() {
  local status=0
  "$source/scripts/mutate" --source "$out/tiny" --config "$out/tiny/mutation.toml" --out "$out/work" \
    --seed 3 --number 40 --least 15 "$@" > "$out/log" 2>&1 || status=$?
  echo $status
}
row() { grep -F "| $1 |" "$out/log" || true; }

# A source without an area is refused, and a rule without a file.
echo 'int more(void);' > "$out/tiny/more.h"
[ "$(mutate --check)" = 2 ] || fail "a source without an area is taken"
grep -q 'more.h: no area' "$out/log" || fail "the source without an area is not named"
rm "$out/tiny/more.h"
[ "$(mutate --check)" = 0 ] || fail "a project in which each source has an area is refused"
sed "s/(strong/(stronger/; s/|part/|parted/" "$out/tiny/mutation.toml" > "$out/stale.toml"
[ "$(mutate --check --config "$out/stale.toml")" = 2 ] || fail "an area without a file is taken"
grep -q 'area "strong": no file' "$out/log" || fail "the area without a file is not named"

sed -i 's/even_sum/even_total/' "$out/tiny/equivalent.toml"
[ "$(mutate --check)" = 2 ] || fail "an entry for a function that is not there is taken"
grep -q 'no such place.*even_total' "$out/log" || fail "the function that is not there is not named"
sed -i 's/even_total/even_sum/' "$out/tiny/equivalent.toml"

[ "$(mutate)" = 1 ] || fail "status is not 1 with a weak area"
row strong | grep -Eq '\| strong \| [0-9]+ \| 0 \| [01] \| 0 \| 100 % \|' || fail "strong tests do not kill all"
row weak | grep -Eq '\| weak \| [0-9]+ \| [1-9][0-9]* \| 0 \| 0 \|' || fail "weak tests kill all"
grep -Eq 'weak.c:[0-9]+ clamp \[(boundary|arithmetic|constant|drop|negate)\] ' "$out/log" ||
  fail "no survivor is named"
grep -q 'broken .* FAILS WITH NO MUTANT ON' "$out/log" || fail "a test that always fails is not named"
! grep -q 'kEvery = 4' "$out/log" || fail "a constant expression was changed"

# The same seed draws the same mutants; another one does not.
first=$(python3 -c 'import json,sys; print([m["change"] for m in json.load(open(sys.argv[1]))["mutants"]])' \
  "$out/work/plan.json")
mutate > "$out/status"
again=$(python3 -c 'import json,sys; print([m["change"] for m in json.load(open(sys.argv[1]))["mutants"]])' \
  "$out/work/plan.json")
[ "$first" = "$again" ] || fail "the same seed gave other mutants"
mutate --seed 4 > "$out/status"
other=$(python3 -c 'import json,sys; print([m["change"] for m in json.load(open(sys.argv[1]))["mutants"]])' \
  "$out/work/plan.json")
[ "$first" != "$other" ] || fail "another seed gave the same mutants"

# A better test kills the rest; --continue runs it with the same mutants.
mutate > "$out/status"
cat > "$out/tiny/weak_test.cpp" <<'TEST'
#include "weak.h"

int main() {
  if (clamp(5, 0, 10) != 5 || clamp(0, 0, 10) != 0 || clamp(10, 0, 10) != 10) return 1;
  if (clamped() != 0) return 1;
  if (clamp(-1, 0, 10) != 0 || clamped() != 1) return 1;
  return clamp(11, 0, 10) == 10 && clamped() == 2 ? 0 : 1;
}
TEST
[ "$(mutate --continue)" = 0 ] || fail "status is not 0 with a good test"
row weak | grep -Eq '\| weak \| [0-9]+ \| 0 \| 0 \| 0 \| 100 % \|' || fail "good tests do not kill all"

# Time over is neither success nor failure.
[ "$(mutate --for 0)" = 3 ] || fail "status is not 3 without time"
# A change by hand is tried too, beside the score.
printf '[[mutant]]\nname = "own"\nfile = "weak.c"\nold = "return low;"\nnew = "return high;"\n' > "$out/extra.toml"
mutate --continue --extra "$out/extra.toml" > "$out/status"
grep -q 'by hand, killed: own weak.c:' "$out/log" || fail "a change by hand is not reported"
# An entry that fits no place is refused.
sed -i 's/0 => 1/0 => 7/' "$out/tiny/equivalent.toml"
[ "$(mutate --continue)" = 2 ] || fail "a stale entry of equivalent.toml is taken"
grep -q 'no such place' "$out/log" || fail "a stale entry of equivalent.toml is not named"

# A test that waits ends at its time by the clock, which follows from its usual one; tests of the own layer come before
# others of a hundredth of their time.
PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=$source/tb/mutation python3 > "$out/log" 2>&1 <<'PYEND' || fail "runs.py"
import types
from runs import Runs, Test

passed, _, wall = Test({'name': 'waits', 'command': ['sleep', '60']}).run({}, 10, 1)
assert not passed and 1 <= wall < 20, (passed, wall)
passed, _, wall = Test({'name': 'ends', 'command': ['sleep', '1']}).run({}, 10, 20)
assert passed and 1 <= wall < 20, (passed, wall)

def order(own, other):
    runs = Runs.__new__(Runs)
    runs.tests = dict.fromkeys(('own.a', 'other.a'))
    runs.state = {'tests': {'own.a': {'passed': True, 'seconds': own}, 'other.a': {'passed': True, 'seconds': other}}}
    runs.reached = dict.fromkeys(runs.tests, {7})
    areas = types.SimpleNamespace(own_tests=lambda area: __import__('re').compile('^own'))
    runs.tree = types.SimpleNamespace(areas=areas)
    return runs.order({'id': 7, 'area': 'x'})

runs = Runs.__new__(Runs)
runs.extra = 10
assert runs.most({'seconds': 4, 'wall': 8}) == (26, 100), runs.most({'seconds': 4, 'wall': 8})
assert runs.most({'seconds': 4, 'wall': 2})[1] == 80  # several processes
assert order(4.9, 0.05) == ['own.a', 'other.a']
assert order(5.1, 0.05) == ['other.a', 'own.a']
PYEND
