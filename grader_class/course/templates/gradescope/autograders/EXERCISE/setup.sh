#!/usr/bin/env bash
# Gradescope runs this once, as root, when it builds the image of the autograder.
set -euo pipefail

# the grader, as pip installs it; of a release that you have put beside this file,
# /autograder/source/NAME
export GRADER_SOURCE="@@source"

source=${AUTOGRADER_ROOT:-/autograder}/source
export EXERCISE=$source/rubric.yaml
bash "$source/install.sh"
