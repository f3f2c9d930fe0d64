#!/usr/bin/env python3
"""Counts how often hivectl explain names the injected cause first: at least 95 % of the causes that its tests inject.

    explain_count.py PROGRAM...

Runs the cases "explain:*" of each program. They append one line per injected cause to the file $HIVE_EXPLAINED. Each
cause of the list below must be among them.
"""
import json
import multiprocessing.pool
import os
import pathlib
import re
import subprocess
import sys
import tempfile

REQUIRED = 0.95
# What must be injected: a cause, and words in its case, sentence or evidence that tell it from others of that name.
CAUSES = [
    ("not running", "not_running", ""),
    ("stopped on purpose", "not_running", "stopped on purpose"),
    ("crashed", "crashed", "SIGSEGV"),
    ("restarts again and again", "failed", "in a row"),
    ("suspended", "suspended", ""),
    ("no answer", "no_answer", ""),
    ("machine unreachable, since when", "unreachable", "lost it"),
    ("key missing", "refused", "without the key"),
    ("other key", "refused", "another key"),
    ("viewer's key", "refused", "a viewer may not"),
    ("other version", "refused", "another version"),
    ("refused connection", "refused", "tock"),
    ("starting", "starting", ""),
    ("halted, by whom", "halted", ", as "),
    ("set not decided", "set_prepared", ""),
    ("exception at each event, which", "throws", "is one of those"),
    ("stuck in one event", "stuck", ""),
    ("source ended", "source_ended", ""),
    ("source stalled", "silent_source", ""),
    ("camera gone while it runs", "condition", "goes away while"),
    ("camera away", "condition", "without its source"),
    ("login refused", "condition", "login required"),
    ("disk full", "condition", "disk full"),
    ("not connected", "not_connected", ""),
    ("wrong way round", "wrong_way", ""),
    ("types do not fit", "wrong_types", ""),
    ("sender at another port", "dialing", ""),
    ("backlog that is not collected", "held", ""),
    ("on demand without receivers", "no_receiver", ""),
    ("on demand only watched", "watched", "only headers"),
    ("on demand only viewers", "watched", "only viewers"),
    ("place kept for a receiver", "receiver_away", ""),
    ("a source on demand, and the receiver that requests nothing", "waits", "does not request"),
    ("group without members", "not_running", "lost its members"),
    ("group member with leases is suspended", "suspended", "lost its members"),
    ("lease running", "slow", "a member of a group"),
    ("slow callback, p99", "slow", "99 %"),
    ("credit 1 over a long round trip", "small_window", ""),
    ("stream over a slow network", "slow_connection", "dropped"),
    ("lane full of a synchronized connection", "slow_connection", "has sent nothing"),
    ("encoder busy", "encoder", ""),
    ("shared memory refused", "copied", ""),
    ("processors full", "load", ""),
    ("memory", "memory", ""),
    ("clock wrong", "clock", ""),
    ("two drones of one name", "same_name", ""),
    ("emits nothing", "emits_nothing", ""),
]


SKIPPED = 77  # the exit code of a test that lacks something


def cases_of(program):
    """A command for each case: most of them wait, so several run at a time."""
    listed = subprocess.run([program, "--list-test-cases", "--test-case=explain*"], capture_output=True, text=True, check=True)
    names = [line for line in listed.stdout.splitlines() if line.startswith("explain")]
    return [[program, "--test-case=" + re.sub(r"[,\\]", "?", name)] for name in names]


def injected_by(programs):
    """The rows of all programs, and whether a case was skipped."""
    with tempfile.TemporaryDirectory() as folder, multiprocessing.pool.ThreadPool(4) as pool:
        file = pathlib.Path(folder, "explained")
        file.touch()
        env = {**os.environ, "HIVE_EXPLAINED": str(file)}

        def run(command):
            return command, subprocess.run(command, env=env, capture_output=True, text=True, check=False)

        skipped = False
        for command, done in pool.imap(run, [case for program in programs for case in cases_of(program)]):
            if done.returncode not in (0, 1, 77):
                sys.exit(f"{command} ended with {done.returncode}:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
            if done.returncode == 1:
                print(done.stdout[-4000:])
            skipped = skipped or done.returncode == 77
        return [json.loads(line) for line in file.read_text().splitlines()], skipped


def label(named):
    return f'{named["what"]} {named["drone"]}' if named else "nothing"


def is_injected(row, what, words):
    text = json.dumps(row, ensure_ascii=False)
    return row["injected"].split()[0] == what and words in text


def main():
    rows, skipped = injected_by(sys.argv[1:])
    missed = [row for row in rows if label(row["named"]) != row["injected"]]
    for row in missed:
        print(f'missed: {row["case"]}: injected {row["injected"]}, first named {label(row["named"])}:'
              f' {row["named"]["text"] if row["named"] else ""}')
    absent = [title for title, what, words in CAUSES if not any(is_injected(row, what, words) for row in rows)]
    for title in absent:
        print(f"not injected: {title}")
    hits = len(rows) - len(missed)
    print(f"{hits} of {len(rows)} injected causes were named first")
    if not rows or hits < REQUIRED * len(rows) or (absent and not skipped):
        return 1
    return SKIPPED if absent else 0


if __name__ == "__main__":
    sys.exit(main())
