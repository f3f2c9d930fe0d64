#!/usr/bin/env bash
# Refuses includes that skip a layer or bring a library where it does not belong. Usage: tests/layers.sh SOURCE_DIR
set -euo pipefail
cd "$1"
failures=0

# refuse WHAT PATTERN PLACES...: no file in the places may include what matches (a Perl regular expression).
refuse() {
    local what=$1 pattern=$2 found=0
    shift 2
    grep -rnP --include='*.hpp' --include='*.cpp' --include='*.h' "^\s*#\s*include\s*[<\"]($pattern)" "$@" || found=$?
    [ "$found" -ne 1 ] || return 0  # 0: found; 2: a place is missing
    echo "layers: $what" >&2
    failures=$((failures + 1))
}

# The public headers of all layers are in one folder, so the compiler accepts an upward include of one. This table says whose
# each is. A header that is not listed belongs to the manager, which no other layer may include.
headers=libhive/include/hive
event=("$headers"/{encoder,event,event_text,kept_failure,match}.hpp)
service=("$headers"/{drone,embedded_drone}.hpp)
mapfile -t manager < <(LC_ALL=C comm -23 <(printf '%s\n' "$headers"/*.hpp | LC_ALL=C sort) <(printf '%s\n' "${event[@]}" "${service[@]}" | LC_ALL=C sort))
any_of() { printf '%s|' "${@#libhive/include/}" | sed 's/\./\\./g; s/|$//'; }
of_service=$(any_of "${service[@]}") of_manager=$(any_of "${manager[@]}")
public=$(any_of "$headers"/*.hpp)

refuse "protocol knows nothing above it" "hive/(transport|event|vision)/|$public" protocol
refuse "platform knows nothing of Hive" 'hive/(transport|event|discovery|vision|protocol)/|hive/[a-z_]+\.hpp' libhive/platform
refuse "transport knows no event" "hive/(event|discovery|vision)/|$public" libhive/transport
refuse "discovery stands on transport alone" "hive/(event|vision)/|$public" libhive/discovery
refuse "event knows neither service nor manager" "$of_service|$of_manager|hive/(discovery|vision)/" libhive/event "${event[@]}"
refuse "service and manager are siblings" "$of_manager|hive/vision/" libhive/service "${service[@]}"
refuse "service and manager are siblings" "$of_service|hive/vision/" libhive/manager "${manager[@]}"
refuse "vision converts events alone" "$of_service|$of_manager|hive/(transport|discovery|protocol)/" libhive/vision "$headers/vision"
refuse "hivectl uses the public API alone, and changes keys" "hive/(transport/(?!(key|folder_lock)\.hpp)|(discovery|event|protocol|vision)/)|$of_service" hivectl
refuse "drones use the public API and vision alone" "hive/(transport|discovery|event|protocol)/|$of_manager" drones
refuse "language stands on the public API alone" '(hive/(transport|discovery|event|protocol|vision|recording)/|asio|opencv|CLI/|spdlog)' libhive/language libhive/include/hive.h libhive/include/hive_swarm.h
refuse "the headers for C include C alone" 'hive/' libhive/include/hive.h libhive/include/hive_swarm.h
refuse "nothing of Hive itself is written against hive.h" 'hive\.h[">]' protocol libhive/transport libhive/discovery libhive/event libhive/service libhive/manager libhive/vision libhive/recording hivectl drones
refuse "recordings are made by who uses the public API" 'hive/recording/' protocol libhive/transport libhive/discovery libhive/event libhive/service libhive/manager libhive/vision
refuse "recording uses the public API alone" "hive/(transport|discovery|event|protocol|vision)/|$of_service|$of_manager" libhive/recording
refuse "Asio belongs to transport and event" 'asio' protocol libhive/discovery libhive/service libhive/manager libhive/vision hivectl drones
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
refuse "http knows nothing else of Hive than platform" 'hive/([a-z_]+\.hpp|(?!platform)[a-gi-z][a-z]*/)' libhive/http
refuse "public headers include public headers, the standard library and json only" '(?!hive/[a-z_]+\.hpp>|nlohmann/|[a-z_]+>)' \
    protocol/include/hive/*.hpp "$headers"/*.hpp

if grep -rnE --include='*.hpp' --include='*.cpp' '(sleep_for|sleep_until|usleep)\(' protocol libhive; then
    echo "layers: libhive sleeps nowhere: wait for what is to happen, with a deadline" >&2
    failures=$((failures + 1))
fi

if grep -rnE --include='*.hpp' --include='*.cpp' \
    '(what|advice)\(\)[^;]*( [!=]= |find\(|starts_with|ends_with)|[!=]= [a-z_.>-]*(what|advice)\(\)' protocol libhive hivectl drones; then
    echo "layers: an error is recognised by its code, not by its text" >&2
    failures=$((failures + 1))
fi

if LC_ALL=C.UTF-8 grep -nE '^[^|].{120,}$' README.md || [ "$(wc -l < README.md)" -gt 200 ]; then
    echo "layers: README.md is read in a terminal: lines of at most 120 characters, and at most 200 of them" >&2
    failures=$((failures + 1))
fi

if grep -rnE --include='*.md' --exclude-dir=build --exclude-dir=.git '^(MEASURED|CALCULATED|TODO)$' .; then
    echo "layers: a page lacks what was to be filled in" >&2
    failures=$((failures + 1))
fi

[ "$failures" -eq 0 ] || exit 1
echo "layers: every include points the right way"
