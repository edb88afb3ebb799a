#!/bin/bash
# Grades a class as an array of Slurm jobs, and puts the parts together in one more job. Submissions,
# class and grader are in folders that all nodes see.
#     bash array.sh SUBMISSIONS CLASS [an option of grader batch] ...
#
# A part that was cut short goes on where it was: the same call again.
set -eu
# EDIT: so many parts, and what each may take; 100 submissions need about ten minutes of one core
parts=16
limits="--cpus-per-task=4 --mem=4G --time=01:00:00"
# EDIT: the grader
export GRADER=${GRADER:-/opt/turtlesim-grader/bin/grader}

case ${1-} in
--part)
    shift 1
    submissions=$1 class=$2
    shift 2
    part=$SLURM_ARRAY_TASK_ID
    exec "$GRADER" batch "$submissions" --out "$class.parts/$part" \
        --shard "$part/$SLURM_ARRAY_TASK_COUNT" --jobs "${SLURM_CPUS_PER_TASK:-1}" "$@"
    ;;
--merge)
    class=$2
    shift 2
    exec "$GRADER" batch --merge "$class.parts"/* --out "$class" "$@"
    ;;
esac

script=$(realpath "$0") submissions=$(realpath "$1") class=$(realpath -m "$2")
shift 2
mkdir -p "$class.parts"
array=$(sbatch --parsable --job-name=grade --array="1-$parts" $limits --requeue \
    --output="$class.parts-%a.log" "$script" --part "$submissions" "$class" "$@")
# afterany: a part that is missing, or not finished, is told by the merge
sbatch --job-name=gradebook --dependency="afterany:${array%%;*}" --output="$class.log" \
    "$script" --merge "$class" "$@"
