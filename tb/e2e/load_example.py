#!/usr/bin/env python3
"""The worked example of `fovea limits --load` in sw/fovea/README.md: the command that stands there gives the table and
the sentences that stand there. With --write it puts them there.

Usage: load_example.py FOVEA SOURCE OUT [--write]
"""
import csv
import os
import re
import shutil
import subprocess
import sys
import textwrap

BEGIN, END = "<!-- load: begin -->\n", "<!-- load: end -->\n"
WIDTH = 118  # of a line on the page


def cell(row):
    """What a port bears at a priority: MB/s moved and asked for, and what the longest remap leaves of a period."""
    if row["answer"] == "unknown":
        sys.exit(f"no answer for {row['searched']}, priority {row['priority']}: {row['why_bad']}")
    if row["answer"] == "none" or row["good"] == "0 MB/s":
        return "none"
    asked = row["good"].removesuffix(" MB/s") if row["good"].endswith(" MB/s") else "no pauses"
    return f"{float(row['moved_MBps']):.0f} ({asked}), {100 * float(row['left_of_frame_period']):.0f} %"


def table(file):
    with open(file, newline="") as f:
        rows = [row for row in csv.DictReader(f) if row["searched"].startswith("load on ")]
    ports = list(dict.fromkeys(row["searched"].removeprefix("load on ") for row in rows))
    priorities = sorted({row["priority"] for row in rows})
    cells = {(row["searched"].removeprefix("load on "), row["priority"]): cell(row) for row in rows}
    out = ["| port | priority " + " | ".join(priorities) + " |", "|---" * (1 + len(priorities)) + "|"]
    for port in ports:
        out.append(f"| `{port}` | " + " | ".join(cells[port, p] for p in priorities) + " |")
    return out


def sentences(file):
    """What the answer says of traffic that a user may want to run beside it, without its sources."""
    with open(file) as f:
        found = [re.sub(r" \[.*\]$", "", line.strip()) for line in f if " needs " in line]
    if len(found) != 2:
        sys.exit(f"{file}: {len(found)} sentences about other traffic, expected 2")
    return [line for text in found for line in textwrap.wrap("- " + text, WIDTH, subsequent_indent="  ")]


def block(command, out):
    return "\n".join(["```", command, "```", "", *table(os.path.join(out, "limits.csv")), "",
                      *sentences(os.path.join(out, "answer.txt"))]) + "\n"


def main():
    fovea, source, out = (os.path.abspath(a) for a in sys.argv[1:4])
    write = sys.argv[4:] == ["--write"]
    page = os.path.join(source, "sw", "fovea", "README.md")
    with open(page) as f:
        text = f.read()
    if text.count(BEGIN) != 1 or text.count(END) != 1:
        sys.exit(f"{page} lacks the lines {BEGIN.strip()} and {END.strip()}")
    before, rest = text.split(BEGIN)
    stands, after = rest.split(END)
    command = next(line for line in stands.splitlines() if line.startswith("fovea limits "))
    if not write:
        shutil.rmtree(out, ignore_errors=True)
    run = subprocess.run([fovea, *command.split()[1:], "-o", out], cwd=source, stdout=subprocess.PIPE,
                         stderr=subprocess.STDOUT, text=True)
    if run.returncode != 0:
        sys.exit(f"'{command}' ended with status {run.returncode}:\n{run.stdout}")
    made = block(command, out)
    if write:
        with open(page, "w") as f:
            f.write(before + BEGIN + made + END + after)
    elif made != stands:
        sys.exit(f"{page} has\n{stands}\nthe command gives\n{made}")


main()
