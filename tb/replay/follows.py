#!/usr/bin/env python3
"""Replays with other settings against runs with these settings, for kernels that use the EDMA.

Usage: follows.py FOVEA SOURCE OUT [--kernel NAME]... [--setting NAME]... [--frames N]

Each kernel is recorded once, and for each setting replayed and run. Compared are the remaps that begin and end in the
window (of the run by its log of the phase pins, which is not the recorder's), and the mean latency of each master with
at least 1,000 requests. The clocks and timings that the firmware programs in the run are taken over from that run's own
trace. Prints a table.

A figure may differ by 1 % (a remap), by 5 % (a mean latency), and as recorded by 0.3 %. If it differs by more, the run
is made again with the phases of camera and display shifted: what the run itself does not keep under a shift, a replay need not know
better, so a figure within these bounds of any of the runs, or between them, is right as well. The least and the largest
of the runs are in the table. A master that makes more than a tenth more or fewer requests in a remap than in the
recorded run is not compared: the firmware takes another path there. As recorded the window has three times as many
frames, since a recording begins a little after the window of the run: when no transfer is under way.
"""
import argparse
import csv
import json
import pathlib
import re
import subprocess
import sys

KERNELS = ["copy", "staged", "gather", "runs"]
PORTS = ["arm_d", "arm_i", "edma_tc0", "edma_tc1", "edma_tc2", "edma_tc3"]


def all_ports(key, value, ports=PORTS):
    return [f"bus.{port}.{key}={value}" for port in ports]


SETTINGS = {
    "as recorded": [],
    "297/270": ["clocks.preset=297/270"],
    "216/172": ["clocks.preset=216/172", "clocks.arm=297MHz"],
    "432/340": ["clocks.preset=432/340", "clocks.arm=297MHz"],
    "frfcfs": ["ddr.scheduler=frfcfs"],
    "closed_page": ["ddr.scheduler=closed_page"],
    "fcfs": ["ddr.scheduler=fcfs"],
    "request_latency 16": ["ddr.request_latency=16cycles"],
    "latencies 0": ["ddr.request_latency=0cycles", "ddr.return_latency=0cycles"],
    "arm_d 6/6": ["bus.arm_d.request_latency=6cycles", "bus.arm_d.response_latency=6cycles"],
    "arm_d 1/1": ["bus.arm_d.request_latency=1cycles", "bus.arm_d.response_latency=1cycles"],
    "edma 6/6": all_ports("request_latency", "6cycles", PORTS[2:]) + all_ports("response_latency", "6cycles", PORTS[2:]),
    "arm_d 64 bit": ["bus.arm_d.width=64bit"],
    "vpbe 12/12": ["bus.vpbe.request_latency=12cycles", "bus.vpbe.response_latency=12cycles"],
    "command FIFO 2": ["ddr.command_fifo=2"],
}
# The firmware programs the clocks and with them the timings: a replay takes them from the run's trace.
PROGRAMMED = {"297/270", "216/172", "432/340"}
# Of the camera, and of all that the firmware starts (the display too) against the refreshes, for the runs that show how
# much a figure varies by itself.
SHIFTS = [["tvp5146.phase=3300us", "psc.transition_time=1310ns"], ["tvp5146.phase=7100us", "psc.transition_time=2170ns"],
          ["tvp5146.phase=13700us", "psc.transition_time=3730ns"]]
# model/contract/phases.h: the low bits of the phase pins
PHASE, REMAP_START, REMAP_END = 15, 4, 5
BOUNDS = {"remap": 0.01, "latency": 0.05, "as recorded": 0.003}


def sets(settings):
    return [word for s in settings for word in ("-s", s)]


def parameters(folder):
    rows = json.loads((folder / "config.json").read_text())["params"]
    return {key: row["value"] for key, row in rows.items()}


def mean(values):
    return sum(values) / len(values) if values else None


def remaps_of_run(folder, start_ns):
    """Lengths in seconds, of those that begin in the window."""
    out, begun = [], None
    for line in (folder / "registers.log").read_text().splitlines():
        found = re.match(r"([0-9.]+) ns .* wrote gpio\.OUT_DATA45 = (0x[0-9a-f]+)", line)
        if not found:
            continue
        at, phase = float(found[1]), int(found[2], 16) & PHASE
        if phase == REMAP_START and at >= start_ns:
            begun = at
        elif phase == REMAP_END and begun is not None:
            out.append((at - begun) * 1e-9)
            begun = None
    return out


class Bench:
    def __init__(self, fovea, source, out, frames):
        self.fovea, self.out, self.frames = fovea, out, frames
        self.experiment = source / "scripts/experiments/throughput.yaml"

    def call(self, *words):
        done = subprocess.run([self.fovea, *map(str, words)], capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"follows.py: {' '.join(map(str, words))}: status {done.returncode}: {done.stderr.strip()}")

    def run(self, kernel, settings, name, times=1):
        folder, trace = self.out / name, self.out / f"{name}.trace"
        self.call("run", self.experiment, "-s", f"firmware.kernel={kernel}", "-s", "firmware.lut=fixed_point", "-s",
                  f"run.frames={times * self.frames}", *sets(settings), "--no-frames", "--bus-trace", trace,
                  "--log-registers", r"gpio\..*", "--log-registers-kept", "1000000", "-o", folder)
        return folder, trace

    def replay(self, trace, settings, name):
        folder = self.out / name
        self.call("replay", trace, *sets(settings), "-o", folder)
        return folder

    def settings_of_run(self, trace, settings, recorded, name):
        """What a replay is given in place of the presets that the firmware programs."""
        programmed = parameters(self.replay(trace, [], f"{name}.other"))
        return settings + [f"{key}={value.replace(chr(32), str())}" for key, value in programmed.items()
                           if recorded.get(key) != value]


