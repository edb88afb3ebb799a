"""similar.html: one self-contained page, without any script, in the looks of a report's page."""

from __future__ import annotations

from functools import cache
from importlib.resources import files
from pathlib import Path

import jinja2
from markupsafe import Markup

from grader.batch.similar import compare, export
from grader.batch.similar.shown import Class, person, shown
from grader.language.catalogue import spoken
from grader.language.telling import tell, tell_many, told
from grader.reports.page.compiled import BesideTheTemplates

_TEMPLATES = Path(__file__).parent / "templates"


def render(found: Class, exercise: str) -> str:
    """The page.

    Args:
        exercise: its title.
    """
    look = found.look
    return (
        _environment()
        .get_template("similar.html")
        .render(
            exercise=told(exercise),
            look=look,
            size=len(found.entries),
            pairs=list(shown(found)),
            groups=[[person(found, number) for number in members] for members in look.groups],
            only_given=[person(found, number) for number in found.only_given],
            export=f"{export.FOLDER}/",
        )
    )


@cache
def _environment() -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(_TEMPLATES),
        bytecode_cache=BesideTheTemplates(_TEMPLATES),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    of_reports = files("grader.reports.page") / "templates" / "page.css"
    style = of_reports.read_text(encoding="utf-8")
    style += (_TEMPLATES / "similar.css").read_text(encoding="utf-8")
    environment.globals.update(
        spoken=spoken,
        tell=tell,
        tell_many=tell_many,
        style=Markup(style),
        large_class=compare.LARGE_CLASS,
        one_in=compare.ONE_IN,
    )
    return environment
