#!/usr/bin/env bash
# An Axis camera and a face detector: scripts/swarms/axis.sh URL [axis settings...], for example
# scripts/swarms/axis.sh http://192.0.2.10 credentials=$HOME/.config/hive/camera resolution=640x480
. "$(dirname "$0")/common.sh"

url=${1:?usage: scripts/swarms/axis.sh URL [axis settings...]}
shift
hivectl start axis url="$url" "$@"
hivectl start face
hivectl connect axis face
swarm_is_up axis face
