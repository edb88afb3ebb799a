"""The sentences of a page: in English in its HTML and its scripts, and what catalogues have."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator, Mapping
from html.parser import HTMLParser
from pathlib import Path

LANGUAGES = ("fr", "zh")
#: A sentence in a script; also one within another.
SAID = re.compile(r'\b(?:t|key)\(\s*("(?:[^"\\]|\\.)*")')
ATTRIBUTES = ("aria-label", "placeholder", "title")
#: Whose text is the same in all languages, or is said otherwise.
SAME = ("script", "style", "noscript", "code", "kbd")
EMPTY = ("meta", "link", "input", "br", "img")
#: Two letters in a row that are no unit, and no name.
WORD = re.compile(r"[A-Za-z]{2}")
UNIT = re.compile(r"\[[a-z/]+\]|\$\w+|turtle\d")


def is_sentence(text: str) -> bool:
    """Whether there is something to translate in it."""
    return bool(WORD.search(UNIT.sub("", text)))


class _Reader(HTMLParser):
    """Collects texts as `language.js` finds them."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []
        self._open: list[tuple[str, bool]] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        is_same = tag in SAME or given.get("translate") == "no" or self._is_same
        if not is_same:
            self.found += [given[name] or "" for name in ATTRIBUTES if name in given]
        if tag not in EMPTY:
            self._open.append((tag, is_same))

    def handle_endtag(self, tag: str) -> None:
        opened, _ = self._open.pop()
        assert opened == tag, f"<{opened}> is closed as </{tag}>"

    def handle_data(self, data: str) -> None:
        if not self._is_same:
            self.found.append(data)

    @property
    def _is_same(self) -> bool:
        return bool(self._open) and self._open[-1][1]


def of_html(file: Path) -> set[str]:
    reader = _Reader()
    reader.feed(file.read_text(encoding="utf-8"))
    return {" ".join(text.split()) for text in reader.found if is_sentence(text)}


def of_script(file: Path) -> set[str]:
    return {json.loads(literal) for literal in SAID.findall(file.read_text(encoding="utf-8"))}


def of_page(files: Iterable[Path]) -> set[str]:
    """All sentences of HTML and scripts."""
    found: set[str] = set()
    for file in files:
        found |= of_html(file) if file.suffix == ".html" else of_script(file)
    return found


def catalogue(folder: Path, language: str) -> dict[str, str]:
    return json.loads((folder / f"{language}.json").read_text(encoding="utf-8"))


def badly_filled(sentences: Mapping[str, str]) -> Iterator[str]:
    """Translations in which other values have a place than in the English sentence."""
    for english, said in sentences.items():
        if sorted(re.findall(r"\{\w+\}", english)) != sorted(re.findall(r"\{\w+\}", said)):
            yield said
