#!/usr/bin/env python3
"""Measures a drone in Python beside the same one in C++: run by scripts/bench --python.

A source in C++ gives its frames on demand, with a window of 8; the drones look at them one after the other, each for
some seconds, in turns. What one event costs is the time between two of them, and the processor time of the drone's
process.
"""
import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time

import hive

SIZES = {"64 B": 64, "100 KB": 100_000, "1080p raw": 6_220_800}
MORE_US, LEAST_RATE = 60, 0.85  # what is promised: of small events, and of 1080p


def processor_us(pid):
    with open(f"/proc/{pid}/stat", encoding="ascii") as file:
        fields = file.read().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) * 1_000_000 / os.sysconf("SC_CLK_TCK")


def measured(swarm, name, pid, seconds):
    """Time and processor time of one event, µs."""
    swarm.connect("source", name, window=8)
    time.sleep(0.2)
    first, used, begin = swarm.status(name)["events"]["processed"], processor_us(pid), time.monotonic()
    time.sleep(seconds)
    events = swarm.status(name)["events"]["processed"] - first
    took, used = (time.monotonic() - begin) * 1e6, processor_us(pid) - used
    swarm.disconnect("source", name)
    if events == 0:
        sys.exit(f"beside: {name} got nothing")
    return took / events, used / events


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("bin", help="folder of the build's programs")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--seconds", type=float, default=1.5, help="of each measurement")
    options = parser.parse_args()
    here = os.path.dirname(os.path.abspath(__file__))
    programs = {
        "source": [os.path.join(options.bin, "bench_pixels"), "source"],
        "cpp": [os.path.join(options.bin, "bench_pixels"), "look"],
        "taker": [os.path.join(options.bin, "bench_pixels"), "take"],
        "python": [sys.executable, os.path.join(here, "pixels.py")],
    }
    with tempfile.TemporaryDirectory(prefix="hv-", dir="/tmp") as home:
        os.environ["HIVE_HOME"] = home
        started = {name: subprocess.Popen([*words, "--name", name, "--log-level", "warning"])
                   for name, words in programs.items()}
        try:
            with hive.Application(timeout=20) as swarm:
                for name in started:
                    swarm.wait(name, timeout=20)
                for name in ("cpp", "python"):
                    swarm.connect(name, "taker", window=8)
                report(swarm, {name: process.pid for name, process in started.items()}, options)
        finally:
            for process in started.values():
                process.terminate()
                process.wait()


def report(swarm, pids, options):
    print(f"{'size':10} {'C++ µs':>9} {'Python µs':>10} {'more µs':>9} {'rate':>6}   processor time, µs: C++, Python")
    for label, size in SIZES.items():
        swarm.set("source", bytes=size)
        rows = [[measured(swarm, name, pids[name], options.seconds) for name in ("cpp", "python")]
                for _ in range(options.rounds)]
        cpp, python = (statistics.median(row[i][0] for row in rows) for i in (0, 1))
        more = statistics.median(row[1][0] - row[0][0] for row in rows)
        rate = statistics.median(row[0][0] / row[1][0] for row in rows)
        used = [statistics.median(row[i][1] for row in rows) for i in (0, 1)]
        print(f"{label:10} {cpp:9.1f} {python:10.1f} {more:9.1f} {rate:6.2f}   {used[0]:.1f}, {used[1]:.1f}", flush=True)
        if label == "64 B":
            print(f"           target: at most {MORE_US} µs an event more: {'met' if more <= MORE_US else 'MISSED'}")
        if label == "1080p raw":
            print(f"           target: at least {LEAST_RATE} of the rate: {'met' if rate >= LEAST_RATE else 'MISSED'}")


if __name__ == "__main__":
    main()
