#!/usr/bin/env python3
"""Counts a CTest JUnit file: `count_results.py FILE` prints "passed failed skipped";
`count_results.py --skipped FILE` names the skipped tests."""
import sys
import xml.etree.ElementTree as xml


def status(case):
    state = case.get("status", "run")
    # GoogleTest's own skip reaches CTest as "notrun" with a skipped element.
    if case.find("skipped") is not None or state in ("notrun", "disabled"):
        return "skipped"
    return "failed" if state == "fail" or case.find("failure") is not None else "passed"


def main():
    cases = xml.parse(sys.argv[-1]).getroot().findall("testcase")
    if sys.argv[1] == "--skipped":
        for case in cases:
            if status(case) == "skipped":
                print("  skipped:", case.get("name"))
        return
    counts = [status(case) for case in cases]
    print(*(counts.count(word) for word in ("passed", "failed", "skipped")))


if __name__ == "__main__":
    main()
