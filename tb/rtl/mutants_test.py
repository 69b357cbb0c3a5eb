#!/usr/bin/env python3
"""scripts/rtl-mutants: what is proven equivalent and what is not, and that weak tests are complained of."""
import contextlib
import importlib.machinery
import importlib.util
import io
import pathlib
import sys
import tempfile
import unittest
from unittest import mock

SCRIPT = str(pathlib.Path(sys.argv.pop(1)).resolve() / 'scripts/rtl-mutants')
loader = importlib.machinery.SourceFileLoader('rtl_mutants', SCRIPT)
script = importlib.util.module_from_spec(importlib.util.spec_from_loader('rtl_mutants', loader))
loader.exec_module(script)

# Bit 0 of `shifted` is 0, and `low` is k, whatever happens; `kept` is a module that is not looked into; `store` a memory.
DESIGN = """
module kept(input clk, input [3:0] a, output [3:0] y);
  reg [3:0] r;
  always @(posedge clk) r <= a;
  assign y = r;
endmodule
module top(input clk, input rst_n, input [3:0] a, input [3:0] b, output [3:0] y, output [3:0] z);
  reg [3:0] sum, last;
  reg [3:0] store [0:15];
  wire [3:0] shifted, k;
  (* keep *) wire [3:0] low;
  kept u_kept(.clk(clk), .a(a ^ b), .y(k));
  assign shifted = {a[2:0], 1'b0};
  assign low = (sum & a) > sum ? b : k;
  always @(posedge clk or negedge rst_n) if (!rst_n) sum <= 0; else sum <= shifted + b;
  always @(posedge clk) begin
    if (a[0]) store[a] <= sum;
    last <= store[b];
  end
  assign y = last | low;
  assign z = sum - k;
endmodule
"""


class Equivalence(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        (self.folder / 'design.sv').write_text(DESIGN)
        script.run(['yosys', '-q', '-p', 'read_verilog -sv design.sv; hierarchy -top top; proc; '
                    'setattr -mod -set keep_hierarchy 1 kept; flatten; memory -nomap; opt_clean; rename -enumerate -pattern '
                    'add_% t:$add; rename -enumerate -pattern gt_% t:$gt; rename -enumerate -pattern sub_% t:$sub; '
                    'rename -enumerate -pattern ff_% t:$adff; '
                    'write_rtlil flat.il'], self.folder)

    def proven(self, mode, cell, port, bit):
        place = f'mutate -mode {mode} -module top -cell {cell} -port {port} -portbit {bit}'
        return script.equivalent('top', place, self.folder)

    def test_what_makes_no_difference_is_proven(self):
        self.assertTrue(self.proven('const0', 'add_0', 'A', 0))
        self.assertTrue(self.proven('const0', 'gt_0', 'Y', 0))

    def test_what_makes_a_difference_is_not(self):
        self.assertFalse(self.proven('const1', 'add_0', 'A', 0))
        self.assertFalse(self.proven('const0', 'add_0', 'A', 1))
        self.assertFalse(self.proven('const1', 'gt_0', 'Y', 0))
        self.assertFalse(self.proven('const0', 'sub_0', 'B', 3))

    def test_what_goes_into_state_and_modules_counts(self):
        self.assertFalse(self.proven('inv', 'ff_0', 'D', 1))
        self.assertFalse(self.proven('inv', 'ff_0', 'ARST', 0))
        self.assertFalse(self.proven('inv', 'store', 'WR_DATA', 0))
        self.assertFalse(self.proven('const0', 'store', 'RD_ADDR', 3))
        self.assertFalse(self.proven('inv', 'u_kept', 'a', 1))
        self.assertFalse(self.proven('inv', 'u_kept', 'y', 1))


class Share(unittest.TestCase):
    """The script with tests and proofs that find what they are told to."""

    def run_script(self, killed, same=(), out=None, *arguments):
        self.tried = []

        def good(program, number, seconds):
            self.tried.append(number)
            return number == 0 or number not in killed

        def proof(top, place, folder, seconds=120):
            return int(place) in same
        out = out or self.enterContext(tempfile.TemporaryDirectory())
        text = io.StringIO()
        with mock.patch.object(script, 'netlist', lambda part, count, bits, folder: [str(n + 1) for n in range(count)]), \
                mock.patch.object(script, 'build', lambda part, folder: None), mock.patch.object(script, 'good', good), \
                mock.patch.object(script, 'equivalent', proof), contextlib.redirect_stdout(text), \
                contextlib.redirect_stderr(io.StringIO()), \
                mock.patch.object(sys, 'argv', ['rtl-mutants', 'addrgen', '--count', '40', '-o', out, *arguments]):
            return script.main(), text.getvalue()

    def test_weak_tests_are_complained_of(self):
        every = set(range(1, 21))
        self.assertEqual(self.run_script(every)[0], 0)
        self.assertEqual(self.run_script(every - {3})[0], 0)       # 95 %
        status, text = self.run_script(every - {3, 4})
        self.assertEqual(status, 1)
        self.assertIn('addrgen: survived: 3: 3\naddrgen: survived: 4: 4\n', text)
        self.assertIn('of 20 mutants 18 killed, 0 proven equivalent: 90.0 %', text)
        self.assertEqual(self.run_script(set())[0], 1)

    def test_what_is_proven_equivalent_counts_and_is_told_apart(self):
        status, text = self.run_script(set(range(3, 21)), {1})
        self.assertEqual(status, 0)
        self.assertIn('proven equivalent: 1: 1\n', text)
        self.assertIn('of 20 mutants 18 killed, 1 proven equivalent: 95.0 %', text)

    def test_a_run_is_continued(self):
        out = self.enterContext(tempfile.TemporaryDirectory())
        self.run_script(set(range(1, 11)), (), out, '--first', '10')
        status, text = self.run_script(set(range(2, 21)), (), out, '--continue')
        self.assertEqual(self.tried, [0, *range(11, 21)])
        self.assertIn('of 20 mutants 20 killed', text)
        self.run_script(set(range(1, 21)), (), out)
        self.assertEqual(len(self.tried), 21)
        with mock.patch.object(script, 'fingerprint', lambda part, places: 'other tests'):
            self.run_script(set(range(1, 21)), (), out, '--continue')
        self.assertEqual(len(self.tried), 21)


if __name__ == '__main__':
    unittest.main()
