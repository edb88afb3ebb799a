#!/usr/bin/env bash
# PrairieLearn runs this in the image of the Dockerfile, as root, with what a question and a student
# give below /grade. Without a results.json, PrairieLearn says that grading failed and takes no
# attempt from the student.
set -uo pipefail

root=${GRADE_ROOT:-/grade}
scripts=${GRADER_SCRIPTS:-/opt}
venv=${GRADER_VENV:-/opt/turtlesim-grader}
results=$root/results
work=$(mktemp -d)

mkdir -p "$results" && chmod 700 "$results"
rm -f "$results/results.json"
export EXERCISE=$root/tests/rubric.yaml
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
