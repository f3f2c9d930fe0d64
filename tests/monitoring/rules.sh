#!/usr/bin/env bash
# The rules for alerts are valid, and fire as their test says. Usage: tests/monitoring/rules.sh SOURCE_DIR
set -euo pipefail
command -v promtool > /dev/null || { echo "skipped: needs promtool, of the package prometheus"; exit 77; }
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cp "$1/hivectl/monitoring/hive.rules.yml" "$1/tests/monitoring/hive.rules.test.yml" "$scratch"
cd "$scratch"
promtool check rules --lint=all --lint-fatal hive.rules.yml
promtool test rules hive.rules.test.yml
