#!/usr/bin/env bash
# An Axis camera and a face detector: scripts/swarms/axis.sh URL|emulated [axis settings...], for example
# scripts/swarms/axis.sh http://192.0.2.10 credentials=$HOME/.config/hive/camera resolution=640x480
usage="axis.sh URL|emulated [axis settings...], for example http://192.0.2.10 resolution=640x480"
. "$(dirname "$0")/common.sh"

[[ -n ${1:-} && ! $1 =~ ^(-|[A-Za-z0-9_.-]+=) ]] || refuse
url=$1
shift
require_settings "$@"
require_own face axis
if [ "$url" != emulated ]; then
    set -- url="$url" "$@"
elif runs axis; then
    echo "axis runs already, with the URL $(hivectl get axis url)"
else
    log=$(mktemp)
    coproc camera { exec "$swarm_root/tests/support/axis_camera.py" 2> "$log"; }
    pid=$!
    read -r _ _ url <&"${camera[0]}" && read -r _ _ control <&"${camera[0]}" || {
        cat "$log" >&2
        echo "the emulated camera needs Python with numpy and OpenCV; install them: scripts/install-deps users" >&2
        exit 1
    }
    set -- url="$url" allow_address=127.0.0.1 "$@"
    echo "an emulated camera runs; see what it can do: curl $control    end it: kill $pid"
fi
share axis "$@"
share face
hivectl connect axis face
swarm_is_up axis face
