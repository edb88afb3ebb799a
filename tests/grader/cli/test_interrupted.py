"""Ctrl-C while the command is still being imported."""

import os
import subprocess
import sys

import pytest

from tests.programs import ROOT
from tests.tiers import others_are_more

INTERRUPTED = """
import sys

class Interrupt:
    def find_spec(self, name, *_):
        if name == sys.argv[1]:
            raise KeyboardInterrupt

sys.meta_path.insert(0, Interrupt())
from grader.cli import main
sys.exit(main(["run", "x.py"]))
"""


MODULES = [
    ("grader.cli.options", "grader"),
    ("grader.cli.run", "grader"),
    ("grader.run.processes.started_process", "grader"),
    ("grader.cli.grade_one", "grader run"),
    ("numpy", "grader run"),
    ("yaml", "grader run"),
]


@pytest.mark.parametrize(
    ("module", "who"),
    others_are_more(
        "one before the verb is known and one after", MODULES, "grader.cli.run", "yaml"
    ),
)
def test_it_ends_in_one_line_and_without_a_traceback(module, who):
    env = {**os.environ, "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-c", INTERRUPTED, module]
    done = subprocess.run(command, env=env, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (130, f"{who}: interrupted\n")
