"""What a system refuses for good is told from what it may grant the next time."""

import errno
import os

import pytest

from grader.run.processes import refusal
from grader.run.processes.refusal import Refusal


@pytest.mark.parametrize(
    ("number", "is_final"),
    [
        *((n, True) for n in (errno.EPERM, errno.EACCES, errno.ENOSYS, errno.EINVAL)),
        *((n, True) for n in (errno.EOPNOTSUPP, errno.EUSERS)),
        *((n, False) for n in (errno.EMFILE, errno.ENOMEM, errno.ENOSPC, errno.ETIMEDOUT, 0)),
    ],
)
def test_an_error_is_for_good_or_not(number, is_final):
    assert Refusal(number, "mount", "?").is_final is is_final


@pytest.mark.parametrize(
    ("step", "is_final"),
    [
        ("unshare (net)", True),
        ("unshare (user, net)", True),
        ("unshare (mnt)", False),
        ("unshare (pid)", False),  # the system does not say
        ("net", False),
    ],
)
def test_no_room_for_a_namespace_is_for_good_where_there_may_be_none(
    tmp_path, monkeypatch, step, is_final
):
    monkeypatch.setattr(refusal, "MOST", str(tmp_path / "max_{kind}"))
    for kind, most in (("net", 0), ("mnt", 1), ("user", 1)):
        (tmp_path / f"max_{kind}").write_text(f"{most}\n")
    assert Refusal(errno.ENOSPC, step, "?").is_final is is_final


@pytest.mark.parametrize(
    ("error", "told"),
    [
        (OSError(1, "Operation not permitted", "unshare (net)"), "unshare (net): Operation not p"),
        (OSError(2, "No such file or directory", "/a: b\n"), "/a b: No such file or directory"),
        (OSError(2, "No such file", b"/\xff"), "/\udcff: No such file"),
        (RuntimeError("can't start\nnew thread"), "test_refusal._raise: can't start new thread"),
        (OSError("odd"), "test_refusal._raise: odd"),
    ],
)
def test_an_error_comes_through_a_pipe_as_a_line(error, told):
    try:
        _raise(error)
    except Exception as raised:
        line = Refusal.of(raised).to_line()
    assert "\n" not in line
    back = Refusal.from_line(line)
    assert back.number == (getattr(error, "errno", 0) or 0)
    assert back.why.startswith(told)


def _raise(error: Exception) -> None:
    raise error


@pytest.mark.parametrize("line", ["", "nsenter: no", "1 no colon", "99999999999 a: b", "² a: b"])
def test_any_other_line_is_what_it_says(line):
    assert Refusal.from_line(line) == Refusal(0, "", line)


@pytest.mark.parametrize(
    ("answers", "tries"),
    [
        ([None], 1),
        ([errno.EMFILE, None], 2),
        ([errno.EMFILE, errno.EPERM], 2),
        ([errno.EMFILE] * 9, refusal.TRIES),
    ],
)
def test_what_may_pass_is_tried_again_a_few_times(monkeypatch, answers, tries):
    monkeypatch.setattr(refusal, "PAUSES_S", (0.0, 0.0))
    left = [None if n is None else Refusal(n, "x", os.strerror(n)) for n in answers]
    before = len(left)
    expected = left[tries - 1]
    assert refusal.insist(lambda: left.pop(0)) == expected
    assert before - len(left) == tries
