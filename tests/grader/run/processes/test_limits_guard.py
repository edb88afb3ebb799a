"""What a family of processes uses, and what ends it."""

import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
import yaml

from grader.run.limits import LIMITS, MIB, RunLimits
from grader.run.processes.limits_guard import Family, LimitsGuard
from grader.system import linux

TEXTS = yaml.safe_load(Path(__file__).with_suffix(".yaml").read_text())

TELLS_FILES = bool(Path("/proc/self/fd").stat().st_size)
#: Only a failing test waits so long [s].
DEADLINE_S = 30.0


@contextmanager
def family() -> Iterator[tuple[int, int]]:
    """Start a family; yield its ancestor and its first member."""
    with subprocess.Popen(
        [sys.executable, "-W", "ignore", "-I", "-S", "-c", TEXTS["family"]],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
    ) as ancestor:
        yield ancestor.pid, int(ancestor.stdout.readline())


def test_all_descendants_count_and_what_they_share_once():
    with family() as (ancestor, first):
        found = Family(ancestor)
        assert found.usage().tasks == 4
        assert found.usage().memory_bytes > 300 * MIB
        assert 100 * MIB < found.private_memory_bytes() < 150 * MIB
        assert Family(first).usage().tasks == 2  # an ancestor does not count


def test_whose_parent_ends_during_a_look_is_found_by_the_next(monkeypatch):
    """He has told of a parent that is not there any more, and has another one by now."""
    gone = 1 << 30
    look = linux.process_stat
    with family() as (ancestor, first):

        def look_before(pid: int) -> linux.ProcessStat:
            seen = look(pid)
            return seen._replace(parent=gone) if pid == first else seen

        found = Family(ancestor)
        with monkeypatch.context() as during:
            during.setattr(linux, "process_stat", look_before)
            assert found.usage().tasks == 0
        assert found.usage().tasks == 4


def test_a_process_that_does_not_exist_has_no_family():
    assert Family(1 << 30).usage() == (0, 0, 0, 0)


@pytest.mark.parametrize(
    ("limits", "said"),
    [
        (RunLimits(family_bytes=50 * MIB), "used more than 50 MiB of memory"),
        (RunLimits(tasks=-10), "-10 processes and threads"),
        (RunLimits(output_bytes=MIB - 1), "printed more than 0 MiB"),
        pytest.param(
            RunLimits(family_files=8),
            "open files and sockets at once",
            marks=pytest.mark.applies(TELLS_FILES, reason="this Linux tells"),
        ),
    ],
)
def test_too_much_ends_them(limits, said):
    ended = threading.Event()
    with family() as (ancestor, _):
        guard = LimitsGuard(limits)
        guard.add(ancestor, ended.set, lambda: MIB)
        assert ended.wait(DEADLINE_S)
        guard.stop()
    assert said in str(guard.remark)


@pytest.mark.parametrize(("bytes_", "is_much"), [(50 * MIB, True), (LIMITS.family_bytes, False)])
def test_the_last_look_finds_what_came_after_the_one_before(monkeypatch, bytes_, is_much):
    monkeypatch.setattr("grader.run.processes.limits_guard.EVERY_S", DEADLINE_S)
    ended = threading.Event()
    with family() as (ancestor, _):
        guard = LimitsGuard(RunLimits(family_bytes=bytes_))
        guard.add(ancestor, ended.set)
        assert guard.measure_last() is ended.is_set() is is_much
    assert ("used more than 50 MiB of memory" in str(guard.remark)) is is_much
