"""Counts the instructions of an event and of a request, at both ends: python3 instructions.py BUILD/bin [COLUMN/VARIANT...].

Each row runs twice under valgrind's callgrind, for a short and for a longer time; the difference, divided by the events or
requests that the longer run had more, leaves out start and end. The number of events sent before all subscribers are
ready differs from run to run, hence the long runs at 400 Hz. Counts of a request move by 1 %, those of an event by 5 %,
times by 15 % and more.
"""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

ROWS = {  # column: the test of bench_hive, the words of the short and of the longer run, and the roles by their number
    "lat64": ("lat", "frames=100", "frames=2100", {"1": "publisher", "2": "subscriber"}),
    "rpc64": ("rpc", "seconds=1", "seconds=6", {"3": "drone", "4": "application"}),
}


def run(binaries, variant, test, length):
    """How many events or requests were sent, and the instructions of each role."""
    with tempfile.TemporaryDirectory() as scratch:
        command = ["valgrind", "--tool=callgrind", "--trace-children=yes", f"--callgrind-out-file={scratch}/out.%p",
                   f"--log-file={scratch}/log.%p", f"{binaries}/bench_hive", variant, test, "64", length,
                   "rate=400", "timeout=60"]
        own = {**os.environ, "LD_LIBRARY_PATH": f"{binaries}/../lib"}  # not the library of the build that has its path
        done = subprocess.run(command, capture_output=True, text=True, timeout=120, env=own)
        if done.returncode or not json.loads(done.stdout)["ok"]:
            sys.exit(f"{' '.join(command)}: {done.stderr.strip() or 'events were lost'}")
        counts = {}
        for name in os.listdir(scratch):
            with open(f"{scratch}/{name}", errors="replace") as file:
                text = file.read()
            role = re.search(r"^cmd: .* role=(\d)", text, re.M)
            if role:
                counts[role[1]] = int(re.search(r"^(?:totals|summary): (\d+)", text, re.M)[1])
        return json.loads(done.stdout)["sent"], counts


def main():
    binaries, *rows = sys.argv[1:]
    if not shutil.which("valgrind"):
        sys.exit("instructions: valgrind is not installed: scripts/install-deps --bench")
    for row in rows or [f"{column}/{variant}" for column in ROWS for variant in ("local", "tcp")]:
        column, variant = row.split("/")
        test, short, longer, roles = ROWS[column]
        sent_before, before = run(binaries, variant, test, short)
        sent, after = run(binaries, variant, test, longer)
        each = {name: (after[role] - before[role]) / (sent - sent_before) for role, name in roles.items()}
        if min(each.values()) <= 0:
            sys.exit(f"{row}: no count: {each}")
        ends = ", ".join(f"{name} {count:,.0f}" for name, count in each.items())
        print(f"{row}: {sum(each.values()):,.0f} instructions ({ends})", flush=True)


if __name__ == "__main__":
    main()
