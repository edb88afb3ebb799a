#!/bin/sh
# Chooses the Python that .venv is made with. Prints its path; or one line that says what to install,
# and fails.
#
#   PYTHON      the Python to take; without it the first that fits
#   ROS_DISTRO  set where ROS is sourced
#   BOUNDS      lowest: for dependencies at their lower bounds, which are older than Python 3.13

fail() {
    echo "Cannot install: $*" >&2
    exit 1
}

wanted="Python 3.11, 3.12 or 3.13"
# Ubuntu 26.04 has 3.14; the wheels of ROS 2 are not tried with it
[ "${ROS_DISTRO:-}" != lyrical ] || wanted="Python 3.12, 3.13 or 3.14"
[ "${BOUNDS:-}" != lowest ] || wanted="Python 3.11 or 3.12"

# "3.12" when the command $1 is a Python that starts
version_of() {
    "$1" -c 'import sys; print("%d.%d" % sys.version_info[:2])' 2>/dev/null
}

fits() {
    case "$(version_of "$1")" in
    3.11 | 3.12) return 0 ;;
    3.13) [ "${BOUNDS:-}" != lowest ] ;;
    3.14) [ "${ROS_DISTRO:-}" = lyrical ] ;;
    *) return 1 ;;
    esac
}

system="$(uname -s) $(uname -m)"
if [ -n "${ROS_DISTRO:-}" ]; then
    # older ones have a Python that is too old; what Rolling has changes from day to day
    case "$ROS_DISTRO" in
    jazzy | kilted | lyrical) ;;
    *) fail "ROS 2 $ROS_DISTRO is sourced, needed is Jazzy, Kilted or Lyrical: source one of them, or use a shell without any ROS." ;;
    esac
elif [ "$system" != "Linux x86_64" ]; then
    fail "this is $system, but ROS 2 is on PyPI for Linux x86_64 only: install ROS 2 Jazzy and source it, or use a Linux x86_64 container."
fi

if [ -n "${PYTHON:-}" ]; then
    command -v "$PYTHON" >/dev/null 2>&1 || fail "PYTHON=$PYTHON: no such command; needed is $wanted."
    # a command of pyenv exists even where the version that it stands for is not chosen
    [ -n "$(version_of "$PYTHON")" ] ||
        fail "PYTHON=$PYTHON does not start: give the full path of $wanted (with pyenv: ~/.pyenv/versions/*/bin/python3)."
    fits "$PYTHON" || fail "PYTHON=$PYTHON is Python $(version_of "$PYTHON"), needed is $wanted."
    python=$PYTHON
else
    python=
    for candidate in python3 python3.12 python3.13 python3.11; do
        if fits "$candidate"; then
            python=$candidate
            break
        fi
    done
    found="$(version_of python3)"
    [ -n "$python" ] ||
        fail "no $wanted found (python3 is ${found:-missing}): install one (Ubuntu 24.04: sudo apt install python3 python3-venv), or name it: make install PYTHON=/path/to/python3."
fi

# the Python behind a pyenv shim or an active virtual environment
python=$("$python" -c 'import os, sys; print(os.path.realpath(getattr(sys, "_base_executable", sys.executable)))')
version=$(version_of "$python")
"$python" -c 'import ensurepip, venv' 2>/dev/null ||
    fail "$python cannot make virtual environments (no venv or ensurepip): sudo apt install python$version-venv."

if [ -n "${ROS_DISTRO:-}" ]; then
    "$python" -c 'import rclpy' 2>/dev/null ||
        fail "ROS 2 $ROS_DISTRO is sourced, but $python cannot import its rclpy: take the Python that ROS was built for (Ubuntu 24.04: PYTHON=/usr/bin/python3)."
fi

echo "$python"
