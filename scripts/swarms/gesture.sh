#!/usr/bin/env bash
# Camera, background, gesture: scripts/swarms/gesture.sh [camera settings...], for example source=/dev/video0
. "$(dirname "$0")/common.sh"

[ $# -gt 0 ] || set -- hand=on faces=0
hivectl start camera "$@"
hivectl start background
hivectl start gesture
hivectl connect camera background
hivectl connect background.mask gesture
swarm_is_up camera background gesture
