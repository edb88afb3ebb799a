"""The key `languages` of exercise.yaml: title, task, checks and tolerances in other languages.

    languages:
      fr:
        title: Dans le coin
        checks:
          moves: Le nœud conduit la tortue
          arrives: {title: Elle s'arrête dans un coin, rubric: Dans chaque essai ...}
        tolerances:
          corner_m: distance du coin

A text alone is the title of a check.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Any

from grader.exercise.check import Checks
from grader.translations import ENGLISH, LANGUAGES
from grader.yaml_file import Mistake, check_known, expect

PART = "languages"
#: All but the language of the file itself.
OTHERS = tuple(language for language in LANGUAGES if language != ENGLISH)
KEYS = ("title", "task", "checks", "tolerances")
OF_A_CHECK = ("title", "rubric")
ByLanguage = dict[str, str]


@dataclass(frozen=True)
class Translated:
    """Each text by its language; one that is left out is shown in the language of the file.

    Attributes:
        title, task: of the exercise.
        titles, rubrics: of its checks, by their names.
        tolerances: what stands beside them in the sheet, by their names.
    """

    title: ByLanguage = field(default_factory=dict)
    task: ByLanguage = field(default_factory=dict)
    titles: dict[str, ByLanguage] = field(default_factory=dict)
    rubrics: dict[str, ByLanguage] = field(default_factory=dict)
    tolerances: dict[str, ByLanguage] = field(default_factory=dict)


def translated(given: object, checks: Checks, tolerances: Collection[str]) -> Translated:
    """Parse the key of the file.

    Raises:
        Mistake: a language, a key, a check or a tolerance is unknown, or a value is no text.
    """
    found = Translated()
    names = [check.name for check in checks]
    for language, words in _named(given, (PART,), OTHERS).items():
        at = (PART, language)
        for key, value in _named(words, at, KEYS).items():
            here = (*at, key)
            if key == "title":
                found.title[language] = _text(value, here)
            elif key == "task":
                found.task[language] = _text(value, here)
            elif key == "checks":
                _checks(value, here, names, found)
            else:
                for name, text in _named(value, here, tolerances).items():
                    by_language = found.tolerances.setdefault(name, {})
                    by_language[language] = _text(text, (*here, name))
    return found


def without(given: object, keys: Collection[str]) -> Any:
    """Remove the texts that an edited copy replaces, in the language of the file alone."""
    if not isinstance(given, dict) or not all(isinstance(words, dict) for words in given.values()):
        return given  # `translated` refuses it
    return {
        language: {key: text for key, text in words.items() if key not in keys}
        for language, words in given.items()
    }


def _checks(given: object, at: tuple[str, ...], names: Collection[str], found: Translated) -> None:
    language = at[1]
    for name, value in _named(given, at, names).items():
        here = (*at, name)
        texts = value if isinstance(value, dict) else {"title": value}
        for key, text in _named(texts, here, OF_A_CHECK).items():
            each = found.titles if key == "title" else found.rubrics
            each.setdefault(name, {})[language] = _text(
                text, (*here, key) if isinstance(value, dict) else here
            )


def _named(given: object, at: tuple[str, ...], known: Collection[str]) -> Mapping[str, Any]:
    """Return the mapping at some keys, each name of which has to be known."""
    if given is None:
        return {}
    if not isinstance(given, dict):
        raise Mistake(
            at,
            "expected some of {names}, each with its text; found {found}",
            names=", ".join(known),
            found=repr(given),
        )
    check_known(given, known, at)
    return given


def _text(given: Any, at: tuple[str, ...]) -> str:
    is_text = isinstance(given, str) and given.strip()
    expect(is_text, at, "expected a text, found {found}", given)
    return str(given)
