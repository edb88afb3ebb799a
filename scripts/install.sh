#!/usr/bin/env bash
# Makes .venv and installs the project into it. Does only what is not done yet, so it may be called
# before every test.
#
#   scripts/install.sh         the project and what it needs
#   scripts/install.sh test    ... and what its tests, ruff and mypy need
#   scripts/install.sh docs    ... and what makes the site
#   scripts/install.sh bench   ... and what runs the benchmarks
#
#   VENV     another folder than .venv
#   BOUNDS   lowest: our dependencies at their lower bounds
#   COMPILE  empty: no interfaces are compiled, even where there is a compiler; gradings need none
#   UV       empty: pip, even where there is uv
#
# The project goes in without pip's own build environment: .venv has all that a build needs, and
# need not download it a second time. `pip install .` works as well, elsewhere.
set -euo pipefail
cd "$(dirname "$0")/.."

# a shell that some Python with the ROS wheels has started: its libraries are not ours
if [ -n "${_ROS_WHEELS_BOOTSTRAP_COMPLETE:-}" ]; then
    unset LD_LIBRARY_PATH _ROS_WHEELS_BOOTSTRAP_COMPLETE
fi

# what is installed, and what builds it, is compiled once
unset PYTHONDONTWRITEBYTECODE

trap 'echo "Interrupted: call it again, and it goes on." >&2; exit 130' INT

# one at a time: two `make` in one folder wait for each other
exec 9<Makefile
flock 9

venv=${VENV:-.venv}
log=$venv/install.log

say() { echo "== $*"; }

# is "$2" what the stamp file "$1" holds?
stamped() { [ "$(cat "$venv/$1" 2>/dev/null)" = "$2" ]; }
stamp() { printf '%s\n' "$2" >"$venv/$1"; }

# uv where it is. Not beside a sourced ROS: it does not see what apt has installed, and would put
# newer packages before those that ROS uses
uv=${UV-uv}
if [ -n "${ROS_DISTRO:-}" ] || ! "$uv" --version >/dev/null 2>&1; then uv=; fi

# "$@" with all its lines in a log; the large downloads and every 20th package are shown
logged() {
    local packages=0 line
    "$@" 2>&1 | tee "$log" | while IFS= read -r line; do
        case "$line" in
        Collecting*)
            packages=$((packages + 1))
            [ $((packages % 20)) -ne 0 ] || echo "   $packages packages found ..."
            ;;
        *Downloading*" MB)" | Downloading* | Resolved*) echo "   ${line#"${line%%[! ]*}"}" ;;
        "Installing collected"*) echo "   unpacking ..." ;;
        esac
    done
}

# without byte code, which pip makes on one core: `byte_code` uses all
packages() {
    if [ -n "$uv" ]; then
        if logged "$uv" --color never pip install --python "$venv/bin/python" "$@"; then return; fi
    elif logged "$venv/bin/python" -u -m pip --disable-pip-version-check install --no-input \
        --retries 2 --progress-bar off --no-compile "$@"; then
        return
    fi
    # setup.py has said it in one line
    if grep -o -m 1 'Cannot install: .*' "$log" >&2; then
        exit 1
    fi
    # its warnings about single tries stay in the log when what failed in the end is a compiler
    if ! grep -q subprocess-exited "$log" && grep -qE \
        'NewConnectionError|NameResolutionError|ConnectTimeout|ReadTimeout|ProxyError|SSLError|Connection(Reset|Refused)|error sending request' "$log"; then
        echo "Cannot install: ${uv:-pip} does not reach the package index: check the network (or proxy), then try again. Details: $log" >&2
        [ -z "$uv" ] || echo "uv reads none of pip's settings: \`make UV= ...\` takes pip." >&2
    else
        grep -E '^ *(ERROR|error):|error:' "$log" | tail -5 >&2 || true
        echo "Cannot install: ${uv:-pip} failed, see above and $log" >&2
    fi
    exit 1
}

