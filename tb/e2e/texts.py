#!/usr/bin/env python3
"""What the commands print and write, whole, against what they printed and wrote before.

Usage: texts.py FOVEA SOURCE OUT [--write] [CASE...]

A case is a row of CASES: command lines, and files that they leave. tb/e2e/texts/CASE.txt holds what is expected: the
status and output of each command, and each file's lines and digest, with its text if it is short. What says when and
where the run was made is replaced first. It tells of every change of a word or figure that a reader sees; whether it
is right others test. --write puts down what is now; the difference is for the reviewer to read.
"""
import argparse
import difflib
import hashlib
import pathlib
import re
import shlex
import subprocess
import sys

SHORT = 6000  # bytes of a text that is kept whole
INPUTS = {
    "tiny.yaml": "camera: {kind: chart, stamp: false}\nvideo: {width: 32, height: 24}\nrun: {frames: 2}\n",
    "key.yaml": "run:\n  frame: 3\n",
    "unit.yaml": "ddr:\n  request_latency: 9\n",
    "range.yaml": "video:\n  width: 4000\n",
    "list.yaml": "run: [1, 2]\n",
    "text.elf": "not an ELF",
    "times.trace": "# dramtrace 1\n# master 0 window 4 video\n0 0 R 0x1000 64\n5000 0 W 0x2000 32\n"
                   "6000 0 R 0x3000 64\n",
    "late.trace": "# dramtrace 1\n# master 0 window 4 video\n0 0 R 0x1000\n",
    "lines.stl": "0: read 0x40\n7: write 0x80\n",
}
FIGURES = ["stats.json", "config.json", "frames.csv", "stalls.csv", "latency.csv", "slowest.csv", "timeline.csv"]
PROFILE = ["profile.txt", "profile.csv", "profile.folded", "profile.callgrind", "functions.csv", "paths.csv",
           "objects.csv", "interrupts.csv", "frame_parts.csv"]
