#!/usr/bin/env bash
# Gradescope runs this once, as root, when it builds the image of the autograder.
set -euo pipefail

# EDIT: the grader, as pip installs it: a git URL with a tag, or the path of a release that you have
# put into the zip, /autograder/source/NAME
export GRADER_SOURCE="git+https://example.org/REPLACE-ME.git@TAG"

source=${AUTOGRADER_ROOT:-/autograder}/source
if [ -f "$source/exercise.yaml" ]; then
    export EXERCISE=$source/exercise.yaml
fi
bash "$source/install.sh"
