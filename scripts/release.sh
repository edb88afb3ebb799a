#!/usr/bin/env bash
# Builds all that a release consists of, into dist/, and proves that it installs by name and works:
#
#   dist/pypi/        what goes to the package index: the source archive, the wheel of the project,
#                     and for each ROS release and each Python from 3.11 to 3.13 that is here a wheel
#                     of what the project needs of it
#   dist/*.cdx.json   all that `pip install` brings with it, by CycloneDX
#   dist/licences-*.md   ... and its licences; of ROS's own, which say nothing in their metadata,
#                     share/PACKAGE/package.xml does
#   dist/SHA256SUMS
#
#   PYTHON   only for that Python
#   ROS      only for that ROS release
#
# Installs nothing but into folders that it removes.
set -euo pipefail
cd "$(dirname "$0")/.."
unset COMPILE AMENT_PREFIX_PATH LD_LIBRARY_PATH _ROS_WHEELS_BOOTSTRAP_COMPLETE PYTHONPATH

fail() {
    echo "Cannot make a release: $*" >&2
    exit 1
}

[ -z "${ROS_DISTRO:-}" ] ||
    fail "ROS 2 $ROS_DISTRO is sourced; what is built has to work without: use a shell without any ROS."

# does a file follow CycloneDX's schema?
VALIDATE='
import sys
from cyclonedx.schema import SchemaVersion
from cyclonedx.validation.json import JsonStrictValidator

sys.exit(JsonStrictValidator(SchemaVersion.V1_6).validate_str(open(sys.argv[1]).read()))
'
only_ros=${ROS:-}
unset ROS
dist=$PWD/dist
pypi=$dist/pypi
log=$PWD/build/release.log
work=$(mktemp -d)
server=
trap '[ -z "$server" ] || kill "$server"; rm -rf "$work"' EXIT
mkdir -p build
: >"$log"

# all that "$@" says goes into the log
quietly() {
    "$@" >>"$log" 2>&1 && return
    grep -o -m 1 'Cannot install: .*' "$log" >&2 || tail -15 "$log" >&2
    fail "see above and $log"
}

# What there is to build with -----------------------------------------------------------------------

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
        PYTHON=$candidate scripts/check_setup.sh >"$work/python" 2>"$work/why" || continue
        "$candidate" grader/ros/compiler.py >"$work/why" && cat "$work/python" && return
    done < <(candidates "$1")
    return 1
}

pythons=()
if [ -n "${PYTHON:-}" ]; then
    python=$(scripts/check_setup.sh)
    why=$("$python" grader/ros/compiler.py) || fail "its wheels are compiled; $why"
    pythons+=("$python")
else
    for each in 3.11 3.12 3.13; do
        echo "there is no Python $each here" >"$work/why"
        if python=$(python_of "$each"); then
            pythons+=("$python")
        else
            echo "== no wheels for Python $each: $(<"$work/why")"
        fi
    done
