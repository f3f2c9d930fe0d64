#!/usr/bin/env bash
# One camera, one face detector: scripts/swarms/face.sh [camera settings...], for example source=/dev/video0
. "$(dirname "$0")/common.sh"

[ $# -gt 0 ] || set -- faces=1  # in the camera's own scene
share camera "$@"
hivectl start face
hivectl connect camera face
swarm_is_up face
