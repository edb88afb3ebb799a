#!/usr/bin/env python3
"""Keep the catalogues of translations: a sentence that is not in one is shown in English.

    make catalogues               drops the translations of sentences that are no longer in the code
    scripts/catalogues.py holes   prints the sentences without a translation, as lines to fill in

Translators edit `grader/text/languages/*.json`; the sentences of the simulator's page are in
`turtlesim_py/live/page/*.json`, those of a cast's in `grader/scenes/cast/page/live/*.json`. A
translation has the values of its sentence in any order, with the same formats; a sentence about a
number has a list of forms: for one, for more. French says "vous", and has a no-break space before
`: ; ! ?`; Chinese has its own punctuation, and a space around Latin words. Exercises have their
translations beside them, in `exercise.fr.yaml`.
"""

from __future__ import annotations

import ast
import json
import re
import sys
from collections.abc import Callable, Iterable, Iterator
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
#: The live page of a cast.
HOPS = ROOT / "grader" / "scenes" / "cast" / "page" / "live"
#: The functions whose argument is a sentence, or a pair of singular and plural.
ONE = ("msg", "tr", "Rejected", "_misfit", "Mistake", "expect")
MAY_BE_PAIR, IN_CONTEXT = ("msg", "tr"), "in_context"
_STRING = r'"((?:[^"\\]|\\.)*)"'
_IN_TEMPLATE = re.compile(rf"\btr\(\s*{_STRING}(?:,\s*{_STRING})?")
_IN_SCRIPT = re.compile(rf"\b(?:t|key)\(\s*{_STRING}")
#: The argument of an error is a sentence, too, if there are values for it.
ERRORS = ("UsageError", "SubmissionError", "ExerciseError", "CheckFailed", "RecordingError")
ERRORS += ("Complaint", "GraderFailure", "NotCompiled", "NotNow", "NotOffered", "SceneFailure")
#: Folders of students' programs, and of no sources.
NOT_OURS = ("starter", "reference", "right", "__pycache__")

ATTRIBUTES = ("aria-label", "placeholder", "title")
#: Elements whose text is the same in all languages, or has another translation.
SAME = ("script", "style", "noscript", "code", "kbd")
EMPTY = ("meta", "link", "input", "br", "img")
#: A text with two letters in a row, without units and names, is translated.
_WORD = re.compile(r"[A-Za-z]{2}")
_UNIT = re.compile(r"\[[a-z/]+\]|\$\w+|turtle\d")

#: A sentence, or its singular and plural.
Sentence = str | tuple[str, str]


def of_code(path: Path) -> Iterator[Sentence]:
    """Yield the sentences of Python code.

    The first lines of docstrings are the titles of checks, and the help of verbs.
    """
    tree = ast.parse(path.read_bytes())
    if {"add_arguments", "main"} <= {getattr(node, "name", "") for node in tree.body}:
        yield (ast.get_docstring(tree) or "").partition("\n")[0]
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
            if node.func.attr in ERRORS and node.keywords:  # errors.ExerciseError(...)
                yield from (a.value for a in node.args if isinstance(a, ast.Constant))
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            texts = [a.value for a in node.args if isinstance(a, ast.Constant)]
            texts = [text for text in texts if isinstance(text, str)]
            is_sentence = node.func.id in ONE or (node.func.id in ERRORS and node.keywords)
            if node.func.id in MAY_BE_PAIR and len(texts) > 1:
                yield texts[0], texts[1]
            elif is_sentence and texts:
                yield texts[0]
            elif node.func.id == IN_CONTEXT and len(texts) > 1:
                yield f"{texts[0]} ({texts[1]})"
        if isinstance(node, ast.FunctionDef):
            calls = [each.func for each in node.decorator_list if isinstance(each, ast.Call)]
            if any(isinstance(call, ast.Name) and call.id == "checks" for call in calls):
                yield (ast.get_docstring(node) or "").partition("\n")[0].strip().rstrip(".")


def of_template(path: Path) -> Iterator[Sentence]:
    """Yield the sentences of a report's template."""
    text = path.read_text(encoding="utf-8")
    for one, many in _IN_TEMPLATE.findall(text):
        yield (_literal(one), _literal(many)) if many else _literal(one)


