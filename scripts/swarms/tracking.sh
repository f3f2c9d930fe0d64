#!/usr/bin/env bash
# People who walk before a camera, and their tracks: scripts/swarms/tracking.sh [camera settings...], for example source=street.avi
usage="tracking.sh [camera settings...], for example source=street.avi"
. "$(dirname "$0")/common.sh"

require_settings "$@"
if [ $# -eq 0 ]; then  # people in the camera's own scene, and no faces, unless another swarm looks for them
    set -- walkers=3
    runs camera || set -- faces=0 "$@"
fi
share camera "$@"
share background
share track
hivectl connect camera background
hivectl connect background track
swarm_is_up track
