#!/usr/bin/env bash
# Builds a wheel for each Python from 3.11 to 3.13 that is here, into dist/jazzy or dist/kilted, and
# tries each in an empty environment without a compiler.
#
#   ROS      which release of ROS the wheels are for: jazzy, unless something else is said
#   PYTHON   only for that Python
#
# The two releases ask pip for different packages, so their wheels are different versions:
# 0.1.0+jazzy and 0.1.0+kilted. In one folder pip would take the later in the alphabet, so each has
# its own.
set -euo pipefail
cd "$(dirname "$0")/.."
unset AMENT_PREFIX_PATH LD_LIBRARY_PATH _ROS_WHEELS_BOOTSTRAP_COMPLETE PYTHONPATH

fail() {
    echo "Cannot make a wheel: $*" >&2
    exit 1
}

[ -z "${ROS_DISTRO:-}" ] ||
    fail "ROS 2 $ROS_DISTRO is sourced, and would be built in: use a shell without any ROS."

# not while another `make` in this folder installs: both use build/
exec 9<Makefile
flock 9

ros=${ROS:-jazzy}
dist=$PWD/dist/$ros
log=$PWD/build/wheel-$ros.log
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p build
: >"$log"

# all that "$@" says goes into the log
quietly() {
    "$@" >>"$log" 2>&1 && return
    if ! grep -o -m 1 'Cannot install: .*' "$log" >&2; then
        tail -5 "$log" >&2
    fi
    fail "see above and $log"
}

# in an empty environment of the Python $1, where there is no compiler: the wheel $2 and what it
# requires, turtlesim_node up and down again, tf2, and the reference, graded
try_wheel() {
    local bare reference
    rm -rf "$work/venv"
    quietly "$1" -m venv "$work/venv"
    bare=(env -C "$work" "PATH=$work/venv/bin" CC=/nonexistent CXX=/nonexistent)
    quietly "${bare[@]}" python -m pip install --no-cache-dir --progress-bar off "$2"
    if ! timeout --preserve-status --signal INT 10 "${bare[@]}" turtlesim_node >"$work/node" 2>&1 ||
        ! grep -q "Starting turtlesim" "$work/node"; then
        fail "turtlesim_node does not start or end: $(<"$work/node")"
    fi
    quietly "${bare[@]}" python -c 'import tf2_ros'
    reference=$("${bare[@]}" python -c \
        'import turtlesim_challenge as c; print(c.__path__[0] + "/turtle_controller.py")')
    quietly "${bare[@]}" grader run "$reference" --out "$work/graded" --fail-under 100
    echo "   it installs, starts, ends and grades"
}

# the Pythons of release $1 that could be meant: on the path, pyenv's, uv's
candidates() {
    command -v "python$1" || true
    ls -d "${PYENV_ROOT:-$HOME/.pyenv}/versions/$1".*/bin/python3 2>/dev/null || true
    ! command -v uv >/dev/null || uv python find --no-python-downloads "$1" 2>/dev/null || true
}

# the first of them that has all that a build needs; else why the last has not
python_of() {
    local candidate
    while read -r candidate; do
        "$candidate" -c '' 2>/dev/null || continue # pyenv's command for a version not chosen
        PYTHON=$candidate scripts/check_setup.sh 2>"$work/why" && return
    done < <(candidates "$1")
    return 1
}

pythons=()
if [ -n "${PYTHON:-}" ]; then
    python=$(scripts/check_setup.sh)
    pythons+=("$python")
else
    for version in 3.11 3.12 3.13; do
        echo "there is no Python $version here" >"$work/why"
        if python=$(python_of "$version"); then
            pythons+=("$python")
        else
            echo "== no wheel for Python $version: $(<"$work/why")"
        fi
    done
fi
[ ${#pythons[@]} -gt 0 ] || fail "no Python from 3.11 to 3.13 can build one, see above."

export ROS=$ros
"${pythons[0]}" scripts/requirements.py >/dev/null # says so where there is no such release
rm -rf "$dist"
for python in "${pythons[@]}"; do
    echo "== building with $python for ROS 2 ${ros^} (a minute)"
    tools=$work/tools
    rm -rf "$tools" "$work/built"
    quietly "$python" -m venv "$tools"
    mapfile -t requirements < <("$python" -c 'import tomllib; print(*tomllib.load(
        open("pyproject.toml", "rb"))["tool"]["turtlesim-py"]["extras"]["release"], sep="\n")')
    quietly "$tools/bin/pip" install --progress-bar off "${requirements[@]}"
    # Not `pip wheel`: for pip setuptools leaves the label out of the name of the wheel's folder
    # .data, and what is in it (package.xml, the programs of ros2 run) is then installed by pip alone
    quietly "$tools/bin/python" -m build --wheel --outdir "$work/built" \
        "-C--global-option=egg_info --tag-build=+$ros --egg-base=$work" .

    # The tag is what auditwheel finds: the oldest glibc (and libstdc++) that has all versions of
    # symbols that the extension modules ask for. Built on glibc 2.34 or newer that is
    # manylinux_2_34, because dlopen moved then; in a manylinux_2_28 container it is 2_28, as the
    # ROS wheels have. The libraries of ROS are left out, neither looked at nor copied: they come
    # with the wheels of ROS that this one requires, and $ORIGIN leads to them.
    PATH=$tools/bin:$PATH quietly "$tools/bin/auditwheel" repair --plat auto --only-plat \
        --exclude 'librosidl_*' --exclude 'lib*__rosidl_*' --exclude 'librmw.so*' \
        --exclude 'librcutils.so*' --exclude 'libfastcdr.so*' \
        --wheel-dir "$work/audited" "$work"/built/*.whl
    mkdir -p "$dist"
    wheel=$dist/$(basename "$work"/audited/*.whl)
    mv "$work"/audited/*.whl "$wheel"
    echo "   ${wheel#"$PWD"/}"
    try_wheel "$python" "$wheel"
done
echo "== ${#pythons[@]} of 3 wheels are in ${dist#"$PWD"/}"
