"""Work in a copy of this process: what it breaks, it breaks there."""

from __future__ import annotations

import os
import re
import signal
import sys
import time
from dataclasses import replace
from pathlib import Path

import psutil
import pytest

from grader import limited, system
from grader.limited import Copy, LimitHit, Limits

BRIEF = Limits(cpu_s=0.3, wall_s=60.0, memory_bytes=2**26, answer_bytes=1000)
ASLEEP = replace(BRIEF, wall_s=0.5)
BUSY = replace(BRIEF, cpu_s=60.0)


def test_an_answer_is_what_the_function_returns():
    with Copy(lambda number: str(number * 2).encode(), Limits()) as copy:
        assert [copy.ask(1), copy.ask(21)] == [b"2", b"42"]


def test_it_is_another_process_that_remembers_what_it_has_done():
    seen = []

    def answer(number):
        seen.append(number)
        return f"{os.getpid()} {seen}".encode()

    with Copy(answer, Limits()) as copy:
        first, second = copy.ask(1).split(b" ", 1), copy.ask(2).split(b" ", 1)
    assert first[0] == second[0] != str(os.getpid()).encode()
    assert (second[1], seen) == (b"[1, 2]", [])


def backtracks(_):
    return str(re.match(r"(a+)+b", "a" * 60)).encode()


def sleeps(_):
    time.sleep(600)
    return b""


def closes_everything(_):
    os.closerange(3, 1000)
    time.sleep(600)
    return b""


def hoards(_):
    kept = []
    while True:
        kept.append(bytearray(2**20))


def raises(_):
    raise ValueError("nobody catches this")


WRONG = {
    "a loop in C": (backtracks, BRIEF, "did not come to an end in 0.3 s of processor time"),
    "a sleeper": (sleeps, ASLEEP, "did not come to an end in 0.5 s"),
    "one that closes its files": (closes_everything, ASLEEP, "ended the process that it ran in"),
    "a hoarder": (hoards, BUSY, "needed more memory than it may have"),
    "one that leaves": (
        lambda _: os._exit(7),
        BRIEF,
        "ended the process that it ran in (exit code 7)",
    ),
    "one that is killed": (
        lambda _: os.kill(os.getpid(), signal.SIGKILL),
        BRIEF,
        "ended the process that it ran in (signal 9)",
    ),
    "one that says too much": (lambda _: bytes(1001), BRIEF, "answered with more than 0 MB"),
    "one that raises": (raises, BRIEF, "ended the process that it ran in (exit code 1)"),
}


@pytest.mark.parametrize(("answer", "limits", "said"), WRONG.values(), ids=WRONG.keys())
def test_what_hits_a_limit_is_told_and_the_next_question_finds_a_new_copy(
    answer, limits, said, monkeypatch
):
    monkeypatch.setattr(limited, "_GRACE_S", 0.1 if answer is closes_everything else 10.0)
    with Copy(lambda number: answer(number) if number else b"well", limits) as copy:
        with pytest.raises(LimitHit) as hit:
            copy.ask(1)
        assert said in str(hit.value)
        assert copy.ask(0) == b"well"
        pid = copy._pid
    with pytest.raises(ProcessLookupError):
        os.kill(pid, 0)


def descriptors():
    return {path.name for path in Path("/proc/self/fd").iterdir()}


def test_nothing_is_left_of_a_copy():
    before, family = descriptors(), psutil.Process().children()
    for _ in range(20):
        assert limited.call(lambda: b"x", Limits()) == b"x"
    assert descriptors() == before
    assert psutil.Process().children() == family


def test_a_copy_holds_no_file_of_ours_open():
    kept, given = os.pipe()
    try:
        with Copy(lambda _: b"x", Limits()) as copy:
            copy.ask(0)
            os.close(given)
            assert os.read(kept, 1) == b""
    finally:
        os.close(kept)


def test_what_it_prints_goes_to_standard_error(capfd):
    def prints():
        print("out")
        print("error", file=sys.stderr)
        os.write(1, b"past Python\n")
        return b""

    limited.call(prints, Limits())
    out, error = capfd.readouterr()
    assert out == ""
    assert sorted(error.split("\n")) == ["", "error", "out", "past Python"]


def test_where_there_is_no_fork_what_python_notices_is_a_limit_all_the_same(monkeypatch):
    monkeypatch.setattr(system, "runs_submissions", lambda: False)

    def deep():
        return deep()

    with pytest.raises(LimitHit, match="too deeply"):
        limited.call(deep, Limits())
    assert limited.call(lambda: str(os.getpid()).encode(), Limits()) == str(os.getpid()).encode()
