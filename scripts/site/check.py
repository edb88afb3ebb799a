"""Checks the built site: every link and anchor leads somewhere, nothing is loaded from elsewhere.

No address is fetched. Each page of the repository has to have as many lists, tables and blocks of
code as on GitHub, which reads Markdown a little differently.
"""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

from markdown_it import MarkdownIt
from markdown_it.token import Token

#: Element -> the attribute that names what a browser loads by itself.
LOADED = {"script": "src", "img": "src", "iframe": "src", "source": "src", "link": "href"}
#: What is counted, and in the page of GitHub as well.
COUNTED = {
    **{"ul": "lists", "ol": "numbered lists", "li": "list items"},
    **{"table": "tables", "pre": "blocks of code", "h2": "headings"},
}


@dataclass
class Page(HTMLParser):
    """What of a page others lead to, and where it leads.

    Attributes:
        names: what an anchor can name; '' is the page itself.
        links: where it leads, and what a browser loads.
        loaded: of these what a browser loads.
        counts: how often each of `COUNTED` is in its article.
    """

    text: str
    names: set[str] = field(default_factory=lambda: {""})
    links: list[str] = field(default_factory=list)
    loaded: list[str] = field(default_factory=list)
    counts: Counter[str] = field(default_factory=Counter)
    _depth: int = 0

    def __post_init__(self) -> None:
        """Read the text."""
        super().__init__()
        self.feed(self.text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note what an element names and where it leads."""
        given = {name: value or "" for name, value in attrs}
        self.names.update(given[key] for key in ("id", "name") if key in given)
        if tag == "article" or self._depth:
            self._depth += tag == "article"
            self.counts[tag] += tag in COUNTED
        if tag in ("a", "area") and "href" in given:
            self.links.append(given["href"])
        if (key := LOADED.get(tag)) in given and given.get("rel") != "canonical":
            self.links.append(given[key])
            self.loaded.append(given[key])

    def handle_endtag(self, tag: str) -> None:
        """Note the end of the article."""
        self._depth -= tag == "article"


def problems(pages: Path, html: Path, address: str = "/") -> list[str]:
    """Return what is wrong with the site.

    Args:
        pages: the Markdown that it was made of.
        address: where it will be published: the page for what is not there names that folder.
    """
    top = urlsplit(address).path.rstrip("/") + "/"
    found = {path: Page(path.read_text(encoding="utf-8")) for path in sorted(html.rglob("*.html"))}
    told: list[str] = []
    for path, page in found.items():
        links = ((link, _whole(link, path, html, top)) for link in dict.fromkeys(page.links))
        told += (f"{path.relative_to(html)}: {what}" for what in _of_links(page, links, found))
    for source in sorted(pages.rglob("*.md")):
        name = source.relative_to(pages).with_suffix(".html")
        if html / name not in found:
            told.append(f"{source.relative_to(pages)} became no page")
        elif name.parts[0] != "api":  # made by mkdocstrings
            told += (f"{name}: {what}" for what in _unlike_github(source, found[html / name]))
    return told


def _whole(link: str, path: Path, html: Path, top: str) -> Path | None:
    """Return the file that a link of a page leads to; None for one that leads elsewhere."""
    parts = urlsplit(link)
    if parts.scheme or parts.netloc:
        return None
    named = unquote(parts.path)
    folder, named = (html, named[len(top) :]) if named.startswith(top) else (path.parent, named)
    target = Path(os.path.normpath(folder / named)) if parts.path else path
    return target / "index.html" if target.is_dir() else target


def _of_links(
    page: Page, links: Iterable[tuple[str, Path | None]], found: Mapping[Path, Page]
) -> Iterator[str]:
    for link, target in links:
        if target is None:
            if link in page.loaded and not link.startswith("data:"):
                yield f"loads {link} from elsewhere"
        elif not target.is_file():
            yield f"{link} is not there"
        elif target in found and unquote(urlsplit(link).fragment) not in found[target].names:
            yield f"{link}: the page has no such heading"


def _unlike_github(source: Path, page: Page) -> Iterator[str]:
    """Yield of what a page has more or less than GitHub's, where it is one of the repository."""
    text = source.read_text(encoding="utf-8")
    if text.startswith("---\n"):
        text = text.split("\n---\n", 1)[1]
    there = Counter(token.tag for token in _tokens(text))
    for tag, what in COUNTED.items():
        if there[tag] != page.counts[tag]:
            yield (
                f"{there[tag]} {what} on GitHub, {page.counts[tag]} here: write it so that both "
                "read it alike (pages.for_python_markdown knows of lists)"
            )


def _tokens(text: str) -> Iterator[Token]:
    for token in MarkdownIt("gfm-like", {"linkify": False}).parse(text):
        if token.type in ("fence", "code_block"):
            token.tag = "pre"
        if token.nesting >= 0:
            yield token
