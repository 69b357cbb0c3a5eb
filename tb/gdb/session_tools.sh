# shellcheck shell=bash
# What the sessions share. Expects $fovea and $gdb; changes to a folder of its own.
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
cd "$out" || exit 1
failures=0
fail() { echo "$*"; failures=$((failures + 1)); }

# begin NAME command...: starts fovea; afterwards $pid and $port are its.
begin() {
  name=$1
  shift
  : >"$name.err"
  "$fovea" "$@" --gdb :0 >"$name.out" 2>"$name.err" <"${input:-/dev/null}" &
  pid=$!
  for _ in $(seq 100); do
    port=$(sed -n 's/.*target remote 127.0.0.1:\([0-9]*\).*/\1/p' "$name.err")
    [ -n "$port" ] && return
    sleep 0.05
  done
  echo "$name: fovea does not listen: $(cat "$name.err")"
  exit 1
}
# debug FILE: runs gdb with the commands of standard input, also behind a command that fails.
debug() {
  local commands=(-ex 'set pagination off' -ex 'set confirm off')
  commands+=(-ex "target remote 127.0.0.1:$port")
  while IFS= read -r line; do commands+=(-ex "$line"); done
  timeout --foreground 60 "$gdb" -nx -batch "${commands[@]}" "$1" >>"$name.gdb" 2>&1
}
# debug_until 'pattern' FILE: the same with Ctrl-C once fovea has said something of this pattern.
debug_until() {
  local commands=(-ex 'set pagination off' -ex 'set confirm off') debugger
  commands+=(-ex "target remote 127.0.0.1:$port")
  while IFS= read -r line; do commands+=(-ex "$line"); done
  # Shells start what runs in the background with SIGINT ignored.
  env --default-signal=INT "$gdb" -nx -batch "${commands[@]}" "$2" >>"$name.gdb" 2>&1 </dev/null &
  debugger=$!
  for _ in $(seq 600); do
    grep -qE -- "$1" "$name.err" "$name.out" && break
    sleep 0.1
  done
  sleep 0.5
  kill -INT $debugger
  wait $debugger
}
# end STATUS 'pattern'...: how fovea ends, and what gdb must have said.
end() {
  local want=$1 got missing=
  shift
  wait $pid
  got=$?
  [ $got = "$want" ] || fail "$name: exit status $got, expected $want: $(cat "$name.err")"
  for p in "$@"; do
    grep -qE -- "$p" "$name.gdb" || missing+=" '$p'"
  done
  [ -z "$missing" ] || fail "$name: no$missing in: $(cat "$name.gdb")"
}
