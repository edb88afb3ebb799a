from datetime import UTC, datetime

from grader.text.message import msg
from grader_class.entry import SUBMISSIONS, Entry, HandIn, Person, entries

ZOE = HandIn(
    "zoe.mueller",
    (Person("4711", "Zoë Müller", {"Email": "zoe@example.org"}), Person("4712")),
    attempt=2,
    at=datetime(2026, 11, 1, 12, tzinfo=UTC),
    problem=msg("The folder is empty."),
)


def test_an_entry_comes_back_as_it_was(tmp_path):
    folder = tmp_path / SUBMISSIONS / ZOE.id
    folder.mkdir(parents=True)
    entry = Entry(ZOE, "unusable", 100.0, key="ab", message=msg("There is nothing."), folder=folder)
    entry.put()
    assert entries(tmp_path) == [entry]
    assert (entry.score, ZOE.name) == (0.0, "Zoë Müller, 4712")


def test_nobody_pays_for_a_failure_of_the_grader(tmp_path):
    assert Entry(ZOE, "failed", 100.0).score is None


def test_an_entry_that_is_no_entry_or_was_not_finished_is_left_out(tmp_path):
    (tmp_path / SUBMISSIONS / "begun").mkdir(parents=True)
    for name, text in (("a", "[]"), ("b", "{"), ("c", '{"schema": "turtlesim-grader/entry/v1"}')):
        folder = tmp_path / SUBMISSIONS / name
        folder.mkdir(parents=True)
        (folder / "entry.json").write_text(text)
    assert entries(tmp_path) == []
