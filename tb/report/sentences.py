#!/usr/bin/env python3
"""Each sentence of `fovea report --text` that gives a share or a time, worked out again from the tables of the run:
from frames.csv, stalls.csv and the trace of the SDRAM's commands, not from the figures that the sentence rests on.
Usage: sentences.py FOVEA OUT EXPERIMENT [-s KEY=VALUE ...]"""
import csv
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

fovea, out, experiment, *options = sys.argv[1:]
out = Path(out)
shutil.rmtree(out, ignore_errors=True)
out.mkdir(parents=True)
subprocess.run([fovea, "run", experiment, "--no-frames", "--command-trace", str(out / "commands.csv"), *options, "-o",
                str(out / "run")], check=True, capture_output=True)
text = subprocess.run([fovea, "report", "--text", str(out / "run")], check=True, capture_output=True, text=True).stdout
stats = {k: v["value"] for k, v in json.loads((out / "run/stats.json").read_text()).items() if isinstance(v, dict)}
rows = lambda name: list(csv.DictReader(open(out / "run" / name, newline="")))
failures, compared = 0, 0


def close(said, number, unit, what):
    """What is said has three digits, or one behind the point."""
    global failures, compared
    compared += 1
    digits = len(said.split(".")[1]) if "." in said else 0
    if abs(float(said) - number) > 0.51 * 10 ** -digits:
        failures += 1
        print(f"{what}: said {said} {unit}, worked out {number}")


def find(pattern):
    global failures
    found = re.search(pattern, text)
    if not found:
        failures += 1
        print(f"no sentence '{pattern}' in:\n{text}")
    return found


frames = [f for f in rows("frames.csv") if f["repeated"] == "0"]
ms = lambda f, a, b: (float(f[b]) - float(f[a])) * 1e-6
mean = lambda values: sum(values) / len(values)
steps = ["capture_start_ns", "capture_end_ns", "remap_start_ns", "remap_end_ns", "display_start_ns"]
whole = [f for f in frames if all(f[s] for s in steps)]
if said := find(r"displayed one ([\d.]+) ms pass on average: ([\d.]+) (ms|us) of capture, "
                r"([\d.]+) (ms|us) until the remap begins, ([\d.]+) ms of remap, and ([\d.]+) ms until"):
    close(said[1], mean([ms(f, steps[0], steps[4]) for f in whole]), "ms", "latency")
    for value, unit, k in ((said[2], said[3], 0), (said[4], said[5], 1), (said[6], "ms", 2), (said[7], "ms", 3)):
        scale = 1e3 if unit == "us" else 1
        close(value, mean([ms(f, steps[k], steps[k + 1]) for f in whole]) * scale, unit, steps[k + 1])
starts = sorted(float(f["display_start_ns"]) for f in rows("frames.csv"))
if said := find(r"and a frame comes every ([\d.]+) ms: ([\d.]+) % of the time is used and ([\d.]+) ms are left"):
    period = (starts[-1] - starts[0]) * 1e-6 / (len(starts) - 1)
    close(said[1], period, "ms", "period")
    # The window's remaps are not those of its frames: the first was made before it began.
    remap = mean([ms(f, "remap_start_ns", "remap_end_ns") for f in whole])
    if abs(float(said[2]) - 100 * remap / period) > 1:
        failures += 1
        print(f"budget: said {said[2]} %, the frames' remaps take {100 * remap / period}")
    compared += 1

waits, by_region, others = {}, {}, 0
for r in rows("stalls.csv"):
    n = int(r["cycles"])
    waits[r["cause"]] = waits.get(r["cause"], 0) + n
    by_region[(r["cause"], r["region"])] = by_region.get((r["cause"], r["region"]), 0) + n
    others += n if r["culprit"].startswith(("edma", "vp", "remap_engine", "load")) else 0
awake = sum(waits.values()) + stats["cpu.issue"]
words = {"dcache": "D-cache line fills", "write_buffer": "room in the write buffer"}
cause = max(waits, key=waits.get)
if said := find(r"Largest wait: in ([\d.]+) % of the clocks in which it is awake, the core waits for (.*?) \("):
    close(said[1], 100 * waits[cause] / awake, "%", "largest wait")
    if words.get(cause) != said[2]:
        failures += 1
        print(f"largest wait: said '{said[2]}', it is {cause}")
if said := re.search(r"By what is accessed: (.*?)\. It issues instructions in ([\d.]+) %", text):
    for name, share in re.findall(r"([\w.]+) \(([\d.]+) %\)", said[1]):
        close(share, 100 * by_region[(cause, name)] / waits[cause], "%", name)
    close(said[2], 100 * stats["cpu.issue"] / awake, "%", "issue")
if said := find(r"while other masters are served adds ([\d.]+) % to the core's awake clocks"):
    close(said[1], 100 * others / awake, "%", "other masters")

columns = sum(1 for line in open(out / "commands.csv") if line.split(",")[1] in ("RD", "WR", "RDA", "WRA"))
if said := find(r"The SDRAM's data bus moves data in ([\d.]+) % of the time"):
    close(said[1], 100 * columns * 4 / (stats["frame.window"] * 243e6), "%", "SDRAM in use")
print(f"{compared} numbers of sentences compared, {failures} failures")
sys.exit(failures > 0 or compared < 10)
