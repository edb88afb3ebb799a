#!/usr/bin/env bash
# Grades a class on a dask cluster of one machine: a scheduler and two workers, which end with it. To
# try what is written for a cluster; for one machine alone `grader batch --jobs N` is simpler.
#
#     one_machine.sh SUBMISSIONS --out CLASS [an option of grader batch] ...
set -euo pipefail

PYTHON=${PYTHON:-python3} # with the grader: pip install 'turtlesim_py[cluster]'
WORKERS=${WORKERS:-2}     # one grading at a time each

work=$(mktemp -d)
trap 'kill $(jobs -p) 2>/dev/null || true; wait; rm -rf "$work"' EXIT
export DASK_TEMPORARY_DIRECTORY=$work

"$PYTHON" -m dask scheduler --host 127.0.0.1 --port 0 --no-dashboard \
    --scheduler-file "$work/scheduler.json" >"$work/log" 2>&1 &
for ((n = 0; n < WORKERS; n++)); do
    # waits for the file, and for the scheduler
    "$PYTHON" -m dask worker --scheduler-file "$work/scheduler.json" --nthreads 1 \
        --no-dashboard >>"$work/log" 2>&1 &
done
until [ -s "$work/scheduler.json" ]; do
    jobs %1 >/dev/null 2>&1 || { cat "$work/log" >&2; exit 3; }
    sleep 0.1
done
address=$("$PYTHON" -c 'import json, sys; print(json.load(open(sys.argv[1]))["address"])' \
    "$work/scheduler.json")
"$PYTHON" -m grader batch "$@" --scheduler "$address"
