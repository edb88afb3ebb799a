"""A class that was graded in parts is the class that was graded at once."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from grader.batch.batch import is_in
from grader.batch.class_file import ClassFile
from grader.batch.entry import SUBMISSIONS, entries
from grader.batch.merge import merge
from grader.batch.store import Store
from grader.errors import UsageError
from grader.exercise.exercise import Exercise
from grader.exercise.loading import load_exercise
from tests.grader.batch.classes import Class, told


@pytest.fixture
def exercise(small_class: Class) -> Exercise:
    return load_exercise(small_class.exercise)


def merged(parts: list[Path], exercise: Exercise, out: Path) -> list[str]:
    with Store.opened(out) as store:
        return merge(parts, exercise, store)


def changed(part: Path, to: Path, **fields: object) -> Path:
    """A copy of a part that says something else of itself."""
    shutil.copytree(part, to)
    replace(ClassFile.read(part), **fields).put(to)  # type: ignore[arg-type]
    return to


@pytest.mark.timeout(300)
def test_parts_put_together_equal_the_class_that_was_graded_at_once(
    small_class: Class, graded: Path, parts: list[Path], tmp_path: Path
) -> None:
    out = tmp_path / "merged"
    call = small_class.grade(out, "--merge", *map(str, parts))
    assert call.returncode == 0, call.stderr
    assert told(out) == told(graded)
    stores = [sorted(path.name for path in each.glob("store/*/*")) for each in (out, graded)]
    assert stores[0] == stores[1]
    assert "Not among these" not in call.stderr
    assert "not finished" not in call.stderr
    again = small_class.grade(out)
    assert "5 hand-ins of 5 graded before." in again.stderr


@pytest.mark.timeout(300)
def test_a_part_that_is_missing_or_not_finished_is_told(
    parts: list[Path], exercise: Exercise, tmp_path: Path
) -> None:
    full = max(parts, key=lambda part: len(entries(part)))
    number = ClassFile.read(full).shard[0]
    begun = tmp_path / "begun"
    shutil.copytree(full, begun)
    shutil.rmtree(next((begun / SUBMISSIONS).iterdir()))
    there = len(entries(full))
    assert merged([begun], exercise, tmp_path / "merged") == [
        f"Not among these: part {3 - int(number)} of 2.",
        f"{begun} is not finished: {there - 1} of {there} hand-ins.",
    ]


@pytest.mark.parametrize(
    ("field", "value", "named"),
    [
        ("grader", "0.0.1", "the grader's version: there 0.0.1"),
        ("python", "3.9.1", "the version of Python: there 3.9.1"),
        ("exercise_sha256", "abc", "the exercise's rubric: there abc"),
        ("time", "real", r"the clock \(--time\): there real, here virtual"),
        ("seed", 7, r"the seed \(--seed\): there 7, here none"),
    ],
)
@pytest.mark.timeout(300)
def test_parts_of_different_graders_or_exercises_are_refused(
    parts: list[Path],
    exercise: Exercise,
    tmp_path: Path,
    field: str,
    value: object,
    named: str,
) -> None:
    other = changed(parts[1], tmp_path / "other", **{field: value})
    with pytest.raises(UsageError, match=f"other does not fit to .*{named}"):
        merged([parts[0], other], exercise, tmp_path / "merged")
    assert entries(tmp_path / "merged") == []


@pytest.mark.timeout(300)
def test_parts_are_not_put_together_as_those_of_another_exercise(
    parts: list[Path], tmp_path: Path
) -> None:
    with pytest.raises(UsageError, match=r"judged by something else .* Name .* --exercise"):
        merged(parts, load_exercise("turtlesim_challenge"), tmp_path / "merged")


@pytest.mark.timeout(300)
def test_two_parts_that_tell_different_things_of_a_student_are_refused(
    parts: list[Path], exercise: Exercise, tmp_path: Path
) -> None:
    full = max(parts, key=lambda part: len(entries(part)))
    other = tmp_path / "other"
    shutil.copytree(full, other)
    entry = next(other.glob("submissions/*/entry.json"))
    data = json.loads(entry.read_text())
    entry.write_text(json.dumps({**data, "key": "0" * 32}))
    with pytest.raises(UsageError, match=f"both have {entry.parent.name}, and not the same"):
        merged([full, other], exercise, tmp_path / "merged")


@pytest.mark.timeout(300)
def test_what_is_no_part_of_a_class_is_refused(exercise: Exercise, tmp_path: Path) -> None:
    (tmp_path / "photos").mkdir()
    with pytest.raises(UsageError, match="photos is no folder of a class"):
        merged([tmp_path / "photos"], exercise, tmp_path / "merged")


@pytest.mark.timeout(300)
def test_parts_do_not_come_into_the_folder_of_another_class(
    parts: list[Path], exercise: Exercise, tmp_path: Path
) -> None:
    out = changed(parts[0], tmp_path / "other", grader="0.0.1", shard="")
    before = told_class(out)
    with pytest.raises(UsageError, match="was graded by something else"):
        merged(parts, exercise, out)
    assert told_class(out) == before


def told_class(out: Path) -> tuple[ClassFile, int]:
    return ClassFile.read(out), len(entries(out))


def test_every_content_is_in_exactly_one_part() -> None:
    for parts in (1, 2, 7):
        for name in map(str, range(100)):
            assert sum(is_in(name, (part, parts)) for part in range(1, parts + 1)) == 1
