"""A simulator that is fed with nonsense lives; for longer, call the script by hand."""

import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parents[3] / "scripts/fuzz_simulator.py"


@pytest.mark.parametrize("where", ["ros", "link"])
def test_a_fuzzed_simulator_lives(where: str) -> None:
    command = [sys.executable, str(SCRIPT), where, "--seconds", "2"]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
    assert "it lives" in run.stdout
