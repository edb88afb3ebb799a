"""Templates of pages that stand alone: everything is escaped, and only their own script runs."""

from __future__ import annotations

import base64
import hashlib
from pathlib import Path

import jinja2
from markupsafe import Markup

from grader import text
from grader.language.catalogue import spoken
from grader.language.telling import in_language, number, tell, tell_many, told
from grader.reports.page.compiled import BesideTheTemplates

#: How all pages look.
STYLE = Path(__file__).parent / "templates" / "page.css"


def environment(script: Path, *styles: Path) -> jinja2.Environment:
    """What renders the templates in the folder of a script.

    They get `script` and `script_digest`, for a content security policy that lets nothing else run,
    and `style`: that of all pages, and what a page adds to it.
    """
    made = jinja2.Environment(
        loader=jinja2.FileSystemLoader(script.parent),
        bytecode_cache=BesideTheTemplates(script.parent),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    code = script.read_text(encoding="utf-8")
    made.filters.update(points=text.points, clip=text.clip)
    made.globals.update(
        tell=tell,
        tell_many=tell_many,
        told=told,
        said=in_language,
        number=number,
        spoken=spoken,
        style=Markup("".join(path.read_text(encoding="utf-8") for path in (STYLE, *styles))),
        script=Markup(code),
        script_digest=base64.b64encode(hashlib.sha256(code.encode()).digest()).decode(),
    )
    return made
