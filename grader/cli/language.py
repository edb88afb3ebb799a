"""`--lang`, on every verb: the language in which people are told something."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from grader.language.catalogue import LANGUAGES, of_environment, speak

OPTION = "--lang"


def choose(words: Sequence[str]) -> None:
    """Speak what a call asks for; else what the user's locale does.

    It is looked for before the call is parsed: what is wrong with the call is said in it as well.
    """
    for word, after in zip(words, [*words[1:], ""], strict=True):
        name, _, value = word.partition("=")
        language = value or after
        if name == OPTION and language in LANGUAGES:
            return speak(language)
    return speak(of_environment())


def add_argument(parser: argparse.ArgumentParser) -> None:
    """Declare the option."""
    parser.add_argument(
        OPTION,
        choices=tuple(LANGUAGES),
        help="the language of what people read (that of your locale: LANG); result files are the "
        "same in all",
    )
