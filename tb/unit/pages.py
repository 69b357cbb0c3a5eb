#!/usr/bin/env python3
"""Markdown pages: width of the lines, headings of READMEs, links to files and headings. C, C++ and
SystemVerilog: width of the lines. Pages and sources: words for persons, where a part of a program or chip is meant.
In a git checkout: what is tracked at the top, and what is tracked and ignored.
Usage: pages.py SOURCE"""
import os
import re
import subprocess
import sys
from pathlib import Path

WIDTH = 120
HEADINGS = ("Purpose", "Concepts|Use", "How it works", "Limits")
# Folders without code of their own, and the page of the whole project.
FREE = {"README.md", "model/howto/README.md", "traces/pictures/README.md", "tb/report/axe-core/README.md"}
# The top level is fixed; files whose names begin with a dot may be added.
TOP = {"CMakeLists.txt", "CMakePresets.json", "CHANGELOG.md", "CONTRIBUTING.md", "LICENSE", "README.md",
       "model", "rtl", "scripts", "sw", "tb", "traces"}
CODE = (".h", ".cpp", ".c", ".S", ".sv")
WORDED = CODE + (".svh", ".py", ".sh", ".yaml", "CMakeLists.txt", ".md")
PERSONS = re.compile(r"\b(somebody|nobody|whoever|anybody|everybody)\b", re.IGNORECASE)
FOREIGN = ("tb/e2e/texts/", "tb/report/axe-core/", "tb/unit/pages.py", "tb/unit/pages_complains.sh")
# Texts of messages that tests or recorded outputs repeat, by file.
KEPT = {"sw/fovea/cli/params_table.cpp": "nobody's but the user's",
        "sw/fovea/regression/markdown.cpp": '"nobody"', "tb/regression/first_baseline_test.cpp": "**who**: nobody",
        "model/engine/rtl/slave_checker.h": "nobody asked for", "tb/cosim/slave_checker_test.cpp": "nobody asked for",
        "model/engine/remap_engine.cpp": "that nobody answers", "tb/engine/chip_test.cpp": "that nobody answers"}


def files_of(source, endings):
    for folder, inner, files in os.walk(source):
        top = Path(folder) == source
        inner[:] = [d for d in inner if not d.startswith(".") and not (top and d in ("build", "out"))]
        yield from (Path(folder) / f for f in files if f.endswith(endings))


def prose(text):
    """The lines outside blocks of code, with their numbers."""
    code = False
    for number, line in enumerate(text.split("\n"), 1):
        if line.lstrip().startswith("```"):
            code = not code
        elif not code:
            yield number, line


def anchors(page):
    """As GitHub makes them of headings."""
    for _, line in prose(page.read_text(encoding="utf-8")):
        if heading := re.match(r"#+ (.*)", line):
            words = re.sub(r"[^\w\- ]", "", re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading[1]).lower())
            yield words.replace(" ", "-")


def strays(source):
    """Results of runs and the like, added by accident."""
    git = subprocess.run(["git", "-C", source, "ls-files", "-z"], capture_output=True, text=True)
    for name in sorted({file.split("/")[0] for file in git.stdout.split("\0") if file}):
        if name not in TOP and not name.startswith("."):
            yield f"{name}: does not belong at the top, where only {', '.join(sorted(TOP))} and files with a dot are"
    ignored = subprocess.run(["git", "-C", source, "ls-files", "-z", "--cached", "--ignored", "--exclude-standard"],
                             capture_output=True, text=True)
    for name in filter(None, ignored.stdout.split("\0")):
        yield f"{name}: is tracked, though .gitignore names it"


def persons(source):
    for file in sorted(files_of(source, WORDED)):
        name, text = file.relative_to(source).as_posix(), file.read_text(encoding="utf-8", errors="replace")
        if name.startswith(FOREIGN):
            continue
        for number, line in prose(text) if file.suffix == ".md" else enumerate(text.split("\n"), 1):
            for word in PERSONS.findall(line.replace(KEPT.get(name, ""), "")):
                yield f"{name}:{number}: '{word}'; name the part: the caller, another process, no master, a user"


def complaints(source):
    yield from strays(source)
    yield from persons(source)
    for file in sorted(files_of(source, CODE)):
        name = file.relative_to(source).as_posix()
        for number, line in enumerate(file.read_text(encoding="utf-8").split("\n"), 1):
            if len(line) > WIDTH:
                yield f"{name}:{number}: {len(line)} columns; at most {WIDTH}"
    for page in sorted(files_of(source, ".md")):
        name, text = page.relative_to(source).as_posix(), page.read_text(encoding="utf-8")
        for number, line in enumerate(text.split("\n"), 1):
            if len(line) > WIDTH and not line.lstrip().startswith("|"):
                yield f"{name}:{number}: {len(line)} columns; at most {WIDTH}, rows of tables excepted"
        if page.name == "README.md" and name not in FREE:
            for heading in HEADINGS:
                if not re.search(rf"^## ({heading})$", text, re.M):
                    yield f"{name}: no heading '## {heading}'"
        for number, line in prose(text):
            for link in re.findall(r"\]\(([^) ]+)\)", re.sub(r"`[^`]*`", "", line)):
                target, _, anchor = link.partition("#")
                file = page if not target else page.parent / target
                if "://" in link:
                    continue
                if not file.exists():
                    yield f"{name}:{number}: no file for the link {link}"
                elif anchor and anchor not in anchors(file):
                    yield f"{name}:{number}: no heading for the link {link}"


found = list(complaints(Path(sys.argv[1])))
print("\n".join(found) or "pages: nothing found")
sys.exit(bool(found))
