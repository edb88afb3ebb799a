#!/bin/bash
# Moodle VPL runs this where the files of the student and of the activity are, then, without the
# activity's files, what it has written: vpl_execution. Where there is no grade in its output, VPL
# gives none. install.sh has to have been run on the jail server.
{
    echo '#!/bin/sh'
    echo "rubric='$(base64 -w0 rubric.yaml)'"
    cat <<'EOF'
scripts=${GRADER_SCRIPTS:-/opt}
venv=${GRADER_VENV:-/opt/turtlesim-grader}
work=$(mktemp -d)
printf %s "$rubric" | base64 -d >"$work/rubric.yaml"
code=0
EXERCISE=$work/rubric.yaml bash "$scripts/grade.sh" . "$work" 2>/dev/null || code=$?
case $code in
0 | 1) "$venv/bin/grader" report "$work/graded/result.json" --format moodle-vpl ;;
2) "$venv/bin/grader" report "$work/error.json" --format moodle-vpl ;;
*)
    "$venv/bin/grader" report "$work/error.json" --format moodle-vpl ||
        echo "Comment :=>> The grader failed. This is not your fault. Please tell the course staff."
    exit 3
    ;;
esac
EOF
} >vpl_execution
chmod +x vpl_execution
