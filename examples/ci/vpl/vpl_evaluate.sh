#!/bin/bash
# Moodle VPL runs this where the student's files are, then what it has written: vpl_execution.
# install.sh has to have been run on the jail server. Where there is no grade in the output, VPL
# gives none.
cat >vpl_execution <<'EOF'
#!/bin/sh
scripts=${GRADER_SCRIPTS:-/opt}
venv=${GRADER_VENV:-/opt/turtlesim-grader}
work=$(mktemp -d)
code=0
bash "$scripts/grade.sh" . "$work" 2>/dev/null || code=$?
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
chmod +x vpl_execution
