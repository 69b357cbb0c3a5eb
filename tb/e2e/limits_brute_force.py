#!/usr/bin/env python3
"""The answers of `fovea limits` by brute force. --find: every value of the range is run by itself, for 24
frames, and judged by this program's own rule from frames.csv; the answer is the edge that these values have. --binds:
every line is run by itself with only that changed, by this program's own table; so are both ends of what is believed.

Usage: limits_brute_force.py FOVEA SOURCE OUT [EXPERIMENT...]
"""
import csv
import json
import os
import shutil
import subprocess
import sys

FOVEA, SOURCE, OUT = (os.path.abspath(a) for a in sys.argv[1:4])
ONLY = sys.argv[4:]
BINDS = 0.02
FRAMES = 24
BEHIND_NS = 0.5e6  # in half of these frames; a remap that takes 0.3 % more than 40 ms falls back by 1.4 ms
SAME = 1e-9  # of two runs with equal settings, written in other words
failures = []

# Experiment: settings, and questions: key, values, further conditions of the command, and the rate of new frames that
# they stand for.
FINDS = {
    "paper-pal": (["run.frames=3", "firmware.lut=fixed_point"], [
        ("clocks.ddr", [f"{mhz}MHz" for mhz in range(156, 173)], "1MHz", None),
        ("bus.arm_d.response_latency", [f"{n}cycles" for n in range(7, 13)], "1cycles", None)]),
    "default": (["run.frames=3"], [
        ("firmware.repeat", [str(n) for n in range(8, 16)], "1", None),
        ("clocks.arm", [f"{mhz}MHz" for mhz in range(126, 181, 9)], "9MHz", None)]),
    "four-cameras": (["run.frames=6"], [
        ("cameras.count", [str(n) for n in range(1, 9)], "1", 6),
        ("firmware.repeat", [str(n) for n in range(4, 10)], "1", None)]),
}
# Further settings of a question, by experiment and key.
WITH = {("default", "clocks.arm"): ["firmware.repeat=6"], ("four-cameras", "cameras.count"): ["run.frames=12"]}

# Resource: what is changed, and the ends of what is believed of it, typed in apart from the program's tables.
ROWS = {
    "core_clock": (["clocks.arm=432MHz"], None),
    "pll1_clocks": (["clocks.ddr=340MHz"], None),
    "sdram_clock": (["clocks.ddr=340MHz", "clocks.crossbar=121500000Hz"], None),
    "crossbar_clock": (["clocks.crossbar=170MHz"], None),
    "ahb_clock": (["cpu.ahb_ratio=1"], [["cpu.ahb_ratio=1"], ["cpu.ahb_ratio=3"]]),
    "dcache": (["cpu.dcache.size=128KiB"], [["cpu.dcache.size=8KiB"]] * 2),
    "icache": (["cpu.icache.size=128KiB"], [["cpu.icache.size=16KiB"]] * 2),
    "row_timing": (["ddr.ideal=row_timing"], None),
    "cas_latency": (["ddr.ideal=cas_latency"], None),
    "turnaround": (["ddr.ideal=turnaround"], None),
    "refresh": (["ddr.ideal=refresh"], None),
    "ddr_scheduler": (["ddr.scheduler=frfcfs"], None),
    "bridge_arm_d": (["bus.arm_d.request_latency=0 cycles", "bus.arm_d.response_latency=0 cycles"],
                     [[f"bus.arm_d.request_latency={n} cycles", f"bus.arm_d.response_latency={n} cycles"]
                      for n in (2, 6)]),
    "bridge_arm_i": (["bus.arm_i.request_latency=0 cycles", "bus.arm_i.response_latency=0 cycles"],
                     [[f"bus.arm_i.request_latency={n} cycles", f"bus.arm_i.response_latency={n} cycles"]
                      for n in (2, 6)]),
    "bridge_vpfe": (["bus.vpfe.request_latency=0 cycles", "bus.vpfe.response_latency=0 cycles"],
                    [[f"bus.vpfe.request_latency={n} cycles", f"bus.vpfe.response_latency={n} cycles"]
                     for n in (1, 4)]),
    "bridge_vpbe": (["bus.vpbe.request_latency=0 cycles", "bus.vpbe.response_latency=0 cycles"],
                    [[f"bus.vpbe.request_latency={n} cycles", f"bus.vpbe.response_latency={n} cycles"]
                     for n in (1, 4)]),
    "width_arm_d": (["bus.arm_d.width=64bit"], [["bus.arm_d.width=32bit"], ["bus.arm_d.width=64bit"]]),
    "buffer_vpfe": (["vpss.write_buffer_bursts=32"],
                    [["vpss.write_buffer_bursts=2"], ["vpss.write_buffer_bursts=8"]]),
    "buffer_vpbe": (["vpss.read_ahead_lines=4", "vpss.read_outstanding=16"],
                    [["vpss.read_ahead_lines=1", "vpss.read_outstanding=1"],
                     ["vpss.read_ahead_lines=2", "vpss.read_outstanding=8"]]),
    "edma_depth": (["edma.tc.outstanding=16"], [["edma.tc.outstanding=2"], ["edma.tc.outstanding=16"]]),
    "edma_start": (["edma.request_clocks=1", "edma.event_clocks=1", "edma.completion_clocks=1"],
                   [["edma.request_clocks=4", "edma.event_clocks=1", "edma.completion_clocks=1"],
                    ["edma.request_clocks=24", "edma.event_clocks=8", "edma.completion_clocks=8"]]),
    "config_bus": (["bus.config.fast_latency=1ns", "bus.config.slow_latency=1ns"],
                   [["bus.config.fast_latency=30ns", "bus.config.slow_latency=100ns"],
                    ["bus.config.fast_latency=400ns", "bus.config.slow_latency=1us"]]),
    "ddr_latency": (["ddr.request_latency=0 cycles", "ddr.return_latency=0 cycles"],
                    [["ddr.request_latency=6 cycles", "ddr.return_latency=1 cycles"],
                     ["ddr.request_latency=10 cycles", "ddr.return_latency=4 cycles"]]),
    "ddr_queues": (["ddr.command_fifo=16", "ddr.read_fifo=512B", "ddr.write_fifo=512B"],
                   [["ddr.command_fifo=7", "ddr.read_fifo=136B", "ddr.write_fifo=88B"]] * 2),
}
for master in ("arm", "vpfe", "vpbe", "edma", "edma_tc0", "edma_tc1", "edma_tc2", "edma_tc3", "remap_engine", "load"):
    ROWS["priority_" + master] = ([f"priority.{master}=0"], None)


