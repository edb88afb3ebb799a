#!/usr/bin/env bash
# Pushes each folder of templates/ to ADDRESS/NAME, which students get a copy of; again after an edit.
#
#     bash publish.sh ADDRESS [NAME]...
#
# ADDRESS is https://github.com/ORG, git@gitlab.com:GROUP or the like. On GitHub the repository is made
# first, private and a template (by gh); on GitLab the push makes a private project.
set -euo pipefail

address=${1:?usage: publish.sh ADDRESS [NAME]...}
shift
cd "$(dirname "${BASH_SOURCE[0]}")/templates"
[ $# -gt 0 ] || set -- *

copy=$(mktemp -d)
trap 'rm -rf "$copy"' EXIT
for name; do
    there=$address/$name.git
    case $address in
    *github.com[:/]*)
        repo=${address##*[:/]}/$name
        gh repo view "$repo" >/dev/null 2>&1 || gh repo create "$repo" --private
        gh repo edit "$repo" --template
        ;;
    esac
    git -c init.defaultBranch=main init --quiet "$copy/$name"
    cp -R "$name/." "$copy/$name"
    # what is there already stays as it was, with these files upon it
    if git -C "$copy/$name" fetch --quiet "$there" main 2>/dev/null; then
        git -C "$copy/$name" reset --quiet FETCH_HEAD
    fi
    git -C "$copy/$name" add --ignore-removal .
    git -C "$copy/$name" diff --cached --quiet HEAD 2>/dev/null ||
        git -C "$copy/$name" commit --quiet --message "The exercise $name"
    git -C "$copy/$name" push --quiet "$there" HEAD:main
    echo "publish.sh: $there is up to date"
done
