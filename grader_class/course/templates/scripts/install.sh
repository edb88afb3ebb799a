#!/usr/bin/env bash
# Installs the grader, as root: on Ubuntu 22.04 or 24.04, Debian 12, or in the image python:3.12.
#
#     GRADER_SOURCE=...  what pip installs: a release by its name, turtlesim_py[jazzy]==1.2.3;
#                        turtlesim_py[jazzy] @ git+https://HOST/PATH.git@TAG; or the full path of an
#                        unpacked release, /PATH[jazzy]
#     GRADER_VENV=...    where to; default /opt/turtlesim-grader
#     EXERCISE=...       as for grade.sh, if there is one; only to see that it can be used
#
# Does nothing where the same GRADER_SOURCE is installed already. At the end a starter package is
# graded, so that a machine on which grading does not work is found now and not by a student.
set -euo pipefail
umask 022

source=${GRADER_SOURCE:?install.sh: set GRADER_SOURCE to what pip shall install}
venv=${GRADER_VENV:-/opt/turtlesim-grader}
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

fail() {
    echo "install.sh: $*" >&2
    exit 1
}

# its hash: submissions can read the file, and an address may have a token in it
from=$(printf %s "$source" | sha256sum)
if [ "$(cat "$venv/installed-from" 2>/dev/null)" = "$from" ]; then
    echo "install.sh: the grader is in $venv already"
    exit 0
fi

case ${EXERCISE:-} in
*.yaml | *.yml) EXERCISE=$(realpath "$EXERCISE") && export EXERCISE ;;
esac
# Python imports from where it is started: not from a student's folder
cd /

# a Python with venv, beside git
usable() {
    "$1" - <<'EOF' >/dev/null 2>&1
import ensurepip, shutil, sys, venv
sys.exit(not ((3, 11) <= sys.version_info < (3, 14) and shutil.which("git")))
EOF
}

find_python() {
    for python in python3.12 python3.13 python3.11; do
        if usable "$python"; then
            return
        fi
    done
    return 1
}

if ! find_python; then
    command -v apt-get >/dev/null || fail "needed: Python 3.11, 3.12 or 3.13 with its venv, and git."
    export DEBIAN_FRONTEND=noninteractive
    apt-get update
    for version in 3.12 3.11 3.13; do
        if apt-cache show "python$version-venv" >/dev/null 2>&1; then
            apt-get install -y --no-install-recommends ca-certificates git procps \
                "python$version" "python$version-venv"
            break
        fi
    done
    find_python || fail "apt has no Python 3.11, 3.12 or 3.13 here: take Ubuntu 24.04."
fi

# emptied, not removed: a cache may have made the folder for its own user
mkdir -p "$venv"
if [ -n "$(ls -A "$venv")" ] && [ ! -f "$venv/pyvenv.cfg" ]; then
    fail "GRADER_VENV=$venv holds something else; expected a new folder, or one that was made here."
fi
find "$venv" -mindepth 1 -delete
# the libraries of another environment with ROS in it are not ours
unset _ROS_WHEELS_BOOTSTRAP_COMPLETE LD_LIBRARY_PATH
"$python" -m venv "$venv"
echo "install.sh: installing the grader (a minute or two)"
ros=jazzy
if [[ $source =~ \[[^]]*kilted ]]; then ros=kilted; fi
case $source in # at an address and in a folder, what is needed of ROS lies beside
*://*) wanted=("${source##*@ }#subdirectory=interfaces/$ros" "$source") ;;
/*) wanted=("${source%%\[*}/interfaces/$ros" "$source") ;;
*) wanted=("$source") ;;
esac
"$venv/bin/python" -m pip install --quiet --disable-pip-version-check --no-input "${wanted[@]}"

check=$(mktemp -d)
trap 'rm -rf "$check"' EXIT
if [ -n "${EXERCISE:-}" ]; then
    "$venv/bin/grader" new "$check/exercise" --exercise "$EXERCISE" >/dev/null ||
        fail "installed, but the exercise cannot be used; see above."
fi
"$venv/bin/grader" new "$check/starter" >/dev/null
if ! EXERCISE=turtlesim_challenge bash "$here/grade.sh" "$check/starter" "$check/work"; then
    fail "installed, but a starter package cannot be graded here; see above."
fi
echo "$from" >"$venv/installed-from"
echo "install.sh: the grader is installed in $venv, and grades"