class Figures:
    """Of a run or a replay: remap and mean latencies in seconds, requests of each master in a remap."""

    def __init__(self, folder, start_ns=None):
        stats = {k: v["value"] for k, v in json.loads((folder / "stats.json").read_text()).items()
                 if isinstance(v, dict) and "value" in v}
        if start_ns is None:
            self.means, self.remaps = {"remap": stats.get("frame.remap_time.mean")}, stats.get("frame.remapped", 0)
        else:
            remaps = remaps_of_run(folder, start_ns)
            self.means, self.remaps = {"remap": mean(remaps)}, len(remaps)
        self.requests = {}
        with open(folder / "latency.csv", newline="") as f:
            for row in csv.DictReader(f):
                if (row["direction"], row["beat"]) in (("read", "first"), ("write", "last")):
                    self.requests[row["master"]] = self.requests.get(row["master"], 0) + int(row["count"])
        for master in [*PORTS, "vpbe", "vpfe"]:
            latency = stats.get(f"ddr.{master}.latency.mean")  # of reads: a camera has none
            if self.requests.get(master, 0) >= 1000 and latency is not None:
                self.means[f"ddr.{master}.latency.mean"] = latency

    def per_remap(self, master):
        return self.requests.get(master, 0) / max(self.remaps, 1)


def window_start(folder):
    """Of a replay, in ns: where its trace begins."""
    with open(folder / "timeline.csv", newline="") as f:
        return float(next(csv.DictReader(f))["start_ns"])


def another_path(figure, run, replayed):
    if figure == "remap":
        return False
    master = figure.split(".")[1]
    before, now = replayed.per_remap(master), run.per_remap(master)
    return master.startswith("arm") and abs(now - before) > 0.1 * before


class Table:
    def __init__(self):
        self.out = csv.writer(sys.stdout)
        self.out.writerow(["kernel", "setting", "figure", "run", "replay", "difference_percent", "least_run",
                           "largest_run", "verdict"])
        self.failures = []

    def add(self, kernel, setting, figure, runs, got, verdict):
        real = runs[0]
        percent = f"{100 * (got / real - 1):+.2f}" if got is not None else ""
        self.out.writerow([kernel, setting, figure, f"{real:.6g}", "absent" if got is None else f"{got:.6g}", percent,
                           f"{min(runs):.6g}", f"{max(runs):.6g}", verdict])
        sys.stdout.flush()
        if verdict == "wrong":
            self.failures.append(f"{kernel}, {setting}: {figure} {percent or 'absent'} %")


def within(got, runs, bound):
    return got is not None and min(runs) * (1 - bound) <= got <= max(runs) * (1 + bound)


def compare(bench, table, kernel, setting, recorded, trace):
    settings = SETTINGS[setting]
    folder, other = bench.run(kernel, settings, f"{kernel}.run", 1 if settings else 3)
    if not settings:
        trace = other
    given = bench.settings_of_run(other, [], recorded, kernel) if setting in PROGRAMMED else settings
    replay_folder = bench.replay(trace, given, f"{kernel}.replay")
    start = window_start(bench.replay(other, [], f"{kernel}.other"))
    run, replayed = Figures(folder, start), Figures(replay_folder)
    shifted = None
    for figure, real in run.means.items():
        got, runs = replayed.means.get(figure), [real]
        if another_path(figure, run, replayed):
            table.add(kernel, setting, figure, runs, got, "another path")
            continue
        bound = BOUNDS["as recorded"] if not settings else BOUNDS["remap" if figure == "remap" else "latency"]
        if not within(got, runs, bound) and settings:
            if shifted is None:
                shifted = []
                for shift in SHIFTS:
                    again, its_trace = bench.run(kernel, settings + shift, f"{kernel}.shifted")
                    shifted.append(Figures(again, window_start(bench.replay(its_trace, [], f"{kernel}.other"))))
            runs += [f.means[figure] for f in shifted if f.means.get(figure) is not None]
        table.add(kernel, setting, figure, runs, got, "right" if within(got, runs, bound) else "wrong")


def main():
    args = argparse.ArgumentParser()
    args.add_argument("fovea")
    args.add_argument("source", type=pathlib.Path)
    args.add_argument("out", type=pathlib.Path)
    args.add_argument("--kernel", action="append")
    args.add_argument("--setting", action="append")
    args.add_argument("--frames", type=int, default=3)
    args = args.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    bench = Bench(args.fovea, args.source, args.out, args.frames)
    table = Table()
    for kernel in args.kernel or KERNELS:
        _, trace = bench.run(kernel, [], f"{kernel}.recorded")
        recorded = parameters(bench.replay(trace, [], f"{kernel}.same"))
        for setting in args.setting or SETTINGS:
            compare(bench, table, kernel, setting, recorded, trace)
    print(*table.failures, f"{len(table.failures)} failures", sep="\n")
    return 1 if table.failures else 0


if __name__ == "__main__":
    sys.exit(main())
