#!/usr/bin/env python3
"""What pages name in code exists in the program: its commands and options where a line or span begins with `fovea`,
keys of parameters and names of figures anywhere.
Usage: page_names.py FOVEA SOURCE BUILD OUT [PAGE...]: all pages of SOURCE, and these, which are named
without their folder.

A name of figures or keys is two or more words with dots between them whose first one begins a key or a figure. A star
and a word in capitals stand for anything, a number for any other."""
import json
import re
import subprocess
import sys
from pathlib import Path

# Endings of files, which look like names: `stats.json`.
FILES = set("bin c callgrind cc cfg cmake conf cpp csv dat elf f folded h html ini input json ld log md mp4 png py "
            "rstl s sh stl sv trace txt xml yaml".split())
NAME = re.compile(r"(?<![\w./-])([a-z]\w*(?:\.[A-Za-z_*][\w*]*)+)(?![\w/(.])")
# Runs that have all kinds of figures between them.
RUNS = {
    "engine": ["run", "{small}", "--no-frames", "--profile", "--bus-trace", "{trace}", "-s", "engine=both_tlm",
               "-s", "firmware.kernel=engine", "-s", "cameras.count=2"],
    "lines": ["run", "{lines}", "--no-frames"],
    "replay": ["replay", "{trace}"],
}
EXPERIMENTS = {
    "small": "run: {frames: 2, start_limit: 3s}\ncamera: {kind: chart, stamp: false}\nvideo: {width: 64, height: 16}\n",
    "lines": "run: {frames: 1, start_limit: 3s}\ncamera: {kind: lines, lens: equisolid, stamp: false}\n"
             "lens: {mapping: equisolid}\nvideo: {width: 320, height: 240}\nfirmware: {lut: fixed_point}\n",
}


class Program:
    def __init__(self, fovea, source, build, out):
        self.fovea, self.out = fovea, out
        self.options = {}  # by command; of the program itself: ""
        self.groups = set()  # commands that have commands
        self.learn_command([])
        names = set(self.keys()) | set(self.figures()) | set(tests_of(source, build))
        # Of pictures that take seconds to make.
        for file in ("mosaic_score.cpp", "picture_score.cpp"):
            names |= set(re.findall(r'"(quality\.\w+)"', (source / "sw/fovea/board" / file).read_text(encoding="utf-8")))
        self.names = {plain(n) for n in names}
        for name in list(self.names):
            for at in re.finditer(r"\.", name):
                self.names.add(name[:at.start()])
        self.first = {n.split(".")[0] for n in self.names}

    def said(self, *arguments):
        r = subprocess.run([self.fovea, *arguments], capture_output=True, text=True, check=False)
        if r.returncode:
            sys.exit(f"fovea {' '.join(arguments)}: status {r.returncode}: {r.stderr[-500:]}")
        return r.stdout

    def learn_command(self, words):
        text = self.said(*words, "--help")
        self.options[" ".join(words)] = set(re.findall(r"(?<![\w-])(--?[a-z][\w-]*)", text))
        commands = re.search(r"^Subcommands:\n(.*?)\n\n", text, re.M | re.S)
        for name in re.findall(r"^  (\w+) ", commands[1] if commands else "", re.M):
            self.groups.add(" ".join(words))
            self.learn_command([*words, name])

    def keys(self):
        yield from re.findall(r"\bexec\.\w+", self.said("completion", "bash"))
        for which in ([], ["--replay"]):
            yield from re.findall(r"^(\w+(?:\.\w+)*) ", self.said("params", *which).partition("\n\n")[0], re.M)

    def figures(self):
        files = {name: self.out / f"{name}.yaml" for name in EXPERIMENTS}
        for name, text in EXPERIMENTS.items():
            files[name].write_text(text, encoding="utf-8")
        for name, arguments in RUNS.items():
            folder = self.out / name
            self.said(*(a.format(trace=self.out / "bus.trace", **files) for a in arguments), "-o", str(folder))
            for file in ("stats.json", "host.json"):
                with open(folder / file, encoding="utf-8") as f:
                    yield from (k for k, v in json.load(f).items() if isinstance(v, dict))

    def knows(self, name):
        name = plain(name)
        pattern = re.sub(r"(?<=\.)[A-Z][A-Z_]*(?=\\|$)", ".+", re.escape(name)).replace(r"\*", ".*")
        return name in self.names or any(re.fullmatch(pattern, n) for n in self.names)

    def call(self, line):
        """What is wrong with a line that calls the program."""
        words = line.split()
        command = []
        for word in words[1:]:
            if " ".join([*command, word]) not in self.options:
                break
            command.append(word)
        known = self.options[" ".join(command)]
        rest = words[1 + len(command):]
        if " ".join(command) in self.groups and rest and re.fullmatch(r"[a-z]+", rest[0]):
            yield f"no command 'fovea {' '.join([*command, rest[0]])}'"
        for word in rest:
            option = re.match(r"(--?[a-z][\w-]*)", word)
            if option and option[1] not in known and option[1][:2] not in known - {"--"}:
                yield f"'fovea {' '.join(command)}' has no option {option[1]}"


def plain(name):
    return re.sub(r"\d+", "N", name)


def tests_of(source, build):
    """Names of tests look like those of figures. Those within a program that is not built are not listed."""
    listed = subprocess.run(["ctest", "--test-dir", build, "-N"], capture_output=True, text=True, check=True).stdout
    yield from re.findall(r"#\d+: (\S+)", listed)
    for file in source.glob("tb/**/CMakeLists.txt"):
        text = file.read_text(encoding="utf-8")
        yield from re.findall(r"\bNAME (\w+\.\w+)", text)  # some need tools that are not everywhere
        for layer in re.findall(r"TEST_PREFIX (\w+)\.", text):
            for test in file.parent.glob("*.cpp"):
                for name in re.findall(r"^TEST(?:_F|_P)?\((\w+, *\w+)\)", test.read_text(encoding="utf-8"), re.M):
                    yield layer + "." + re.sub(", *", ".", name)


def code_of(page):
    """Spans and lines of code, with their numbers."""
    block = False
    for number, line in enumerate(page.read_text(encoding="utf-8").split("\n"), 1):
        if line.lstrip().startswith("```"):
            block = not block
        elif block:
            yield number, line.split("#")[0].strip()
        else:
            yield from ((number, span) for span in re.findall(r"`([^`]+)`", line))


def complaints(program, pages):
    for page, name in pages:
        for number, code in code_of(page):
            if call := re.match(r"(?:build/release/|\./)?(fovea( [^|;&>]*)?)(?=$|[|;&>])", code):
                for fault in program.call(call[1]):
                    yield f"{name}:{number}: {fault}"
            for word in NAME.findall(code):
                ends = word.split(".")
                if ends[0] in program.first and ends[-1] not in FILES and not program.knows(word):
                    yield f"{name}:{number}: '{word}' is neither a key nor a figure"


def main(fovea, source, build, out, *pages):
    source, out = Path(source), Path(out)
    out.mkdir(parents=True, exist_ok=True)
    pages = [(Path(p), Path(p).name) for p in pages] + [
        (p, p.relative_to(source).as_posix()) for p in sorted(source.rglob("*.md"))
        if p.name != "CHANGELOG.md" and p.relative_to(source).parts[0] not in ("build", "out")
        and not any(part.startswith(".") for part in p.relative_to(source).parts)]
    found = list(complaints(Program(fovea, source, build, out), pages))
    print("\n".join(found) or "pages: every name exists")
    return bool(found)


sys.exit(main(*sys.argv[1:]))
