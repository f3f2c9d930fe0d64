# shellcheck shell=bash
# Runs commands as a reader of a page would: ends streaming commands by Ctrl-C after $timeout seconds. To be sourced;
# $program is hivectl.
set -euo pipefail
hivectl() {
    local code=0 limit=60
    case "$1" in
        top|results|save|view|dash|exceptions|metrics) limit=$timeout ;;
        record) limit=$((timeout + 3)) ;;  # the other commands of a page use what it has recorded
    esac
    timeout -s INT "$limit" "$program" "$@" || code=$?
    case "$1:$code" in top:124|results:124|record:124|save:124|view:124|dash:124|exceptions:124|metrics:124) return 0 ;; esac
    return $code
}
command -v jq > /dev/null || jq() { cat; }
