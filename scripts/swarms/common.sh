# What every swarm script begins with (sourced): find the programs, share what runs already, say how to look at the swarm and how to end it.
set -euo pipefail
swarm_root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
command -v hivectl > /dev/null || PATH=$swarm_root/build/release/bin:$PATH
command -v hivectl > /dev/null || { echo "hivectl is not built; build it: scripts/build" >&2; exit 1; }

runs() { hivectl get "$1" > /dev/null 2>&1; }

# A drone that swarms share: started with these settings, or, when it runs already, only set.
share() {
    local drone=$1
    shift
    if ! runs "$drone"; then
        hivectl start "$drone" "$@"
    elif [ $# -gt 0 ]; then
        hivectl set "$drone" "$@"
    fi
}

# The drones that are this swarm's own.
swarm_is_up() {
    echo "the swarm is up; look at it: hivectl top    end it: hivectl stop $*    end all: hivectl stop --all"
}
