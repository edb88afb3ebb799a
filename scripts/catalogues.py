#!/usr/bin/env python3
"""Look for sentences in the code, and bring the catalogues of all languages up to date.

    make catalogues               after a sentence was written
    scripts/catalogues.py holes   what has no translation yet

Translators edit `grader/languages/*.json`; what only the simulator's page says is in
`turtlesim_py/live/page/*.json`.
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
LANGUAGES = ("fr", "zh")
#: How many forms a sentence about a number has.
FORMS = {"fr": 2, "zh": 1}
#: The functions that get a sentence; of a pair the second is for more than one.
ONE = ("msg", "tr", "Rejected", "_misfit", "Mistake", "expect")
PAIR, IN_CONTEXT = ("msg_many", "tr_many"), "in_context"
_STRING = r'"((?:[^"\\]|\\.)*)"'
_IN_TEMPLATE = re.compile(rf"\btr\(\s*{_STRING}")
_PAIR_IN_TEMPLATE = re.compile(rf"\btr_many\(\s*{_STRING},\s*{_STRING}")
_IN_SCRIPT = re.compile(rf"\b(?:t|key)\(\s*{_STRING}")
#: Errors get a sentence, too, where they get its values.
ERRORS = ("UsageError", "SubmissionError", "ExerciseError", "CheckFailed", "RecordingError")
ERRORS += ("GraderFailure", "NotNow", "NotOffered")
#: What is a student's, or another project's.
NOT_OURS = ("starter", "reference", "right", "__pycache__")

ATTRIBUTES = ("aria-label", "placeholder", "title")
#: Whose text is the same in all languages, or is said otherwise.
SAME = ("script", "style", "noscript", "code", "kbd")
EMPTY = ("meta", "link", "input", "br", "img")
#: Two letters in a row that are no unit, and no name.
_WORD = re.compile(r"[A-Za-z]{2}")
_UNIT = re.compile(r"\[[a-z/]+\]|\$\w+|turtle\d")

#: A sentence, or the two forms of one about a number.
Sentence = str | tuple[str, str]


def of_code(path: Path) -> Iterator[Sentence]:
    """What functions of these names are given, and titles of checks: their docstrings' first."""
    for node in ast.walk(ast.parse(path.read_bytes())):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            texts = [a.value for a in node.args if isinstance(a, ast.Constant)]
            texts = [text for text in texts if isinstance(text, str)]
            is_sentence = node.func.id in ONE or (node.func.id in ERRORS and node.keywords)
            if is_sentence and texts:
                yield texts[0]
            elif node.func.id in PAIR and len(texts) > 1:
                yield texts[0], texts[1]
            elif node.func.id == IN_CONTEXT and len(texts) > 1:
                yield f"{texts[0]} ({texts[1]})"
        if isinstance(node, ast.FunctionDef):
            calls = [each.func for each in node.decorator_list if isinstance(each, ast.Call)]
            if any(isinstance(call, ast.Name) and call.id == "checks" for call in calls):
                yield (ast.get_docstring(node) or "").partition("\n")[0].strip().rstrip(".")


def of_template(path: Path) -> Iterator[Sentence]:
    """What a template of a report renders."""
    text = path.read_text(encoding="utf-8")
    yield from map(_literal, _IN_TEMPLATE.findall(text))
    yield from ((_literal(one), _literal(many)) for one, many in _PAIR_IN_TEMPLATE.findall(text))


def of_script(path: Path) -> Iterator[Sentence]:
    """What a page's script renders in the browser."""
    yield from map(_literal, _IN_SCRIPT.findall(path.read_text(encoding="utf-8")))


def of_html(path: Path) -> Iterator[Sentence]:
    """The texts that stand in a page, as `language.js` finds them."""
    reader = _Reader()
    reader.feed(path.read_text(encoding="utf-8"))
    for text in reader.found:
        if _WORD.search(_UNIT.sub("", text)):
            yield " ".join(text.split())


