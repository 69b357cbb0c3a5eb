#!/usr/bin/env python3
"""The folders of the host program are libraries: none includes a header of a folder whose library it does not link, no
two need each other, no source lies outside of them, and names of figures stand in one file.
Usage: rooms.py SOURCE"""
import pathlib
import re
import sys

MOST_SOURCES = 20  # of `cli`, which has one for each command
TOP = {"CMakeLists.txt", "README.md", "main.cpp"}


def calls(text, function):
    """The arguments of each call of a CMake function."""
    text = re.sub(r"#.*", "", text)
    return [m.group(1).split() for m in re.finditer(rf"\b{function}\(([^)]*)\)", text)]


def main():
    root = pathlib.Path(sys.argv[1]) / "sw/fovea"
    problems = []
    for entry in root.iterdir():
        if entry.is_file() and entry.name not in TOP:
            problems.append(f"{entry.name}: lies in no folder")

    owner, links = {}, {}  # library: folder; folder: libraries
    for listed in sorted(root.glob("*/CMakeLists.txt")):
        folder, text = listed.parent.name, listed.read_text()
        links[folder] = set()
        for name, *_ in calls(text, "fovea_library") + calls(text, "fovea_room"):
            owner[name] = folder
        sources = len(list(listed.parent.glob("*.cpp")))
        if sources > MOST_SOURCES:
            problems.append(f"{folder}: {sources} sources; allowed: {MOST_SOURCES}")
        for _, *libraries in calls(text, "target_link_libraries"):
            links[folder] |= set(libraries)
    if len(links) < 15:
        problems.append(f"{len(links)} folders found: this test looks in the wrong place")

    below = {folder: {owner[l] for l in libraries if l in owner} - {folder} for folder, libraries in links.items()}

    def reached(folder, seen):
        for b in below[folder]:
            if b not in seen:
                seen.add(b)
                reached(b, seen)
        return seen

    reach = {folder: reached(folder, set()) for folder in below}
    problems += [f"{folder}: needs itself by way of {', '.join(sorted(below[folder]))}"
                 for folder in sorted(reach) if folder in reach[folder]]
    includes = 0
    for path in sorted(root.glob("*/*")):
        if path.suffix not in (".h", ".cpp"):
            continue
        folder = path.parent.name
        for line in path.read_text().splitlines():
            m = re.match(r'#include "sw/fovea/(\w+)/', line)
            if not m:
                continue
            includes += 1
            if m.group(1) != folder and m.group(1) not in reach[folder]:
                problems.append(f"{folder}/{path.name}: includes a header of {m.group(1)}, which "
                                f"{folder}/CMakeLists.txt does not link")
    names = re.findall(r'= ("[a-z0-9_.]+");', (root / "results/names.h").read_text())
    if len(names) < 30:
        problems.append(f"{len(names)} names of figures found: this test looks in the wrong place")
    for path in sorted(root.glob("*/*")):
        if path.suffix not in (".h", ".cpp") or path.name == "names.h":
            continue
        code = re.sub(r"//.*", "", path.read_text())
        problems += [f"{path.parent.name}/{path.name}: {name} is written out; results/names.h has it"
                     for name in names if name in code]
    if includes < 300:
        problems.append(f"{includes} includes found: this test looks in the wrong place")
    for p in problems:
        print(p)
    print(f"{len(links)} folders, {includes} includes, {len(problems)} problems")
    return 1 if problems else 0


sys.exit(main())
