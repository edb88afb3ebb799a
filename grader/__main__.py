"""`python -m grader` is the command `grader`."""

from grader.cli import run_and_leave

run_and_leave()
