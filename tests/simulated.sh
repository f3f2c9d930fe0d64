#!/usr/bin/env bash
# Refuses calls to the machine in objects that the simulator links: what they need of it they ask of hive/platform.
# Usage: tests/simulated.sh OBJECT...
# The objects that reach below Home (files) still do so directly; files are not among the refused calls yet.
set -euo pipefail

# Undefined symbols as `nm -uC` prints them. Asio's headers bring the threads of its own scheduler and resolver, which
# nobody starts, so pthread_create is not among them; std::thread is.
refused='std::chrono::(_V2::)?(steady|system)_clock::now|std::random_device|std::thread::_M_start_thread|std::this_thread::__sleep_for'
refused+='|(clock_)?nanosleep|usleep|sleep|clock_gettime|gettimeofday|time|getpid|getppid|gettid|getrandom|kill|v?fork|posix_spawnp?'
refused+='|exec[lv][pe]*|system|popen|waitpid|signalfd|timerfd_(create|settime)|sigaction|signal'
refused+='|socket|socketpair|connect|bind|listen|accept4?|getaddrinfo|gethostname|poll|ppoll|select'

failures=0
for object in "$@"; do
    case $object in *.gch) continue ;; esac
    symbols=$(nm -uC "$object")
    if found=$(sed 's/^ *U //; s/@.*//; s/(.*//' <<< "$symbols" | grep -xE "$refused"); then
        sed "s|^|${object##*/CMakeFiles/}: |" <<< "$found" >&2
        failures=$((failures + 1))
    fi
done
[ "$failures" -eq 0 ] || { echo "simulated: $failures objects touch the machine; see hive/platform" >&2; exit 1; }
echo "simulated: the objects leave the machine to hive/platform"
