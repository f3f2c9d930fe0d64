#!/usr/bin/env bash
# The library exports what is listed, the headers declare it, and nothing else is visible. Usage: symbols.sh LIBRARY HEADERS LIST NM
set -euo pipefail
library=$1 headers=$2 list=$3 nm=$4

exported=$("$nm" -D --defined-only "$library" | awk '$2 != "A" { sub(/@.*/, "", $3); print $3 }' | LC_ALL=C sort)
declared=$(cat "$headers"/*.h | tr '\n' ' ' | grep -oE 'HIVE_API [^;(]*\(' | grep -oE 'hive_[a-z_]+ ?\($' | tr -d ' (' | LC_ALL=C sort)
difference() {
    diff "$list" <(printf '%s\n' "$1") > /tmp/hive-symbols.$$ && { rm -f /tmp/hive-symbols.$$; return; }
    echo "symbols: $2 differs from $list (< listed, > there):" >&2
    cat /tmp/hive-symbols.$$ >&2
    rm -f /tmp/hive-symbols.$$
    exit 1
}
difference "$exported" "what the library exports"
difference "$declared" "what the headers declare"
echo "symbols: $(wc -l < "$list") functions, and nothing else"
