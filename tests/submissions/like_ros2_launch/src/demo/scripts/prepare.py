"""A script that a launch file starts by its path."""

import sys

print("prepared", *sys.argv[1:])