TINY = "run tiny.yaml"
CASES = {
    "help": [["--help", *[f"{c} --help" for c in "run replay limits exec trace report compare check bless trend params "
                          "version completion man".split()], "trace convert --help", "trace info --help", "man",
              "completion bash"], []],
    "params": [["params", "params --replay", "params --markdown", "params run", "params ddr.check", "params nothing"],
               []],
    "run": [[f"{TINY} -o a --profile --report --command-trace a.cmd --bus-trace a.trace --around 400ms",
             "report a --text"], [f"a/{f}" for f in [*FIGURES, *PROFILE, "requests.csv", "uart.log",
                                                              "report.html"]] + ["a.cmd"]],
    "kernels": [[f"{TINY} -o {k} --no-frames -s firmware.kernel={k}" for k in "copy gather staged runs ldm".split()],
                [f"{k}/stats.json" for k in "copy gather staged runs ldm".split()]],
    "settings": [[f"{TINY} -o s{n} --no-frames {words}" for n, words in enumerate([
        "--strict -s ddr.check=commands -s clocks.preset=216/172", "--hazards -s firmware.flow=serial",
        "-s engine=tlm -s firmware.kernel=engine", "-s cameras.count=2 -s firmware.kernel=copy",
        "-s run.until=time:300ms --log-registers 'psc|ddr'", "-s run.until=uart:lut --max-time 2s",
        "-s load.port=edma_tc2 -s load.kind=copy -s load.bytes=64B -s load.gap=2us",
        "-s run.until=pc:main -s cpu.ahb_ratio=3"])],
        [f"s{n}/stats.json" for n in range(8)] + ["s4/registers.log"]],
    "compare": [[f"{TINY} -o a --report", f"{TINY} -o b -s ddr.request_latency=16cycles --profile",
                 f"{TINY} -o c --profile", "compare a a", "compare a b", "compare a b --all --csv",
                 "compare a b --json",
                 "compare c b --only frame.re", "compare a b --tolerance 50%", "report a b -o r.html",
                 "report c b --text"], ["r.html"]],
    "gates": [[f"{TINY} -o c --profile", f"{TINY} -o b -s ddr.request_latency=16cycles --profile",
               "bless c --against g.yaml --why first --tolerance 1%", "check c --against g.yaml",
               "check b --against g.yaml --junit g.xml", "check b --against g.yaml --markdown g.md",
               "check b --against g.yaml --all", "bless b --against g.yaml --why slower", "check b --against g.yaml",
               "trend c --database t.db --commit 1111111", "trend b --database t.db --commit 2222222 --plot t.html"],
              ["g.yaml", "g.xml", "g.md"]],
    "replay": [[f"{TINY} -o a --bus-trace a.trace", "trace info a.trace", "replay a.trace -o r",
                "replay a.trace -o r2 -s ddr.clock=200MHz -s ddr.request_latency=9cycles --around 400ms",
                "replay a.trace -o r3 --without vpbe --memory-only", "replay times.trace -o r4 --command-trace t.cmd",
                "trace info times.trace", "trace convert times.trace -o t.bin --to binary",
                "trace convert t.bin -o t.txt --to text",
                "trace convert lines.stl -o l.txt --to text --from dramsys-stl --clock 100MHz",
                *[f"trace convert times.trace -o t.{n} --to {n} --clock 200MHz"
                                    for n in "dramsys-stl dramsys-rstl dramsim3".split()],
                *[f"trace convert times.trace -o t.{n} --to {n}" for n in "ramulator ramulator2".split()]],
               ["r/stats.json", "r/timeline.csv", "r2/stats.json", "r2/requests.csv", "r3/stats.json", "r4/stats.json",
                "r4/latency.csv", "t.cmd", "t.txt", "l.txt", "t.dramsys-stl", "t.dramsys-rstl", "t.ramulator",
                "t.ramulator2", "t.dramsim3"]],
    "limits": [["limits tiny.yaml -j 1 --over ddr.request_latency=0cycles,8cycles -o l",
                "limits tiny.yaml -j 1 --find cpu.ahb_ratio=2..6 --probes 3 --require frame.remap_time.mean<=50e-6 "
                "-o f"],
               ["l/limits.csv", "l/points.csv", "f/limits.csv", "f/points.csv", "f/answer.txt"]],
    "wrong": [["nothing", "run", "run none.yaml", "run key.yaml", "run unit.yaml", "run range.yaml", "run list.yaml",
               f"{TINY} -o w -s ddr.nothing=1", f"{TINY} -o w -s ddr.request_latency", f"{TINY} -o w -s ddr.tRFC=fast",
               f"{TINY} -o w -s run.until=never", f"{TINY} -o w -s firmware.elf=text.elf",
               f"{TINY} -o w --max-time 1ms", f"{TINY} -o w -s firmware.elf=none.elf",
               f"{TINY} -o w --max-instructions 100", f"{TINY} -o w --sync fast",
               f"{TINY} -o w --around soon", f"{TINY} -o w --log-registers '('", f"{TINY} -o w --perfetto-size 0",
               f"{TINY} -o w -s ddr.clock=1kHz", f"{TINY} -o w -s camera.file=none.png -s camera.kind=chart",
               f"{TINY} -o w -s lens.mapping=none", f"{TINY} -o w -s cameras.count=99", "replay none.trace",
               "replay tiny.yaml", "replay late.trace", "replay times.trace -s run.frames=1", "trace info tiny.yaml",
               "trace convert times.trace -o x --to none", "report none", "report tiny.yaml", "compare none none",
               "check none --against none.yaml", "check tiny.yaml", "bless none --against x.yaml --why x",
               "limits none.yaml", "limits tiny.yaml --find nothing", "limits tiny.yaml --over run.frames=2,x",
               "exec none.elf", "exec text.elf", "exec text.elf --load 0 --entry 0 --max-instructions 10",
               "exec tiny.yaml --board --load 0x80000000 --entry 0x80000000 --max-time 1ms", "params --what",
               "trend none --database t.db"], []],
}


