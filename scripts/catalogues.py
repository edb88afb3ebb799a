#!/usr/bin/env python3
"""Look for sentences in the code, bring the catalogues of all languages up to date, compile them.

    make catalogues          after a sentence was written or translated
    scripts/catalogues.py holes   what has no translation yet

Translators edit `grader/language/locale/*/LC_MESSAGES/grader.po`, with any editor for gettext.
"""

from __future__ import annotations

import ast
import io
import sys
from collections.abc import Iterator
from datetime import UTC, datetime
from functools import cache
from pathlib import Path

from babel.messages.catalog import Catalog, Message
from babel.messages.extract import extract
from babel.messages.mofile import write_mo
from babel.messages.pofile import read_po, write_po

_ANY_DAY = datetime(2026, 1, 1, tzinfo=UTC)
ROOT = Path(__file__).resolve().parents[1]
LOCALE = ROOT / "grader" / "language" / "locale"
LANGUAGES = {"fr": "French", "zh": "Chinese"}
#: What marks a sentence; of a pair the second is for more than one.
KEYWORDS = {
    **{"say": None, "tell": None, "marked": None},
    **{"say_many": (1, 2), "tell_many": (1, 2)},
}
#: Below grader/: file name ending -> babel's name of who reads it; Python we read ourselves.
READERS = {".html": "jinja2.ext:babel_extract", ".js": "javascript"}
#: Of a file's head: dates, which would make each run another file, and who nobody is.
CHANGING = tuple(
    f'"{name}'
    for name in (
        *("POT-Creation-Date", "PO-Revision-Date", "Generated-By", "Last-Translator"),
        *("Report-Msgid-Bugs-To", "Language-Team", "Project-Id-Version"),
    )
)
#: What only has to be handed on, or is a student's.
NOT_OURS = ("starter", "reference", "right", "doubles", "__pycache__")


def sentences() -> Iterator[str | tuple[str, str]]:
    """All marked sentences; a pair has one and many."""
    for path in sorted((ROOT / "grader").rglob("*")):
        reader = READERS.get(path.suffix)
        if not _is_ours(path):
            continue
        if path.suffix == ".py":
            tree = ast.parse(path.read_bytes())
            yield from _called(tree)
            yield from _titles(tree)
        if reader is None:
            continue
        source = path.read_bytes()
        options = {"encoding": "utf-8", "trimmed": "true"}
        for _, message, _, _ in extract(reader, io.BytesIO(source), KEYWORDS, (), options):
            if message:
                yield message if isinstance(message, str) else (message[0], message[1])


def _is_ours(path: Path) -> bool:
    return not set(path.relative_to(ROOT).parts) & set(NOT_OURS)


def _called(tree: ast.Module) -> Iterator[str | tuple[str, str]]:
    """What functions of these names are given; methods called so say something else."""
    for node in ast.walk(tree):
        if not (isinstance(node, ast.Call) and isinstance(node.func, ast.Name)):
            continue
        count = 2 if KEYWORDS.get(node.func.id) else 1
        texts = [each.value for each in node.args[:count] if isinstance(each, ast.Constant)]
        if node.func.id in KEYWORDS and len(texts) == count:
            yield texts[0] if count == 1 else (texts[0], texts[1])


def _titles(tree: ast.Module) -> Iterator[str]:
    """The titles of an exercise's checks, which are the first lines of their docstrings."""
    for node in ast.walk(tree):
        if not isinstance(node, ast.FunctionDef):
            continue
        calls = [each.func for each in node.decorator_list if isinstance(each, ast.Call)]
        if any(isinstance(call, ast.Name) and call.id == "checks" for call in calls):
            yield (ast.get_docstring(node) or "").partition("\n")[0].strip().rstrip(".")


@cache
def template() -> Catalog:
    """The catalogue of all sentences, without translations."""
    found = Catalog(domain="grader", project="turtlesim_py", charset="utf-8")
    for sentence in sentences():
        found.add(sentence)
    return found


def po(language: str) -> Path:
    """The file that translators edit."""
    return LOCALE / language / "LC_MESSAGES" / "grader.po"


def read(language: str) -> Catalog:
    """A language's catalogue as it is; empty if there is none."""
    path = po(language)
    if not path.exists():
        return Catalog(locale=language, domain="grader")
    with path.open("rb") as file:
        return read_po(file, locale=language, domain="grader")


def updated(language: str) -> Catalog:
    """A language's catalogue with the sentences that there are now, and no others."""
    old, new = read(language), template()
    head = f"# {LANGUAGES[language]} sentences of the grader; scripts/catalogues.py keeps them."
    made = Catalog(
        *(language, "grader", head),
        project="turtlesim_py",
        version="0",
        charset="utf-8",
        fuzzy=False,
    )
    for message in new:
        if message.id:
            known = old.get(message.id)
            made.add(message.id, known.string if known and not known.fuzzy else "")
    return made


def text(catalog: Catalog) -> bytes:
    """A catalogue as translators get it: in the order of the sentences, no line numbers."""
    file = io.BytesIO()
    write_po(file, catalog, no_location=True, omit_header=False, sort_output=True, width=100)
    lines = file.getvalue().decode().splitlines(keepends=True)
    return "".join(line for line in lines if not line.startswith(CHANGING)).encode()


def compiled(catalog: Catalog) -> bytes:
    """A catalogue as gettext reads it."""
    file = io.BytesIO()
    catalog.creation_date = catalog.revision_date = _ANY_DAY  # the same file each time
    write_mo(file, catalog)
    return file.getvalue()


def holes(language: str) -> list[str]:
    """The sentences that have no translation."""
    return [
        _first(message) for message in updated(language) if message.id and not _is_whole(message)
    ]


def _first(message: Message) -> str:
    return str(message.id if isinstance(message.id, str) else message.id[0])


def _is_whole(message: Message) -> bool:
    strings = message.string if isinstance(message.string, tuple | list) else [message.string]
    return all(strings)


def main() -> int:
    """Update, or list the holes."""
    for language in LANGUAGES:
        missing = holes(language)
        if sys.argv[1:] == ["holes"]:
            print(*(f"{language}: {sentence}" for sentence in missing), sep="\n")
            continue
        catalog = updated(language)
        po(language).parent.mkdir(parents=True, exist_ok=True)
        po(language).write_bytes(text(catalog))
        po(language).with_suffix(".mo").write_bytes(compiled(read(language)))
        print(f"{language}: {len(catalog)} sentences, {len(missing)} of them not translated")
    return 0


if __name__ == "__main__":
    sys.exit(main())
