#!/bin/sh
# Prints the tests that CTest has just run and that were skipped, with their reasons. Usage: tests/skipped.sh BUILD_DIR
awk '
    /^[0-9]+\/[0-9]+ Test: / { name = $0; sub(/^[0-9]+\/[0-9]+ Test: /, "", name); reason = "" }
    /^skipped: / && reason == "" { reason = substr($0, 10) }
    /^Test Passed\./ && reason != "" { print "skipped: " name ": " reason }  # the log calls them passed
' "$1/Testing/Temporary/LastTest.log.tmp"
