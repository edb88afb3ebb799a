"""A real browser for tests of pages: Debian's Chromium, driven by Playwright."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from tests.needs import BROWSERS, needs

BROWSER = next(filter(None, map(shutil.which, BROWSERS)), "")
needs_browser = needs("chromium")
#: WCAG 2.2, levels A and AA: more than the law asks for.
RULES = {
    "runOnly": ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"],
    "rules": {
        name: {"enabled": True} for name in ("css-orientation-lock", "label-content-name-mismatch")
    },
    "resultTypes": ["violations"],  # half the work: nobody reads what has passed
}
#: Screens [px]: small and smaller phones, one of 1280 at 200 %, one of 1280.
WIDTHS = (320, 375, 640, 1280)


@contextmanager
def open_browser() -> Iterator[Any]:
    """A browser without a window; pages of it are opened with `new_page`, and may throw nothing."""
    from playwright.sync_api import sync_playwright

    thrown: list[str] = []

    def new_page(**options: Any) -> Any:
        page = opened(**options)
        page.on("pageerror", lambda error: thrown.append(str(error)))
        return page

    with sync_playwright() as playwright:
        arguments = ["--no-sandbox", "--disable-gpu"]
        browser = playwright.chromium.launch(executable_path=BROWSER, args=arguments)
        opened, browser.new_page = browser.new_page, new_page
        yield browser
        browser.close()
    assert thrown == []


def obstacles(page: Any) -> list[str]:
    """What axe-core finds on a page that keeps somebody from using it: rule, and where."""
    from axe_playwright_python.sync_playwright import Axe

    if not page.evaluate("'axe' in window"):  # half a megabyte
        page.evaluate(Axe().axe_script)
    found = page.evaluate("(rules) => axe.run(rules).then(({ violations }) => violations)", RULES)
    return [f"{each['id']}: {node['html'][:120]}" for each in found for node in each["nodes"]]


_CUT_OFF = """
() => {
  const wide = document.documentElement.clientWidth;
  const scrolls = (element) => element && (
    /auto|scroll/.test(getComputedStyle(element).overflowX) || scrolls(element.parentElement)
  );
  const told = ({ tagName, id, textContent }) => [tagName, id, textContent.trim()].join(" ");
  return [...document.body.querySelectorAll("*")].filter((element) => {
    const { left, right, width } = element.getBoundingClientRect();
    return width && (left < -1 || right > wide + 1) && !scrolls(element.parentElement);
  }).map(told);
}
"""


def cut_off(page: Any) -> list[str]:
    """What lies beyond the edges of the screen and in no part that scrolls."""
    return page.evaluate(_CUT_OFF)


_CLIPPED = """
() => {
  // a phone's tables may scroll
  const tables = innerWidth < 900 ? "" : ", .table, .scroll, th, td";
  const parts = "main section, .card, .check, .column, figure, li, p" + tables;
  const told = ({ tagName, id, textContent }) => [tagName, id, textContent.trim()].join(" ");
  const isCut = (part) => (
    part.clientWidth && part.scrollWidth > part.clientWidth + 1 && !part.closest(".hidden")
  );
  const isLow = (part) => part.scrollHeight > part.clientHeight + 1;
  return [
    ...[...document.querySelectorAll(parts)].filter(isCut),
    ...[...document.querySelectorAll("section.pictures:not(:has(.solid + figure))")].filter(isLow),
  ].map(told);
}
"""


def clipped(page: Any) -> dict[int, list[str]]:
    """Which cards, columns and tables hold more than they show, on a phone and on desks."""
    found = {}
    for width in (390, 900, 1280):
        page.set_viewport_size({"width": width, "height": 700})
        if parts := page.evaluate(_CLIPPED):
            found[width] = parts
    return found


def moving(page: Any) -> int:
    """How many parts move by style sheet."""
    return page.evaluate("document.getAnimations().length")
