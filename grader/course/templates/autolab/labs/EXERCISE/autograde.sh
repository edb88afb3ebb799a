#!/usr/bin/env bash
# Grades for Autolab, in the image of image/Dockerfile. The last line on standard output is the
# scores; where there is none, Autolab says that the autograder failed.
set -uo pipefail

# the name under which Autolab puts the file that was handed in beside this script, as in @@exercise.yml
handed_in=handin.zip

scripts=${GRADER_SCRIPTS:-/opt}
venv=${GRADER_VENV:-/opt/turtlesim-grader}
export EXERCISE=$PWD/rubric.yaml
work=$(mktemp -d)

code=0
bash "$scripts/grade.sh" "$handed_in" "$work" || code=$?
case $code in
0 | 1)
    "$venv/bin/grader" report "$work/graded/result.json"
    "$venv/bin/grader" report "$work/graded/result.json" --format autolab
    ;;
2)
    "$venv/bin/grader" report "$work/error.json"
    "$venv/bin/grader" report "$work/error.json" --format autolab --exercise "$EXERCISE"
    ;;
*) exit 3 ;;
esac
