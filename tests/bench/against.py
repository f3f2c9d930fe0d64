"""Compares this build of Hive with another one, in turns: python3 against.py THIS/bin OTHER/bin [--column REGEX] [--pairs N].

Each row is one way of moving bytes by `bench_hive`; a pair is one run of each build, one directly after the other, and
every second pair runs the other build first. A ratio above 1 means that this build is better: it sends more each second,
or takes less time (lat). The median of the pairs' ratios counts; `from` and `to` enclose the median with 95 % confidence
if there are at least 6 pairs, and are the smallest and the largest ratio otherwise.
"""
import argparse
import json
import math
import os
import re
import statistics
import subprocess
import sys

LARGE = 6_220_800
ROWS = {  # column: what bench_hive is given after its variant, and the variants
    "lat64": (["lat", "64", "frames=90"], ["local", "tcp"]),
    "lat100K": (["lat", "100000", "frames=90"], ["local", "tcp"]),
    "lat6.2M": (["lat", str(LARGE), "frames=60"], ["local", "tcp"]),
    "thr100K": (["thr", "100000", "seconds=0.5", "window=32"], ["local", "tcp", "tls"]),
    "thr6.2M": (["thr", str(LARGE), "seconds=0.5", "window=2"], ["local", "tcp", "tls"]),
    "fan4": (["thr", str(LARGE), "seconds=0.5", "window=2", "subscribers=4"], ["local"]),
    "rpc64": (["rpc", "64", "seconds=0.5"], ["local", "tcp", "tls"]),
    "sync100K": (["sync", "100000", "seconds=0.5", "window=1"], ["local", "tcp", "tls"]),
    "sync6.2M": (["sync", str(LARGE), "seconds=0.5", "window=1"], ["local", "tcp"]),
}


def goodness(binaries, variant, words):
    """Events per second, or for latency one per median; None when a frame was lost or corrupt."""
    own = {**os.environ, "LD_LIBRARY_PATH": f"{binaries}/../lib"}  # not the library of the build that has its path
    done = subprocess.run([f"{binaries}/bench_hive", variant, *words], capture_output=True, text=True, timeout=60, env=own)
    if done.returncode:
        sys.exit(f"{binaries}/bench_hive {variant} {' '.join(words)}: {done.stderr.strip()}")
    figures = json.loads(done.stdout)
    if not figures["ok"]:
        return None
    return 1 / figures["p50"] if words[0] == "lat" else figures["per_second"]


def interval(ratios):
    """The order statistics that enclose the median with 95 % confidence (the sign test)."""
    count, tail, outside = len(ratios), 0.0, 0
    while outside < count // 2:
        tail += math.comb(count, outside) / 2**count
        if tail > 0.025:
            break
        outside += 1
    skipped = max(outside - 1, 0)
    return sorted(ratios)[skipped], sorted(ratios)[count - 1 - skipped]


def compare(this, other, variant, words, pairs):
    ratios = []
    for turn in range(pairs):
        order = [this, other] if turn % 2 else [other, this]
        found = {binaries: goodness(binaries, variant, words) for binaries in order}
        if all(found.values()):
            ratios.append(found[this] / found[other])
    return ratios


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("this")
    parser.add_argument("other")
    parser.add_argument("--column", default=".*", help="a regular expression, as in 'lat64|rpc'")
    parser.add_argument("--pairs", type=int, default=11)
    given = parser.parse_args()
    print(f"{'':10} {'':6} {'median':>7} {'from':>6} {'to':>6} {'pairs':>6}")
    for column, (words, variants) in ROWS.items():
        if not re.search(given.column, column):
            continue
        for variant in variants:
            ratios = compare(given.this, given.other, variant, words, given.pairs)
            if len(ratios) < 2:
                sys.exit(f"{column} {variant}: fewer than two pairs in which no frame was lost")
            low, high = interval(ratios)
            print(f"{column:10} {variant:6} {statistics.median(ratios):7.2f} {low:6.2f} {high:6.2f} {len(ratios):6}", flush=True)


if __name__ == "__main__":
    main()
