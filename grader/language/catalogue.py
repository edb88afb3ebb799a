"""The languages that we speak, and the catalogues of their sentences (gettext).

A catalogue may have holes: what it does not know is said in English. `make catalogues` looks for
sentences in the code and compiles what has been translated; docs/languages.md says how.
"""

from __future__ import annotations

import copy
import gettext
import os
import re
from collections.abc import Mapping
from functools import cache
from importlib.resources import as_file, files
from typing import Final

#: Code -> how the language calls itself.
LANGUAGES: Final = {"en": "English", "fr": "français", "zh": "中文"}
ENGLISH: Final = "en"
DOMAIN: Final = "grader"
#: Where POSIX looks for the language of messages, first come, first served.
_VARIABLES = ("LANGUAGE", "LC_ALL", "LC_MESSAGES", "LANG")

_spoken = ENGLISH


def spoken() -> str:
    """The language in which this process tells its user something."""
    return _spoken


def speak(language: str) -> None:
    """Choose it.

    Raises:
        ValueError: we do not know it.
    """
    global _spoken
    if language not in LANGUAGES:
        raise ValueError(f"expected one of {', '.join(LANGUAGES)}, found {language!r}")
    _spoken = language


def of_environment(environment: Mapping[str, str] = os.environ) -> str:
    """What the user's locale asks for; English where that is none of ours."""
    first = next((found for name in _VARIABLES if (found := environment.get(name))), "")
    for wanted in first.split(":"):  # LANGUAGE may name several
        code = re.split("[-_.@]", wanted)[0].lower()
        if code in LANGUAGES:
            return code
    return ENGLISH


@cache
def catalogue(language: str) -> gettext.NullTranslations:
    """The sentences of a language; empty for English and where it was not compiled."""
    if language == ENGLISH:
        return gettext.NullTranslations()
    with as_file(files("grader.language") / "locale") as folder:
        return gettext.translation(DOMAIN, folder, [language], fallback=True)


def knows(language: str, key: str, many: str = "") -> bool:
    """Whether a catalogue has a sentence; one that reads as in English counts, too."""
    found = _with_holes(language)
    return bool(key) and bool(found.ngettext(key, many, 1) if many else found.gettext(key))


class _Holes(gettext.NullTranslations):
    """Answers for what a catalogue does not have."""

    def gettext(self, message: str) -> str:
        return ""

    def ngettext(self, msgid1: str, msgid2: str, n: int) -> str:
        return ""


@cache
def _with_holes(language: str) -> gettext.NullTranslations:
    found = copy.copy(catalogue(language))
    found.add_fallback(_Holes())
    return found
