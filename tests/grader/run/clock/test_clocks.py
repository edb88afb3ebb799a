"""Time as the submission sees it."""

import math
import time
from fractions import Fraction

import pytest

from grader.run.clock import time_and_chance
from grader.run.clock.scheduler import Scheduler
from grader.run.lockstep import faults

ASKED_NS: list[int] = []


@pytest.fixture
def scheduler(monkeypatch):
    scheduler = Scheduler()
    monkeypatch.setattr(scheduler, "sleep", ASKED_NS.append)
    monkeypatch.setattr(time_and_chance, "SCHEDULER", scheduler, raising=False)
    return scheduler


@pytest.mark.usefixtures("scheduler")
@pytest.mark.parametrize("seconds", [-1, -0.5, math.nan, math.inf, "1", None, [], 1j])
def test_sleeping_wrongly_is_the_program_s_mistake_in_python_s_words(seconds):
    with pytest.raises((TypeError, ValueError, OverflowError)) as real:
        time.sleep(seconds)
    with pytest.raises(type(real.value)) as ours:
        time_and_chance._sleep(seconds)
    assert str(ours.value) == str(real.value)
    assert faults.whose(ours.value) == ""


@pytest.mark.usefixtures("scheduler")
@pytest.mark.parametrize(("seconds", "ns"), [(0, 0), (1, 10**9), (0.25, 250_000_000)])
def test_sleeping_is_the_scheduler_s_work(seconds, ns):
    ASKED_NS.clear()
    time_and_chance._sleep(seconds)
    assert [ns] == ASKED_NS
    assert Fraction(ns, 10**9) == seconds
