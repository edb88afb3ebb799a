"""A regrade as one self-contained HTML page, which looks like the others."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from urllib.parse import quote

import jinja2

from grader.batch.entry import SUBMISSIONS
from grader.batch.regrade.changes import Regrade
from grader.batch.regrade.shown import signed, verdicts
from grader.language.telling import in_language, told
from grader.reports.page import templating
from grader.result.result import PAGE
from grader.text import clip, one_line, plain, plain_all

_TEMPLATES = Path(__file__).parent / "templates"
_LONGEST = 600


def render(found: Regrade, to_class: str = "") -> str:
    """The page.

    Args:
        to_class: the way from the page to the folder of the class, for links to reports; '' for no
            links.
    """
    made: str = (
        _environment()
        .get_template("regrade.html")
        .render(
            found=found,
            title=plain(told(found.exercise.title)),
            checks=plain_all(in_language(found.of_checks)),
            link=lambda id: (
                f"{to_class}/{SUBMISSIONS}/{quote(id, safe='')}/{PAGE}" if to_class else ""
            ),
        )
    )
    return made


@cache
def _environment() -> jinja2.Environment:
    made = templating.environment(_TEMPLATES / "regrade.js", _TEMPLATES / "regrade.css")
    made.filters.update(
        signed=signed,
        verdicts=verdicts,
        text=lambda value: clip(one_line(plain(value)), _LONGEST),
    )
    return made
