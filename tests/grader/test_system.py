"""Where the system refuses something, it is noticed, and a run goes on without it."""

from pathlib import Path

import pytest

from grader import linux, system
from grader.run.processes import network


def test_submissions_are_run_where_linux_shows_its_processes(monkeypatch, tmp_path: Path) -> None:
    assert system.runs_submissions()
    monkeypatch.setattr(system, "PROC", tmp_path)
    assert not system.runs_submissions()


@pytest.mark.parametrize("libc", [None, object()])
def test_namespaces_that_libc_does_not_know_are_refused(monkeypatch, libc) -> None:
    monkeypatch.setattr(linux, "_libc", libc)
    monkeypatch.setattr(network, "_refused", set())
    with pytest.raises(OSError, match=r"unshare \(net\)"):
        linux.unshare(linux.CLONE_NEWNET)
    with pytest.raises(OSError, match=r"unshare \(net\)"):
        network._as_root()
