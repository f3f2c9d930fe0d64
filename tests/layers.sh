#!/usr/bin/env bash
# Refuses includes that skip a layer or bring a library where it does not belong. Usage: tests/layers.sh SOURCE_DIR
set -euo pipefail
cd "$1"
failures=0

# refuse WHAT PATTERN PLACES...: no file in the places may include what matches.
refuse() {
    local what=$1 pattern=$2
    shift 2
    if grep -rnE --include='*.hpp' --include='*.cpp' --include='*.h' "^[[:space:]]*#[[:space:]]*include[[:space:]]*[<\"]$pattern" "$@"; then
        echo "layers: $what" >&2
        failures=$((failures + 1))
    fi
}

refuse "protocol knows nothing above it" 'hive/(transport|event|vision)/|hive/(event|drone|application)\.hpp' protocol
refuse "platform knows nothing of Hive" 'hive/(transport|event|discovery|vision|protocol)/|hive/[a-z_]+\.hpp' libhive/platform
refuse "transport knows no event" 'hive/(event|discovery|vision)/|hive/(event|drone|application)\.hpp' libhive/transport
refuse "discovery stands on transport alone" 'hive/(event|vision)/|hive/(event|drone|application)\.hpp' libhive/discovery
refuse "event knows neither service nor manager" 'hive/(drone|application)\.hpp|hive/(discovery|vision)/' libhive/event
refuse "service and manager are siblings" 'hive/application\.hpp|hive/vision/' libhive/service
refuse "service and manager are siblings" 'hive/drone\.hpp|hive/vision/' libhive/manager
refuse "hivectl uses the public API alone" 'hive/(transport|discovery|event|protocol|vision)/|hive/drone\.hpp' hivectl
refuse "drones use the public API and vision alone" 'hive/(transport|discovery|event|protocol)/|hive/application\.hpp' drones
refuse "language stands on the public API alone" '(hive/(transport|discovery|event|protocol|vision|recording)/|asio|opencv|CLI/|spdlog)' libhive/language
refuse "nothing of Hive itself is written against hive.h" 'hive\.h[">]' protocol libhive/transport libhive/discovery libhive/event libhive/service libhive/manager libhive/vision libhive/recording hivectl drones
refuse "recordings are made by who uses the public API" 'hive/recording/' protocol libhive/transport libhive/discovery libhive/event libhive/service libhive/manager libhive/vision
refuse "recording uses the public API alone" 'hive/(transport|discovery|event|protocol|vision)/|hive/(drone|application)\.hpp' libhive/recording
mapfile -t no_asio < <(find drones \( -name '*.hpp' -o -name '*.cpp' \) -not -path 'drones/axis/emulator/*')
refuse "Asio belongs to transport, event and the emulated camera" 'asio' protocol libhive/discovery libhive/service libhive/manager libhive/vision hivectl "${no_asio[@]}"
refuse "the emulated camera is no part of Hive" 'hive/' drones/axis/emulator
refuse "OpenCV belongs to vision and the drones" 'opencv' protocol libhive/transport libhive/discovery libhive/event libhive/service libhive/manager hivectl
refuse "CLI11 belongs to hivectl and the command line of the drones" 'CLI/' protocol libhive/transport libhive/discovery libhive/event libhive/manager libhive/vision drones
mapfile -t verbs < <(find hivectl \( -name '*.hpp' -o -name '*.cpp' \) -not -name command_line.cpp)
refuse "in hivectl one file knows CLI11: it takes seconds to compile" 'CLI/' "${verbs[@]}"
refuse "zlib belongs to recording" 'zlib' protocol libhive/transport libhive/discovery libhive/event libhive/service libhive/manager libhive/vision hivectl drones
refuse "curl belongs to the drones that fetch" 'curl/' protocol libhive hivectl
refuse "OpenSSL belongs to transport" 'openssl/' protocol libhive/discovery libhive/event libhive/service libhive/manager libhive/vision libhive/recording hivectl drones
refuse "Avahi belongs to discovery" 'avahi-' protocol libhive/transport libhive/event libhive/service libhive/manager libhive/vision libhive/recording libhive/language hivectl drones
mapfile -t no_http < <(find libhive -mindepth 1 -maxdepth 1 -not -name http)
refuse "libmicrohttpd belongs to http" 'microhttpd' protocol "${no_http[@]}" hivectl drones
refuse "http knows nothing else of Hive" 'hive/([a-z_]+\.hpp|[a-gi-z][a-z]*/)' libhive/http
refuse "public headers include the standard library and json only" '(asio|opencv|CLI|curl|openssl|spdlog)' \
    protocol/include/hive/*.hpp libhive/transport/include/hive/key.hpp libhive/event/include/hive/event.hpp libhive/event/include/hive/event_text.hpp libhive/event/include/hive/encoder.hpp libhive/event/include/hive/kept_failure.hpp libhive/event/include/hive/match.hpp libhive/service/include/hive libhive/manager/include/hive

if LC_ALL=C.UTF-8 grep -nE '^[^|].{120,}$' README.md || [ "$(wc -l < README.md)" -gt 200 ]; then
    echo "layers: README.md is read in a terminal: lines of at most 120 characters, and at most 200 of them" >&2
    failures=$((failures + 1))
fi

[ "$failures" -eq 0 ] || exit 1
echo "layers: every include points the right way"
