#!/usr/bin/env python3
"""Reads a Perfetto trace and holds it against the results of the run that wrote it.

An own reader of the wire format (https://protobuf.dev/programming-guides/encoding/): it shares nothing with the
writer but the field numbers of Perfetto's schema.

usage: perfetto.py TRACE RESULTS      exit 0: they agree; 1: they do not
       perfetto.py --slices TRACK TRACE   prints the slices of a track
       perfetto.py --shape TRACE      prints groups, tracks, packets and times, and checks the slices
       perfetto.py --counters TRACE RESULTS COMMANDS   exit 0: the SDRAM's counters say what the command trace says
"""
import collections
import csv
import json
import pathlib
import struct
import sys


class Malformed(Exception):
    pass


def varint(data, at):
    value = shift = 0
    while True:
        if at >= len(data) or shift > 63:
            raise Malformed(f"varint at byte {at}")
        byte = data[at]
        value |= (byte & 0x7F) << shift
        at, shift = at + 1, shift + 7
        if byte < 0x80:
            return value, at


def fields(data):
    """(field number, value) of a message: int, or bytes for what has a length."""
    at = 0
    while at < len(data):
        tag, at = varint(data, at)
        kind = tag & 7
        if kind == 0:
            value, at = varint(data, at)
        elif kind in (1, 5):
            size = 8 if kind == 1 else 4
            value, at = data[at:at + size], at + size
        elif kind == 2:
            size, at = varint(data, at)
            value, at = data[at:at + size], at + size
        else:
            raise Malformed(f"wire type {kind} at byte {at}")
        if at > len(data):
            raise Malformed("cut short")
        yield tag >> 3, value


class Trace:
    def __init__(self, data):
        self.names, self.events, self.packets = {}, {}, 0  # by track
        for number, packet in fields(data):
            if number != 1:
                raise Malformed(f"field {number} in the trace")
            self.packets += 1
            self.packet(dict(fields(packet)))
        for events in self.events.values():
            events.sort(key=lambda e: e["at"])  # stable: as a viewer does

    def packet(self, p):
        if p.get(10) != 1:
            raise Malformed("a packet of no sequence")
        if 60 in p:
            d = dict(fields(p[60]))
            if d[1] in self.names:
                raise Malformed(f"track {d[1]} is described twice")
            parent = self.names[d[5]] + "/" if 5 in d else ""
            self.names[d[1]] = parent + d[2].decode()
            return
        e = dict(fields(p[11]))
        if e[11] not in self.names:
            raise Malformed(f"an event of the unknown track {e[11]}")
        value = e.get(30)
        if 44 in e:
            value = struct.unpack("<d", e[44])[0]
        flow = struct.unpack("<Q", e[47])[0] if 47 in e else None
        self.events.setdefault(self.names[e[11]], []).append(
            {"at": p[8], "type": e[9], "name": e.get(23, b"").decode(), "flow": flow, "value": value})

    def slices(self, track):
        """[(begin, end, name, flow)]; every begin has its end, and none overlap."""
        out, open_ = [], None
        for e in self.events.get(track, []):
            if e["type"] == 1:
                if open_:
                    raise Malformed(f"{track}: slices overlap at {e['at']}")
                open_ = e
            elif e["type"] == 2:
                if not open_:
                    raise Malformed(f"{track}: an end without a beginning at {e['at']}")
                out.append((open_["at"], e["at"], open_["name"], open_["flow"]))
                open_ = None
        if open_:
            raise Malformed(f"{track}: a slice has no end")
        return out

    def of_group(self, group):
        return [t for t in self.events if t.startswith(group + "/")]


def ns(text):
    return int(text.split(".")[0])


