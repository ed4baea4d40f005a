#!/usr/bin/env bash
# Run a command of Snakemake as the only run of this project: alone.sh snakemake TARGET...
# A run that is killed frees this lock, and would leave Snakemake's own. Where the run before was
# killed at its very end, nothing is left to do but the manifest.
set -euo pipefail
mkdir -p build
flock --nonblock --conflict-exit-code 75 build/lock "$@" --nolock || {
    status=$?
    test $status -ne 75 || echo "error: another run of this study has not ended yet" >&2
    exit $status
}
python -m dea.audit --collect
