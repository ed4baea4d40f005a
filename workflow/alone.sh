#!/usr/bin/env bash
# Run a command that makes results as the only run of this project: alone.sh COMMAND ARGUMENT...
# The kernel frees this lock when a run is killed. Snakemake's own would stay: it runs with --nolock.
# Where the run before was killed at its very end, nothing is left to do but the manifest.
set -euo pipefail
mkdir -p build
# The lock's file holds the process that has it.
flock --nonblock --conflict-exit-code 75 build/lock \
    bash -c 'echo $$ > build/lock; exec "$@"' run "$@" || {
    status=$?
    test $status -ne 75 || echo "error: another run of this project, process $(cat build/lock), has" \
        "not ended yet. Wait for it, or end it: kill -INT $(cat build/lock)" >&2
    exit $status
}
python -m dea.audit --collect
