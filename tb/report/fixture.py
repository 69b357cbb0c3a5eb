#!/usr/bin/env python3
"""Copies a run's folder and adds the files that only some runs have: pictures of the camera, histograms, a profile."""
import shutil
import sys
from pathlib import Path

source, target = map(Path, sys.argv[1:])
shutil.copytree(source, target)
(target / "camera").mkdir(exist_ok=True)
# Any picture of the same size does.
shutil.copy(target / "frames/frame_000001.png", target / "camera/frame_000000.png")

if not (target / "latency.csv").exists():
    lines = ["master,direction,beat,low_ns,high_ns,count"]
    for master, middle in (("arm_d", 7), ("vpbe", 8)):
        for beat, later in (("first", 0), ("last", 1)):
            lines += [f"{master},read,{beat},{2 ** i},{2 ** (i + 1)},{10 ** (6 - abs(i - middle - later))}"
                      for i in range(4, 12) if abs(i - middle - later) < 6]
    (target / "latency.csv").write_text("\n".join(lines) + "\n")
if not (target / "profile.csv").exists():
    lines = ["phase,function,file,line,cause,region,culprit,clocks,instructions"]
    lines += ["frames,remap,kernels/plain.c,40,issue,,,6500000,6500000", "frames,remap,kernels/plain.c,41,dcache,lut,bridge,20000000,0",
              "frames,main,app/main.c,9,idle.capture,,,9000000,0"]
    lines += [f"frames,helper_{i},app/helper.c,{i},issue,,,{1000 * (i + 1)},{1000 * (i + 1)}" for i in range(20)]
    (target / "profile.csv").write_text("\n".join(lines) + "\n")
    (target / "profile.folded").write_text("start;main 9000000\nstart;main;remap 26500000\nirq_handler;capture_done 120000\n")