def of_grader() -> Iterator[Sentence]:
    """All that the grader says, its robots too; not what its player shares with the simulator."""
    player = ROOT / "grader" / "scenes" / "turtlesim" / "player" / "page"
    shared = set(of_simulator())
    yield from (each for each in of_page(player) if each not in shared)
    readers: dict[str, Callable[[Path], Iterator[Sentence]]] = {
        ".py": of_code,
        ".html": of_template,
    }
    for path in sorted(p for name in ("grader", "grader_robots") for p in (ROOT / name).rglob("*")):
        is_ours = not set(path.relative_to(ROOT).parts) & set(NOT_OURS)
        if is_ours and path.suffix in readers and path.parent != player:
            yield from readers[path.suffix](path)


def of_simulator() -> Iterator[Sentence]:
    """Everything that the simulator's page says, and what its server answers."""
    live = ROOT / "turtlesim_py" / "live"
    yield from of_page(live / "page")
    for path in sorted(live.glob("*.py")):
        yield from of_code(path)


def of_page(folder: Path) -> Iterator[Sentence]:
    """What the HTML and the scripts of a page say."""
    for path in sorted(folder.iterdir()):
        if path.suffix in (".html", ".js"):
            yield from (of_html if path.suffix == ".html" else of_script)(path)


#: The folders of catalogues, and what finds their sentences.
CATALOGUES: dict[Path, Callable[[], Iterable[Sentence]]] = {
    ROOT / "grader" / "languages": of_grader,
    ROOT / "turtlesim_py" / "live" / "page": of_simulator,
}


def read(folder: Path, language: str) -> dict[str, Any]:
    """A catalogue as it is."""
    found: dict[str, Any] = json.loads((folder / f"{language}.json").read_text(encoding="utf-8"))
    return found


def updated(folder: Path, language: str) -> dict[str, Any]:
    """A catalogue with the sentences that there are now, and no others; "" is a hole."""
    old, new = read(folder, language), dict[str, Any]()
    for sentence in CATALOGUES[folder]():
        if not sentence:
            continue
        key = sentence if isinstance(sentence, str) else sentence[0]
        hole = "" if isinstance(sentence, str) else [""] * FORMS[language]
        known = old.get(key)
        if key not in new or isinstance(hole, list):
            new[key] = known if isinstance(known, type(hole)) else hole
    return dict(sorted(new.items()))


def holes(folder: Path, language: str) -> list[str]:
    """The sentences that have no translation."""
    found = updated(folder, language).items()
    return [key for key, said in found if not (said if isinstance(said, str) else all(said))]


def text(catalogue: dict[str, Any]) -> str:
    """A catalogue as its file has it: a line for each sentence."""
    lines = (
        f" {json.dumps(key, ensure_ascii=False)}: {json.dumps(said, ensure_ascii=False)}"
        for key, said in catalogue.items()
    )
    return "{\n" + ",\n".join(lines) + "\n}\n"


class _Reader(HTMLParser):
    """Collects texts that people read."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []
        self._open: list[tuple[str, bool]] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Take the attributes that are read; remember whether what is within is translated."""
        given = dict(attrs)
        is_same = tag in SAME or given.get("translate") == "no" or self._is_same
        if not is_same:
            self.found += [given[name] or "" for name in ATTRIBUTES if name in given]
        if tag not in EMPTY:
            self._open.append((tag, is_same))

    def handle_endtag(self, tag: str) -> None:
        """Leave an element."""
        opened, _ = self._open.pop()
        assert opened == tag, f"<{opened}> is closed as </{tag}>"

    def handle_data(self, data: str) -> None:
        """Take a text."""
        if not self._is_same:
            self.found.append(data)

    @property
    def _is_same(self) -> bool:
        return bool(self._open) and self._open[-1][1]


def _literal(inside: str) -> str:
    said: str = json.loads(f'"{inside}"')
    return said


def main() -> int:
    """Update, or list the holes."""
    for folder in CATALOGUES:
        for language in LANGUAGES:
            missing = holes(folder, language)
            if sys.argv[1:] == ["holes"]:
                print(*(f"{language}: {sentence}" for sentence in missing), sep="\n")
                continue
            made = updated(folder, language)
            (folder / f"{language}.json").write_text(text(made), encoding="utf-8")
            name = (folder / f"{language}.json").relative_to(ROOT)
            print(f"{name}: {len(made)} sentences, {len(missing)} of them not translated")
    return 0


if __name__ == "__main__":
    sys.exit(main())