fi
[ ${#pythons[@]} -gt 0 ] || fail "no Python from 3.11 to 3.13 can build one, see above."
first=${pythons[0]}
releases=()
for folder in interfaces/*/pyproject.toml; do
    each=$(basename "$(dirname "$folder")")
    [ -n "$only_ros" ] && [ "$only_ros" != "$each" ] || releases+=("$each")
done
[ ${#releases[@]} -gt 0 ] || fail "ROS=$only_ros: there is no interfaces/$only_ros."

# Build ---------------------------------------------------------------------------------------------

echo "== building the source archive and the wheel"
tools=$work/tools
quietly "$first" -m venv "$tools"
"$first" scripts/requirements.py release >"$work/tools.txt"
quietly "$tools/bin/pip" install --progress-bar off -r "$work/tools.txt"
rm -rf "$dist"
mkdir -p "$pypi"
# the wheel from the archive, and the rest as well: so nothing is missing in it
quietly "$tools/bin/python" -m build --outdir "$pypi" .
tar -xf "$pypi"/*.tar.gz -C "$work"
source=$(echo "$work"/turtlesim_py-*/)
version=$(basename "$source")
version=${version#*-}

for python in "${pythons[@]}"; do
    builder=$work/builder
    rm -rf "$builder"
    quietly "$python" -m venv "$builder"
    for ros in "${releases[@]}"; do
        echo "== compiling for ROS 2 ${ros^} with $python (a minute)"
        rm -rf "$work/built"
        quietly "$builder/bin/pip" wheel --progress-bar off --no-deps --wheel-dir "$work/built" \
            "$source/interfaces/$ros"
        # The tag is what auditwheel finds: the oldest glibc (and libstdc++) that has all versions of
        # symbols that the extension modules ask for. Built on glibc 2.34 or newer that is
        # manylinux_2_34, because dlopen moved then; in a manylinux_2_28 container it is 2_28, as the
        # ROS wheels have. The libraries of ROS are left out, neither looked at nor copied: they come
        # with the wheels of ROS that this one requires, and $ORIGIN leads to them.
        PATH=$tools/bin:$PATH quietly "$tools/bin/auditwheel" repair --plat auto --only-plat \
            --exclude 'librosidl_*' --exclude 'lib*__rosidl_*' --exclude 'librmw.so*' \
            --exclude 'librcutils.so*' --exclude 'libfastcdr.so*' \
            --wheel-dir "$pypi" "$work"/built/*.whl
    done
done
echo "== asking twine"
quietly "$tools/bin/twine" check --strict "$pypi"/*

# Try -----------------------------------------------------------------------------------------------

# an index with what was built: a folder for each project, whose pages are lists of files
for file in "$pypi"/*; do
    name=$(basename "$file")
    name=${name%%-*}
    mkdir -p "$work/index/${name//_/-}"
    ln -s "$file" "$work/index/${name//_/-}/"
done
exec 8< <(exec "$first" -u -m http.server 0 --bind 127.0.0.1 --directory "$work/index" 2>/dev/null)
server=$!
read -r -u 8 said || fail "no web server: $first -m http.server"
[[ $said =~ port\ ([0-9]+) ]] || fail "no web server: $said"
index=http://127.0.0.1:${BASH_REMATCH[1]}
export no_proxy=127.0.0.1,${no_proxy:-}

# into the environment $1, which has no pip of its own: the rest, by name
install() {
    quietly "$builder/bin/pip" --python "$1/bin/python" install --progress-bar off \
        --extra-index-url "$index" "${@:2}"
    quietly "$builder/bin/pip" --python "$1/bin/python" check
}

# in the environment $1, where there is no compiler, and with the variables that follow: the
# simulator up and down again, tf2, the starter graded, and the reference, which gets all points
try() {
    local bare reference node line said=
    bare=(env -C "$work" "PATH=$1/bin" CC=/nonexistent CXX=/nonexistent "${@:2}")
    exec 9< <(exec timeout --preserve-status --signal INT 60 "${bare[@]}" turtlesim_node 2>&1)
    node=$!
    while read -r -u 9 line; do
        said+=$line$'\n'
        [[ $line != *"Starting turtlesim"* ]] || kill -INT "$node"
    done
    if ! wait "$node" || [[ $said != *"Starting turtlesim"* ]]; then
        fail "turtlesim_node does not start or end: $said"
    fi
    quietly "${bare[@]}" python -c 'import tf2_ros'
    rm -rf "$work/starter"
    quietly "${bare[@]}" grader new starter
    quietly "${bare[@]}" grader run starter --out "$work/graded"
    reference=$("${bare[@]}" python -c \
        'import turtlesim_challenge as c; print(c.__path__[0] + "/turtle_controller.py")')
    quietly "${bare[@]}" grader run "$reference" --out "$work/graded" --fail-under 100
}

for python in "${pythons[@]}"; do
    rm -rf "$builder"
    quietly "$python" -m venv "$builder"
    for ros in "${releases[@]}"; do
        empty=$work/empty
        echo "== pip install 'turtlesim_py[$ros]' in an empty environment of $python"
        rm -rf "$empty"
        quietly "$python" -m venv --without-pip "$empty"
        install "$empty" "turtlesim_py[$ros]==$version"
        try "$empty"
        bom=$dist/turtlesim_py-$version-$ros.cdx.json
        if [ ! -e "$bom" ]; then
            quietly "$tools/bin/cyclonedx-py" environment --of JSON --output-reproducible \
                --pyproject pyproject.toml -o "$bom" "$empty/bin/python"
            quietly "$tools/bin/python" -c "$VALIDATE" "$bom"
            # a licence's whole text in place of its name has further lines
            "$tools/bin/pip-licenses" --python "$empty/bin/python" --format markdown \
                --order license --partial-match --fail-on 'GPL;GNU;MPL-;Mozilla' 2>>"$log" |
                grep -v '^|  ' >"$dist/licences-$ros.md" ||
                fail "something that is installed has a licence that asks for more than ours: see $log"
        fi
        # What is left without the project stands for a sourced ROS, which pip knows nothing of
        quietly "$builder/bin/pip" --python "$empty/bin/python" uninstall --yes turtlesim_py
        beside=$work/beside
        echo "== pip install turtlesim_py where ROS 2 ${ros^} is sourced"
        rm -rf "$beside"
        quietly "$python" -m venv --without-pip "$beside"
        export ROS_DISTRO=$ros AMENT_PREFIX_PATH=$empty
        install "$beside" "turtlesim_py==$version"
        "$builder/bin/pip" --python "$beside/bin/python" list --format freeze >"$work/list"
        ! grep -E '^(ros-|turtlesim[-_]py[-_])' "$work/list" || fail "that has taken ROS from PyPI, see above."
        for name in turtlesim turtlesim_msgs tf2_ros rclpy; do
            [ -z "$(find "$beside/share" "$beside"/lib/python*/site-packages -maxdepth 1 -name "$name")" ] ||
                fail "the $name of what was installed hides that of ROS."
        done
        packages=$(echo "$empty"/lib/python*/site-packages)
        libraries=$empty/lib
        for folder in "$packages"/ros_*.libs; do libraries+=:$folder; done
        try "$beside" "PYTHONPATH=$packages" "LD_LIBRARY_PATH=$libraries"
        unset ROS_DISTRO AMENT_PREFIX_PATH
    done
done
(cd "$dist" && sha256sum pypi/* ./*.cdx.json ./licences-*.md >SHA256SUMS)
echo "== dist/ has a release $version: wheels for ${#pythons[@]} of 3 Pythons, ${#releases[@]} ROS releases"
