#!/usr/bin/env bash
# One camera, one face detector: scripts/swarms/face.sh [camera settings...], for example source=/dev/video0
. "$(dirname "$0")/common.sh"

hivectl start camera "$@"
hivectl start face
hivectl connect camera face
swarm_is_up camera face
