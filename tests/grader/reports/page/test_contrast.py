"""What is to be told apart has the contrast of WCAG 2.2: text as in 1.4.3, the rest in 1.4.11."""

import re
from itertools import product
from pathlib import Path

import pytest

from grader.reports.page import html

CSS = (Path(html.__file__).parent / "templates" / "page.css").read_text(encoding="utf-8")
TEXT, OTHER = 4.5, 3.0


def variables(block):
    return dict(re.findall(r"--([\w-]+): (#\w+);", block))


_light, _dark = re.findall(r":root \{\s*(--paper.*?)\}", CSS, re.DOTALL)[:2]
SCHEMES = {"light": variables(_light), "dark": {**variables(_light), **variables(_dark)}}


def luminance(color):
    digits = color[1:] if len(color) == 7 else "".join(2 * digit for digit in color[1:])
    parts = [part / 255 for part in bytes.fromhex(digits)]
    red, green, blue = (p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def contrast(one, other):
    darker, lighter = sorted((luminance(one), luminance(other)))
    return (lighter + 0.05) / (darker + 0.05)


def stroke(selector):
    (color,) = re.findall(rf"^{re.escape(selector)} {{ stroke: (#\w+);", CSS, re.MULTILINE)
    return color


def test_contrast_is_computed_as_wcag_does():
    assert contrast("#000", "#fff") == pytest.approx(21)
    assert contrast("#1f4fc4", "#4556ff") == pytest.approx(1.35, abs=0.02)


def test_a_pin_s_focus_ring_is_seen_on_whatever_is_drawn_below():
    rings = stroke(".pin .ring.dark"), stroke(".pin .ring.light")
    assert contrast(*rings) >= OTHER
    steps = [f"{level:02x}" for level in (0, 0x33, 0x45, 0x56, 0x77, 0x99, 0xB3, 0xCC, 0xFF)]
    for ground in ("#" + "".join(parts) for parts in product(steps, repeat=3)):
        assert max(contrast(ring, ground) for ring in rings) >= OTHER, ground


@pytest.mark.parametrize("scheme", SCHEMES)
def test_every_other_focus_ring_and_the_chosen_path_are_seen_on_the_page(scheme):
    colors = SCHEMES[scheme]
    assert re.search(
        r"a:focus-visible, button:focus-visible.*?outline: 3px solid var\(--link\)", CSS, re.DOTALL
    )
    for ground in ("paper", "card", "open-wash"):
        assert contrast(colors["link"], colors[ground]) >= OTHER, ground
    assert contrast(colors["bad"], colors["paper"]) >= OTHER  # the chosen path of a class


@pytest.mark.parametrize("scheme", SCHEMES)
def test_text_can_be_read(scheme):
    colors = SCHEMES[scheme]
    for text, ground in [
        *product(("ink", "soft", "link"), ("paper", "card")),
        # in every row of a class, and in the chosen one
        *product(("ink", "link", "good", "bad", "open"), ("card", "open-wash")),
        *((name, f"{name}-wash") for name in ("good", "bad", "open")),
    ]:
        assert contrast(colors[text], colors[ground]) >= TEXT, (text, ground)


def test_paper_is_never_dark():
    assert "@media screen and (prefers-color-scheme: dark)" in CSS
    assert "@media (prefers-color-scheme: dark)" not in CSS
