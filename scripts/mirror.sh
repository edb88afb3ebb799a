#!/usr/bin/env bash
# Downloads, of PyPI's ROS, all that interfaces/ asks for, for Python 3.11 to 3.13: a copy for the day
# on which it is no longer there. docs/release.md says how pip takes it.
#
#   scripts/mirror.sh DIR     a folder a project, as package indexes have it, SHA256SUMS, and for each
#                             ROS release a requirements file with hashes
#
#   ROS      only that ROS release
#   PYTHON   which pip; default: the first python3
#
# What is there already stays as it is; nothing is removed.
set -euo pipefail
mirror=$(mkdir -p "${1:?mirror.sh: give a folder}" && cd "$1" && pwd)
cd "$(dirname "$0")/.."
python=${PYTHON:-python3}
pip=("$python" -m pip --disable-pip-version-check --quiet --quiet)
CHOSEN='
import json, sys
for each in json.load(open(sys.argv[1]))["install"]:
    if each["metadata"]["name"].startswith("ros-"):
        print("{name}=={version}".format(**each["metadata"]))
'
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

for folder in interfaces/${ROS:-*}/pyproject.toml; do
    ros=$(basename "$(dirname "$folder")")
    env -u ROS_DISTRO ROS="$ros" "$python" scripts/requirements.py | grep ^ros- >"$work/ASKED"
    "${pip[@]}" install --dry-run --ignore-installed --report "$work/REPORT" --requirement "$work/ASKED"
    # only what one author keeps; the rest is on every mirror of PyPI
    "$python" -c "$CHOSEN" "$work/REPORT" >"$work/$ros"
    for version in 3.11 3.12 3.13; do
        echo "== ROS 2 ${ros^} for Python $version"
        "${pip[@]}" download --no-deps --dest "$work/all" --requirement "$work/$ros" \
            --only-binary :all: --implementation cp --python-version "$version" \
            --platform manylinux_2_28_x86_64
    done
done
for file in "$work"/all/*; do
    name=$(basename "$file")
    name=${name%%-*}
    mkdir -p "$mirror/${name//_/-}"
    mv -n "$file" "$mirror/${name//_/-}/"
done
cd "$mirror"
sha256sum -- */*.whl >SHA256SUMS
for chosen in "$work"/[a-z]*; do
    [ -f "$chosen" ] || continue
    ros=$(basename "$chosen")
    while IFS='=' read -r name _ version; do
        echo "$name==$version" "$(sed -nE "s,^(\w+)  $name/[^-]+-$version-.*,--hash=sha256:\1,p" SHA256SUMS |
            tr '\n' ' ')"
    done <"$chosen" >"$ros.txt"
done
echo "== $(du -sh . | cut -f1) in $(wc -l <SHA256SUMS) files"
