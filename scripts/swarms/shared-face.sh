#!/usr/bin/env bash
# One camera, N face detectors that share its pictures: scripts/swarms/shared-face.sh N [camera settings...]
usage="shared-face.sh N [camera settings...], for example 2 source=/dev/video0"
. "$(dirname "$0")/common.sh"

[[ ${1:-} =~ ^[1-9][0-9]?$ ]] || refuse
count=$1
shift
require_settings "$@"
workers=()
share camera "$@"
for ((i = 1; i <= count; i++)); do
    share "face-$i"
    workers+=("face-$i")
done
hivectl connect camera "${workers[@]}" --share
swarm_is_up "'face-*'"
