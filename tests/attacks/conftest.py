"""Gradings of attacks: in containers, each only once."""

from __future__ import annotations

import compileall
import hashlib
import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from tests import once
from tests.attacks import container, observing

#: So many attacks share a container, and the grader in it.
TOGETHER = 24
#: What decides how they go, beside the tree.
SOURCES = hashlib.sha256(
    b"".join(path.read_bytes() for path in sorted(Path(__file__).parent.rglob("*.py")))
).hexdigest()


@dataclass(frozen=True)
class Outcome:
    """What was seen of one attack at one level; see `observing`.

    Attributes:
        harm: sentences: whatever an attack may not do.
        code: how the grader ended.
        score: what the result file says; None if there is none.
        passed: checks.
        isolation: what the result says.
        told: all of it, for a message.
    """

    harm: tuple[str, ...]
    code: int
    score: float | None
    passed: tuple[str, ...]
    isolation: str
    told: dict[str, Any]


Graded = Callable[[str, str], Outcome]
Told = Callable[[str, list[str]], dict[str, dict[str, Any]]]


@pytest.fixture(scope="session")
def told() -> Told:
    """Give what was seen of attacks that share a container; see `observing`."""
    for package in observing.PACKAGES:  # else whoever imports first would write into the copies
        compileall.compile_dir(container.ROOT / package, quiet=2)

    def told(level: str, attacks: list[str]) -> dict[str, dict[str, Any]]:
        def observe(folder: Path) -> None:
            seen = container.run({"level": level, "attacks": attacks})
            (folder / "told.json").write_text(json.dumps(seen))

        path = once.folder(observe, "attacks", level, attacks, SOURCES) / "told.json"
        return {each["attack"]: each for each in json.loads(path.read_text())}

    return told


@pytest.fixture(scope="session")
def graded(request: pytest.FixtureRequest, told: Told) -> Graded:
    """Give the outcome of an attack at a level, graded with others that are asked for."""
    asked: dict[str, set[str]] = {}
    for item in request.session.items:
        words = getattr(getattr(item, "callspec", None), "params", {})
        if {"level", "attack"} <= words.keys():
            asked.setdefault(words["level"], set()).add(words["attack"])

    def graded(level: str, attack: str) -> Outcome:
        names = sorted(asked[level])
        first = names.index(attack) // TOGETHER * TOGETHER
        seen = told(level, names[first : first + TOGETHER])[attack]
        return Outcome(
            harm=tuple(seen["harm"]),
            code=seen["code"],
            score=seen["score"],
            passed=tuple(seen["passed"]),
            isolation=seen["isolation"],
            told=seen,
        )

    return graded
