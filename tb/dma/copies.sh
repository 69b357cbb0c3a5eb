#!/usr/bin/env bash
# How long the EDMA copies, against a sum of documented steps: commands x latency where one command is under way, the
# data bus where there are several. Within 5 %, with three burst sizes, three latencies of the bridge, two clocks.
# Usage: copies.sh FOVEA PROGRAM OUT
set -uo pipefail
fovea=$1 program=$2 out=$3
rm -rf "$out"
mkdir -p "$out"

# Columns: burst, reads and writes under way, bridge (crossbar clocks each way), ARM MHz, SDRAM MHz, name, bytes, ticks.
measure() {
  local burst outstanding bridge clocks
  while read -r burst outstanding bridge clocks; do
    timeout 60 "$fovea" exec --board -q "$program" -s clocks.preset="$clocks" -s edma.tc.burst="${burst}B" \
      -s edma.tc.outstanding="$outstanding" -s bus.edma_tc0.request_latency="${bridge}cycles" \
      -s bus.edma_tc0.response_latency="${bridge}cycles" >"$out/lines" || { echo "status $?" >&2; return 1; }
    sed "s,^,$burst $outstanding $bridge ${clocks/\// } ," "$out/lines"
  done
}

# The steps, in SDRAM clocks, two of which are one of the crossbar. d: bytes of a command. JESD79-2, with what the boot
# code programs: CL 5, write latency CL - 1, tWTR 7.5 ns, BL8 = 4 clocks for 16 bytes, refresh each 7.8 us.
# One command under way, from SDRAM to SDRAM: when the data of a read are there, the write and the next read are put on
# their ports together. The crossbar serves the write first, as the read had the last turn; it is granted after the
# bridge and occupies the crossbar for d / 8 clocks (8 bytes wide). The controller sees it a clock and
# ddr.request_latency (8) later. The read, a crossbar clock behind, finds the SDRAM turned to writing: RD comes write
# latency + 4 + tWTR behind the last WR. Its data take the read latency (5), d / 4 clocks, ddr.return_latency (2), the
# next edge of the crossbar and the bridge.
# One command under way, from internal RAM: bridge, grant, `cpu.tcm.dma_latency` (2) and `cpu.tcm.dma_word_clocks` (2)
# for each word in core clocks, bridge.
# Several, from SDRAM to SDRAM: the write FIFO (88 bytes) takes 64 bytes in bursts of 32 or 64, so the data bus carries
# 64 bytes each way and turns twice: CL + 4 + 1 - WL clocks from RD to WR in place of 4, WL + 4 + tWTR from WR to RD.
# Several, from internal RAM: its port alone.
explain() {  # FACTOR on what was measured
  awk -v factor="$1" '
    function up(x) { return x == int(x) ? x : int(x) + 1 }
    {
      d = $1; several = $2 > 1; bridge = $3; arm = $4; ddr = $5; name = $6; bytes = $7; us = factor * $8 / 24
      CL = 5; WL = 4; RL = 5; wtr = up(0.0075 * ddr)
      # A refresh: 127.5 ns (1 Gbit), and twice in 13 intervals PREA (tRP + 1) and ACT to RD (tRCD) for several.
      left = 1 - (up(0.1275 * ddr) + 2 / 13 * (2 * up(0.0125 * ddr) + 3)) / (7.8 * ddr)
      if (name == "ddr_to_ddr" && !several) {
        clocks = 2 * (1 + bridge + d / 8) + 1 + 8 + 4 * (d / 16 - 1) + WL + 4 + wtr + RL + d / 4 + 2
        clocks = (2 * up(clocks / 2) + 2 * bridge) / left
      } else if (name == "ddr_to_ddr")
        clocks = (2 * 16 + (CL + 1 - WL) + (WL + wtr)) * d / 64 / left
      else {
        clocks = (2 + 2 * d / 4) * ddr / arm
        if (!several) clocks += 2 * (1 + bridge + 1 + bridge)
      }
      want = bytes / d * clocks / ddr
      off = us / want - 1
      rate = bytes / us
      verdict = off > 0.05 || off < -0.05 ? "NOT EXPLAINED" : "explained"
      if (name == "ddr_to_ddr" && rate > 2 * ddr) verdict = "FASTER THAN THE SDRAM COPIES AT MOST"
      printf "%-10s %2d B, %d under way, bridge %2d, %d/%d: %6.1f MB/s, %6.1f ns a command, by the steps %6.1f: %+.1f %% %s\n",
             name, d, $2, bridge, arm, ddr, rate, 1e3 * us * d / bytes, 1e3 * want * d / bytes, 100 * off, verdict
      n++
      bad += verdict != "explained"
    }
    END { exit bad || n < 36 }'
}
{
  for clocks in 297/243 432/340; do
    for burst in 16 32 64; do
      for bridge in 0 2 16; do echo "$burst 1 $bridge $clocks"; done
    done
    echo "32 4 2 $clocks"
    echo "64 4 2 $clocks"
  done
} | measure >"$out/measured" || exit 1
[ "$(wc -l <"$out/measured")" = 44 ] || { echo "not all was measured"; exit 1; }
explain 1 <"$out/measured" || exit 1
# The comparison complains of a tenth more or less, of a copy at twice the bus's rate, and of what is missing.
for factor in 0.9 1.1; do
  explain $factor <"$out/measured" >"$out/other" && { echo "a factor of $factor is not seen"; exit 1; }
done
explain 0.5 <"$out/measured" >"$out/other"
grep -q 'FASTER THAN' "$out/other" || { echo 'too fast a copy is not seen'; exit 1; }
head -5 "$out/measured" | explain 1 >"$out/other" && { echo 'missing measurements are not seen'; exit 1; }
exit 0