def of_script(path: Path) -> Iterator[Sentence]:
    """Yield the sentences of a page's script."""
    yield from map(_literal, _IN_SCRIPT.findall(path.read_text(encoding="utf-8")))


def of_html(path: Path) -> Iterator[Sentence]:
    """Yield the texts in a page, as `language.js` finds them."""
    reader = _Reader()
    reader.feed(path.read_text(encoding="utf-8"))
    for text in reader.found:
        if _WORD.search(_UNIT.sub("", text)):
            yield " ".join(text.split())


def of_grader() -> Iterator[Sentence]:
    """Yield the sentences of the grader and its robots; not those that its players share."""
    yield from of_code(ROOT / "turtlesim_py" / "ros" / "source.py")
    players = [ROOT / "grader" / "scenes" / "turtlesim" / "page", HOPS.parent, HOPS]
    shared = set(of_simulator())
    for player in players:
        yield from (each for each in of_page(player) if each not in shared)
    readers = {".py": of_code, ".html": of_template}
    rooms = ("grader", "grader_class", "grader_diagnosis", "grader_robots")
    for path in sorted(path for name in rooms for path in (ROOT / name).rglob("*")):
        is_ours = not set(path.relative_to(ROOT).parts) & set(NOT_OURS)
        if is_ours and path.suffix in readers and path.parent not in players:
            yield from readers[path.suffix](path)


def of_simulator() -> Iterator[Sentence]:
    """Yield the sentences of the simulator's page, and of its server."""
    live = ROOT / "turtlesim_py" / "live"
    yield from of_page(live / "page")
    for path in sorted(live.glob("*.py")):
        yield from of_code(path)


def of_hops() -> Iterator[Sentence]:
    """Yield the sentences of the page of a cast, with those of the modules that it shares."""
    yield from of_page(HOPS)
    for name in ("choice.js", "grading.js", "language.js", "rosbridge.js"):
        yield from of_script(ROOT / "turtlesim_py" / "live" / "page" / name)


def of_page(folder: Path) -> Iterator[Sentence]:
    """Yield the sentences in the HTML and the scripts of a page."""
    for path in sorted(folder.iterdir()):
        if path.suffix in (".html", ".js"):
            yield from (of_html if path.suffix == ".html" else of_script)(path)


#: The folders of catalogues, and what finds their sentences.
CATALOGUES: dict[Path, Callable[[], Iterable[Sentence]]] = {
    ROOT / "grader" / "text" / "languages": of_grader,
    ROOT / "turtlesim_py" / "live" / "page": of_simulator,
    HOPS: of_hops,
}


def update(there: dict[str, Any], sentences: Iterable[Sentence]) -> tuple[dict[str, Any], ...]:
    """Return the translations of sentences that are still there, and those that are missing.

    Args:
        there: the catalogue as it is.
    """
    kept, missing = {}, {}
    for sentence in sentences:
        key = sentence if isinstance(sentence, str) else sentence[0]
        said = there.get(key)
        if said and all(said):
            kept[key] = said
        elif key:
            missing[key] = "" if isinstance(sentence, str) else ["", ""]
    return kept, missing


def text(catalogue: dict[str, Any]) -> str:
    """Return the text of a catalogue's file: a line for each sentence."""
    lines = (
        f" {json.dumps(key, ensure_ascii=False)}: {json.dumps(said, ensure_ascii=False)}"
        for key, said in sorted(catalogue.items())
    )
    return "{\n" + ",\n".join(lines) + "\n}\n"


class _Reader(HTMLParser):
    """Collects texts that people read."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []
        self._open: list[tuple[str, bool]] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Collect the translated attributes; record whether the content is translated."""
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


def _literal(inside: str) -> str:
    literal: str = json.loads(f'"{inside}"')
    return literal


def main() -> int:
    """Update the catalogues, or print what they lack."""
    for folder, sentences in CATALOGUES.items():
        found = list(sentences())
        for file in sorted(folder.glob("??.json")):
            kept, missing = update(json.loads(file.read_text(encoding="utf-8")), found)
            print(f"{file.relative_to(ROOT)}: {len(missing)} sentences are not translated")
            if sys.argv[1:] == ["holes"]:
                print(text(missing))
            else:
                file.write_text(text(kept), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
