#!/bin/sh
# A program is skipped (77) if every selected case was skipped and none failed. Usage: skips.sh PROGRAM
gives() {
    code=$1
    shift
    "$program" "$@" > /dev/null
    found=$?
    [ $found -eq "$code" ] || { echo "$*: exit code $found, expected $code"; failed=1; }
}
program=$1
failed=0
gives 77 --test-case=skipped
gives 77 '--test-case=*skipped' '--test-case-exclude=failed*,one*'
gives 0 --test-case=passed,skipped
gives 1 --test-case=failed,skipped
gives 1 '--test-case=failed*'
gives 0 '--test-case=one part skipped'
gives 0 --test-case=none
gives 0 --list-test-cases
exit $failed
