"""Loads an exercise: reads its exercise.yaml, merged with an edited copy, and its checks.py.

`grader.exercise.places` finds the files, `grader.exercise.building` interprets the values.
"""

from __future__ import annotations

import math
import os
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from grader.errors import ExerciseError
from grader.exercise import allowed, cases, places
from grader.exercise.building import EXPECT, FITS, INTERFACES, NAME, build
from grader.exercise.comparing import is_number
from grader.exercise.draws import DRAW
from grader.exercise.exercise import CPU, INSPECTIONS, INSPECTS, Exercise
from grader.exercise.places import DESCRIPTION, Place, names
from grader.exercise.translated import read_translations, translate
from grader.system.extensions import DEFAULT_EXERCISE
from grader.system.yaml_file import (
    Mistake,
    YamlFile,
    check_known,
    decoded,
    did_you_mean,
    expect,
    read_yaml,
)
from grader.text.message import Message

SUFFIXES = (".yaml", ".yml")
KEYS = (
    *("exercise", "title", "task", "scene", "setting", "limits", "varied_runs", INSPECTS, CPU),
    *(INSPECTIONS, INTERFACES, DRAW, *cases.KEYS, *allowed.KEYS, EXPECT),
    *("points", "visible", "late", "tolerances", "starter", "program", "programs", FITS),
)
#: Keys of an edited copy -> what it replaces, for which the original's translations do not fit.
TRANSLATED = {"title": "title", "task": "task", EXPECT: "checks"}


def load_exercise(name_or_path: str | os.PathLike[str] = DEFAULT_EXERCISE) -> Exercise:
    """Load an exercise.

    Args:
        name_or_path: the name of an installed one; else a folder with exercise.yaml and checks.py;
            or a file *.yaml: an edited copy of the exercise.yaml that it names, which is the one
            of its own folder or an installed one. What an edited copy leaves out of `limits` and
            `tolerances` stays as it is in the original.

    Raises:
        ExerciseError: there is no such exercise, or something in it is wrong; with file and line.
    """
    try:
        return _load(name_or_path)
    except OSError as error:
        of_system = f"{error.strerror}: {error.filename}" if error.strerror else str(error)
        raise ExerciseError(
            "cannot read the exercise {name_or_path}: {why}",
            name_or_path=repr(str(name_or_path)),
            why=of_system or type(error).__name__,
        ) from None


def _load(name_or_path: str | os.PathLike[str]) -> Exercise:
    path = Path(name_or_path)
    if path.suffix in SUFFIXES:
        return _from_file(path)
    is_named = isinstance(name_or_path, str) and places.is_installed(name_or_path)
    if path.is_dir() and not is_named:
        return _from_place(places.in_folder(path))
    return _from_place(places.installed(str(name_or_path)))


def _from_place(place: Place) -> Exercise:
    with _naming(place.folder):
        file = _read(place.description)
        with _placing(file):
            exercise = build(_described(file, place), place)
        return _translated(exercise, place.description)


def _from_file(path: Path) -> Exercise:
    if path.name == DESCRIPTION and places.is_exercise(path.parent):
        return _from_place(places.in_folder(path.parent))
    with _naming(path):
        edited = _read(path)
        with _placing(edited):
            _check_keys(edited.data)
            place, original = _original(edited.data.get("exercise"), path.parent)
            merged = _merged(original, edited.data)
            exercise = build(merged, place)
        replaced = [to for key, to in TRANSLATED.items() if merged.get(key) != original.get(key)]
        exercise = _translated(exercise, place.description, replaced)
        return _translated(exercise, path)


def _translated(exercise: Exercise, description: Path, without: Collection[str] = ()) -> Exercise:
    """Add the translations beside an exercise.yaml, without those of some keys."""
    for language, file in read_translations(description).items():
        with _placing(file):
            exercise = translate(exercise, language, file.data, without)
    return exercise


@contextmanager
def _naming(path: Path) -> Iterator[None]:
    """Name the folder or the file of an exercise in an error of it."""
    try:
        yield
    except (ExerciseError, ValueError) as error:
        raise ExerciseError(
            "{path} is not an exercise: {why}", path=str(path), why=Message.of(error)
        ) from error


@contextmanager
def _placing(file: YamlFile) -> Iterator[None]:
    """Tell a mistake with its file and line."""
    try:
        yield
    except Mistake as mistake:
        raise ExerciseError(file.describe(mistake)) from mistake


def _original(name: object, folder: Path) -> tuple[Place, dict[str, Any]]:
    """Find the exercise that an edited copy in a folder is a copy of."""
    if places.is_exercise(folder):
        beside = places.in_folder(folder)
        file = _read(beside.description)
        with _placing(file):  # which is another than the one that is being read
            described = _described(file, beside)
        if described["exercise"] == name:
            return beside, described
    if not isinstance(name, str) or name not in names():
        raise Mistake(
            ("exercise",),
            "expected one of {names}, found {name}. An edited copy of an exercise"
            " that is not installed must lie in that exercise's own folder",
            names=", ".join(names()),
            name=repr(name),
        )
    place = places.installed(name)
    return place, _described(_read(place.description), place)


def _described(file: YamlFile, place: Place) -> dict[str, Any]:
    """Return the data of an exercise.yaml, which must be complete."""
    data: dict[str, Any] = file.data
    for key in ("exercise", "title", "points"):
        if key not in data:
            raise Mistake((), "it has no {key}", key=repr(key))
    _check_keys(data)
    name = data["exercise"]
    if not isinstance(name, str) or not NAME.fullmatch(name):
        raise Mistake(
            ("exercise",), "expected a name such as my_exercise, found {name}", name=repr(name)
        )
    if place.name and name != place.name:
        raise Mistake(
            ("exercise",),
            "it is installed as {name}, and calls itself {own_name}",
            name=repr(place.name),
            own_name=repr(name),
        )
    if not place.name and name in names():
        raise Mistake(
            ("exercise",),
            "{name} is the name of an installed exercise; give yours another",
            name=repr(name),
        )
    return data


def _check_keys(data: Mapping[Any, Any]) -> None:
    for key in data:
        if key not in KEYS:
            raise Mistake((str(key),), "unknown; {hint}", hint=did_you_mean(key, KEYS))


def _read(path: Path) -> YamlFile:
    file = read_yaml(path)
    if not isinstance(file.data, dict):
        raise ExerciseError(
            "{name}: expected keys such as exercise, limits, points", name=file.name
        )
    return file


def _merged(original: dict[str, Any], edited: dict[str, Any]) -> dict[str, Any]:
    """Merge edited values into the original; tolerances must exist there, with like values."""
    merged = {**original, **edited}
    for part in ("limits", "tolerances", "varied_runs"):
        if isinstance(edited.get(part), dict):
            merged[part] = {**(original.get(part) or {}), **edited[part]}
    known = original.get("tolerances") or {}
    tolerances = decoded(Mapping[Any, Any], edited.get("tolerances", {}), "tolerances")
    check_known(tolerances, known, ("tolerances",))
    for key, value in tolerances.items():
        at, example = ("tolerances", key), repr(known[key])
        fits = _alike(value, known[key])
        expect(fits, at, "expected e.g. {known}, found {found}", value, known=example)
    return merged


def _alike(value: Any, example: object) -> bool:
    if isinstance(example, list):
        return isinstance(value, list) and all(_alike(v, example[0]) for v in value)
    if not is_number(example):
        return type(value) is type(example)
    return is_number(value) and 0 <= value < math.inf
