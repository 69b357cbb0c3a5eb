#!/usr/bin/env python3
"""Random guest programs on the whole board: none may show a defect of the simulator, and strict synchronisation, the
slow reference, must leave the same bytes as the default.

Usage: random_guests.py FOVEA GUEST.elf REGISTERS.h OUT FIRST COUNT [--jobs N] [--known FILE [--write]]

Program number n is drawn from the seed n. It writes and reads registers of all blocks in all widths, at random and in
sequences that start timers, transfers, caches and, with some writes left out or changed, camera and display as the
firmware does; it waits for registers and interrupts, and jumps. It may end as it likes, with status 0 or 3 (a fault of
the guest), but within the time limit of a run. Prints how the programs ended, and each complaint with the number that
makes it again; the folders of those are kept.

FILE holds, for each program, a digest of what it has read and written in registers and sent on UART0, and one of that
with all times and figures. A change of the model that is to alter neither must keep both; --write puts down those of
now, which a new register or another firmware changes as well, since they change the programs.
"""
import argparse
import concurrent.futures
import hashlib
import pathlib
import random
import re
import shutil
import struct
import subprocess
import sys

PROGRAM, OPTIONS = b"random guest's..", b"options of guest"
FILES = ["stats.json", "stalls.csv", "uart.log", "registers.log", "latency.csv", "slowest.csv", "timeline.csv"]
EXPERIMENT = """camera: {kind: chart, stamp: false}
video: {width: 16, height: 16}
tvp5146: {output_at_reset: true}
"""
RAM, BUFFERS, SDRAM = 0x0000, 0x7000, 0x80000000
ROOM = 12288  # for a program
TIME_LIMIT = 120  # of the host, for what takes a fraction of a second


class Registers:
    """Of the header that the model prints: addresses by block, and the fields of each."""

    def __init__(self, header):
        self.blocks, self.fields, self.video = {}, {}, []
        address = {}
        for name, value in re.findall(r"^#define (\w+) 0x([0-9A-F]{8})u$", header, re.M):
            number = int(value, 16)
            if number >= 0x01C00000:
                address[name] = number
                self.blocks.setdefault(name.split("_")[0], []).append(number)
            else:
                register = max((r for r in address if name.startswith(r + "_")), key=len, default=None)
                if register:
                    self.fields.setdefault(address[register], []).append(number)
        several = r"^#define (\w+)\(n\) \(0x([0-9A-F]{8})u \+ (\d+)u \* \(n\)\)$"
        for name, base, step in re.findall(several, header, re.M):
            here = self.blocks.setdefault(name.split("_")[0], [])
            here += [int(base, 16) + int(step) * n for n in range(8)]

        self.address = address

    def learn(self, log):
        """Of the log of a run: how the firmware starts camera and display."""
        for block, register, value in re.findall(r" wrote (isif|vpss|osd|venc|system)\.(\w+) = (0x[0-9a-f]+)", log):
            if f"{block}_{register}".upper() in self.address:
                self.video.append((self.address[f"{block}_{register}".upper()], int(value, 16)))
        assert len(self.video) > 30

    def draw(self, dice):
        return dice.choice(self.blocks[dice.choice(sorted(self.blocks))])

    def value(self, dice, address):
        kind = dice.randrange(7)
        if kind < 3 and address in self.fields:
            masks = dice.sample(self.fields[address], min(len(self.fields[address]), dice.randint(1, 3)))
            return sum(m & dice.choice([0xFFFFFFFF, dice.getrandbits(32), m & -m]) for m in set(masks)) & 0xFFFFFFFF
        if kind == 3:
            return 1 << dice.randrange(32)
        if kind == 4:
            return dice.choice([0, 1, 2, 0xFFFFFFFF, 0x80000000, 0x7FFFFFFF])
        if kind == 5:
            return dice.choice([BUFFERS, SDRAM, 0x10000]) + 4 * dice.randrange(256)
        return dice.getrandbits(dice.choice([4, 8, 16, 32]))


