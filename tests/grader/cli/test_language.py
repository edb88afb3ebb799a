import subprocess
import sys

import pytest

from grader import cli


@pytest.mark.parametrize("words", [["run", "--lang"], ["run", "--lang="], ["--lang"]])
def test_a_language_that_is_not_named_is_asked_for(words, capsys):
    assert cli.main(words) == 2
    assert "Traceback" not in capsys.readouterr().err


def test_a_terminal_that_lacks_a_languages_signs_is_told_the_rest():
    command = [sys.executable, "-m", "grader", "run", "no_such_file.py", "--lang", "zh"]
    environment = {"PATH": "/usr/bin:/bin", "PYTHONIOENCODING": "ascii", "PYTHONPATH": "."}
    done = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
    assert done.returncode == 2
    assert "no_such_file.py" in done.stderr
    assert "Traceback" not in done.stderr
