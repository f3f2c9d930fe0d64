#!/usr/bin/env bash
# Camera, background, gesture: scripts/swarms/gesture.sh [camera settings...], for example source=/dev/video0
usage="gesture.sh [camera settings...], for example source=/dev/video0"
. "$(dirname "$0")/common.sh"

require_settings "$@"
[[ " $* " == *" faces="* ]] || runs camera || set -- faces=0 "$@"  # in the camera's own scene, unless another swarm looks for them
share camera "$@"
share background
share gesture
hivectl connect camera background
hivectl connect background.mask gesture
hivectl set camera hand=on  # the scene begins again: first without the hand, so that the background is learned
swarm_is_up gesture
