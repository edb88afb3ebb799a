#!/usr/bin/env bash
# Grades one submission so that the student's code does not reach the grade.
#
#     grade.sh SUBMISSION WORK [OPTION of `grader run`]...
#
# The folder WORK gets
#     graded/       what `grader run` leaves: result.json, canvas.png, ...
#     error.json    with the exit codes 2 and 3: what went wrong. `grader report error.json --format
#                   NAME` makes of it what the student reads
#     log.txt       all that the grader said, for the staff
# The exit code says whose turn it is:
#     0  judged, whatever the score          1  judged, below --fail-under
#     2  the submission cannot be used: the student's; no points, error.json says what to mend
#     3  the grader failed, also when tried again: the staff's; there is no judgement
#
#     EXERCISE=...        the exercise: a name, or the path of an edited copy, *.yaml. Always given,
#                         so that no student chooses an easier one
#     GRADER_VENV=...     where install.sh has put the grader; default /opt/turtlesim-grader
#     GRADER_LIMIT_S=...  for everything together, in seconds; default 500
#     GRADER_USER=...     where this runs as root: whom the submission runs as. Default
#                         turtle-grader, made if need be; a user who has nothing else to do, since
#                         all that still runs as that user in the end is killed
#
# The submission is run as a copy, without the environment of whoever calls this (tokens, places of
# results), and cannot gain privileges; where this runs as root, as a user who can write nothing
# but the copy's folder. The grader runs as that user too; it writes the judgement into files that
# this script has opened for it, and that nobody else can write.
set -uo pipefail
umask 022

submission=${1:?usage: grade.sh SUBMISSION WORK [OPTION]...}
work=${2:?usage: grade.sh SUBMISSION WORK [OPTION]...}
shift 2
exercise=${EXERCISE:-}
venv=${GRADER_VENV:-/opt/turtlesim-grader}
limit_s=${GRADER_LIMIT_S:-500}
user=${GRADER_USER-turtle-grader}

mkdir -p "$work" && work=$(cd "$work" && pwd) || exit 3
rm -rf "$work"/{graded,result.json,error.json,log.txt}
: >"$work/log.txt"

# not below WORK: that user need not be able to go there
box=$(mktemp -d /tmp/grading.XXXXXX) || exit 3
trap 'rm -rf "$box"' EXIT

# indented: nobody takes a line of it for a command or a score
indented() { sed 's/^/  /' >&2; }

# $1: a text without quotes
staffs_turn() {
    echo "$1" >>"$work/log.txt"
    [ -s "$work/error.json" ] || cat >"$work/error.json" <<EOF
{"schema": "turtlesim-grader/error/v1", "whose": "grader", "message": "$1", "max_score": null}
EOF
    "$venv/bin/grader" report "$work/error.json" | indented
    indented <"$work/log.txt"
    exit 3
}

whose_turn() {
    "$venv/bin/python" -I -c 'import json, sys; print(json.load(open(sys.argv[1]))["whose"])' \
        "$work/error.json" 2>>"$work/log.txt"
}

limited=(setpriv --no-new-privs)
if [ "$(id -u)" = 0 ] && [ -n "$user" ]; then
    case $user in
    *[!0-9]*)
        id "$user" >/dev/null 2>&1 ||
            useradd --system --user-group --no-create-home --shell /usr/sbin/nologin "$user" ||
            staffs_turn "cannot make the user that GRADER_USER names"
        uid=$(id -u "$user") gid=$(id -g "$user")
        ;;
    *) uid=$user gid=$user ;;
    esac
    [ "$uid" != 0 ] || staffs_turn "GRADER_USER is root; expected a user of its own"
    limited=(setpriv --reuid="$uid" --regid="$gid" --clear-groups --no-new-privs)
fi
limited+=(env -i PATH=/usr/local/bin:/usr/bin:/bin LANG=C.UTF-8 HOME="$box" TMPDIR="$box/tmp")

case $exercise in
'') staffs_turn "EXERCISE is not set" ;;
*.yaml | *.yml)
    # not as exercise.yaml, which would stand for an exercise of its own
    cp "$exercise" "$box/rubric.yaml" 2>>"$work/log.txt" || staffs_turn "there is no such exercise"
    exercise=$box/rubric.yaml
    ;;
esac

mkdir "$box/tmp" "$box/submission"
name=$(basename "$(realpath -m "$submission")")
start=$box/submission/$name
if [ -d "$submission" ]; then
    mkdir "$start"
    tar -C "$submission" --exclude=./.git -cf - . | tar -C "$start" --no-same-owner -xf -
elif [ -e "$submission" ]; then
    cp "$submission" "$start"
fi 2>>"$work/log.txt" || staffs_turn "cannot copy the submission"
[ -z "${uid:-}" ] || chown -hR "$uid:$gid" "$box"

# from now on in a folder in which no student can put a module for the grader to import
cd / || exit 3
if [ ! -e "$start" ]; then
    # the grader says so; it need not name our folders
    cd "$box/submission" || exit 3
    start=./$name
fi
unset _ROS_WHEELS_BOOTSTRAP_COMPLETE LD_LIBRARY_PATH  # of another environment with ROS in it

code=3
for try in 1 2; do
    left_s=$((limit_s - SECONDS))
    [ "$try" = 1 ] || [ "$left_s" -ge $((limit_s / 2)) ] || break
    [ "$left_s" -ge 1 ] || left_s=1 # 0 would be no limit
    rm -rf "$box/graded"
    code=0
    timeout --kill-after=10 "$left_s" "${limited[@]}" "$venv/bin/grader" run "$start" "$@" \
        --exercise "$exercise" --out "$box/graded" --json /dev/fd/3 --error-json /dev/fd/4 \
        </dev/null >>"$work/log.txt" 2>&1 3>"$work/result.json" 4>"$work/error.json" || code=$?
    # whatever the submission has left behind
    [ -z "${uid:-}" ] || pkill -KILL -U "$uid" || true
    case $code in
    0 | 1 | 2) break ;;
    esac
done

# What lies in the folder is read as that user, who may have put links there; a pipe would stop
# whoever reads it. The result is the one that the grader wrote into our file.
take_over() {
    "${limited[@]}" tar -C "$box" -chf - graded | tar -C "$work" --no-same-owner -xf -
    [ -d "$work/graded" ] || { rm -f "$work/graded" && mkdir "$work/graded"; } || return
    find "$work/graded" ! -type f ! -type d -delete
    chmod -R u+rwX,a+rX "$work/graded"
    rm -rf "$work/graded/result.json"
    mv "$work/result.json" "$work/graded/result.json"
} 2>>"$work/log.txt"

case $code in
0 | 1)
    rm -f "$work/error.json"
    [ -s "$work/result.json" ] || staffs_turn "there is no result"
    take_over || staffs_turn "cannot copy the result"
    exit "$code"
    ;;
124 | 137)
    rm -f "$work"/{result,error}.json
    staffs_turn "killed, or not ready after $limit_s s"
    ;;
esac
rm -f "$work/result.json"
if [ "$code" != 2 ]; then
    staffs_turn "exit code $code"
elif [ ! -e "$start" ] && [ "$(whose_turn)" = call ]; then
    # here the path is fixed, and the student has not put anything there
    sed -i 's/"whose": "call"/"whose": "submission"/' "$work/error.json"
elif [ "$(whose_turn)" != submission ]; then
    staffs_turn "exit code 2, but not for the submission"
fi
"$venv/bin/grader" report "$work/error.json" | indented
exit 2