def check(trace, folder):
    wrong = []

    def expect(what, got, want):
        if got != want:
            wrong.append(f"{what}: {got}, expected {want}")

    with open(f"{folder}/frames.csv", newline="") as f:
        rows = list(csv.DictReader(f))
    with open(f"{folder}/stats.json") as f:
        stats = {k: v["value"] for k, v in json.load(f).items() if isinstance(v, dict) and "value" in v}
    fresh = [r for r in rows if r["repeated"] == "0" and r["captured_frame"]]
    for track, what, of in (("1 capture", "capture", fresh), ("2 remap", "remap", fresh), ("3 display", "display", rows)):
        expect(track, [s[:2] for s in trace.slices("frames/" + track)],
               [(ns(r[what + "_start_ns"]), ns(r[what + "_end_ns"])) for r in of])
    # The arrows of a frame lead from its capture over its remap to its display.
    ways = {}
    for track in ("1 capture", "2 remap", "3 display"):
        for begin, _, name, flow in trace.slices("frames/" + track):
            ways.setdefault(flow, []).append((begin, track, name))
    for r in fresh:
        way = sorted(ways.get(int(r["captured_frame"]) + 1, []))
        expect("frame " + r["captured_frame"], [w[1] for w in way][:3], ["1 capture", "2 remap", "3 display"])
        expect("name", {w[2] for w in way}, {"frame " + r["captured_frame"]})
    # Phases: the remaps that the pins show are those of frames.csv.
    phases = {s[:2] for s in trace.slices("firmware/phases") if s[2].startswith("remap ") and s[2] != "remap done"}
    begin = min(s[0] for s in trace.slices("firmware/phases"))
    for r in fresh:
        if ns(r["remap_start_ns"]) > begin:
            expect("phase of " + r["captured_frame"], (ns(r["remap_start_ns"]), ns(r["remap_end_ns"])) in phases, True)
    # Requests: as many and as many bytes as the statistics have, but for those under way at an edge.
    of_stat = {}
    for track in trace.of_group("masters"):
        master = track.split("/")[1].split(" (")[0]
        if master.startswith("edma_tc"):
            master = master[:len("edma_tc0")]
        for _, _, name, _ in trace.slices(track):
            words = name.split()
            if words[0] in ("RAM", "register"):
                words = words[1:]
            key = (master, words[0])
            n, size = of_stat.get(key, (0, 0))
            of_stat[key] = (n + 1, size + int(words[1]))
    moved = {(k.split(".")[1], k.split(".")[2][:-len("_bytes")]): v for k, v in stats.items()
             if k.startswith("bus.") and k.endswith("_bytes") and v and k.split(".")[1] not in ("config",)}
    for key, (n, size) in of_stat.items():
        if key in moved and abs(size - moved[key]) > 64 * 48:
            wrong.append(f"{key}: {size} bytes in {n} requests, stats.json has {moved[key]}")
    for key, size in moved.items():
        if size > 64 * 48 and key not in of_stat:
            wrong.append(f"{key}: no request in the trace, {size} bytes in stats.json")
    # DMA transfers.
    transfers = sum(len(trace.slices(t)) for t in trace.of_group("DMA"))
    done = sum(v for k, v in stats.items() if k.startswith("edma.tc") and k.endswith(".requests"))
    if abs(transfers - done) > 8:
        wrong.append(f"{transfers} DMA transfers, stats.json has {done}")
    wrong += functions(trace, folder, stats)
    # Interrupts and counters.
    if not trace.slices("interrupts/IRQ of the core"):
        wrong.append("no interrupt of the core")
    lines = {t.split(" ", 1)[1]: len(trace.slices(t)) for t in trace.of_group("interrupts") if t.split("/")[1][:2].isdigit()}
    taken = pathlib.Path(folder) / "interrupts.csv"
    for row in csv.DictReader(taken.read_text().splitlines()) if taken.exists() else []:
        # One may be under way at each edge.
        if abs(lines.get(row["interrupt"], -9) - int(row["count"])) > 1:
            wrong.append(f"{row['interrupt']} rises {lines.get(row['interrupt'])} times, interrupts.csv has {row['count']}")
    values = {t: [e["value"] for e in trace.events.get(t, [])] for t in trace.events}
    for track in ("SDRAM/queue", "SDRAM/refreshes owed", "SDRAM/column commands without a new row"):
        if len(values.get(track, [])) < 100:
            wrong.append(f"{track}: {len(values.get(track, []))} values")
    if max(values.get("SDRAM/refreshes owed", [99])) > stats["ddr.refresh_backlog"]:
        wrong.append("more refreshes owed than the backlog of stats.json")
    wrong += empty_queue([(0, v) for v in values["SDRAM/queue"]], stats)
    seconds = stats["frame.window"]
    for way in ("reads", "writes"):
        rates = values.get(f"bandwidth/{'vpbe' if way == 'reads' else 'vpfe'} {way}", [])
        want = stats[f"bus.{'vpbe' if way == 'reads' else 'vpfe'}.{way[:-1]}_bytes"] / seconds * 1e-6
        got = sum(rates) * 1e-4 / seconds
        if abs(got - want) > 0.02 * want + 0.01:
            wrong.append(f"bandwidth of {way}: mean {got} MB/s, expected {want}")
    return wrong


