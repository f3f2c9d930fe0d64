#!/usr/bin/env python3
"""Runs the tests of a preset, and tells a test that is broken from one that only sometimes fails.

    tests/gate.py PRESET [CTEST OPTION...]

A test that fails is run again alone, twice. If it passes both times it is flaky: the exit code stays 0, and the line
`flaky: NAME (REASON)` is printed, also to the file that HIVE_GATE_LIST names. Skipped tests are listed the same way, and
with --stop-time the number of those that were not run. Any other failure ends with exit code 1.
"""
import os
import pathlib
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as xml

ROOT = pathlib.Path(__file__).resolve().parent.parent
UNKNOWN = "no failed check"
MAX_RERUN = 20  # more failures than that have one cause, and it is not luck


def first_line(text, *words):
    return next((line.strip() for line in text.splitlines() if any(word in line for word in words)), "")


def reason_of(output, seconds):
    """The first failed check with its values; of a crash or a hang only the duration is known."""
    check = first_line(output, "ERROR: ", "FATAL: ", "Error: ", "FAIL: ", "failed:", "Sanitizer: ")
    values = first_line(output[output.find(check):], "values: ") if check else ""
    return " ".join(filter(None, [check.removeprefix(str(ROOT) + "/"), values])) or f"{UNKNOWN}, over after {seconds:.1f} s"


class Run:
    """The verdicts of one run of ctest: names with reasons."""

    def __init__(self, report):
        self.failed, self.skipped, self.number = {}, {}, 0
        for case in xml.parse(report).iter("testcase"):
            self.number += 1
            output = case.findtext("system-out") or ""
            if case.find("failure") is not None:
                self.failed[case.get("name")] = reason_of(output, float(case.get("time") or 0))
            elif case.find("skipped") is not None:
                reason = first_line(output, "skipped: ").partition("skipped: ")[2]
                self.skipped[case.get("name")] = reason or case.find("skipped").get("message") or ""


def run_tests(preset, options=()):
    """Runs ctest; its output goes to ours. Exits if it ran no test."""
    with tempfile.NamedTemporaryFile(suffix=".xml") as report:
        done = subprocess.run(["ctest", "--preset", preset, "--output-junit", report.name, *options], cwd=ROOT,
                              check=False)
        run = Run(report.name) if os.path.getsize(report.name) > 0 else None
        if run is None or (done.returncode != 0 and not run.failed):
            sys.exit(f"gate: ctest ran no test, or failed without a failing test (exit code {done.returncode})")
        return run


def number_of_tests(preset, options):
    listed = subprocess.run(["ctest", "--preset", preset, "--show-only", *options], cwd=ROOT, check=True, capture_output=True, text=True)
    return int(listed.stdout.rpartition("Total Tests:")[2])


def report(lines):
    text = "".join(line + "\n" for line in lines)
    sys.stdout.write(text)
    if listed := os.environ.get("HIVE_GATE_LIST"):
        with open(listed, "a", encoding="utf-8") as file:
            file.write(text)


def main(arguments):
    if not arguments or arguments[0].startswith("-"):
        sys.exit(__doc__)
    preset, *options = arguments
    first = run_tests(preset, options)
    again = {}
    if 0 < len(first.failed) <= MAX_RERUN:
        print(f"gate: {len(first.failed)} failed; each is run again alone, twice", flush=True)
        again = run_tests(preset, ["--rerun-failed", "-j", "1", "--repeat", "until-fail:2"]).failed
    broken = again if len(first.failed) <= MAX_RERUN else first.failed
    left = number_of_tests(preset, options) - first.number if "--stop-time" in options else 0
    flaky = {name: reason for name, reason in first.failed.items()
             if name not in broken and not (left > 0 and reason.startswith(UNKNOWN))}  # those were cut
    report(f"skipped: {name} ({reason})" for name, reason in first.skipped.items())
    report([f"skipped: {left} tests of {preset} (no time left)"] if left > 0 else [])
    report(f"flaky: {name} ({reason})" for name, reason in flaky.items())
    report(f"failed: {name} ({reason})" for name, reason in broken.items())
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
