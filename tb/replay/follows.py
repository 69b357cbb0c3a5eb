#!/usr/bin/env python3
"""Replays with other settings against runs with these settings, for kernels that use the EDMA.

Usage: follows.py FOVEA SOURCE OUT [--kernel NAME]... [--setting NAME]... [--frames N]

Each kernel is recorded once, and for each setting replayed and run. Compared are the remap time and the mean latency
of each master with at least 1,000 requests. The clocks and timings that the firmware programs in the run are taken
over from that run's own trace. Prints a table; the status is 1 if a remap differs by more than 1 %, or a mean by more
than 5 %; as recorded, by more than 0.3 %.
"""
import argparse
import csv
import json
import pathlib
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


def sets(settings):
    return [word for s in settings for word in ("-s", s)]


class Bench:
    def __init__(self, fovea, source, out, frames):
        self.fovea, self.out, self.frames = fovea, out, frames
        self.experiment = source / "scripts/experiments/throughput.yaml"

    def call(self, *words):
        done = subprocess.run([self.fovea, *map(str, words)], capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"follows.py: {' '.join(map(str, words))}: status {done.returncode}: {done.stderr.strip()}")

    def run(self, kernel, settings, name):
        folder, trace = self.out / name, self.out / f"{name}.trace"
        self.call("run", self.experiment, "-s", f"firmware.kernel={kernel}", "-s", "firmware.lut=fixed_point", "-s",
                  f"run.frames={self.frames}", *sets(settings), "--no-frames", "--bus-trace", trace, "-o", folder)
        return folder, trace

    def replay(self, trace, settings, name):
        folder = self.out / name
        self.call("replay", trace, *sets(settings), "-o", folder)
        return folder


def figures(folder):
    return {k: v["value"] for k, v in json.loads((folder / "stats.json").read_text()).items()
            if isinstance(v, dict) and "value" in v}


def parameters(folder):
    rows = json.loads((folder / "config.json").read_text())["params"]
    return {key: row["value"] for key, row in rows.items()}


def compared(run, inside, replay):
    """(name, of the run, of the replay), the remap first: those that began in the window, by a replay of the run's own
    trace; as recorded, the shortest of the run, since that would be the replay itself."""
    mean, least = "frame.remap_time.mean", "frame.remap_time.min"
    rows = [("remap", inside[mean], replay.get(mean)) if inside else ("shortest remap", run[least], replay.get(least))]
    for master in [*PORTS, "vpbe", "vpfe"]:
        if run.get(f"bus.{master}.transactions", 0) < 1000:
            continue
        name = f"ddr.{master}.latency.mean"
        if run.get(name) is not None:
            rows.append((name, run[name], replay.get(name)))
    return rows


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
    table = csv.writer(sys.stdout)
    table.writerow(["kernel", "setting", "figure", "run", "replay", "difference_percent"])
    failures = []
    for kernel in args.kernel or KERNELS:
        _, trace = bench.run(kernel, [], f"{kernel}.recorded")
        recorded = parameters(bench.replay(trace, [], f"{kernel}.same"))
        for name in args.setting or SETTINGS:
            folder, other = bench.run(kernel, SETTINGS[name], f"{kernel}.run")
            settings, inside = SETTINGS[name], None
            if settings:
                inside = bench.replay(other, [], f"{kernel}.other")
            if name in PROGRAMMED:
                programmed = parameters(inside)
                settings = [f"{key}={value.replace(chr(32), str())}" for key, value in programmed.items()
                            if recorded.get(key) != value]
            replayed = figures(bench.replay(trace, settings, f"{kernel}.replay"))
            for figure, real, got in compared(figures(folder), inside and figures(inside), replayed):
                bound = 0.3 if not SETTINGS[name] else 1 if "remap" in figure else 5
                percent = 100 * (got / real - 1) if got is not None else float("nan")
                table.writerow([kernel, name, figure, f"{real:.6g}", "absent" if got is None else f"{got:.6g}",
                                f"{percent:+.2f}"])
                sys.stdout.flush()
                if not abs(percent) <= bound:
                    failures.append(f"{kernel}, {name}: {figure} {percent:+.2f} %, allowed: {bound} %")
    print(*failures, f"{len(failures)} failures", sep="\n")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
