"""A mechanism that there is once stays one: who needs it takes that."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
#: What -> the text by which it is known, and the only file below grader/ that may have it.
ONE = {
    "a file that cannot be written is told": (r'say\(\s*"cannot write', "files.py"),
    "a trace is serialised between processes": (r"np\.savez|np\.load\(", ""),
    "work is done in a limited copy": (r"setitimer\(signal\.ITIMER_PROF", "limited.py"),
    "data of others becomes a dataclass": (r"get_type_hints\(", "strict_json.py"),
    "what a process uses is looked up": (r"/proc/[^ ]*/stat\"", "usage.py"),
    "a process of a run is begun": (r"os\.execvpe?\(", "run/processes/forking.py"),
}


@pytest.mark.parametrize("what", ONE)
def test_there_is_one(what: str) -> None:
    pattern, where = ONE[what]
    grader = ROOT / "grader"
    found = {
        path.relative_to(grader).as_posix()
        for path in grader.rglob("*.py")
        if re.search(pattern, path.read_text(encoding="utf-8"))
    }
    assert found == ({where} if where else set())
