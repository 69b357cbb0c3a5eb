#!/usr/bin/env python3
"""No module of the firmware needs itself. A module is a header and the source of the same name; it needs those whose
headers either of them includes, and those in whose source a function is that its own header declares. A header without
a C source of its own promises what others provide (program.h, method.h): who uses it does not need them.
Usage: circles.py SOURCE"""
import pathlib
import re
import sys

PARTS = (".h", ".c", ".S", ".inc")


def plain(text):
    return re.sub(r"/\*.*?\*/|//[^\n]*", " ", text, flags=re.S)


def needs(root, path):
    """The files of the repository that a file includes."""
    for name in re.findall(r'^\s*#\s*include\s+"([^"]+)"', path.read_text(), re.M):
        found = [base / name for base in (path.parent, root) if (base / name).is_file()]
        if not found:
            raise SystemExit(f"{path}: includes {name}, which is not there")
        yield found[0].resolve()


def circle(below):
    """The modules of a circle, the first one at the end again; nothing if there is none."""
    done, way = set(), []

    def visit(module):
        if module in way:
            return way[way.index(module):] + [module]
        if module in done:
            return []
        done.add(module)
        way.append(module)
        for b in sorted(below.get(module, ())):
            found = visit(b)
            if found:
                return found
        way.pop()
        return []

    for module in sorted(below):
        found = visit(module)
        if found:
            return found
    return []


def at_top(text):
    """C code without comments, preprocessor lines, attributes and what is between braces."""
    code = re.sub(r"^\s*#(.*\\\n)*.*$", "", plain(text), flags=re.M)
    code = re.sub(r"__attribute__\s*\(\([^()]*\)\)", "", code)
    while re.search(r"{[^{}]+}", code):
        code = re.sub(r"{[^{}]+}", "{}", code)
    return code


def functions(path, end):
    """The functions whose parameters are followed by `end`: declarations or definitions that other files can use."""
    if path.suffix == ".S":
        return set(re.findall(r"^(\w+):", path.read_text(), re.M))
    head = rf"^((?:static )?)(?!typedef)\w[\w\s*]*?\b(\w+)\s*\([^;{{}}]*\)\s*"
    inline = {name for static, name in re.findall(head + "{", at_top(path.read_text()), re.M) if static}
    return {name for _, name in re.findall(head + end, at_top(path.read_text()), re.M)} - inline


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    firmware = root / "sw/firmware"
    files = sorted(p for p in firmware.rglob("*") if p.suffix in PARTS)
    home = {name: p for p in files if p.suffix in (".c", ".S") for name in functions(p, "{")}
    problems, below, declared = [], {}, 0

    def module(path):
        return str(path.relative_to(firmware).with_suffix(""))

    for path in files:
        needed = {p for p in needs(root, path) if firmware in p.parents}
        if path.suffix == ".h" and path.with_suffix(".c") in files:
            names = functions(path, ";")
            declared += len(names)
            problems += [f"{module(path)}.h: declares {n}(), which is nowhere" for n in sorted(names - set(home))]
            needed |= {home[n] for n in names if n in home}
        below.setdefault(module(path), set()).update({module(p) for p in needed} - {module(path)})
    found = circle(below)
    if found:
        problems.append("these need one another in a circle: " + " -> ".join(found))
    includes = sum(map(len, below.values()))
    if includes < 200 or declared < 100:
        problems.append("this test looks in the wrong place")
    for p in problems:
        print(p)
    print(f"{len(below)} modules, {includes} includes, {declared} functions, {len(problems)} problems")
    return 1 if problems else 0


sys.exit(main())
