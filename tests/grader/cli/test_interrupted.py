"""Ctrl-C while the command is still being imported."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[3]
INTERRUPTED = """
import sys

class Interrupt:
    def find_spec(self, name, *_):
        if name == "grader.cli.run":
            raise KeyboardInterrupt

sys.meta_path.insert(0, Interrupt())
from grader.cli import main
"""


def test_it_ends_in_one_line_and_without_a_traceback():
    env = {**os.environ, "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-c", INTERRUPTED]
    done = subprocess.run(command, env=env, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (130, "grader: interrupted\n")
