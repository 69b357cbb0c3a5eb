#!/usr/bin/env python3
"""Sources of model and programs: lengths of functions, events that keep no horizon true. Usage: sources.py SOURCE"""
import re
import sys
from pathlib import Path

LINES = 80  # of a function; those of the style are shorter
FOLDERS = ("model", "sw")
SUFFIXES = {".c", ".cpp", ".h"}
# The only place that may hold events: a Timer tells agents that work ahead that their horizon has moved.
EVENTS = "model/common/timer.h"

# What has braces, semicolons or words without being code: comments, literals and preprocessor lines.
NO_CODE = re.compile(
    r"""//[^\n]* | /\*.*?\*/ | R"([^(\s]*)\(.*?\)\1" | "(?:\\.|[^"\\\n])*" | (?<![0-9A-Fa-f])'(?:\\.|[^'\\\n])+'
      | ^[ \t]*\#(?:\\\n|[^\n])*""", re.S | re.M | re.X)
SCOPE = re.compile(r"^\s*(?:template\s*<.*>\s*)?(?:inline\s+|typedef\s+|static\s+)*"
                   r"(?:namespace|class|struct|union|enum|extern)\b", re.S)


def code_of(text):
    """The text with blanks for all that is not code; lines stay where they are."""
    return NO_CODE.sub(lambda m: re.sub(r"[^\n]", " ", m[0]), text)


def functions(code):
    """(first line, last line, name) of each function's body that is not inside another one."""
    open_scopes = []  # for each brace that is open: (offset, what precedes it, is it a scope of declarations)
    since = 0
    for at, character in enumerate(code):
        if character == "{":
            before = code[since:at]
            inside = all(scope for _, _, scope in open_scopes)
            open_scopes.append((at, before, bool(SCOPE.match(before)) and not before.rstrip().endswith(")") and inside))
            since = at + 1
        elif character == "}":
            since = at + 1
            if not open_scopes:
                continue
            start, before, scope = open_scopes.pop()
            if not scope and "(" in before and all(s for _, _, s in open_scopes):
                name = re.search(r"([~\w:]+|operator\W+)\s*\(", before)
                yield code.count("\n", 0, start) + 1, code.count("\n", 0, at) + 1, name[1] if name else "?"
        elif character == ";":
            since = at + 1


def complaints(name, text):
    code = code_of(text)
    for first, last, function in functions(code):
        if last - first + 1 > LINES:
            yield f"{name}:{first}: {function} has {last - first + 1} lines; at most {LINES}"
    if name.startswith("model/") and name != EVENTS:
        for found in re.finditer(r"\bsc_event(?:_queue)?\b(?!\s*&)", code):
            line = code.count("\n", 0, found.start()) + 1
            yield f"{name}:{line}: an event that keeps no horizon true; allowed: a Timer ({EVENTS})"


def check_itself():
    """The matcher sees what it must, and not what it must not."""
    body = "  // }\n  f('{', \"}}\", 1'000);\n" * (LINES // 2)
    long_ones = {
        "member": "namespace a {\nstruct S : B<int> {\n  int f(int x) const {\n" + body + "  }\n};\n}\n",
        "constructor": "A::A(int x)\n    : a_{x}, b_(x) {\n" + body + "}\n",
        "in C": "static int f(void) {\n#define X {\n" + body + "}\n",
        "in a template": "template <class T>\nvoid g(T t) {\n  for (;;) {\n" + body + "  }\n}\n",
    }
    for what, text in long_ones.items():
        assert any("lines" in c for c in complaints("sw/x.cpp", text)), what
        assert not any(complaints("sw/x.cpp", text.replace("  f(", "//f(", 1).replace("  // }\n", "", 6))), what
    assert not any(complaints("sw/x.cpp", "struct S {\n" + "  int f() { return 1; }\n" * 200 + "};\n"))
    assert not any(complaints("sw/x.cpp", "constexpr Row kRows[] = {\n" + "  {1, f(2)},\n" * 200 + "};\n"))
    event = "class A {\n  sc_core::sc_event changed_;\n};\n"
    assert any(complaints("model/a.h", event)) and not any(complaints(EVENTS, event))
    assert not any(complaints("model/a.h", "const sc_core::sc_event& event() const;  // not an sc_event\n"))


check_itself()
source = Path(sys.argv[1])
files = [f for folder in FOLDERS for f in sorted((source / folder).rglob("*")) if f.suffix in SUFFIXES]
found = [c for f in files for c in complaints(f.relative_to(source).as_posix(), f.read_text(encoding="utf-8"))]
if len(files) < 300:
    found.append(f"only {len(files)} sources in {' and '.join(FOLDERS)}")
print("\n".join(found) or "sources: nothing found")
sys.exit(bool(found))
