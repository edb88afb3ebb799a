"""The sentences of the pages that play runs: the live page's, and the grader's."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

import pytest

from grader.cast import replay
from grader.scenes import joined
from grader.translations import ENGLISH, catalogue
from tests.catalogues import script

#: Of each page its name, its first module, and the folders of its modules before those of others.
PAGES = [
    ("player.html", "player", [joined.PLAYER]),
    ("replay.html", "replay", [replay.PAGE, replay.PAGE / "live", joined.PLAYER]),
]
pages = pytest.mark.parametrize(("html", "entry", "folders"), PAGES)


@cache
def of_live() -> set[str]:
    """What the live page and its server say."""
    return {each if isinstance(each, str) else each[0] for each in script().of_simulator()}


def own(folder: Path) -> set[str]:
    return set(script().of_page(folder)) - of_live()


def sentences(html: str, entry: str, folders: list[Path], language: str) -> dict[str, str]:
    """The sentences of a page that have a translation there."""
    text = (folders[0] / html).read_text(encoding="utf-8")
    modules = joined.join_modules(entry, [*folders, joined.LIVE_PAGE])
    return joined._sentences(f"{modules} {text}", language)


@pages
@pytest.mark.parametrize("language", script().LANGUAGES)
def test_every_sentence_has_a_translation_in_the_page(html, entry, folders, language):
    there = sentences(html, entry, folders, language)
    assert own(folders[0]) | of_live() <= set(there)
    assert all(there.values())
    # words of other sentences, and of modules that are shared
    assert len(set(there) - own(folders[0]) - of_live()) < 50


@pages
@pytest.mark.parametrize("language", script().LANGUAGES)
def test_what_both_pages_say_is_translated_once(html, entry, folders, language):
    live = json.loads((joined.LIVE_PAGE / f"{language}.json").read_text(encoding="utf-8"))
    assert len(own(folders[0])) > 10
    assert own(folders[0]) <= set(catalogue(language))
    there = sentences(html, entry, folders, language)
    assert {key: there[key] for key in of_live()} == live


@pages
def test_in_english_there_is_nothing_to_translate(html, entry, folders):
    assert sentences(html, entry, folders, ENGLISH) == {}
