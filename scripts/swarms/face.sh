#!/usr/bin/env bash
# One camera, one face detector: scripts/swarms/face.sh [camera settings...], for example source=/dev/video0
usage="face.sh [camera settings...], for example source=/dev/video0"
. "$(dirname "$0")/common.sh"

require_settings "$@"
require_own face camera
[ $# -gt 0 ] || set -- faces=1  # in the camera's own scene
share camera "$@"
share face
hivectl connect camera face
swarm_is_up face
