#!/usr/bin/env bash
# People who walk before a camera, and their tracks: scripts/swarms/tracking.sh [camera settings...], for example source=street.avi
. "$(dirname "$0")/common.sh"

[ $# -gt 0 ] || set -- faces=0 walkers=3  # people in the camera's own scene
hivectl start camera "$@"
hivectl start background
hivectl start track
hivectl connect camera background
hivectl connect background track
swarm_is_up camera background track
