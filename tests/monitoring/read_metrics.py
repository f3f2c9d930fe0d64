#!/usr/bin/env python3
"""Reads OpenMetrics from stdin with the parser of prometheus_client, and checks the accounts in it.

Usage: read_metrics.py RULES DASHBOARD   (every metric that these name has to be in the text)
Prints the queries of the dashboard as rules, for promtool to parse.
"""
import collections
import json
import re
import sys

from prometheus_client.openmetrics.parser import text_string_to_metric_families


def accounts(samples, subject, settled, rest):
    """By labels: what came, and the sum of what became of it."""
    came, gone = {}, collections.Counter()
    for name, labels, value in samples:
        key = tuple(sorted(item for item in labels.items() if item[0] != "fate"))
        if name == subject:
            came[key] = value
        elif name == settled or name in rest:
            gone[key] += value
    return came, gone


def main():
    text = sys.stdin.read()
    samples = [(sample.name, sample.labels, sample.value)
               for family in text_string_to_metric_families(text) for sample in family.samples]
    for subject, settled, *rest in (
            ("hive_connection_came_events_total", "hive_connection_settled_events_total", "hive_connection_in_flight_events"),
            ("hive_group_came_events_total", "hive_group_settled_events_total", "hive_group_in_flight_events"),
            ("hive_input_received_events_total", "hive_input_settled_events_total", "hive_input_queued_events",
             "hive_input_in_progress_events")):
        came, gone = accounts(samples, subject, settled, rest)
        assert came and sum(came.values()) > 0, f"no {subject}"
        for key, events in came.items():
            assert events == gone[key], f"{subject}{dict(key)}: {events} came, {gone[key]} are accounted for"

    known = {name for name, _, _ in samples}
    with open(sys.argv[1]) as rules, open(sys.argv[2]) as file:
        named = rules.read()
        dashboard = json.load(file)
    queries = [target["expr"] for panel in dashboard["panels"] for target in panel["targets"]]
    queries.append(re.search(r"\((hive_\w+),", dashboard["templating"]["list"][1]["definition"]).group(1))
    for name in re.findall(r"hive_(?:audit|connection|drone|group|input|output|scrape)_\w+", named + " ".join(queries)):
        assert name in known, f"a rule or the dashboard names {name}, and there is none"
    ids = [panel["id"] for panel in dashboard["panels"]]
    assert len(ids) == len(set(ids)) and dashboard["id"] is None and dashboard["uid"] == "hive-swarm"

    print("groups: [{name: dashboard, rules: [")
    for number, query in enumerate(queries):
        query = query.replace("$__rate_interval", "1m").replace("$__range", "15m").replace("$drone", ".*")
        print(f"  {{record: query_{number}, expr: {json.dumps(query)}}},")
    print("]}]")


main()
