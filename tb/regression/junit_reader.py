#!/usr/bin/env python3
"""Reads JUnit XML as the servers do that show it, independently of the program that writes it and of the schema.

GitLab (documentation, "Unit test reports") takes from each test case its classname, which it shows as the suite, name
and time, and from a failure its text; of two cases with the same classname and name it takes the first. Jenkins (JUnit
plugin) takes suites from `testsuites` or alone, of each the name, and of a failure its attribute `message` and its text;
it wants no element that it does not know. Both need the file to be XML in UTF-8.

Usage: junit_reader.py FILE.xml      prints "failed CLASS NAME: FIRST LINE" or "passed CLASS NAME" for each case
Exit status: 0 read, 1 something that one of them would not show, with a line for each
"""
import re
import sys
import xml.etree.ElementTree as tree

KNOWN = {"testsuites", "testsuite", "properties", "property", "testcase", "failure", "error", "skipped", "system-out",
         "system-err"}
GITLAB_BYTES = 30_000_000


def faults(data, root):
    """What a server would drop, or refuse the file for."""
    out = [f"unknown element {e.tag}" for e in root.iter() if e.tag not in KNOWN]
    if len(data) > GITLAB_BYTES:
        out.append("larger than 30 MB")
    if root.tag not in ("testsuites", "testsuite"):
        return out + [f"the root is {root.tag}"]
    suites = [root] if root.tag == "testsuite" else list(root)
    if not suites:
        out.append("no suite")
    seen = set()
    for suite in suites:
        name = suite.get("name", "")
        if not name:
            out.append("a suite without a name")
        cases = suite.findall("testcase")
        counts = {"tests": len(cases)}
        for kind, tag in (("failures", "failure"), ("errors", "error"), ("skipped", "skipped")):
            counts[kind] = sum(c.find(tag) is not None for c in cases)
        for kind, number in counts.items():
            if suite.get(kind, "0" if kind == "skipped" else None) != str(number):
                out.append(f"suite {name}: {kind} is {suite.get(kind)}, its cases make {number}")
        for case in cases:
            key = case.get("classname", ""), case.get("name", "")
            if not all(key):
                out.append(f"a case without classname or name: {key}")
            if key in seen:
                out.append(f"two cases {key[0]} {key[1]}: only the first one would be shown")
            seen.add(key)
            if not re.fullmatch(r"\d+(\.\d+)?", case.get("time", "")):
                out.append(f"case {key[1]}: time is {case.get('time')}")
            for failure in case.findall("failure"):
                if not failure.get("message") or not (failure.text or "").strip():
                    out.append(f"case {key[1]}: a failure without a message or without a text")
    return out


def main():
    data = open(sys.argv[1], "rb").read()
    try:
        data.decode("utf-8")
        root = tree.fromstring(data)
    except (UnicodeDecodeError, tree.ParseError) as e:
        print(f"not XML in UTF-8: {e}")
        return 1
    found = faults(data, root)
    if found:
        print("\n".join(found))
        return 1
    for case in root.iter("testcase"):
        failure = case.find("failure")
        where = f"{case.get('classname')} {case.get('name')}"
        print(f"passed {where}" if failure is None else f"failed {where}: {failure.get('message')}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
