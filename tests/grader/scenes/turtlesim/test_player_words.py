"""The sentences of the page that plays runs: the live page's, and the grader's."""

from __future__ import annotations

import json

import pytest

from grader.scenes.turtlesim.player import page
from grader.translations import ENGLISH, catalogue
from tests.catalogues import script


def said() -> tuple[set[str], set[str]]:
    """What the player says; what the live page and its server say."""
    shared = {each if isinstance(each, str) else each[0] for each in script().of_simulator()}
    return set(script().of_page(page._PAGE)), shared


@pytest.mark.parametrize("language", script().LANGUAGES)
def test_every_sentence_has_a_translation_in_the_page(language):
    own, shared = said()
    there = page._sentences(language)
    assert own | shared <= set(there)
    assert all(there.values())
    assert len(set(there) - own - shared) < 50  # words of other sentences


@pytest.mark.parametrize("language", script().LANGUAGES)
def test_what_both_pages_say_is_translated_once(language):
    own, shared = said()
    live = json.loads((page._LIVE_PAGE / f"{language}.json").read_text(encoding="utf-8"))
    assert len(own - shared) > 20
    assert own - shared <= set(catalogue(language))
    assert {key: page._sentences(language)[key] for key in shared} == live


def test_in_english_there_is_nothing_to_translate():
    assert page._sentences(ENGLISH) == {}
