"""Gradings of attacks: in containers, in the background, several at once, each only once."""

from __future__ import annotations

import compileall
import os
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import pytest

from tests.attacks import container, levels, observing

#: So many attacks share a container.
TOGETHER = 6
#: So many containers at once: a grading waits now and then.
AT_ONCE = 1 + (os.cpu_count() or 1)


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


@pytest.fixture(scope="session")
def no_container() -> str:
    """Why there is no container here; empty where there is one."""
    for package in observing.PACKAGES:  # else whoever imports first would write into the copies
        compileall.compile_dir(container.ROOT / package, quiet=2)
    try:
        container.run(container.PROBE)
    except container.NoContainer as why:
        return str(why)
    return ""


@pytest.fixture(scope="session")
def graded(request: pytest.FixtureRequest, no_container: str) -> Iterator[Graded]:
    """Give the outcome of an attack at a level: all that the chosen tests ask for are begun."""
    asked: dict[str, list[str]] = {}
    for item in request.session.items if not no_container else ():
        words = getattr(getattr(item, "callspec", None), "params", {})
        if {"level", "attack"} <= words.keys():
            asked.setdefault(words["level"], []).append(words["attack"])
    groups: dict[tuple[str, str], Future[list[dict[str, Any]]]] = {}
    with ThreadPoolExecutor(AT_ONCE) as pool:

        def begin(level: str, attacks: list[str]) -> None:
            job = {"level": level, "attacks": attacks}
            future = pool.submit(container.run, job)
            groups.update({(level, attack): future for attack in attacks})

        def graded(level: str, attack: str) -> Outcome:
            if no_container:
                pytest.skip(
                    f"attacks run in a container, and there can be none here: {no_container}"
                )
            if levels.LEVELS[level].is_confined and not levels.can_filter():
                pytest.skip("the filter of a container is written for x86_64")
            if levels.LEVELS[level].is_root and os.getuid() != 0:
                pytest.skip("nobody but root can grade as root")
            told = next(t for t in groups[level, attack].result() if t["attack"] == attack)
            return Outcome(
                harm=tuple(told["harm"]),
                code=told["code"],
                score=told["score"],
                passed=tuple(told["passed"]),
                isolation=told["isolation"],
                told=told,
            )

        for level, names in asked.items():
            attacks = list(dict.fromkeys(names))
            if levels.LEVELS[level].is_root and os.getuid() != 0:
                continue
            for at in range(0, len(attacks), TOGETHER):
                begin(level, attacks[at : at + TOGETHER])
        yield graded
        pool.shutdown(cancel_futures=True)
