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

A path is relative to the file, or PACKAGE/FILE of an installed package. `replace` lists passages of
the first right solution, each of which must occur exactly once when its turn comes. `leaves` is
what is left of some checks' points, a share below 1 or `some`; all other checks must give all
points. Without it, it is enough that some check fails. `says` are words of the first line of its
report, which names the cause, or of the place behind it, as "(stands.py, line 7)".

If the first right solution is a folder, as a package is, `program` is the file in which passages
are replaced, and `in` the file of one passage. `files` holds whole files, or null for one to
remove; the sources of `put` are relative to this file. Another right solution may be made in the
same way:

    program: walker/state_publisher.py
    right:
      reference: reference
      a_loop: {put: {walker/state_publisher.py: right/loop.py}}
    mutants:
      no_launch_file: {files: {launch/walker.launch.py: null}, leaves: {launch: 0}}
"""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from grader.errors import ExerciseError
from grader.exercise import places
from grader.exercise.exercise import Exercise
from grader.system.yaml_file import Keys, Mistake, read_yaml
from grader.text.message import Message

FILE_NAME = "mutants.yaml"
#: What is left of a check's points: a share from 0 to 1, or some of them.
Left = float | Literal["some"]
#: The keys of a solution that is made of the first one.
MADE = frozenset(("replace", "files", "put"))


@dataclass(frozen=True)
class Change:
    """A change of a solution.

    Attributes:
        old, new: a passage that occurs exactly once, and its replacement. Without `old`, `new` is
            the whole file, and None removes it.
        file: the file in a folder; '' where the solution is a file.
    """

    old: str | None
    new: str | None
    file: str = ""


@dataclass(frozen=True)
class Solution:
    """A solution that an exercise is tried on.

    Attributes:
        name: its name.
        path: the submission, or what is changed to make it.
        is_right: whether it must get every point; else it is a mutant.
        changes: those that make it of `path`.
        leaves: check -> what is left of its points, where that is less than all; None: any.
        first_line: words of the first line of its report.
    """

    name: str
    path: Path
    is_right: bool
    changes: tuple[Change, ...] = ()
    leaves: Mapping[str, Left] | None = None
    first_line: str = ""

    def texts(self) -> Mapping[str, str | None]:
        """Apply its changes: file -> its new text, None if it is removed; '' is the path itself.

        Raises:
            ExerciseError: a passage does not occur exactly once, or there is no such file.
        """
        texts: dict[str, str | None] = {}
        for change in self.changes:
            file = self.path / change.file
            is_there = texts[change.file] is not None if change.file in texts else file.is_file()
            if not is_there and (change.old is not None or change.new is None):
                raise ExerciseError(
                    "mutants: {name}: there is no file {file!r} in {path}",
                    name=self.name,
                    file=change.file,
                    path=self.path.name,
                )
            if change.old is None:
                texts[change.file] = change.new
                continue
            text = texts.get(change.file)
            if text is None:
                text = file.read_text(encoding="utf-8")
            if text.count(change.old) != 1:
                raise ExerciseError(
                    "mutants: {name}: {old!r} stands {count} times in {in_file}; expected once",
                    name=self.name,
                    old=change.old,
                    count=text.count(change.old),
                    in_file=file.name,
                )
            texts[change.file] = text.replace(change.old, change.new or "")
        return texts

    def text(self) -> str:
        """Return the source of a solution that is a file, with its changes; see `texts`."""
        text = self.texts().get("")
        return self.path.read_text(encoding="utf-8") if text is None else text

    def lay_out(self, folder: Path) -> Path:
        """Return the path of the submission: the original, or a changed copy in a new folder."""
        if not self.changes:
            return self.path
        copy = folder / self.name / self.path.name
        texts = self.texts()
        if self.path.is_dir():
            shutil.copytree(self.path, copy, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            copy.parent.mkdir(parents=True)
        for file, text in texts.items():
            target = copy / file
            if text is None:
                target.unlink()
            else:
                target.parent.mkdir(parents=True, exist_ok=True)
                target.write_text(text, encoding="utf-8")
        return copy


def read_solutions(exercise: Exercise, path: Path | None = None) -> list[Solution]:
    """Read the solutions of an exercise, the right ones first.

    Args:
        path: of a mutants.yaml; None for the one in the exercise's folder.

    Raises:
        ExerciseError: there is none, or it is not valid.
    """
    path = path or exercise.folder / FILE_NAME
    try:
        file = read_yaml(path)
        try:
            found = _solutions(file.data, path.parent, exercise)
        except Mistake as mistake:
            raise ExerciseError(file.describe(mistake)) from None
        for solution in found:
            solution.texts()
    except OSError as error:
        raise ExerciseError(
            "cannot read the solutions of {name!r}, {path}: {why}. Expected a "
            "{file} in the exercise's folder, or --mutants FILE.",
            name=exercise.name,
            path=str(path),
            why=str(error.strerror),
            file=FILE_NAME,
        ) from None
    except (ExerciseError, ValueError) as error:
        raise ExerciseError(
            "{path} cannot be used: {why}", path=str(path), why=Message.of(error)
        ) from None
    return found


def right_solutions(exercise: Exercise) -> list[Path]:
    """Return the paths of the right solutions of an exercise that names some."""
    is_there = (exercise.folder / FILE_NAME).is_file()
    return [each.path for each in read_solutions(exercise) if each.is_right] if is_there else []


def _solutions(data: object, folder: Path, exercise: Exercise) -> list[Solution]:
    if not isinstance(data, dict) or not isinstance(data.get("right"), dict) or not data["right"]:
        raise Mistake(("right",), "expected names with paths of right solutions")
    unknown = [key for key in data if key not in ("right", "mutants", "program")]
    if unknown:
        raise Mistake((str(unknown[0]),), "unknown; there are right, mutants, program")
    (name, where), *others = data["right"].items()
    if isinstance(where, dict):
        raise Mistake(("right", str(name)), "expected the path of the first right solution")
    first = Solution(str(name), places.locate(folder, str(where)), is_right=True)
    program = str(data.get("program", ""))
    made = _Made(first.path, program, folder)
    right = [first, *(_right(str(n), words, made) for n, words in others)]
    mutants = data.get("mutants") or {}
    if not isinstance(mutants, dict):
        raise Mistake(("mutants",), "expected names with what is changed")
    both = {solution.name for solution in right} & set(mutants)
    if both:
        raise ExerciseError("{name!r} is both a right solution and a mutant", name=min(both))
    return [*right, *(_mutant(str(n), words, made, exercise) for n, words in mutants.items())]


@dataclass(frozen=True)
class _Made:
    """The origin of made solutions.

    Attributes:
        of: the first one.
        program: the file in a folder whose passages are replaced without `in`.
        folder: that of mutants.yaml, to which the paths of `put` are relative.
    """

    of: Path
    program: str
    folder: Path

    def changes(self, words: Mapping[str, Any], keys: Keys) -> tuple[Change, ...]:
        try:
            put = {
                file: places.locate(self.folder, str(where)).read_text(encoding="utf-8")
                for file, where in words.get("put", {}).items()
            }
            written = {**put, **words.get("files", {})}
            changes = (
                *(Change(None, None if t is None else str(t), str(f)) for f, t in written.items()),
                *(
                    Change(str(each["old"]), str(each["new"]), str(each.get("in", self.program)))
                    for each in words.get("replace", ())
                ),
            )
        except (TypeError, KeyError, AttributeError):
            raise Mistake((*keys, "replace"), "expected a list of old and new") from None
        is_folder = self.of.is_dir()
        if not changes or any(bool(each.file) != is_folder for each in changes):
            raise Mistake(keys, "there is nothing to replace in {path}", path=str(self.of))
        return changes


def _right(name: str, words: Any, made: _Made) -> Solution:
    if not isinstance(words, dict):
        return Solution(name, places.locate(made.folder, str(words)), is_right=True)
    keys: Keys = ("right", name)
    unknown = words.keys() - MADE
    if unknown:
        raise Mistake(keys, "unknown {key!r}", key=min(map(str, unknown)))
    return Solution(name, made.of, is_right=True, changes=made.changes(words, keys))


def _mutant(name: str, words: Any, made: _Made, exercise: Exercise) -> Solution:
    keys: Keys = ("mutants", name)
    if not isinstance(words, dict) or ("file" in words) != MADE.isdisjoint(words):
        raise Mistake(keys, "expected either `replace` or `file`")
    unknown = words.keys() - {"file", "leaves", "says", *MADE}
    if unknown:
        raise Mistake(keys, "unknown {key!r}", key=min(map(str, unknown)))
    leaves, says = _leaves(name, words.get("leaves"), exercise), words.get("says", "")
    if not isinstance(says, str):
        raise Mistake(
            (*keys, "says"), "expected words of a first line, found {says}", says=repr(says)
        )
    if "file" in words:
        path = places.locate(made.folder, str(words["file"]))
        return Solution(name, path, is_right=False, leaves=leaves, first_line=says)
    changes = made.changes(words, keys)
    return Solution(name, made.of, is_right=False, changes=changes, leaves=leaves, first_line=says)


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
            raise Mistake(keys, "no check is named {check!r}", check=check)
        is_share = isinstance(left, int | float) and not isinstance(left, bool) and 0 <= left < 1
        if left != "some" and not is_share:
            raise Mistake(
                (*keys, check), "expected a share below 1, or some; found {left!r}", left=left
            )
    return words