class Code:
    """Words of ARM instructions. r0 addresses, r1 and r2 hold values, r3 counts."""

    def __init__(self, dice, registers, booted):
        self.dice, self.registers, self.booted, self.words = dice, registers, booted, []

    def load(self, register, value):
        self.words += [0xE59F0000 | register << 12, 0xEA000000, value & 0xFFFFFFFF]  # ldr rN, [pc]; b over; value

    def write(self, address, value, store=0xE5801000):  # str r1, [r0]
        self.load(0, address)
        self.load(1, value)
        self.words.append(store)

    def read(self, address, load=0xE5902000):  # ldr r2, [r0]
        self.load(0, address)
        self.words.append(load)

    def delay(self):
        self.load(3, self.dice.choice([1, 3, 30, 300, 2000]))
        self.words += [0xE2533001, 0x1AFFFFFD]  # subs r3, r3, #1; bne

    def any_write(self):
        address = self.registers.draw(self.dice)
        value = self.registers.value(self.dice, address)
        odd = self.dice.randrange(4) if self.dice.randrange(8) == 0 else 0
        self.write(address + odd, value, self.dice.choice([0xE5801000] * 5 + [0xE1C010B0, 0xE5C01000, 0xE8800006]))

    def any_read(self):
        odd = self.dice.randrange(4) if self.dice.randrange(8) == 0 else 0
        self.read(self.registers.draw(self.dice) + odd,
                  self.dice.choice([0xE5902000] * 4 + [0xE1D020B0, 0xE5D02000, 0xE8900006, 0xE1002091]))  # swp last

    def wait(self):
        """For a bit of a register, a bounded number of times."""
        self.load(3, self.dice.choice([3, 40, 300]))
        self.load(0, self.registers.draw(self.dice))
        bit = self.dice.randrange(8)
        self.words += [0xE2533001, 0x0A000002, 0xE5902000, 0xE3120000 | 1 << bit, 0x0AFFFFFA]

    def memory(self):
        base = self.dice.choice([BUFFERS, 0x10000 + BUFFERS] + [SDRAM + 0x100000] * (3 if self.booted else 1))
        self.load(0, base + 4 * self.dice.randrange(128))
        self.load(3, self.dice.choice([2, 20, 150]))
        body = self.dice.choice([[0xE4902004], [0xE4801004], [0xE8B01FF0], [0xE8A01FF0], [0xE4902004, 0xE5802100]])
        self.words += body + [0xE2533001, 0x1A000000 | (-(len(body) + 3) & 0xFFFFFF)]

    def transfer(self):
        """A set of the EDMA and its trigger, by hand or by the timer's event."""
        dice, at = self.dice, 0x01C04000
        channel = dice.choice([0, 5, 13, 40, 63])
        places = [BUFFERS + 0x10000, SDRAM + 0x200000] if self.booted else [BUFFERS + 0x10000]
        words = [dice.choice([0, 1 << 20]) | dice.choice([0, 1, 2, 3, 8]) | dice.randrange(64) << 12 |
                 dice.choice([0, 1 << 22, 1 << 23]) | dice.choice([0, 4]),
                 dice.choice(places) + dice.randrange(256), dice.choice([1, 3, 8]) << 16 | dice.choice([1, 4, 64, 500]),
                 dice.choice(places) + dice.randrange(256), dice.choice([0, 64, 0xFFC00040, 0x02000200]),
                 dice.choice([0xFFFF, 0x4000 + 32 * channel]), dice.choice([0, 0x00400040]), dice.choice([1, 2])]
        for n, word in enumerate(words):
            self.write(at + 32 * channel + 4 * n, word)
        for register in ([0x1030, 0x1060] if dice.randrange(2) else [0x1060, 0x1010]):
            self.write(0x01C00000 + register + (4 if channel > 31 else 0), 1 << channel % 32)

    def start_video(self):
        for address, value in self.registers.video[:100]:
            chance = self.dice.randrange(40)
            if chance == 0:
                value = self.registers.value(self.dice, address)
            elif chance == 1:
                value ^= 1 << self.dice.randrange(16)
            if chance != 2:
                self.write(address, value)

    def timer(self):
        base = self.dice.choice([0x01C21400, 0x01C21800])
        for offset, value in ((0x20, 0), (0x24, 0x17), (0x18, self.dice.choice([50, 500, 5000])), (0x1C, 0),
                              (0x20, self.dice.choice([0x40, 0x80, 0x800040, 0xC000C0]))):
            self.write(base + offset, value)
        self.write(0x01C48018, 0xFFFFFFFF)  # the interrupt controller lets all through
        self.write(0x01C4801C, 0xFFFFFFFF)

    def system(self):
        dice = self.dice
        kind = dice.randrange(8)
        if kind == 0:
            self.words.append(0xE321F000 | dice.choice([0x13, 0x53, 0x93, 0xD3]))  # interrupts on and off
        elif kind == 1:  # sleeps; with the timer there is something to wake it
            if dice.randrange(3):
                self.timer()
            self.words.append(0xEE070F90)
        elif kind == 2:  # control register: I-cache, D-cache, high vectors rarely
            self.load(1, 0x00050078 | dice.choice([0, 0x1000, 0x1004, 4, 0x5000]))
            self.words.append(0xEE011F10)
        elif kind == 3:  # cache and TLB operations
            self.load(1, dice.choice([0, BUFFERS, SDRAM + 0x100000, dice.getrandbits(32)]))
            self.words.append(dice.choice([0xEE071F15, 0xEE071F16, 0xEE071F35, 0xEE071F3A, 0xEE071F3E, 0xEE071F9A,
                                           0xEE081F17, 0xEE071F36]))
        elif kind == 4:
            self.words.append(dice.choice([0xEF000000 | dice.getrandbits(20), 0xE7F000F0, 0xE1A00000]))
        elif kind == 5:  # any data processing with r4 to r11
            self.words += [0xE0844005 | dice.randrange(16) << 21 & 0x01E00000 for _ in range(dice.randint(1, 12))]
        elif kind == 6:  # a leap over some words that are not executed
            skipped = [dice.getrandbits(32) for _ in range(dice.randint(1, 9))]
            self.words += [0xEA000000 | len(skipped) - 1] + skipped
        else:  # back, a few times: the same lines again
            self.load(9, dice.randint(2, 40))
            begin = len(self.words)
            for _ in range(dice.randint(1, 3)):
                dice.choice([self.any_read, self.any_write, self.memory])()
            self.words.append(0xE2599001)
            self.words.append(0x1A000000 | (begin - len(self.words) - 2 & 0xFFFFFF))

    def make(self, video):
        if video:
            self.start_video()
        steps = [self.any_write] * 6 + [self.any_read] * 3 + [self.delay, self.wait, self.memory, self.memory,
                                                              self.transfer, self.timer] + [self.system] * 3
        for _ in range(self.dice.randint(10, 60)):
            self.dice.choice(steps)()
        self.words += self.dice.choice([[], [0xEE070F90]]) + [0xEAFFFFFE]  # wait for interrupt; b .
        return struct.pack(f"<{len(self.words)}I", *self.words)


