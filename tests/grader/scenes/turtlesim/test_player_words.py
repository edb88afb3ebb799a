"""The pages that play runs have their sentences' translations in them."""

import json

import pytest

from grader.scenes import playback
from grader.scenes.cast import timeline
from grader.text.translations import ENGLISH, catalogue

#: Of each page its name, its first module, and the folders of its modules before those of others.
PAGES = [
    ("player.html", "player", [playback.PLAYER]),
    ("replay.html", "replay", [timeline.PAGE, timeline.PAGE / "live", playback.PLAYER]),
]


def sentences(html, entry, folders, language):
    text = playback.whole_html(folders[0] / html)
    modules = playback.join_modules(entry, [*folders, playback.LIVE_PAGE])
    return playback._sentences(f"{modules} {text}", language)


@pytest.mark.parametrize(("html", "entry", "folders"), PAGES)
def test_a_page_has_the_translations_of_its_own_sentences_and_the_live_pages(html, entry, folders):
    shared = json.loads((playback.LIVE_PAGE / "fr.json").read_text(encoding="utf-8"))
    there = sentences(html, entry, folders, "fr")
    assert shared.items() <= there.items()
    assert there["Pause"] == catalogue("fr")["Pause"]
    assert len(there) < len(shared) + 100  # of thousands
    assert sentences(html, entry, folders, ENGLISH) == {}