def plain(text, out):
    """Without what says when, where and how fast."""
    text = text.replace(str(out), "OUT")
    text = re.sub(r"(commit\W{1,12})[0-9a-f]{12,40}(, modified|-modified)?\b", r"\1COMMIT", text)
    text = re.sub(r"\b[0-9a-f]{64}\b", "DIGEST", text)
    text = text.replace('"modified": true', '"modified": false')
    text = re.sub(r'<p class="note">The simulator.s source was modified: [^<]*</p>', "", text)
    text = re.sub(r"\b20\d\d-\d\d-\d\d(T| )\d\d:\d\d(:\d\d)?Z?", "DATE", text)
    text = re.sub(r"^host .*\n( {8}.*\n)*", "host ...\n", text, flags=re.M)
    of_host = "wall_time|realtime_factor|mips|peak_rss|host_instructions"
    text = re.sub(rf"^.*data-figure=\"({of_host})\".*\n", "", text, flags=re.M)
    text = re.sub(r"^(t\.db: .* of commit \w+).*", r"\1 ...", text, flags=re.M)  # some hosts count instructions
    text = re.sub(r"^[0-9a-f]{16},", "POINT,", text, flags=re.M)
    text = re.sub(r"^(\[\d+\] .*: )[0-9.]+ s(; .*)?$", r"\1...", text, flags=re.M)
    return re.sub(r"[0-9.]+(x real time| million instructions a second| s on the host)", r"...\1", text)


def described(name, text):
    lines = [f"-- {name}: {text.count(chr(10))} lines, {hashlib.sha256(text.encode()).hexdigest()[:16]}"]
    return lines + (text.splitlines() if len(text) <= SHORT else [])


def seen(case, fovea, out):
    """Lines that say what a case prints and writes."""
    commands, files = CASES[case]
    lines = []
    for command in commands:
        done = subprocess.run([fovea, *shlex.split(command)], cwd=out, capture_output=True, text=True, errors="replace")
        lines.append(f"== fovea {command}: status {done.returncode}")
        for name, text in (("output", done.stdout), ("errors", done.stderr)):
            if text:
                (out / f"{name}.txt").write_text(plain(text, out))
                lines += described(name, plain(text, out))
    for name in files:
        if not (out / name).exists():
            lines.append(f"-- {name}: not written")
            continue
        text = plain((out / name).read_text(errors="replace"), out)
        (out / name).write_text(text)
        lines += described(name, text)
    return [line + "\n" for line in lines]


def main():
    args = argparse.ArgumentParser()
    args.add_argument("fovea", type=lambda p: pathlib.Path(p).resolve())
    args.add_argument("source", type=pathlib.Path)
    args.add_argument("out", type=lambda p: pathlib.Path(p).resolve())
    args.add_argument("case", nargs="*")
    args.add_argument("--write", action="store_true")
    args = args.parse_args()
    different = []
    for case in args.case or CASES:
        out = args.out / case
        subprocess.run(["rm", "-rf", out], check=True)
        out.mkdir(parents=True)
        for name, text in INPUTS.items():
            (out / name).write_text(text)
        file = args.source / f"{case}.txt"
        now = seen(case, args.fovea, out)
        if args.write:
            file.write_text("".join(now))
            continue
        before = file.read_text().splitlines(keepends=True)
        if now != before:
            different.append(case)
            sys.stdout.writelines(list(difflib.unified_diff(before, now, str(file), "now", n=1))[:100])
    if different:
        print(f"other texts: {', '.join(different)}; whole in {args.out}; 'texts.py --write' takes them over")
    return 1 if different else 0


if __name__ == "__main__":
    sys.exit(main())
