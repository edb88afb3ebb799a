"""mutants.yaml: the right solutions of an exercise, and mutants of them that must lose points.

    right:
      reference: solution.py
    mutants:
      no_stop:
        replace:
          - {old: 'if near:', new: 'if False:'}
        leaves: {stops: 0, line: some}
      stands_still:
        file: stands_still.py
        leaves: nothing

A path is one beside the file, or PACKAGE/FILE of an installed package. `replace` names passages of
the first right solution, each standing there exactly once when its turn comes. `leaves` says what
is left of some checks' points, a share below 1 or `some`, and that all others stay whole; without
it, it is enough that some check fails.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from grader.errors import ExerciseError
from grader.exercise import places
from grader.exercise.loading import Exercise
from grader.exercise.yaml_file import Keys, Mistake, read_yaml

FILE_NAME = "mutants.yaml"

#: What is left of a check's points: a share from 0 to 1, or some of them.
Left = float | Literal["some"]


@dataclass(frozen=True)
class Solution:
    """Something that an exercise is tried on.

    Attributes:
        name: its own.
        path: what is handed in, or what is changed before.
        is_right: whether it must get every point; else it is a mutant.
        changes: passages of `path` and what stands there instead.
        leaves: check -> what is left of its points, where that is less than all; None: not said.
    """

    name: str
    path: Path
    is_right: bool
    changes: tuple[tuple[str, str], ...] = ()
    leaves: Mapping[str, Left] | None = None

    def text(self) -> str:
        """The source, with its changes.

        Raises:
            ExerciseError: a passage does not stand there exactly once.
        """
        text = self.path.read_text(encoding="utf-8")
        for old, new in self.changes:
            if text.count(old) != 1:
                raise ExerciseError(
                    f"mutants: {self.name}: {old!r} stands {text.count(old)} times in "
                    f"{self.path.name}; expected once"
                )
            text = text.replace(old, new)
        return text

    def lay_out(self, folder: Path) -> Path:
        """What is handed in: the file itself, or a changed copy in a new folder."""
        if not self.changes:
            return self.path
        copy = folder / self.name / self.path.name
        copy.parent.mkdir(parents=True)
        copy.write_text(self.text(), encoding="utf-8")
        return copy


def read_solutions(exercise: Exercise, path: Path | None = None) -> list[Solution]:
    """The solutions of an exercise, the right ones first.

    Args:
        path: of a mutants.yaml; None for the one in the exercise's folder.

    Raises:
        ExerciseError: there is none, or it says something that cannot be.
    """
    path = path or exercise.folder / FILE_NAME
    try:
        file = read_yaml(path)
        try:
            found = _solutions(file.data, path.parent, exercise)
        except Mistake as mistake:
            raise ExerciseError(file.told(mistake)) from None
        for solution in found:
            if solution.changes:
                solution.text()
    except OSError as error:
        raise ExerciseError(
            f"cannot read the solutions of {exercise.name!r}, {path}: {error.strerror}. "
            f"Expected a {FILE_NAME} in the exercise's folder, or --mutants FILE."
        ) from None
    except (ExerciseError, ValueError) as error:
        raise ExerciseError(f"{path} cannot be used: {error}") from None
    return found


def _solutions(data: object, folder: Path, exercise: Exercise) -> list[Solution]:
    if not isinstance(data, dict) or not isinstance(data.get("right"), dict) or not data["right"]:
        raise Mistake(("right",), "expected names with paths of right solutions")
    unknown = [key for key in data if key not in ("right", "mutants")]
    if unknown:
        raise Mistake((str(unknown[0]),), "unknown; there are right, mutants")
    right = [
        Solution(str(name), places.locate(folder, str(where)), is_right=True)
        for name, where in data["right"].items()
    ]
    mutants = data.get("mutants") or {}
    if not isinstance(mutants, dict):
        raise Mistake(("mutants",), "expected names with what is changed")
    both = {solution.name for solution in right} & set(mutants)
    if both:
        raise ExerciseError(f"{min(both)!r} is both a right solution and a mutant")
    return [
        *right,
        *(_mutant(str(n), words, right[0], folder, exercise) for n, words in mutants.items()),
    ]


def _mutant(name: str, words: Any, of: Solution, folder: Path, exercise: Exercise) -> Solution:
    keys: Keys = ("mutants", name)
    if not isinstance(words, dict) or ("file" in words) == ("replace" in words):
        raise Mistake(keys, "expected either `replace` or `file`")
    unknown = words.keys() - {"file", "replace", "leaves"}
    if unknown:
        raise Mistake(keys, f"unknown {min(map(str, unknown))!r}")
    leaves = _leaves(name, words.get("leaves"), exercise)
    if "file" in words:
        path = places.locate(folder, str(words["file"]))
        return Solution(name, path, is_right=False, leaves=leaves)
    try:
        changes = tuple((str(each["old"]), str(each["new"])) for each in words["replace"])
    except (TypeError, KeyError):
        raise Mistake((*keys, "replace"), "expected a list of old and new") from None
    if not changes or not of.path.is_file():
        raise Mistake(keys, f"there is nothing to replace in {of.path}")
    return Solution(name, of.path, is_right=False, changes=changes, leaves=leaves)


def _leaves(name: str, words: object, exercise: Exercise) -> Mapping[str, Left] | None:
    if words is None:
        return None
    keys: Keys = ("mutants", name, "leaves")
    if words == "nothing":
        return dict.fromkeys(exercise.points, 0.0)
    if not isinstance(words, dict) or not words:
        raise Mistake(keys, "expected 'nothing', or checks with shares")
    for check, left in words.items():
        if check not in {known.name for known in exercise.checks}:
            raise Mistake(keys, f"no check is named {check!r}")
        is_share = isinstance(left, int | float) and not isinstance(left, bool) and 0 <= left < 1
        if left != "some" and not is_share:
            raise Mistake((*keys, check), f"expected a share below 1, or some; found {left!r}")
    return words
