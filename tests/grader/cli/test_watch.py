"""`grader run --watch` grades again after every save, and goes on after a mistake."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[3]


def test_a_save_is_graded_again_and_an_unusable_one_does_not_end_it(tmp_path):
    controller = tmp_path / "turtle_controller.py"
    controller.write_text("print('first')\n")
    process = subprocess.Popen(
        [sys.executable, "-m", "grader", "run", str(controller), "--watch"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        read_until(process, "Waiting for the next save")
        result = tmp_path / "graded" / "turtle_controller.py"
        assert (result / "output.txt").read_text() == "first\n"
        controller.write_text("print('second')\n")
        read_until(process, "Waiting for the next save")
        assert (result / "output.txt").read_text() == "second\n"
        controller.unlink()
        assert "does not exist" in read_until(process, "Waiting for the next save")
        controller.write_text("print('third')\n")
        read_until(process, "Waiting for the next save")
        assert (result / "output.txt").read_text() == "third\n"
        process.send_signal(signal.SIGINT)
        assert process.wait(timeout=30) == 130
    finally:
        process.kill()
        process.communicate()


def read_until(process: subprocess.Popen[str], words: str) -> str:
    """What the process says until and with a line that holds the words."""
    assert process.stderr is not None
    said = ""
    for line in process.stderr:
        said += line
        if words in line:
            return said
    raise AssertionError(f"it ended without saying {words!r}: {said}")
