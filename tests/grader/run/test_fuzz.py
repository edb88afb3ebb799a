"""A simulator that is fed with nonsense lives; EXAMPLES=n feeds it for n seconds."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parents[3] / "scripts/fuzz_simulator.py"
LONG = pytest.param(
    os.environ.get("EXAMPLES", "20"), marks=[pytest.mark.more("a search"), pytest.mark.timeout(0)]
)


@pytest.mark.parametrize("seconds", ["1", LONG])
@pytest.mark.parametrize("where", ["ros", "link", "cast"])
def test_a_fuzzed_simulator_lives(where: str, seconds: str) -> None:
    command = [sys.executable, str(SCRIPT), where, "--seconds", seconds]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
    assert "it lives" in run.stdout
