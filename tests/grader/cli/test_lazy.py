import json
import os
import subprocess
import sys

import pytest

from grader import cli
from grader.cli import live, options, run
from grader.grading import RUNNERS
from grader.system import extensions
from grader.system import versions as system
from tests.programs import ROOT

IMPORTED = """
import json, sys
import grader.cli
if sys.argv[1:]:
    try:
        grader.cli.main(sys.argv[1:])
    except SystemExit:
        pass
print(json.dumps(list(sys.modules)))
"""
#: What takes long to import, and is not needed to know what is asked for.
DEAR = {"numpy", "PIL", "yaml", "backports", "jsonschema", "rich", "jinja2", "psutil"}


def imported(*words, cwd=ROOT):
    done = subprocess.run(
        [sys.executable, "-c", IMPORTED, *map(str, words)],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        cwd=cwd,
        capture_output=True,
        text=True,
        check=True,
    )
    return set(json.loads(done.stdout.splitlines()[-1]))


@pytest.mark.parametrize("words", [["--version"], ["run", "--help"], ["run", "--nonsense"]])
def test_who_only_asks_for_help_waits_for_nothing(words):
    assert not DEAR & imported(*words)


def test_the_versions_are_told(capsys):
    with pytest.raises(SystemExit) as end:
        cli.main(["--version"])
    assert end.value.code == 0
    said = capsys.readouterr().out
    assert said.startswith(
        f"grader {system.grader_version()} (Python {system.python_version()}, rclpy "
    )


def test_help_shows_the_first_line_of_each_verbs_module(capsys):
    with pytest.raises(SystemExit):
        cli.main(["--help"])
    said = " ".join(capsys.readouterr().out.split())
    for verb in extensions.points(extensions.VERBS):
        assert f"{verb} {cli.load(verb).__doc__.splitlines()[0]}" in said


def test_the_clocks_and_speeds_are_those_that_there_are():
    assert set(options.CLOCKS) == RUNNERS.keys()
    assert tuple(live.SPEEDS) == run.SPEEDS
