#!/usr/bin/env bash
# scripts/synth: what it counts, of a circuit whose cells are known by construction, and what it refuses.
# Usage: synth.sh SOURCE OUT
set -uo pipefail
synth=$1/scripts/synth out=$2
rm -rf "$out"
mkdir -p "$out"
cd "$out" || exit 1
cat >known.sv <<'V'
// 13 flip-flops, a multiplier, a memory of 16 Kibit, and a look-up table at least.
module known (input logic clk_i, input logic [15:0] a_i, b_i, input logic [8:0] at_i, input logic write_i,
              output logic [31:0] product_o, output logic [31:0] word_o, output logic [12:0] count_o);
  logic [31:0] memory[512];
  assign product_o = a_i * b_i;
  always_ff @(posedge clk_i) begin
    count_o <= count_o + 13'd1;
    if (write_i) memory[at_i] <= {16'b0, a_i};
    word_o <= memory[at_i];
  end
endmodule
V
failures=0
fail() {
  echo "$*"
  failures=$((failures + 1))
}
"$synth" --source known.sv --module known --family xc6s >known.out 2>known.err || fail "status $?: $(cat known.err)"
# | module | family | cells | LUT | FF | BRAM | LUT-RAM | DSP | carry | other | unmapped |
row=$(grep '^| `known` | xc6s |' known.out | tr -d ' `')
IFS='|' read -r _ _ _ cells lut ff bram lutram dsp carry other unmapped _ <<<"$row"
[ "$ff" = 13 ] && [ "$dsp" = 1 ] && [ "$bram" = 1 ] && [ "$lutram" = 0 ] && [ "$unmapped" = 0 ] || fail "counts: $row"
[ "$((lut + ff + bram + lutram + dsp + carry + other + unmapped))" = "$cells" ] || fail "the kinds are not all cells: $row"
refused() { # STATUS TEXT ARGUMENTS...
  local status=$1 text=$2
  shift 2
  "$synth" "$@" >refused.out 2>refused.err
  [ $? = "$status" ] || fail "$*: not status $status: $(cat refused.err)"
  grep -q -- "$text" refused.err || fail "$*: $(cat refused.err)"
}
refused 2 'yosys: ERROR: Module .absent. not found' --source known.sv --module absent --family xc6s
refused 2 'for the whole table' --check --module known
refused 2 'invalid choice' --family stratix
env PATH="$PWD" "$(python3 -c 'import sys; print(sys.executable)')" "$synth" --source known.sv --module known >refused.out 2>refused.err
[ $? = 2 ] && grep -q 'yosys is missing' refused.err || fail "a missing yosys: $(cat refused.err)"
[ "$failures" = 0 ] && echo "counts and refusals: good"
exit "$((failures != 0))"
