#!/usr/bin/env bash
# The section of model/howto/add-a-report-section.md, in a program that has its source and its row: between its neighbours
# on the page and in the list at the top; not on the page of a program without it, nor of a run with nothing to show.
# Usage: section.sh FOVEA_WITH_IT FOVEA OUT
set -uo pipefail
with=$1 fovea=$2 out=$3
rm -rf "$out"
mkdir -p "$out"
cd "$out" || exit 1
fail() { echo "$*"; exit 1; }
printf 'run: {frames: 1}\nvideo: {width: 48, height: 16}\ncamera: {kind: chart, stamp: false}\n' >small.yaml
"$fovea" run small.yaml --no-frames -s run.until=time:6ms -o run >run.txt 2>&1 || fail "no results: $(<run.txt)"
"$with" report run -o with.html >/dev/null || fail "no page"
"$fovea" report run -o without.html >/dev/null || fail "no page of the program itself"
order=$(grep -o '<section id="[a-z]*"' with.html | head -3 | tr -d '\n')
[ "$order" = '<section id="verdict"<section id="ending"<section id="pictures"' ] || fail "the sections are $order"
grep -q '<a href="#ending">How it ended</a>' with.html || fail "the list at the top does not have it"
grep -q '<td>time:6ms</td><td>complete</td>' with.html || fail "it does not say what ended the run"
grep -q 'How it ended' without.html && fail "the program without the row has the section"
sed -i '/^ *"ended_by"/d' run/stats.json
"$with" report run -o nothing.html >/dev/null || fail "no page of a run that does not say what ended it"
grep -q 'How it ended' nothing.html && fail "an empty section is shown"
echo "the section of the how-to works"
