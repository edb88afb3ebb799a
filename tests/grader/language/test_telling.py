"""A phrase is said in a language: order, numbers and plurals are that language's."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import pytest

from grader.language import catalogue as catalogues
from grader.language import telling
from grader.language.catalogue import of_environment, speak
from grader.language.phrase import Phrase, joined, say, say_many
from grader.language.telling import in_language, number, tell, tell_many, told

SENTENCES = {
    "It made {turns:.1f} turns of {asked:g}.": "Sur {asked:g}, {turns:.1f} tours.",
    "{n:,} pixel": ("{n:,} pixel", "{n:,} pixels"),
    "red": "rouge",
    "{color}, at {at}": "{color} ({at})",
    "{seconds:.1f} s": "{seconds:.1f} s",
    "broken {name}": "cassé {nome}",
}


class Words:
    """A small catalogue, with holes."""

    def gettext(self, key):
        found = SENTENCES.get(key, key)
        return found if isinstance(found, str) else found[0]

    def ngettext(self, key, many, n):
        return SENTENCES[key][n > 1] if key in SENTENCES else key if n == 1 else many


@pytest.fixture(autouse=True)
def small(monkeypatch):
    monkeypatch.setattr(telling, "catalogue", lambda language: Words())
    monkeypatch.setattr(telling, "knows", lambda language, key, many="": key in SENTENCES)


def test_values_come_where_the_language_wants_them():
    said = say("It made {turns:.1f} turns of {asked:g}.", turns=2.53, asked=3.5)
    assert told(said, "fr") == "Sur 3,5, 2,5 tours."
    assert told(said, "en") == "It made 2.5 turns of 3.5."


def test_a_phrase_in_a_phrase_is_said_too():
    said = say("{color}, at {at}", color=say("red"), at=say("{seconds:.1f} s", seconds=1.25))
    assert told(said, "fr") == "rouge (1,2 s)"


def test_a_row_is_said_part_by_part():
    assert told(joined([say("red"), "-", "x"]), "fr") == "rouge-x"


@pytest.mark.parametrize(
    ("n", "said"),
    [
        (0, "0 pixel"),
        (1, "1 pixel"),
        (2, "2 pixels"),
        (4210, "4\N{NARROW NO-BREAK SPACE}210 pixels"),
    ],
)
def test_plurals_are_those_of_the_language(n, said):
    assert told(say_many("{n:,} pixel", "{n:,} pixels", n), "fr") == said


def test_a_hole_is_english_with_english_numbers():
    assert told(say("No such {x:.1f} sentence.", x=1.5), "fr") == "No such 1.5 sentence."


def test_a_translation_that_is_like_the_english_has_numbers_of_its_language():
    assert told(say("{seconds:.1f} s", seconds=2.5), "fr") == "2,5 s"


def test_a_translation_with_other_values_is_not_used():
    assert told(say("broken {name}", name="x"), "fr") == "broken x"


@pytest.mark.parametrize(
    "phrase",
    [
        Phrase("English", "It made {turns:.1f} turns of {asked:g}.", {}),
        Phrase(
            "English", "It made {turns:.1f} turns of {asked:g}.", {"turns": 10**400, "asked": 1}
        ),
        Phrase("English", "{n:,} pixel", {"n": "many"}, "{n:,} pixels"),
        Phrase("English", "{n:,} pixel", {"n": float("inf")}, "{n:,} pixels"),
        Phrase("English", "{n:,} pixel", {}, "{n:,} pixels"),
    ],
)
def test_what_a_stranger_wrote_is_english_and_no_error(phrase):
    assert told(phrase, "fr") == "English"


class Pair(NamedTuple):
    one: str
    other: str


@dataclass(frozen=True)
class Thing:
    name: str
    said: tuple[str, ...]
    pair: Pair


def test_of_a_whole_only_phrases_are_said_and_names_stay():
    thing = Thing("red", (say("red"), "red"), Pair(say("red"), "red"))
    said = in_language({"red": [thing]}, "fr")
    assert said == {"red": [Thing("red", ("rouge", "red"), Pair("rouge", "red"))]}
    assert in_language(thing, "en") is thing


@pytest.mark.parametrize(
    ("text", "said"),
    [("4,210.5", "4\N{NARROW NO-BREAK SPACE}210,5"), ("0.5", "0,5"), ("-12", "-12"), ("1.", "1.")],
)
def test_numbers(text, said):
    assert (number(text, "fr"), number(text, "zh"), number(text, "en")) == (said, text, text)


def test_what_is_told_is_in_the_language_that_this_process_speaks():
    assert tell("red") == "red"
    speak("fr")
    assert (tell("red"), tell_many("{n:,} pixel", "{n:,} pixels", 2)) == ("rouge", "2 pixels")


def test_a_language_that_is_none_of_ours_is_refused():
    with pytest.raises(ValueError, match="expected one of en, fr, zh, found 'xx'"):
        speak("xx")


@pytest.mark.parametrize(
    ("environment", "language"),
    [
        ({}, "en"),
        ({"LANG": "fr_CA.UTF-8"}, "fr"),
        ({"LANG": "zh_CN.GB18030"}, "zh"),
        ({"LANG": "C.UTF-8"}, "en"),
        ({"LANG": "POSIX"}, "en"),
        ({"LANG": "de_DE.UTF-8"}, "en"),
        ({"LANGUAGE": "xx:zh_CN", "LANG": "fr_FR.UTF-8"}, "zh"),
        ({"LANGUAGE": "", "LANG": "fr"}, "fr"),
        ({"LC_ALL": "C", "LANG": "fr_FR.UTF-8"}, "en"),
        ({"LC_MESSAGES": "zh-Hans", "LANG": "fr_FR.UTF-8"}, "zh"),
        ({"LANG": "FR@euro"}, "fr"),
    ],
)
def test_the_locale_of_a_user_chooses(environment, language):
    assert of_environment(environment) == language


def test_a_catalogue_that_was_not_compiled_says_english(monkeypatch, tmp_path):
    monkeypatch.setattr(catalogues, "files", lambda package: tmp_path)
    catalogues.catalogue.cache_clear()
    catalogues._with_holes.cache_clear()
    try:
        assert catalogues.catalogue("fr").gettext("red") == "red"
        assert not catalogues.knows("fr", "red")
    finally:
        catalogues.catalogue.cache_clear()
        catalogues._with_holes.cache_clear()
