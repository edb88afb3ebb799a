"""Whether all that a verdict says is sentences that translators find."""

from __future__ import annotations

import importlib.util
import re
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

from grader.exercise.verdict import Verdict
from grader.language.phrase import Phrase

_SCRIPT = Path(__file__).parents[3] / "scripts" / "catalogues.py"
#: Two words behind each other are somebody's sentence; a name, a type or a number is none.
_PROSE = re.compile(r"[a-z]{2,} [a-z]{2,}")


@cache
def sentences() -> frozenset[str]:
    """The keys of all sentences in the code, of a plural that for one."""
    spec = importlib.util.spec_from_file_location("catalogues", _SCRIPT)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return frozenset(s if isinstance(s, str) else s[0] for s in module.sentences())


def unknown(verdicts: Iterable[Verdict]) -> list[str]:
    """What of these verdicts could not be said in another language."""
    return sorted({text for verdict in verdicts for said in _texts(verdict) for text in _in(said)})


def _texts(verdict: Verdict) -> Iterator[str]:
    yield from (verdict.title, verdict.rationale, verdict.help)
    yield from (item.note for item in verdict.evidence)
    yield from (item.text for item in verdict.expected)


def _in(said: object, *, is_value: bool = False) -> Iterator[str]:
    if not isinstance(said, Phrase):
        if isinstance(said, str) and (_PROSE.search(said) if is_value else said.strip()):
            yield str(said)
    elif said.parts:
        for part in said.parts:
            yield from _in(part, is_value=True)
    else:
        if said.key and said.key not in sentences():
            yield said.key
        for value in said.values.values():
            yield from _in(value, is_value=True)
