#!/usr/bin/env bash
# Grades one submission so that the student's code does not reach the grade.
#
#     grade.sh SUBMISSION WORK [OPTION of `grader run`]...
#
# The folder WORK gets
#     graded/       what `grader run` leaves: result.json, canvas.png, ...
#     message.txt   with the exit codes 2 and 3: what to tell the student
#     log.txt       all that the grader said, for the staff
# The exit code says whose turn it is:
#     0  judged, whatever the score          1  judged, below --fail-under
#     2  the submission cannot be used: the student's; no points, message.txt says what to mend
#     3  the grader failed, also when tried again: the staff's; there is no judgement
#
#     EXERCISE=...        name, or the path of an edited exercise.yaml
#     GRADER_VENV=...     where install.sh has put the grader; default /opt/turtlesim-grader
#     GRADER_LIMIT_S=...  for everything together, in seconds; default 500
#     GRADER_USER=...     where this runs as root: whom the submission runs as. Default
#                         turtle-grader, made if need be; a user who has nothing else to do, since
#                         all that still runs as that user in the end is killed
#
# The submission is run as a copy, without the environment of whoever calls this (tokens, places of
# results), and cannot gain privileges; where this runs as root, as a user who can write nothing
# but the copy's folder.
set -uo pipefail
umask 022

submission=${1:?usage: grade.sh SUBMISSION WORK [OPTION]...}
work=${2:?usage: grade.sh SUBMISSION WORK [OPTION]...}
shift 2
exercise=${EXERCISE:-turtlesim_challenge}
venv=${GRADER_VENV:-/opt/turtlesim-grader}
limit_s=${GRADER_LIMIT_S:-500}
user=${GRADER_USER-turtle-grader}

mkdir -p "$work" && work=$(cd "$work" && pwd) || exit 3
rm -rf "$work"/{graded,message.txt,log.txt}
: >"$work/log.txt"

# not below WORK: that user need not be able to go there
box=$(mktemp -d /tmp/grading.XXXXXX) || exit 3
trap 'rm -rf "$box"' EXIT

# indented: nobody takes a line of it for a command or a score
indented() { sed 's/^/  /' "$@" >&2; }

students_turn() {
    printf '%s\n' "$1" >"$work/message.txt"
    indented "$work/message.txt"
    exit 2
}

staffs_turn() {
    echo "$1" >>"$work/log.txt"
    cat >"$work/message.txt" <<'EOF'
The grader failed. This is not your fault, and it says nothing about your work. Please tell the course staff: they have to grade it again.
EOF
    indented "$work/message.txt" "$work/log.txt"
    exit 3
}

limited=(setpriv --no-new-privs)
if [ "$(id -u)" = 0 ] && [ -n "$user" ]; then
    case $user in
    *[!0-9]*)
        id "$user" >/dev/null 2>&1 ||
            useradd --system --user-group --no-create-home --shell /usr/sbin/nologin "$user" ||
            staffs_turn "cannot make the user $user"
        uid=$(id -u "$user") gid=$(id -g "$user")
        ;;
    *) uid=$user gid=$user ;;
    esac
    [ "$uid" != 0 ] || staffs_turn "GRADER_USER=$user is root; expected a user of its own"
    limited=(setpriv --reuid="$uid" --regid="$gid" --clear-groups --no-new-privs)
fi
limited+=(env -i PATH=/usr/local/bin:/usr/bin:/bin LANG=C.UTF-8 HOME="$box" TMPDIR="$box/tmp")

# A mistake in the exercise is the staff's, but `grader run` would call it unusable like a submission
case $exercise in
*.yaml | *.yml)
    cp "$exercise" "$box/exercise.yaml" 2>>"$work/log.txt" || staffs_turn "no exercise $exercise"
    exercise=$box/exercise.yaml
    ;;
esac
unset _ROS_WHEELS_BOOTSTRAP_COMPLETE LD_LIBRARY_PATH  # of another environment with ROS in it
"$venv/bin/python" -P -c 'import sys; from grader import exercise; exercise.load(sys.argv[1])' \
    "$exercise" 2>>"$work/log.txt" || staffs_turn "cannot use the exercise ${EXERCISE:-$exercise}"

[ -e "$submission" ] || students_turn "There is no ${submission##*/} in what was handed in."
name=$(basename "$(realpath "$submission")")
mkdir "$box/tmp" "$box/submission"
if [ -d "$submission" ]; then
    mkdir "$box/submission/$name"
    tar -C "$submission" --exclude=./.git -cf - . |
        tar -C "$box/submission/$name" --no-same-owner -xf -
else
    cp "$submission" "$box/submission/$name"
fi 2>>"$work/log.txt" || staffs_turn "cannot copy the submission"
[ -z "${uid:-}" ] || chown -hR "$uid:$gid" "$box"

# from now on in a folder in which no student can put a module for the grader to import
cd / || exit 3

code=3
for try in 1 2; do
    left_s=$((limit_s - SECONDS))
    [ "$try" = 1 ] || [ "$left_s" -ge $((limit_s / 2)) ] || break
    [ "$left_s" -ge 1 ] || left_s=1 # 0 would be no limit
    rm -rf "$box/graded"
    code=0
    timeout --kill-after=10 "$left_s" "${limited[@]}" "$venv/bin/grader" run \
        "$box/submission/$name" --exercise "$exercise" --out "$box/graded" "$@" \
        </dev/null >>"$work/log.txt" 2>"$work/messages.txt" || code=$?
    cat "$work/messages.txt" >>"$work/log.txt"
    # whatever the submission has left behind
    [ -z "${uid:-}" ] || pkill -KILL -U "$uid" || true
    case $code in
    0 | 1 | 2) break ;;
    esac
done
message=$(sed -n '/^grader run: /,$ { s/^grader run: //; p }' "$work/messages.txt")
misused=$(grep '^usage: ' "$work/messages.txt")
rm -f "$work/messages.txt"

# read as that user, who may have put links there
take_over() {
    "${limited[@]}" tar -C "$box" -chf - graded |
        tar -C "$work" --no-same-owner -xf -
    [ -f "$work/graded/result.json" ] && chmod -R u+rwX,a+rX "$work/graded"
} 2>>"$work/log.txt"

# The submission could write the result's folder, but not the file into which the grader printed
as_printed() {
    local printed
    printed=$(sed -n 's/^Score: \([0-9.]*\) of .*/\1/p' "$work/log.txt" | tail -n 1)
    "$venv/bin/python" -P - "$work/graded/result.json" "$printed" <<'EOF'
import json, sys
with open(sys.argv[1], encoding="utf-8") as file:
    score = json.load(file)["score"]
sys.exit(abs(score - float(sys.argv[2])) > 0.01)
EOF
}

case $code in
0 | 1)
    take_over || staffs_turn "there is no result"
    as_printed || staffs_turn "result.json has not the score that was printed: did the submission change it?"
    exit "$code"
    ;;
2)
    if [ -z "$message" ] || [ -n "$misused" ]; then
        staffs_turn "exit code 2, but not for the submission"
    fi
    students_turn "$message"
    ;;
124 | 137) staffs_turn "killed, or not ready after $limit_s s" ;;
*) staffs_turn "exit code $code" ;;
esac
