"""Templates of self-contained pages: all values are escaped, and only the page's script runs.

Compiled templates are cached as Python caches compiled modules: in __pycache__.
"""

from __future__ import annotations

import base64
import hashlib
import os
import sys
from contextlib import suppress
from importlib.metadata import version
from importlib.util import cache_from_source
from pathlib import Path

import jinja2
from jinja2.bccache import Bucket, FileSystemBytecodeCache
from markupsafe import Markup

from grader.system import versions as system
from grader.text import strings as text
from grader.text.translations import current, number, tr, translate

#: The style of all pages.
STYLE = Path(__file__).parent / "templates" / "page.css"


def environment(folder: Path, page: str) -> jinja2.Environment:
    """Return the environment that renders the templates in a folder.

    They get `script`, which is PAGE.js if there is one, `script_digest` for a content security
    policy that lets nothing else run, and `style`: that of all pages, and PAGE.css.
    """
    made = jinja2.Environment(
        loader=jinja2.FileSystemLoader(folder),
        bytecode_cache=BesideTheTemplates(folder),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    script = folder / f"{page}.js"
    code = script.read_text(encoding="utf-8") if script.exists() else ""
    styles = dict.fromkeys((STYLE, folder / f"{page}.css"))
    made.filters.update(points=text.points, clip=text.clip, t=translate)
    made.globals.update(
        tr=tr,
        t=translate,
        number=number,
        language=current,
        style=Markup("".join(path.read_text(encoding="utf-8") for path in styles)),
        script=Markup(code),
        script_digest=base64.b64encode(hashlib.sha256(code.encode()).digest()).decode(),
    )
    return made


class BesideTheTemplates(FileSystemBytecodeCache):
    """Caches compiled templates beside them; where it cannot write, they are compiled each time.

    jinja2 checks source and Python's version of a cached template. The name of its file has the
    versions of jinja2 and of the grader, since both change how templates are compiled.

    Args:
        folder: the templates'.
    """

    def __init__(self, folder: Path) -> None:
        made_by = f"{version('jinja2')}-{system.grader_version()}"
        cache = cache_from_source(str(folder / f"template_%s_{made_by}.py"))
        super().__init__(*os.path.split(cache))

    def load_bytecode(self, bucket: Bucket) -> None:
        with suppress(Exception):  # a damaged file raises anything
            super().load_bytecode(bucket)

    def dump_bytecode(self, bucket: Bucket) -> None:
        if not sys.dont_write_bytecode:
            with suppress(OSError):
                Path(self.directory).mkdir(exist_ok=True)
                super().dump_bytecode(bucket)
