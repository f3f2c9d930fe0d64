#!/usr/bin/env python3
"""Counts how often hivectl explain named the injected cause first: in at least 95 % of the cases that inject one.

    explain_count.py FILE

The cases "explain:*", which the presets release and slow run, append a line to FILE for each cause that they inject. After a
full count FILE is removed, so that the next count is of the next run. Each cause of the list below must be among them;
the count is skipped if one is not because a case was skipped, or one of the presets has not run.
"""
import json
import pathlib
import sys

REQUIRED = 0.95
PROGRAMS = {"e2e_explain", "e2e_explain_busy", "e2e_explain_machines"}
SKIPPED = 77  # the exit code of a test that lacks something
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


def rows_of(file):
    """Of a case that was run again, the last ones count."""
    rows = [json.loads(line) for line in file.read_text().splitlines()] if file.exists() else []
    return list({(row["program"], row["case"], row["number"]): row for row in rows}.values())


def label(named):
    return f'{named["what"]} {named["drone"]}' if named else "nothing"


def is_injected(row, what, words):
    text = json.dumps(row, ensure_ascii=False)
    return row["injected"].split()[0] == what and words in text


def main():
    file = pathlib.Path(sys.argv[1])
    noted = rows_of(file)
    rows = [row for row in noted if "injected" in row]
    missed = [row for row in rows if label(row["named"]) != row["injected"]]
    for row in missed:
        print(f'missed: {row["case"]}: injected {row["injected"]}, first named {label(row["named"])}:'
              f' {row["named"]["text"] if row["named"] else ""}')
    absent = [title for title, what, words in CAUSES if not any(is_injected(row, what, words) for row in rows)]
    hits = len(rows) - len(missed)
    print(f"{hits} of {len(rows)} injected causes were named first")
    if hits < REQUIRED * len(rows):
        return 1
    if absent:
        excused = len(rows) < len(noted) or {pathlib.Path(row["program"]).name for row in noted} != PROGRAMS
        print("skipped: not injected:" if excused else "not injected:", ", ".join(absent))
        return SKIPPED if excused else 1
    file.unlink()
    return 0


if __name__ == "__main__":
    sys.exit(main())
