"""Work in a copy of this process: what it breaks, it breaks there."""

import os
import re
import signal
import sys
import time
from dataclasses import replace
from pathlib import Path

import psutil
import pytest

from grader.system import limited
from grader.system import versions as system
from grader.system.limited import LimitHit, WorkLimits

BRIEF = WorkLimits(cpu_s=0.2, wall_s=60.0, memory_bytes=2**26, answer_bytes=1000)
ASLEEP = replace(BRIEF, wall_s=0.2)
BUSY = replace(BRIEF, cpu_s=60.0)


def test_answers_come_as_they_are_made_from_one_other_process():
    seen = []

    def work():
        for number in range(3):
            seen.append(number)
            yield f"{os.getpid()} {seen}".encode()

    pids, told = zip(
        *(each.split(b" ", 1) for each in limited.stream(work, WorkLimits())), strict=True
    )
    assert told == (b"[0]", b"[0, 1]", b"[0, 1, 2]")
    assert len(set(pids)) == 1 and pids[0] != str(os.getpid()).encode()
    assert seen == []


def backtracks():
    return str(re.match(r"(a+)+b", "a" * 60)).encode()


def closes_everything():
    os.closerange(3, 1000)
    time.sleep(600)


def hoards():
    kept = []
    while True:
        kept.append(bytearray(2**20))


WRONG = {
    "a loop in C": (backtracks, BRIEF, "did not come to an end in 0.2 s of processor time"),
    "a sleeper": (lambda: time.sleep(600), ASLEEP, "did not come to an end in 0.2 s"),
    "one that closes its files": (closes_everything, ASLEEP, "ended the process that it ran in"),
    "a hoarder": (hoards, BUSY, "needed more memory than it may have"),
    "one that leaves": (lambda: os._exit(7), BRIEF, "process that it ran in (exit code 7)"),
    "one that is killed": (lambda: signal.raise_signal(9), BRIEF, "ran in (signal 9)"),
    "one that says too much": (lambda: bytes(1001), BRIEF, "answered with more than 0 MB"),
    "one that raises": (lambda: 1 / 0, BRIEF, "ended the process that it ran in (exit code 1)"),
}


@pytest.mark.parametrize(("answer", "limits", "said"), WRONG.values(), ids=WRONG.keys())
def test_what_hits_a_limit_is_told_and_what_came_before_is_there(answer, limits, said, monkeypatch):
    monkeypatch.setattr(limited, "_GRACE_S", 0.1 if answer is closes_everything else 10.0)

    def work():
        yield b"well"
        yield answer()

    family = psutil.Process().children()
    answers = limited.stream(work, limits)
    assert next(answers) == b"well"
    with pytest.raises(LimitHit) as hit:
        next(answers)
    assert said in str(hit.value)
    assert psutil.Process().children() == family


def descriptors():
    return {path.name for path in Path("/proc/self/fd").iterdir()}


def test_nothing_is_left_of_a_copy_nor_held_open():
    before, family = descriptors(), psutil.Process().children()
    for _ in range(4):
        assert limited.call(lambda: b"x", WorkLimits()) == b"x"
    assert descriptors() == before
    assert psutil.Process().children() == family
    kept, given = os.pipe()
    try:
        answers = limited.stream(lambda: iter([b"x", b"y"]), WorkLimits())
        next(answers)
        os.close(given)
        assert os.read(kept, 1) == b""
        answers.close()
    finally:
        os.close(kept)


def test_what_it_prints_goes_to_standard_error(capfd):
    def prints():
        print("out")
        print("error", file=sys.stderr)
        os.write(1, b"past Python\n")
        return b""

    limited.call(prints, WorkLimits())
    out, error = capfd.readouterr()
    assert out == ""
    assert sorted(error.split("\n")) == ["", "error", "out", "past Python"]


def test_where_there_is_no_fork_what_python_notices_is_a_limit_all_the_same(monkeypatch):
    monkeypatch.setattr(system, "runs_submissions", lambda: False)

    def deep():
        return deep()

    with pytest.raises(LimitHit, match="too deeply"):
        limited.call(deep, WorkLimits())
    assert limited.call(lambda: b"%d" % os.getpid(), WorkLimits()) == b"%d" % os.getpid()
