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

Where the first right solution is a folder, as a package is, `program` says in which of its files
passages are replaced; `in` says so of one passage. Files may be `put` into a copy of the folder,
from beside this file, and be `removed`; a right solution may be made so as well:

    program: walker/state_publisher.py
    right:
      reference: reference
      a_loop: {put: {walker/state_publisher.py: right/loop.py}}
    mutants:
      no_launch_file: {remove: [launch/walker.launch.py], leaves: {launch: 0}}
"""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

from grader.errors import ExerciseError
from grader.exercise import places
from grader.exercise.loading import Exercise
from grader.exercise.yaml_file import Keys, Mistake, read_yaml

FILE_NAME = "mutants.yaml"
#: How a solution may be made of the first one.
MADE = frozenset(("replace", "put", "remove"))

#: What is left of a check's points: a share from 0 to 1, or some of them.
Left = float | Literal["some"]


@dataclass(frozen=True)
class Change:
    """A passage, and what stands there instead; `file` is '' for the solution itself."""

    old: str
    new: str
    file: str = ""


@dataclass(frozen=True)
class Solution:
    """Something that an exercise is tried on.

    Attributes:
        name: its own.
        path: what is handed in, or what is changed before.
        is_right: whether it must get every point; else it is a mutant.
        changes: passages of `path` and what stands there instead.
        leaves: check -> what is left of its points, where that is less than all; None: not said.
        program: of a folder, the file that `text` is; '' for a solution that is a file.
        puts: file of a folder -> what is put there.
        removes: files of a folder that are not there.
    """

    name: str
    path: Path
    is_right: bool
    changes: tuple[Change, ...] = ()
    leaves: Mapping[str, Left] | None = None
    program: str = ""
    puts: Mapping[str, Path] = field(default_factory=dict)
    removes: tuple[str, ...] = ()

    @property
    def is_changed(self) -> bool:
        """Whether it is another than what lies at `path`."""
        return bool(self.changes or self.puts or self.removes)

    def text(self, file: str = "") -> str:
        """The source of a file, the program's for '', with its changes.

        Raises:
            ExerciseError: a passage does not stand there exactly once.
            OSError: there is no such file.
        """
        file = file or self.program
        source = self.puts.get(file) or (self.path / file if file else self.path)
        text = source.read_text(encoding="utf-8")
        for change in self.changes:
            if (change.file or self.program) != file:
                continue
            if text.count(change.old) != 1:
                raise ExerciseError(
                    f"mutants: {self.name}: {change.old!r} stands {text.count(change.old)} times "
                    f"in {source.name}; expected once"
                )
            text = text.replace(change.old, change.new)
        return text

    def lay_out(self, folder: Path) -> Path:
        """What is handed in: what lies at `path` itself, or a changed copy in a new folder."""
        if not self.is_changed:
            return self.path
        copy = folder / self.name / self.path.name
        copy.parent.mkdir(parents=True)
        if not self.program:
            copy.write_text(self.text(), encoding="utf-8")
            return copy
        shutil.copytree(self.path, copy, ignore=shutil.ignore_patterns("__pycache__"))
        for file in {*self.puts, *(change.file or self.program for change in self.changes)}:
            (copy / file).parent.mkdir(parents=True, exist_ok=True)
            (copy / file).write_text(self.text(file), encoding="utf-8")
        for file in self.removes:
            (copy / file).unlink()
        return copy

    def look(self) -> None:
        """See whether it can be laid out.

        Raises:
            ExerciseError: a passage does not stand in its file exactly once.
            OSError: a file is not there.
        """
        for file in {*self.puts, *(change.file for change in self.changes)}:
            self.text(file)
        for file in self.removes:
            (self.path / file).stat()


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
            solution.look()
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
    unknown = [key for key in data if key not in ("right", "mutants", "program")]
    if unknown:
        raise Mistake((str(unknown[0]),), "unknown; there are right, mutants")
    (name, where), *others = data["right"].items()
    path = places.locate(folder, str(where))
    program = str(data.get("program", "")) if path.is_dir() else ""
    first = Solution(str(name), path, is_right=True, program=program)
    right = [first, *(_right(str(n), words, first, folder) for n, words in others)]
    mutants = data.get("mutants") or {}
    if not isinstance(mutants, dict):
        raise Mistake(("mutants",), "expected names with what is changed")
    both = {solution.name for solution in right} & set(mutants)
    if both:
        raise ExerciseError(f"{min(both)!r} is both a right solution and a mutant")
    return [
        *right,
        *(_mutant(str(n), words, first, folder, exercise) for n, words in mutants.items()),
    ]


def _right(name: str, words: Any, first: Solution, folder: Path) -> Solution:
    if not isinstance(words, dict):
        return Solution(name, places.locate(folder, str(words)), is_right=True)
    keys: Keys = ("right", name)
    unknown = words.keys() - MADE
    if unknown:
        raise Mistake(keys, f"unknown {min(map(str, unknown))!r}")
    return replace(first, name=name, **_made(keys, words, first, folder))


def _mutant(name: str, words: Any, of: Solution, folder: Path, exercise: Exercise) -> Solution:
    keys: Keys = ("mutants", name)
    if not isinstance(words, dict) or ("file" in words) == bool(words.keys() & MADE):
        raise Mistake(keys, "expected either `replace` or `file`")
    unknown = words.keys() - {"file", "leaves", *MADE}
    if unknown:
        raise Mistake(keys, f"unknown {min(map(str, unknown))!r}")
    leaves = _leaves(name, words.get("leaves"), exercise)
    if "file" in words:
        path = places.locate(folder, str(words["file"]))
        return Solution(name, path, is_right=False, leaves=leaves)
    made = _made(keys, words, of, folder)
    return replace(of, name=name, is_right=False, leaves=leaves, **made)


def _made(keys: Keys, words: Mapping[str, Any], of: Solution, folder: Path) -> dict[str, Any]:
    """How a solution is made of another one."""
    try:
        changes = tuple(
            Change(str(each["old"]), str(each["new"]), str(each.get("in", "")))
            for each in words.get("replace", ())
        )
    except (TypeError, KeyError, AttributeError):
        raise Mistake((*keys, "replace"), "expected a list of old and new") from None
    puts, removes = words.get("put", {}), words.get("remove", [])
    if not isinstance(puts, dict) or not isinstance(removes, list):
        raise Mistake(keys, "expected files with what is `put` there, and a list to `remove`")
    if not (changes or puts or removes) or not (of.path.is_file() or of.program):
        raise Mistake(keys, f"there is nothing to replace in {of.path}")
    found = {str(file): places.locate(folder, str(where)) for file, where in puts.items()}
    if not of.program and (found or removes or any(change.file for change in changes)):
        raise Mistake(keys, f"{of.path.name} is no folder, in which files could be")
    return {"changes": changes, "puts": found, "removes": tuple(map(str, removes))}


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