def fail(text):
    failures.append(text)
    print("FAILED", text, flush=True)


def run(experiment, settings, name):
    """Figures and rows of frames.csv."""
    folder = os.path.join(OUT, "runs", experiment, name.replace("/", "_").replace(" ", ""))
    if not os.path.exists(os.path.join(folder, "stats.json")):
        command = [FOVEA, "run", f"{SOURCE}/scripts/experiments/{experiment}.yaml", "--no-frames", "-o", folder]
        for s in settings:
            command += ["-s", s]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"{' '.join(command)}: status {done.returncode}: {done.stderr[-500:]}")
    with open(os.path.join(folder, "stats.json")) as f:
        stats = {k: v["value"] for k, v in json.load(f).items() if isinstance(v, dict) and "value" in v}
    with open(os.path.join(folder, "frames.csv"), newline="") as f:
        return stats, list(csv.DictReader(f))


def limits(experiment, settings, name, options):
    out = os.path.join(OUT, name)
    command = [FOVEA, "limits", f"{SOURCE}/scripts/experiments/{experiment}.yaml", "-j", "1", "-o", out] + options
    for s in settings:
        command += ["-s", s]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}: status {done.returncode}: {done.stderr[-500:]}")
    print(done.stdout, flush=True)
    return out


def keeps_up(stats, rows, rate):
    """In a long window: nothing lost, no frame shown twice but by one slip or for the decoder's sake, and a loop that
    does not fall behind: the time from a frame's capture to the end of its remap does not grow in the second half."""
    lost = sum(stats.get(k, 0) for k in ("frame.dropped", "capture.overflows", "display.underflows"))
    again = sum(int(r["repeated"]) for r in rows) - stats.get("frame.repeated_relock", 0)
    lag = [float(r["remap_end_ns"]) - float(r["capture_end_ns"]) for r in rows
           if r["repeated"] == "0" and r["remap_end_ns"]]
    half = lag[len(lag) // 2:]
    behind = len(half) > 4 and sum(half[-2:]) / 2 - sum(half[:2]) / 2 > BEHIND_NS
    enough = rate is None or all(v >= rate for k, v in stats.items()
                                 if k.endswith(".frame.rate") or k == "frame.rate")
    return lost == 0 and again <= 1 and not behind and enough


def find(experiment, settings, key, values, step, rate):
    settings = settings + WITH.get((experiment, key), [])
    frames = next(int(s.split("=")[1]) for s in reversed(settings) if s.startswith("run.frames="))
    window = frames if rate else FRAMES  # a rate depends on where the window ends
    good = [keeps_up(*run(experiment, settings + [f"run.frames={window}", f"{key}={v}"], f"{key}={v}"), rate)
            for v in values]
    print(experiment, key, " ".join(v + ("+" if g else "-") for v, g in zip(values, good)), flush=True)
    if all(good) or not any(good):
        return fail(f"{experiment} {key}: the range has no edge")
    up = good[0]
    edge = good.index(False) - 1 if up else len(good) - good[::-1].index(False)
    more = ["--require", f"frame.rate>={rate}"] if rate else []
    out = limits(experiment, settings, f"find-{experiment}-{key}",
                 ["--find", f"{key}={values[0]}..{values[-1]}:{step}"] + more)
    with open(os.path.join(out, "limits.csv"), newline="") as f:
        row = next(csv.DictReader(f))
    same = lambda a, b: a.replace(" ", "") == b.replace(" ", "")
    word = "largest" if up else "smallest"
    if row["answer"] != word or not same(row["good"], values[edge]):
        fail(f"{experiment} {key}: the command answers '{row['answer']}' '{row['good']}', all values say {word} "
             f"{values[edge]}")
    alternates = sum(a != b for a, b in zip(good, good[1:])) > 1
    if alternates and row["monotonic"] == "yes":
        print(f"note: {experiment} {key}: good and bad values alternate, and the values that were tried do not show it")
    if not alternates and row["monotonic"] == "no":
        fail(f"{experiment} {key}: not monotonic, says the command; by all values it is")


def binds(experiment, settings):
    metric = "frame.remap_time.mean"
    settings = [s for s in settings if not s.startswith("run.frames=")] + ["run.frames=1"]
    out = limits(experiment, settings, f"binds-{experiment}", ["--binds", metric])
    figure = lambda name, more: run(experiment, settings + more, "binds-" + name)[0].get(metric)  # None: no remap in it
    plain = figure("plain", [])
    with open(os.path.join(out, "binds.csv"), newline="") as f:
        rows = list(csv.DictReader(f))
    tried = 0
    for row in rows:
        name = row["resource"]
        if row["by"] == "replay":
            if row["gain"] and abs(float(row["reference"]) / plain - 1) > 0.003:
                fail(f"{experiment} {name}: by a replay that does not follow its run")
            continue
        if not row["gain"]:
            if row["remark"] not in ("no traffic", "it is so already",
                                     "the PLLs give no higher one beside the other clock"):
                fail(f"{experiment} {name}: {row['remark']}")
            continue
        if name not in ROWS:
            fail(f"{experiment} {name}: not in the table of this test")
            continue
        tried += 1
        changed, ends = ROWS[name]
        relaxed = figure(name, changed)
        gain = 1 - relaxed / plain
        expect(experiment, name, row["relaxed"], relaxed)
        expect(experiment, name, row["gain"], gain, 1)
        gains = [gain]
        for end, column in zip(ends or [], ("low", "high")):
            at = figure(f"{name}-{column}", end)
            expect(experiment, f"{name} {column}", row["plain_" + column], at)
            expect(experiment, f"{name} {column}", row["gain_" + column], None if at is None else 1 - relaxed / at, 1)
            if at is not None:
                gains.append(1 - relaxed / at)
        if bool(ends) != (row["origin"] in ("assumed", "family")):
            fail(f"{experiment} {name}: the origin is {row['origin']}")
        word = "yes" if gain > BINDS else "perhaps" if max(gains) > BINDS else "no"
        if row["binds"] != word:
            fail(f"{experiment} {name}: '{row['binds']}', by runs '{word}'")
    print(f"{experiment}: {tried} lines of --binds run again", flush=True)
    if tried < 12:
        fail(f"{experiment}: {tried} lines")
    # A figure that is better with refresh than without has its reason: more requests find another row open.
    if next(float(r["gain"]) for r in rows if r["resource"] == "refresh") < 0:
        conflicts = [run(experiment, settings + more, name)[0]["ddr.row_conflicts"]
                     for name, more in (("binds-plain", []), ("binds-refresh", ROWS["refresh"][0]))]
        if not conflicts[0] < conflicts[1]:
            fail(f"{experiment}: slower without refresh, and {conflicts} row conflicts with and without it")
    clocks = {r["resource"]: float(r["gain"]) for r in rows if r["resource"].endswith(("_clock", "_clocks"))}
    # What is raised together gains about what both gain apart: neither of the two is counted twice or forgotten.
    apart = 1 - (1 - clocks["sdram_clock"]) * (1 - clocks["crossbar_clock"])
    if abs(clocks["pll1_clocks"] - apart) > 0.05:
        fail(f"{experiment}: SDRAM {clocks['sdram_clock']}, crossbar {clocks['crossbar_clock']}, both "
             f"{clocks['pll1_clocks']}")


def expect(experiment, what, text, value, scale=None):
    if value is None:
        if text:
            fail(f"{experiment} {what}: '{text}', and a run has no such figure")
    elif not text or abs(float(text) - value) > SAME * (scale or abs(value)):
        fail(f"{experiment} {what}: '{text}', by a run {value}")


shutil.rmtree(OUT, ignore_errors=True)
os.makedirs(OUT)
for experiment, (settings, questions) in FINDS.items():
    if ONLY and experiment not in ONLY:
        continue
    for question in questions:
        find(experiment, settings, *question)
    binds(experiment, settings)
print(f"{len(failures)} failures")
sys.exit(1 if failures else 0)
