# What every swarm script begins with (sourced): find the programs, check the arguments, share what runs already, say how to look at the swarm
# and how to end it. `usage` says how the script is called.
set -euo pipefail
swarm_root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
command -v hivectl > /dev/null || PATH=$swarm_root/build/release/bin:$PATH
command -v hivectl > /dev/null || { echo "hivectl is not built; build it: scripts/build" >&2; exit 1; }

refuse() {
    echo "usage: scripts/swarms/$usage" >&2
    exit 2
}

require_settings() {
    local word
    for word; do
        [[ $word =~ ^[A-Za-z0-9_.-]+= ]] || refuse
    done
}

runs() { hivectl get "$1" > /dev/null 2>&1; }

# Is DRONE free for this swarm, which feeds it from SENDER? One that others feed is another swarm's.
require_own() {
    local feeds
    feeds=$(hivectl connections "$1" --json 2> /dev/null | grep -o "\"from\":\"[^\"]*\",\"to\":\"$1\.[^\"]*\"") || return 0
    if grep -qv "^\"from\":\"$2\." <<< "$feeds"; then
        echo "$1 runs already, for another swarm; end it: hivectl stop $1" >&2
        exit 1
    fi
}

# A drone that may run already, for another swarm or since the script ran before: then it is only set. Otherwise it is started with these
# settings; face-2 is of the kind face.
share() {
    local drone=$1
    shift
    if ! runs "$drone"; then
        hivectl start "${drone%-[0-9]*}" --as "$drone" "$@"
    elif [ $# -gt 0 ]; then
        hivectl set "$drone" "$@"
    fi
}

# The drones that are this swarm's own.
swarm_is_up() {
    echo "the swarm is up; look at it: hivectl top    end it: hivectl stop $*    end all: hivectl stop --all"
}
