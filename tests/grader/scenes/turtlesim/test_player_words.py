"""The sentences of the page that plays runs: the live page's, and its own."""

from __future__ import annotations

import pytest

from grader.scenes.turtlesim.player import page
from tests import page_words

FOLDER = page._PAGE
FILES = sorted(file for file in FOLDER.iterdir() if file.suffix in (".html", ".js"))


@pytest.mark.parametrize("language", page_words.LANGUAGES)
def test_every_sentence_has_a_translation_and_every_translation_a_sentence(language):
    own = page_words.catalogue(FOLDER, language)
    shared = page_words.catalogue(page._LIVE_PAGE, language)
    assert set(own) == page_words.of_page(FILES) - set(shared)
    assert all(own.values())


@pytest.mark.parametrize("language", page_words.LANGUAGES)
def test_a_translation_has_the_values_of_its_sentence(language):
    assert list(page_words.badly_filled(page_words.catalogue(FOLDER, language))) == []
