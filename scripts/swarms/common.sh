# What every swarm script begins with (sourced): find the programs, and say how to look at the swarm and how to end it.
set -euo pipefail
swarm_root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
command -v hivectl > /dev/null || PATH=$swarm_root/build/release/bin:$PATH
command -v hivectl > /dev/null || { echo "hivectl is not built; build it: scripts/build" >&2; exit 1; }

swarm_is_up() {
    echo "the swarm is up; look at it: hivectl top    end it: hivectl stop $*"
}
