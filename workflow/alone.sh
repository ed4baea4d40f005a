#!/usr/bin/env bash
# Run a command that makes results as the only run of this project: alone.sh COMMAND ARGUMENT...
# After one that removes them, `alone.sh --no-manifest COMMAND ARGUMENT...`, there is none to write.
# The kernel frees this lock when a run is killed. Snakemake's own would stay: it runs with --nolock.
# Snakemake writes no manifest where nothing is to be made; the one before may be missing or damaged.
set -euo pipefail
mkdir -p build
manifest=yes
test "$1" != --no-manifest || { manifest=no; shift; }
# The lock's file holds the process that has it.
flock --nonblock --conflict-exit-code 75 build/lock \
    bash -c 'echo $$ > build/lock; exec "$@"' run "$@" || {
    status=$?
    test $status -ne 75 || echo "error: another run of this project, process $(cat build/lock), has" \
        "not ended yet. Wait for it, or end it: kill -INT $(cat build/lock)" >&2
    exit $status
}
test $manifest = no || python -m dea.audit --collect