def counters(trace, folder, commands):
    """The samples of the SDRAM's counters, from the commands on its bus. A window that begins with open rows is needed."""
    with open(f"{folder}/stats.json") as f:
        stats = {k: v["value"] for k, v in json.load(f).items() if isinstance(v, dict) and "value" in v}
    values = {t: [(e["at"], e["value"]) for e in trace.events.get("SDRAM/" + t, [])]
              for t in ("queue", "refreshes owed", "column commands without a new row")}
    begin = values["queue"][0][0]
    clocks_a_ns = round(stats["ddr.queued_clocks"] / (1 - stats["ddr.headroom"]) / stats["frame.window"]) * 1e-9
    # Of each sample's interval: ACT, column commands, refreshes.
    counts, start = collections.defaultdict(lambda: [0, 0, 0]), None
    with open(commands) as f:
        for line in f.readlines()[1:]:
            clock, command = line.split(",")[:2]
            start = int(clock) if start is None else start
            kind = {"ACT": 0, "RD": 1, "WR": 1, "RDA": 1, "WRA": 1, "REF": 2}.get(command)
            if kind is not None:
                counts[int((int(clock) - start) / clocks_a_ns / 100_000)][kind] += 1
    wrong = []
    for at, value in values["column commands without a new row"]:
        acts, columns, _ = counts[round((at - begin) / 100_000) - 1]
        if abs(value - 100 * (1 - acts / columns)) > 100 * 3 / columns:  # as many may lie on the other side of its edges
            wrong.append(f"at {at}: {value} % without a new row, {acts} ACT for {columns} column commands")
    # Refreshes fall due at a constant rate.
    owed = [v for _, v in values["refreshes owed"]]
    done = [sum(counts[i][2] for i in range(n)) for n in range(len(owed))]
    rate = (done[-1] + owed[-1] - owed[0]) / (len(owed) - 1)
    for n, v in enumerate(owed):
        if abs(owed[0] + rate * n - done[n] - v) > 2:
            wrong.append(f"sample {n}: {v} refreshes owed, {owed[0] + rate * n - done[n]:.1f} by the commands")
    if max(owed) - min(owed) < 3:
        wrong.append("hardly a refresh is put off: nothing is tested")
    return wrong + empty_queue(values["queue"], stats)


def empty_queue(samples, stats):
    idle = sum(v == 0 for _, v in samples) / len(samples)
    if abs(idle - stats["ddr.headroom"]) > 0.05:
        return [f"the queue is empty in {idle} of the samples, ddr.headroom is {stats['ddr.headroom']}"]
    return []


def functions(trace, folder, stats):
    """What the call stacks of the profile say of the functions; a trace lacks those below 1 us."""
    path = pathlib.Path(folder) / "profile.folded"
    if not path.exists():
        return []
    seconds = stats["frame.window"] / stats["cpu.cycles"]
    within, handlers = collections.Counter(), 0
    lines = [line.rsplit(" ", 1) for line in path.read_text().splitlines()]
    for names, clocks in lines:
        for name in set(names.split(";")):
            within[name] += int(clocks) * seconds * 1e9
    root = max(lines, key=lambda l: int(l[1]))[0].split(";")[0]
    handlers = sum(int(clocks) for names, clocks in lines if names.split(";")[0] != root) * seconds * 1e9
    levels = sorted(t for t in trace.events if t.startswith("firmware/functions "))
    if not levels:
        return ["no functions"]
    wrong, above, shown, calls = [], None, collections.Counter(), collections.Counter()
    for level in levels:
        slices = trace.slices(level)
        for begin, end, name, _ in slices:
            if end - begin < 999 and (begin, end) != (slices[0][0], slices[0][1]) and end != slices[-1][1]:
                wrong.append(f"{level}: {name} of {end - begin} ns")
            if above is not None and not any(b <= begin and end <= e for b, e, _, _ in above):
                wrong.append(f"{level}: {name} at {begin} has no caller")
            shown[name] += end - begin
            calls[name] += 1
        above = slices
    whole = sum(end - begin for begin, end, _, _ in trace.slices(levels[0]))
    if abs(whole - stats["frame.window"] * 1e9) > 2000:
        wrong.append(f"the outermost functions take {whole} ns of {stats['frame.window']} s")
    for name, ns in shown.items():
        if ns > (within[name] + handlers) * 1.001 + 5000:
            wrong.append(f"{name}: {ns} ns, the profile has {within[name]:.0f} ns")
    # Of functions that take long at a time, nothing is left out.
    long = [name for name, ns in shown.items() if ns > 10_000 * calls[name]]
    for name in long:
        if shown[name] < within[name] * 0.99:
            wrong.append(f"{name}: {shown[name]} ns, the profile has {within[name]:.0f} ns")
    if len(long) < 3:
        wrong.append(f"few functions: {long}")
    return wrong


def main(arguments):
    if arguments[:1] == ["--slices"]:
        with open(arguments[2], "rb") as f:
            for begin, end, name, _ in Trace(f.read()).slices(arguments[1]):
                print(begin, end, name)
        return 0
    if arguments[:1] == ["--counters"]:
        with open(arguments[1], "rb") as f:
            wrong = counters(Trace(f.read()), arguments[2], arguments[3])
        print("\n".join(wrong[:20]))
        return 1 if wrong else 0
    shape = arguments[:1] == ["--shape"]
    with open(arguments[1 if shape else 0], "rb") as f:
        trace = Trace(f.read())
    if shape:
        for track in sorted(trace.events):
            trace.slices(track)
        times = [e["at"] for events in trace.events.values() for e in events]
        groups = sorted({t.split("/")[0] for t in trace.events})
        print(trace.packets, min(times, default=0), max(times, default=0), *groups)
        return 0
    wrong = check(trace, arguments[1])
    print("\n".join(wrong[:20]))
    return 1 if wrong else 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except Malformed as problem:
        print(problem)
        sys.exit(1)
