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
TOGETHER = 12
#: For a level and an attack: those that share its container, itself among them.
SHARING = pytest.StashKey[dict[tuple[str, str], list[str]]]()
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


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Lay side by side what shares a container: one worker asks for it, and no other waits."""
    asked = {place: words for place, item in enumerate(items) if (words := _asked(item))}
    attacks: dict[str, set[str]] = {}
    for level, attack in asked.values():
        attacks.setdefault(level, set()).add(attack)
    sharing = {
        (level, name): names[index // TOGETHER * TOGETHER :][:TOGETHER]
        for level, names in ((level, sorted(found)) for level, found in attacks.items())
        for index, name in enumerate(names)
    }
    config.stash[SHARING] = sharing
    ordered = sorted(asked, key=lambda place: (asked[place][0], sharing[asked[place]]))
    for place, item in zip(asked, [items[place] for place in ordered], strict=True):
        items[place] = item


@pytest.fixture(scope="session")
def graded(request: pytest.FixtureRequest, told: Told) -> Graded:
    """Give the outcome of an attack at a level, graded with others that are asked for."""
    sharing = request.config.stash[SHARING]

    def graded(level: str, attack: str) -> Outcome:
        seen = told(level, sharing[level, attack])[attack]
        return Outcome(
            harm=tuple(seen["harm"]),
            code=seen["code"],
            score=seen["score"],
            passed=tuple(seen["passed"]),
            isolation=seen["isolation"],
            told=seen,
        )

    return graded


def _asked(item: pytest.Item) -> tuple[str, str] | None:
    """The level and the attack that a test asks for."""
    words = getattr(getattr(item, "callspec", None), "params", {})
    return (words["level"], words["attack"]) if {"level", "attack"} <= words.keys() else None
