"""Beginners' mistakes in right controllers are named, at their line."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.conftest import EXAMPLES

ROOT = Path(__file__).parents[2]
#: In `make test-all`; a sample where few examples are asked for, as in CI, and in shorter runs.
IS_SAMPLE = EXAMPLES < 100
MISTAKES = 36 if IS_SAMPLE else 200
#: Of those that lose points: what is to be right of the place, its line, and of the words [%].
LINE, WORDS = 75, 85


@pytest.mark.more("a grading for each mistake")
@pytest.mark.timeout(0)
def test_the_first_line_names_the_mistake_and_its_line() -> None:
    words = [ROOT / "scripts" / "search_wrong_verdicts.py", "--only", "mistakes", "--seed", "11"]
    words += ["--quick"] if IS_SAMPLE else []
    done = subprocess.run(
        [sys.executable, *words, "--count", str(MISTAKES), "--limit-s", "3600"],
        check=False,
        stdout=subprocess.PIPE,
        text=True,
    )
    line = re.search(r"exact line: .* \((\d+) %\)", done.stdout)
    own = re.search(r"mistake's own: .* \((\d+) %\)", done.stdout)
    assert line is not None and own is not None, done.stdout
    assert int(line[1]) >= LINE, done.stdout
    assert int(own[1]) >= WORDS, done.stdout
