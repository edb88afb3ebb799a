"""What `--pattern` says of names."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path

import pytest

from grader.batch.find.pattern import Pattern
from grader.errors import UsageError
from tests.grader.batch.find.exports import NODE, Finder, content, lay, noted


def test_names_of_files_are_taken_apart(tmp_path: Path, finder: Finder) -> None:
    files = {
        "s1_Ann Lee_1_20261101T120000Z.py": NODE,
        "s1_Ann Lee_2_20261102T120000Z.zip": b"",
        "s2_Bob_van_Dyk_1_20261101T120000Z.tar.gz": b"",
        "readme.py": NODE,
    }
    found = finder(lay(tmp_path / "c", files), pattern="{id}_{name}_{attempt}_{at}")
    ann, bob = found.hand_ins
    assert (ann.id, ann.name, ann.attempt) == ("s1", "Ann Lee", 2)
    assert ann.at == datetime(2026, 11, 2, 12, tzinfo=UTC)
    assert (bob.name, bob.filename) == ("Bob_van_Dyk", "s2_Bob_van_Dyk_1_20261101T120000Z.tar.gz")
    assert noted(found, "the pattern does not fit", "readme.py")
    assert noted(found, "Several attempts", "Ann Lee")


def test_folders_are_taken_apart_too(tmp_path: Path, finder: Finder) -> None:
    files = {
        "ann@x.org/2026-11-01_12-00-00+0100/node.py": NODE,
        "ann@x.org/2026-10-01_12-00-00+0100/node.py": NODE,
        "bob@x.org/soon/node.py": NODE,
    }
    found = finder(lay(tmp_path / "c", files), pattern="{email}/{at}")
    ann, bob = found.hand_ins
    assert (ann.id, ann.attempt, ann.at) == (
        "ann@x.org",
        2,
        datetime.fromisoformat("2026-11-01T12:00:00+01:00"),
    )
    assert ann.path == tmp_path / "c" / "ann@x.org" / "2026-11-01_12-00-00+0100"
    assert ann.people[0].columns == {"email": "ann@x.org"}
    assert bob.at is None and noted(found, "soon is no time")


def test_a_file_gets_its_own_name_back(tmp_path: Path, finder: Finder) -> None:
    files = {"lab3-s1-A-my-node.py": NODE, "lab3-s2-B-x.tar.gz": b""}
    pattern = "lab3-{id}-{section}-{filename}"
    one, two = finder(lay(tmp_path / "c", files), pattern=pattern).hand_ins
    assert one.path and one.path.name == one.filename == "my-node.py"
    assert one.people[0].columns == {"section": "A"}
    assert two.filename == "x.tar.gz"


@pytest.mark.parametrize(
    ("pattern", "why"),
    [
        ("{attempt}_x", "does not say whose"),
        ("{id}{name}", "nothing between them"),
        ("{id}_{id}", "stands in it twice"),
        ("{id}_{a b}", "is no name for a field"),
        ("{id}_{name", "a brace has no partner"),
        ("{id}//x", "empty folders"),
        ("{id}/a/b/c/d", "more than 4"),
    ],
)
def test_a_pattern_that_makes_no_sense_says_why(pattern: str, why: str) -> None:
    with pytest.raises(UsageError, match=why):
        Pattern(pattern)


def test_a_pattern_that_fits_nothing_says_what_there_is(tmp_path: Path, finder: Finder) -> None:
    folder = lay(tmp_path / "c", {"alice.py": NODE, "bob.py": NODE})
    with pytest.raises(UsageError, match=r"fits none of what was found: alice\.py, bob\.py"):
        finder(folder, pattern="{id}_{name}")


def test_files_of_one_attempt_are_one_submission(tmp_path: Path, finder: Finder) -> None:
    files = {"ann_1_x.py": NODE, "ann_2_setup.py": "", "ann_2_node.py": NODE, "bob_1_x.py": NODE}
    by_id = finder.by_id(lay(tmp_path / "c", files), pattern="{id}_{attempt}_{filename}")
    assert content(by_id["ann"]) == {"setup.py", "node.py"}
    assert (by_id["ann"].attempt, by_id["bob"].attempt) == (2, 1)


def test_no_name_keeps_a_pattern_busy(tmp_path: Path, finder: Finder) -> None:
    """A regular expression would try all ways to part it: 10 million millions."""
    folder = lay(tmp_path / "c", {"_" * 200 + "x.py": NODE, "1_2_3_4_5_6_7_1_.py": NODE})
    found = finder(folder, pattern="{id}_{a}_{b}_{c}_{d}_{e}_{f}_{attempt}_")
    assert [each.id for each in found.hand_ins] == ["1"]
