"""Translations of an exercise: `exercise.fr.yaml` beside its exercise.yaml.

    title: Dans le coin
    checks:
      moves: Le nœud conduit la tortue
      arrives: {title: Elle s'arrête dans un coin, rubric: Dans chaque essai ...}
    tolerances:
      corner_m: distance du coin

A text alone is the title of a check. What a translation leaves out is shown in the language of
exercise.yaml. It judges nothing, and is no part of the exercise's hash.
"""

from __future__ import annotations

import glob
from collections.abc import Collection, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from grader.errors import ExerciseError
from grader.exercise.exercise import Exercise
from grader.system.yaml_file import Keys, YamlFile, check_known, decoded, expect, read_yaml
from grader.text.translations import ENGLISH, LANGUAGES

OF_ALL = ("title", "task")
KEYS = (*OF_ALL, "checks", "tolerances")
OF_A_CHECK = ("title", "rubric")


def read_translations(description: Path) -> dict[str, YamlFile]:
    """Read the translations beside an exercise.yaml, or beside an edited copy: language -> file."""
    languages = [code for code in LANGUAGES if code != ENGLISH]
    files = {}
    name = f"{glob.escape(description.stem)}.[a-z][a-z]{description.suffix}"
    for path in sorted(description.parent.glob(name)):
        language = path.stem[-2:]
        if language not in languages:
            raise ExerciseError(
                "{name}: expected one of {languages} as its language, found {language}",
                name=path.name,
                languages=", ".join(languages),
                language=language,
            )
        files[language] = read_yaml(path)
    return files


def translate(
    exercise: Exercise, language: str, texts: object, without: Collection[str] = ()
) -> Exercise:
    """Return the exercise with its texts in a language, too.

    Args:
        texts: the content of the translation.
        without: keys in it that are not used.

    Raises:
        Mistake: a key, a check or a tolerance is unknown, or a value is no text.
    """
    given = {key: value for key, value in _named(texts, (), KEYS).items() if key not in without}
    names = [check.name for check in exercise.checks]
    of_checks = {
        name: _of_check(value, ("checks", name))
        for name, value in _named(given.get("checks"), ("checks",), names).items()
    }
    tolerances = _texts(given.get("tolerances"), ("tolerances",), exercise.tolerances)
    whole = _texts({key: given[key] for key in OF_ALL if key in given}, (), OF_ALL)
    earlier = exercise.explained.get(language, {})
    return replace(
        exercise,
        title=exercise.title.translated(language, whole.get("title")),
        task=exercise.task.translated(language, whole.get("task")),
        checks=exercise.checks.translated(language, of_checks),
        explained={**exercise.explained, language: {**earlier, **tolerances}},
    )


def _of_check(given: object, at: Keys) -> dict[str, str]:
    return _texts(given, at, OF_A_CHECK) if isinstance(given, dict) else {"title": _text(given, at)}


def _named(given: object, at: Keys, known: Collection[str]) -> Mapping[str, Any]:
    """Return the mapping at some keys, each name of which has to be known."""
    texts: dict[str, Any] = decoded(Mapping[str, Any], {} if given is None else given, *at)
    check_known(texts, known, at)
    return texts


def _texts(given: object, at: Keys, known: Collection[str]) -> dict[str, str]:
    return {name: _text(value, (*at, name)) for name, value in _named(given, at, known).items()}


def _text(given: object, at: Keys) -> str:
    text: str = decoded(str, given, *at)
    expect(text.strip(), at, "expected a text, found {found}", given)
    return text
