"""`--lang`, on every verb: the language in which people are told something."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from itertools import zip_longest

from grader.language.catalogue import LANGUAGES, of_environment, speak
from grader.language.phrase import say, say_many
from grader.language.telling import tell, tell_many, told

OPTION = "--lang"
#: What argparse says by itself, of Python 3.11 to 3.13; here so that it comes into the catalogues.
ARGPARSE = (
    say("usage: "),
    say("positional arguments"),
    say("options"),
    say("show this help message and exit"),
    say("show program's version number and exit"),
    say("the following arguments are required: %s"),
    say("argument %(argument_name)s: %(message)s"),
    say("invalid choice: %(value)r (choose from %(choices)s)"),
    say("invalid %(type)s value: %(value)r"),
    say("unrecognized arguments: %s"),
    say("ambiguous option: %(option)s could match %(matches)s"),
    say("not allowed with argument %s"),
    say("expected one argument"),
    say("expected at least one argument"),
    say("expected at most one argument"),
    say("ignored explicit argument %r"),
    say_many("expected %s argument", "expected %s arguments", 1),
)


def choose(words: Sequence[str]) -> None:
    """Speak what a call asks for; else what the user's locale does.

    It is looked for before the call is parsed: what is wrong with the call is said in it as well.
    """
    _argparse_too()
    for word, after in zip_longest(words, words[1:], fillvalue=""):
        name, _, value = word.partition("=")
        language = value or after
        is_meant = len(name) > 3 and OPTION.startswith(name)  # argparse takes '--la', too
        if is_meant and language in LANGUAGES:
            return speak(language)
    return speak(of_environment())


def _argparse_too() -> None:
    """Its own words in our language: it looks them up by these two of gettext's names."""
    vars(argparse).update(_=told, ngettext=tell_many)


def add_argument(parser: argparse.ArgumentParser) -> None:
    """Declare the option."""
    parser.add_argument(
        OPTION,
        choices=tuple(LANGUAGES),
        help=tell(
            "the language of what people read (that of your locale: LANG); result files are the "
            "same in all"
        ),
    )
