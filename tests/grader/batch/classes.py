"""A class on the real command line, and what of its folder is the same each time."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
#: Only what hangs takes so long [s].
DEADLINE_S = 240.0
#: When it was run, and how long that took.
CLOCKS = re.compile(rb'("wall_s"|"date"): [^,\n]+')
OF_ALL = ("class.json", "gradebook.csv", "gradebook.jsonl", "index.html")
#: Of each student; the page tells how long the run took, as the result does.
EACH = ("entry.json", "result.json", "output.txt", "canvas.png")


@dataclass(frozen=True)
class Class:
    """Submissions, and the exercise that they are for."""

    handed_in: Path
    exercise: Path

    def grade(self, out: Path, *words: str) -> subprocess.CompletedProcess[str]:
        """`grader batch`, to its end."""
        command = self.command(out, *words)
        return subprocess.run(
            command, env=ENV, text=True, capture_output=True, timeout=DEADLINE_S, check=False
        )

    def command(self, out: Path, *words: str) -> list[str]:
        """The words of the call."""
        common = [str(self.handed_in), "--out", str(out), "--exercise", str(self.exercise)]
        return [sys.executable, "-P", "-m", "grader", "batch", *common, *words]


ENV = {
    **os.environ,
    "PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")]),
    "PYTHONUNBUFFERED": "1",
}


def told(out: Path) -> dict[str, bytes]:
    """What a class has come to, but for when that was, and how long it took."""
    files = [out / name for name in OF_ALL]
    files += [path for name in EACH for path in sorted(out.glob(f"submissions/*/{name}"))]
    return {
        path.relative_to(out).as_posix(): CLOCKS.sub(rb"\1: -", path.read_bytes()) for path in files
    }
