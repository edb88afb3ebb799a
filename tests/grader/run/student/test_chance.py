"""What a program draws is the same in every process, whichever way it draws it."""

from __future__ import annotations

import subprocess
import sys

import pytest

WAYS = [
    "random.random()",
    "random.seed() or random.random()",
    "random.Random().random()",
    "random.SystemRandom().random()",
    "os.urandom(8)",
    "os.getrandom(8)",
    "uuid.uuid4()",
    "secrets.token_hex()",
]


def drawn(way: str) -> str:
    """The first and the second of what a process draws."""
    code = (
        "import os, random, secrets, uuid\n"
        "from grader.run.student import chance\n"
        "chance.install()\n"
        f"print({way}, {way})"
    )
    command = [sys.executable, "-c", code]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


@pytest.mark.parametrize("way", WAYS)
def test_two_processes_draw_the_same_and_never_twice(way: str) -> None:
    first = drawn(way)
    assert first == drawn(way)
    one, other = first.rsplit(maxsplit=1)
    assert one != other
