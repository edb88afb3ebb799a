#!/usr/bin/env bash
# PrairieLearn runs this in the image of ../Dockerfile, as root: see docs/course-ci.md for the
# question's info.json. Without a results.json, PrairieLearn says that grading failed and takes no
# attempt from the student.
set -uo pipefail

root=${GRADE_ROOT:-/grade}
scripts=${GRADER_SCRIPTS:-/opt}
venv=${GRADER_VENV:-/opt/turtlesim-grader}
results=$root/results
work=$(mktemp -d)

mkdir -p "$results" && chmod 700 "$results"
rm -f "$results/results.json"
if [ -f "$root/tests/exercise.yaml" ]; then
    export EXERCISE=$root/tests/exercise.yaml
fi
code=0
bash "$scripts/grade.sh" "$root/student" "$work" || code=$?
case $code in
0 | 1)
    "$venv/bin/grader" report "$work/graded/result.json" --format prairielearn \
        --out "$results/results.json" || exit 3
    ;;
2)
    "$venv/bin/grader" report "$work/error.json" --format prairielearn \
        --out "$results/results.json" || exit 3
    ;;
*) exit 3 ;;
esac