def program(frame, registers, seed):
    dice = random.Random(seed)
    booted = dice.randrange(2) == 0
    video = booted and dice.randrange(2) == 0
    code = Code(dice, registers, booted).make(video)
    out = bytearray(frame)
    at = out.index(PROGRAM)
    assert len(code) <= ROOM
    out[at:at + len(code)] = code
    options = out.index(OPTIONS) + len(OPTIONS)
    out[options:options + 4] = struct.pack("<I", booted | (video or dice.randrange(4) != 0) << 1)
    if video or dice.randrange(4) == 0:  # whether or not the core comes to a halt
        return bytes(out), f"[exit, reset, time:{60 if video else 12 if booted else 4}ms]"
    return bytes(out), "[exit, reset, halt, time:12ms]"


def fovea_run(fovea, folder, out, *more):
    words = [fovea, "run", folder / "guest.yaml", "--no-frames", "--log-registers", ".*", "--log-registers-kept",
             "100000", "-o", out, *more]
    return subprocess.run(list(map(str, words)), capture_output=True, text=True, timeout=TIME_LIMIT, errors="replace")


def run(fovea, folder, elf, until, mode):
    out = folder / mode
    try:
        done = fovea_run(fovea, folder, out, "-s", f"firmware.elf={elf}", "-s",
                         f"run.until={until}", f"--sync={mode}")
    except subprocess.TimeoutExpired:
        return None, f"does not end within {TIME_LIMIT} s"
    lines = [line for line in done.stderr.splitlines() if str(out) not in line]
    return done.returncode, "\n".join(lines).replace(str(out), "OUT")


