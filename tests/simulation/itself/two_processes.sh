#!/usr/bin/env bash
# One seed gives the same digest in two processes with different addresses, environments and earlier histories. Usage:
# two_processes.sh SIMULATE
set -euo pipefail
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
told() { grep -v '^a second:' "$1"; }
history=(--seed 11 --trace --with connect-all crash-point fail part replace)
timeout 100 "$1" "${history[@]}" > "$scratch/one"
HIVE_HOME=/nowhere LONG_NAME=$(head -c 3000 /dev/zero | tr '\0' x) timeout 100 "$1" "${history[@]}" > "$scratch/other"
[ "$(wc -l < "$scratch/one")" -gt 100 ] || { echo "too little was told" >&2; exit 1; }
diff <(told "$scratch/one") <(told "$scratch/other") | head -n 20 >&2
echo "the same $(wc -l < "$scratch/one") lines"
