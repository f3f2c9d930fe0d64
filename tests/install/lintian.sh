#!/usr/bin/env bash
# Lintian has no error on the Debian packages of a build. Skipped where lintian is not installed.
# Usage: lintian.sh BUILD CPACK
set -euo pipefail
build=$1 cpack=$2

command -v lintian > /dev/null || { echo "skipped: lintian is not installed; install it: apt install lintian"; exit 77; }
place=$(mktemp -d /tmp/hive-lintian-XXXXXX)
trap 'rm -rf "$place"' EXIT
(cd "$place" && "$cpack" --config "$build/CPackConfig.cmake" -G DEB -B "$place/made" -D CPACK_OUTPUT_FILE_PREFIX="$place/debs") \
    > "$place/log" 2>&1 || { tail -n 10 "$place/log" >&2; exit 1; }
timeout 500 lintian --fail-on error --allow-root "$place"/debs/*.deb
