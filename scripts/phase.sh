# Runs the long steps of a script and shows their progress (sourced).

# phase WHAT COMMAND...: runs COMMAND. On a terminal its output is shown. Otherwise there is one line, WHAT and the seconds that it took,
# and if COMMAND fails, the end of its output. Everything goes to stderr.
phase() {
    local what=$1 start=$SECONDS code=0 log
    shift
    if [ -t 2 ]; then
        echo "== $what" >&2
        "$@" >&2 || code=$?
        [ $code -ne 0 ] || echo "== $((SECONDS - start)) s" >&2
    else
        log=$(mktemp)
        printf '%s ... ' "$what" >&2
        "$@" > "$log" 2>&1 || code=$?
        if [ $code -eq 0 ]; then
            echo "$((SECONDS - start)) s" >&2
        else
            printf 'failed after %s s\n' "$((SECONDS - start))" >&2
            tail -n 60 "$log" >&2
        fi
        rm -f "$log"
    fi
    return $code
}
