#!/usr/bin/env bash
# scripts/cmake/commit.cmake: the commit of a tree, of a modified one, of one without git; written
# only when it changes. Usage: commit.sh SOURCE
set -uo pipefail
script=$1/scripts/cmake/commit.cmake
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
unset GIT_DIR GIT_WORK_TREE GIT_INDEX_FILE
export GIT_CEILING_DIRECTORIES=$dir GIT_AUTHOR_NAME=a GIT_AUTHOR_EMAIL=a@b GIT_COMMITTER_NAME=a \
  GIT_COMMITTER_EMAIL=a@b
failures=0
commit() { cmake -DSOURCE="$dir/tree${1-}" -DOUT="$dir/out" -P "$script" && cat "$dir/out"; }
expect() { [ "$2" = "$3" ] || { echo "$1: '$2', expected '$3'"; failures=$((failures + 1)); }; }
mkdir -p "$dir/tree/inner"
expect no_git "$(commit)" unknown
git -C "$dir/tree" init -q
expect no_commit "$(commit)" unknown
echo 1 >"$dir/tree/file"
git -C "$dir/tree" add file
git -C "$dir/tree" commit -qm one
hash=$(git -C "$dir/tree" rev-parse HEAD | cut -c1-12)
expect clean "$(commit)" "$hash"
touch -d '2001-01-01' "$dir/out"
commit >/dev/null
expect unchanged "$(date -r "$dir/out" +%Y)" 2001
echo 2 >"$dir/tree/untracked"
expect untracked "$(commit)" "$hash"
echo 2 >"$dir/tree/file"
expect modified "$(commit)" "$hash-modified"
git -C "$dir/tree" commit -qam two
expect committed "$(commit)" "$(git -C "$dir/tree" rev-parse HEAD | cut -c1-12)"
expect inside_another "$(commit /inner)" unknown
echo "$failures failures"
[ "$failures" = 0 ]