# A submission's process may write nowhere: what is not compiled here, each run would compile again.
# Nobody runs the tests of others. As with pip, a file that is no Python of today's hinders nobody.
byte_code() {
    local library
    "$venv/bin/python" -m compileall -qq -j 0 -x 'site-packages/.*/tests?/' \
        "$venv"/lib/python*/site-packages || true
    if [ -n "$uv" ]; then # its Pythons come without byte code; with a system's there is nothing to do
        library=$("$venv/bin/python" -c 'import sysconfig; print(sysconfig.get_path("stdlib"))')
        "$venv/bin/python" -m compileall -qq -j 0 \
            -x '/(dist-packages|site-packages|idlelib|lib2to3|tests?)/' "$library" || true
    fi
}

# what scripts/requirements.py prints; $1 is the name of the stamp, the rest are its arguments
requirements() {
    local all
    all=$("$venv/bin/python" scripts/requirements.py "${@:2}")
    stamped "$1" "$all" && return
    say "installing what ${2:-it} needs into $venv (half a minute, more where the network is slow)"
    packages -r <(echo "$all")
    stamp "$1" "$all"
}

place="$PWD ${ROS_DISTRO:-no ROS}"
if [ -n "${PYTHON:-}" ] || ! stamped made-in "$place" || ! "$venv/bin/python" -c '' 2>/dev/null; then
    python=$(scripts/check_setup.sh)
    if ! stamped made-in "$place" || ! stamped made-with "$python" || ! "$venv/bin/python" -c ''; then
        say "making $venv with $python"
        rm -rf "$venv"
        # only there can .venv see the rclpy of a sourced ROS and what apt has installed for it
        if [ -n "$uv" ]; then
            "$uv" venv --quiet --python "$python" "$venv"
        else
            "$python" -m venv ${ROS_DISTRO:+--system-site-packages} "$venv"
        fi
        stamp made-in "$place"
        stamp made-with "$python"
    fi
fi

requirements installed-requirements

# what is to be installed, by its folder, and then stamped: `name text`
folders=() stamps=()
# a hash of the files below "$@": content, not dates; git changes dates, and a deleted file has none
sources() {
    find "$@" -type f ! -name '*.pyc' -print0 | LC_ALL=C sort -z | xargs -0 sha256sum | sha256sum
}
# the folder $1, unless the stamp "$2" says so already
project() {
    stamped "${2%% *}" "${2#* }" && return
    folders+=("$1") stamps+=("$2")
}

packaging="LICENSE launch pyproject.toml interfaces/ament.py"
# shellcheck disable=SC2086  # several words
project . "installed-project $(sources $packaging turtlesim_py turtlesim_challenge grader \
    grader_class grader_diagnosis grader_robots ros_doubles MANIFEST.in README.md package.xml setup.py)"
missing= # what a compilation lacks that was asked for
if [ -z "${ROS_DISTRO:-}" ]; then
    ros=interfaces/${ROS:-jazzy}
    # shellcheck disable=SC2086
    hash=$(sources $packaging tf2 grader/ros interfaces/{build.py,LICENSE-Apache-2.0,packages} \
        "$ros"/{setup.py,pyproject.toml})
    if ! stamped installed-interfaces "compiled $hash"; then
        # what is compiled stays so
        ! grep -qsv '^definitions ' "$venv/installed-interfaces" || COMPILE=yes
        how=definitions
        if [ -n "${COMPILE-yes}" ]; then
            ! missing=$("$venv/bin/python" grader/ros/compiler.py) || how=compiled
        fi
        project "./$ros" "installed-interfaces $how $hash"
        export COMPILE=
        [ $how != compiled ] || COMPILE=yes
    fi
fi
if [ ${#folders[@]} -gt 0 ]; then
    say "installing the project${COMPILE:+, and compiling its interfaces: half a minute}"
    packages --no-build-isolation --no-deps --force-reinstall "${folders[@]}"
    byte_code
    for each in "${stamps[@]}"; do stamp "${each%% *}" "${each#* }"; done
fi

for tools in "$@"; do
    requirements "installed-$tools-requirements" "$tools"
done

if [ -n "$missing" ]; then
    say "gradings work; turtlesim_node, other nodes and grader run --time real need compiled interfaces"
    say "$missing, then: make install"
fi