def complaint(fovea, folder, elf, until):
    """What is wrong with a program, and how it ended."""
    ends = {mode: run(fovea, folder, elf, until, mode) for mode in ("default", "strict")}
    for mode, (status, text) in ends.items():
        if status not in (0, 3):
            return f"{mode}: status {status}: {text[-400:]}", None
    if ends["default"] != ends["strict"]:
        return f"default says {ends['default']}, strict {ends['strict']}", None
    for name in FILES:
        if (folder / "default" / name).read_bytes() != (folder / "strict" / name).read_bytes():
            return f"{name} differs between default and strict", None
    return None, ends["default"]


def digests(folder):
    """Of the values that a program has seen, and of these with all times and figures."""
    contents = {name: (folder / "default" / name).read_bytes() for name in FILES}
    untimed = re.sub(rb"^[0-9.]+ ns ", b"", contents["registers.log"], flags=re.M)
    values = hashlib.sha256(untimed + contents["uart.log"])
    everything = hashlib.sha256(b"".join(contents[name] for name in FILES))
    return values.hexdigest()[:16], everything.hexdigest()[:16]


def unlike(known, seed, seen):
    if known is None or known.get(seed) == seen:
        return None
    if seed not in known:
        return "is not known"
    return "other times or figures than known" if known[seed][0] == seen[0] else "other values than known"


def main():
    args = argparse.ArgumentParser()
    args.add_argument("fovea")
    args.add_argument("guest", type=pathlib.Path)
    args.add_argument("registers", type=pathlib.Path)
    args.add_argument("out", type=pathlib.Path)
    args.add_argument("first", type=int)
    args.add_argument("count", type=int)
    args.add_argument("--jobs", type=int, default=1)
    args.add_argument("--known", type=pathlib.Path)
    args.add_argument("--write", action="store_true")
    args = args.parse_args()
    known = None
    if args.known and not args.write:
        rows = [line.split() for line in args.known.read_text().splitlines()]
        known = {int(seed): tuple(seen) for seed, *seen in rows}
    frame, registers = args.guest.read_bytes(), Registers(args.registers.read_text())

    def new_folder(name):
        folder = args.out / name
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        (folder / "guest.yaml").write_text(EXPERIMENT)
        return folder

    firmware = new_folder("firmware")
    fovea_run(args.fovea, firmware, firmware / "out", "-s", "run.frames=1").check_returncode()
    registers.learn((firmware / "out/registers.log").read_text())

    def one(seed):
        folder = new_folder(str(seed))
        elf = folder / "guest.elf"
        contents, until = program(frame, registers, seed)
        elf.write_bytes(contents)
        wrong, end = complaint(args.fovea, folder, elf, until)
        seen = accesses = None
        if wrong is None:
            accesses = (folder / "default/registers.log").read_text().count("\n")
            seen = digests(folder)
            wrong = unlike(known, seed, seen)
        if wrong is None:
            shutil.rmtree(folder)
        return seed, wrong, end, accesses, seen

    failures, ended, accesses, all_seen = 0, {}, 0, []
    with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
        for seed, wrong, end, logged, seen in pool.map(one, range(args.first, args.first + args.count)):
            if wrong is not None:
                failures += 1
                print(f"program {seed}: {wrong}", flush=True)
                continue
            accesses += logged
            ended[end[0]] = ended.get(end[0], 0) + 1
            all_seen.append(f"{seed} {seen[0]} {seen[1]}\n")
    if args.write:
        args.known.write_text("".join(all_seen))
    ways = ", ".join(f"{n} with status {status}" for status, n in sorted(ended.items()))
    print(f"{args.count} programs, {accesses} logged accesses to registers: ended {ways}; {failures} complaints")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
