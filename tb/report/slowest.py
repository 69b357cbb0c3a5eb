#!/usr/bin/env python3
"""The slowest requests of a run: they are those of the statistics, their steps add up, strict mode finds the same, a
run with --around sees them again, and a longer bridge lengthens its own step.
Usage: slowest.py FOVEA OUT EXPERIMENT [-s KEY=VALUE ...]"""
import csv
import json
import shutil
import subprocess
import sys
from decimal import Decimal
from pathlib import Path

fovea, out, experiment, *options = sys.argv[1:]
out = Path(out)
shutil.rmtree(out, ignore_errors=True)
out.mkdir(parents=True)
failures = 0


def check(good, what):
    global failures
    if not good:
        failures += 1
        print(what)


def run(name, *more):
    command = [fovea, "run", experiment, "--no-frames", *options, *more, "-o", str(out / name)]
    result = subprocess.run(command, capture_output=True, text=True)
    if result.returncode:
        sys.exit(f"{' '.join(command)}: status {result.returncode}: {result.stderr}")
    return result.stdout


def figures(name):
    stats = json.loads((out / name / "stats.json").read_text())
    return {name: figure["value"] for name, figure in stats.items() if isinstance(figure, dict)}


def slowest(name):
    """The rows of each request, by master and direction."""
    requests = {}
    with open(out / name / "slowest.csv", newline="") as file:
        for row in csv.DictReader(file):
            requests.setdefault((row["master"], row["direction"]), []).append(row)
    return requests


def add_up(name):
    """Steps without gaps, whose sum is the latency, which is the statistics' maximum."""
    stats, requests = figures(name), slowest(name)
    for (master, direction), steps in requests.items():
        who = f"{name}: {master} {direction}"
        at = Decimal(steps[0]["issued_ns"])
        for number, step in enumerate(steps, 1):
            check(int(step["step"]) == number, f"{who}: step {step['step']} is not {number}")
            check(Decimal(step["begin_ns"]) == at, f"{who}: step {number} begins at {step['begin_ns']}, not at {at}")
            check(Decimal(step["time_ns"]) > 0, f"{who}: step {number} takes no time")
            at += Decimal(step["time_ns"])
        latency = Decimal(steps[0]["latency_ns"])
        check(at - Decimal(steps[0]["issued_ns"]) == latency, f"{who}: the steps add up to {at}, not to {latency}")
        figure = f"ddr.{master}.latency." + ("max" if direction == "read" else "write_last.max")
        check(stats[figure] is not None and abs(stats[figure] * 1e9 - float(latency)) < 5e-4,
              f"{who}: {latency} ns; {figure} is {stats[figure]}")
    for figure, value in stats.items():
        if value is None or not figure.startswith("ddr.") or not figure.endswith((".latency.max", ".write_last.max")):
            continue
        key = (figure.split(".")[1], "write" if "write_last" in figure else "read")
        check(key in requests, f"{name}: {figure} has no request in slowest.csv")
    return requests


plain_words = run("plain")
requests = add_up("plain")
check(len(requests) >= 3, f"only {len(requests)} requests: {list(requests)}")
run("strict", "--sync=strict")
check((out / "plain/slowest.csv").read_bytes() == (out / "strict/slowest.csv").read_bytes(),
      "strict mode finds other requests")

(master, direction), steps = max(requests.items(), key=lambda item: Decimal(item[1][0]["latency_ns"]))
first = steps[0]
line = f"slowest {direction} of {master}: {Decimal(first['latency_ns']) / 1000:.3f} us at "
check(line in plain_words, f"no '{line}' in: {plain_words}")
run("around", "--around", f"{Decimal(first['issued_ns']) / 1_000_000}ms")
check((out / "plain/stats.json").read_bytes() == (out / "around/stats.json").read_bytes(), "--around changes the run")
check((out / "plain/slowest.csv").read_bytes() == (out / "around/slowest.csv").read_bytes(), "--around finds others")
with open(out / "around/requests.csv", newline="") as file:
    around = list(csv.DictReader(file))
same = [r for r in around if (r["master"], r["direction"], r["port"], r["issued_ns"], r["address"], r["bytes"]) ==
        (master, direction, first["port"], first["issued_ns"], first["address"], first["bytes"])]
check(len(same) == 1, f"{len(same)} such requests around it: {first}")
for r in around:
    end = Decimal(r["first_ns"] if r["direction"] == "read" else r["last_ns"])
    latency = end - Decimal(r["issued_ns"])
    slower = requests[(r["master"], r["direction"])][0] if (r["master"], r["direction"]) in requests else None
    if r in same:
        check(latency == Decimal(first["latency_ns"]), f"seen again it takes {latency} ns, not {first['latency_ns']}")
    elif slower:
        check(latency <= Decimal(slower["latency_ns"]), f"slower than the slowest: {r}")

# A bridge of n clocks takes them and the wait for an edge, which is at most one more.
for clocks in (2, 6):
    name = f"bridge{clocks}"
    run(name, "-s", f"bus.{master}.request_latency={clocks}cycles")
    longer = add_up(name)
    edge = Decimal(2000) / 243  # of the crossbar, ns
    way = [Decimal(s["time_ns"]) for s in longer[(master, direction)] if s["place"] == "port"]
    least, most = clocks * edge - Decimal("0.002"), (clocks + 1) * edge + Decimal("0.002")
    check(len(way) == 1 and least < way[0] < most,
          f"{name}: {way} ns on the way to the crossbar, of {clocks} clocks of {edge:.3f} ns")
forgotten = sum(Decimal(s["time_ns"]) for rows in requests.values() for s in rows if s["culprit"] == "not_known")
all_of_them = sum(Decimal(rows[0]["latency_ns"]) for rows in requests.values())
print(f"{len(requests)} requests, the slowest {line[8:]}{first['issued_ns']} ns; not known "
      f"{100 * forgotten / all_of_them:.1f} % of their time; {failures} failures")
sys.exit(failures > 0)
