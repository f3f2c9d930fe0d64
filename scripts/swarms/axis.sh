#!/usr/bin/env bash
# An Axis camera and a face detector: scripts/swarms/axis.sh URL [axis settings...], for example
# scripts/swarms/axis.sh http://192.0.2.10 credentials=$HOME/.config/hive/camera resolution=640x480
usage="axis.sh URL [axis settings...], for example http://192.0.2.10 resolution=640x480"
. "$(dirname "$0")/common.sh"

[[ -n ${1:-} && ! $1 =~ ^(-|[A-Za-z0-9_.-]+=) ]] || refuse
url=$1
shift
require_settings "$@"
require_own face axis
share axis url="$url" "$@"
share face
hivectl connect axis face
swarm_is_up axis face
