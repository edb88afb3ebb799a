import errno
import os
from pathlib import Path

import pytest

from grader.errors import GraderFailure, NotNow, NotOffered
from grader.run.processes import levels
from grader_class import grade
from grader_class.pool import Task


@pytest.mark.parametrize(
    ("error", "state"),
    [
        (OSError(errno.EMFILE, os.strerror(errno.EMFILE)), "again"),
        (OSError(errno.ENOENT, os.strerror(errno.ENOENT)), "failed"),
        (NotNow("a trial took 20 s"), "again"),
        (NotOffered("there is less here"), "unfit"),
        (GraderFailure("the simulator died"), "failed"),
    ],
)
def test_only_what_may_pass_is_to_be_tried_again(monkeypatch, error, state):
    def make(task):
        raise error

    monkeypatch.setattr(grade, "make", make)
    monkeypatch.setattr(levels, "_only", "")
    task = Task("a", (), "square", "virtual", None, None, Path("a.py"))
    answer = grade.done(task)
    assert answer.state == state
    assert str(error) in str(answer.message)
