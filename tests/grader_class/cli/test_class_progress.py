import io

import pytest
from rich.console import Console
from rich.progress import Progress

from grader_class.batch import Planned
from grader_class.cli import class_progress
from grader_class.entry import Entry, HandIn
from grader_class.pool import Task
from grader_class.store import Store


class Clock:
    """The time, which passes only when a test says so [s]."""

    now = 1000.0

    def __call__(self):
        return self.now


def _graded(store, number, path):
    """A hand-in whose folder is there; without a path there was nothing to run."""
    made = HandIn(f"s{number}", (), path)
    Entry(made, "unusable" if path else "nothing", 10.0, folder=store.student(made.id)).put()
    return made


@pytest.mark.parametrize("each_s", [0.5, 25.0, 400.0])
def test_after_ten_runs_the_time_left_is_right_however_slow_and_however_many_are_missing(
    each_s, tmp_path, monkeypatch
):
    store, clock, shown = Store(tmp_path), Clock(), list[Progress]()

    def seen(*columns, **options):
        shown.append(Progress(*columns, **options))
        return shown[0]

    monkeypatch.setattr(class_progress, "Progress", seen)
    there = [_graded(store, number, tmp_path) for number in range(100)]
    missing = tuple(_graded(store, number, None) for number in range(100, 150))
    paths = ("", "virtual", None, None, tmp_path)
    tasks = tuple(Task(each.id, (each,), *paths) for each in there)
    console = Console(file=io.StringIO(), force_terminal=True, width=120, get_time=clock)
    with class_progress.shown(console, Planned(tasks, missing, (), 0), store) as show:
        for each in missing:
            show(each)
        for each in there[:10]:
            clock.now += each_s
            show(each)
        (bar,) = shown[0].tasks
        assert bar.completed == 60
        assert bar.time_remaining == pytest.approx(90 * each_s, rel=0.2)
