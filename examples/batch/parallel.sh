#!/bin/bash
# Grades a class on several machines with GNU parallel: no server, only ssh and a shared folder. Each
# machine has the grader at the same place.
#     bash parallel.sh SUBMISSIONS CLASS [an option of grader batch] ...
set -eu
# EDIT: so many parts; a few for each machine, so that none of them waits for the last
parts=16
# EDIT: the machines, as ssh takes them; ":" is this one
machines=:,grade1,grade2
# EDIT: the grader, at the same place on all of them
export GRADER=${GRADER:-/opt/turtlesim-grader/bin/grader}

submissions=$(realpath "$1") class=$(realpath -m "$2")
shift 2
mkdir -p "$class.parts"
# One part on each machine at a time: it takes all of its cores. What fails of it the merge tells.
parallel --sshlogin "$machines" --jobs 1 --workdir "$PWD" --env GRADER --retries 3 --quote \
    "$GRADER" batch "$submissions" --shard "{}/$parts" --out "$class.parts/{}" "$@" \
    ::: $(seq "$parts") || true
"$GRADER" batch --merge "$class.parts"/* --out "$class" "$@"
