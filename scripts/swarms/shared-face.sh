#!/usr/bin/env bash
# One camera, N face detectors that share its pictures: scripts/swarms/shared-face.sh N [camera settings...]
. "$(dirname "$0")/common.sh"

count=${1:?usage: scripts/swarms/shared-face.sh N [camera settings...], for example 2 source=/dev/video0}
shift
workers=()
share camera "$@"
for ((i = 1; i <= count; i++)); do
    hivectl start face --as "face-$i"
    workers+=("face-$i")
done
hivectl connect camera "${workers[@]}" --share
swarm_is_up "'face-*'"
