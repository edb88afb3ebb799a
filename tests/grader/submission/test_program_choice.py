"""What is found, and what is refused, with the system as it is not in an ordinary test."""

import os

import pytest

from grader.errors import SubmissionError
from grader.submission.answer import Inspection, SetUp, SetUpFacts
from grader.submission.program_choice import find, find_evaluated
from grader.submission.reader import readable
from grader.submission.request import Request
from grader.submission.set_ups import Unevaluated
from tests.files import lay
from tests.grader.submission.copies import NODE
from tests.grader.submission.test_opening import PACKAGE


@pytest.fixture
def scratch(tmp_path):
    folder = tmp_path / "scratch"
    folder.mkdir()
    return folder


def refused(path, scratch):
    with pytest.raises(SubmissionError) as error, readable(path):
        find(path, Request(), scratch)
    return str(error.value)


def test_an_unreadable_file_is_named(tmp_path, scratch, monkeypatch):
    handed_in = lay(tmp_path / "in", {"node.py": NODE})
    forbid(monkeypatch, handed_in / "node.py")
    assert refused(handed_in, scratch).startswith("node.py cannot be read: Permission denied.")


def test_an_unreadable_file_of_a_package_is_named(tmp_path, scratch, monkeypatch):
    handed_in = lay(tmp_path / "in", PACKAGE)
    asked = find(handed_in, Request(), scratch)
    assert asked == Unevaluated(handed_in, (".",))
    forbid(monkeypatch, handed_in / "spiral/node.py")
    said = SetUp(".", SetUpFacts(scripts=("turtle_controller = spiral.node:main",)), None)
    words = r"^spiral/node\.py cannot be read: Permission"
    with pytest.raises(SubmissionError, match=words), readable(handed_in):
        find_evaluated(asked, Inspection((said,)), "in", Request(), scratch)


def forbid(monkeypatch, path):
    """Make a file unreadable, also for root."""
    really_open = os.open

    def open_or_not(name, *args, **options):
        if name == path:
            raise PermissionError(13, "Permission denied", str(name))
        return really_open(name, *args, **options)

    monkeypatch.setattr(os, "open", open_or_not)


def test_a_fault_of_the_grader_is_not_blamed_on_the_submission(tmp_path, scratch, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("grader.submission.unpacking.unpack", full)
    (tmp_path / "a.zip").touch()
    with pytest.raises(OSError, match="No space left"), readable(tmp_path):
        find(tmp_path / "a.zip", Request(), scratch)


def test_a_folder_with_too_many_files_is_refused(tmp_path, scratch, monkeypatch):
    monkeypatch.setattr("grader.submission.folder.MAX_ENTRIES", 2)
    handed_in = lay(tmp_path / "in", dict.fromkeys(("a", "b", "c"), ""))
    assert "more than 2 files" in refused(handed_in, scratch)
