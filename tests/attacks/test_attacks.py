"""Hostile submissions, graded as in a course: what they gain, and what they do to anything else.

`attacks.ATTACKS` says what there is, `submissions/` what each does. Each is graded by the real
command line, in a container that makes a machine of each kind out of this one (`levels`), among
canaries (`observing`): at one level in `make test`, at every other in `make test-all`.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from typing import Any

import pytest

from tests.attacks import levels
from tests.attacks.attacks import (
    AS_ROOT,
    AS_ROOT_BY_LANDLOCK,
    AT_LIMITS,
    ATTACKS,
    LINK,
    READING,
    RUBRIC,
    SECOND,
    SIMULATOR,
    TRIED_ELSEWHERE,
    what_happens,
)
from tests.attacks.conftest import Graded, Told
from tests.attacks.handed_in import SUBMISSIONS
from tests.needs import needs

pytestmark = [
    pytest.mark.timeout(900),  # the first waits for all that share its container
    needs("container"),
]

BEST = "namespaces-user"
EXAMPLES = int(os.environ.get("EXAMPLES") or 0)
#: What no level changes is tried at one, which has all of them.
EVERYWHERE_THE_SAME = {READING, RUBRIC, SIMULATOR, LINK}
DIFFER = {name for name, each in ATTACKS.items() if each.about not in EVERYWHERE_THE_SAME}
#: Where a level may matter most: tried first.
TRIED = {
    "namespaces-user": ATTACKS.keys(),
    "namespaces-root": AS_ROOT,
    "landlock-user": DIFFER - TRIED_ELSEWHERE,
    "landlock-root": AS_ROOT_BY_LANDLOCK,
    "limits-user": AT_LIMITS,
}
#: As the second of two programs: what concerns how that comes to its view and to its link.
TRIED_AS_SECOND = {
    *("reads_home", "looks_at_processes", "kills_all", "unmounts", "mounts", "enters_namespaces"),
    *("takes_descriptors", "works_in_a_descriptor", "fills_disk", "misuses_the_link"),
}
#: What the grader waits for as long as it would for anybody.
SLOW = {
    "outlives_main": "half a minute of sleep, which is waited for at every level",
    "stops_itself": "waits as long as for `stops_all`, and dies of the same",
}
#: What is wrong wherever it happens, whatever the level lets through.
NEVER = ("the grader failed", "the grading never ended", "the next submission", "an escape on")


def applies(level: levels.Level) -> pytest.MarkDecorator:
    """Whether a machine of a kind can be made out of this one."""
    can_be_made = (levels.can_filter() or not level.is_confined) and (
        os.getuid() == 0 or not level.is_root
    )
    return pytest.mark.applies(can_be_made, reason="nobody but root can grade as root")


def chosen() -> Iterator[Any]:
    """Level and attack of each grading: all at one level, and EXAMPLES at each of the others.

    But not where nothing is promised: there an attack may have its points, or end the grader.
    """
    for level, kind in levels.LEVELS.items():
        marks = [applies(kind)]
        promised = [name for name in ATTACKS if what_happens(name, kind.grader) != "open"]
        names = sorted(promised, key=lambda name: name not in TRIED[level])
        if level != BEST:
            marks.append(pytest.mark.more("the same attack on another kind of machine"))
            names = names[: EXAMPLES or None]
        for name in names:
            slow = (pytest.mark.more(SLOW[name]),) if name in SLOW else ()
            if name.endswith(SECOND) and name.removesuffix(SECOND) not in TRIED_AS_SECOND:
                slow = (pytest.mark.more("as the second of two programs"),)
            yield pytest.param(level, name, marks=(*marks, *slow))


GRADINGS = list(chosen())


@pytest.mark.parametrize(("level", "attack"), GRADINGS)
def test_it_does_no_harm_and_earns_no_points(graded: Graded, level: str, attack: str) -> None:
    outcome = graded(level, attack)
    harm = outcome.harm
    if levels.LEVELS[level].grader not in ATTACKS[attack].stopped_by:
        harm = tuple(each for each in harm if each.startswith(NEVER))
    assert not harm, outcome.told
    assert outcome.code in ATTACKS[attack].codes, outcome.told
    if expected := ATTACKS[attack].outcome:
        assert outcome.told["outcome"] == expected, outcome.told
    assert (outcome.score or 0) <= ATTACKS[attack].most, outcome.told
    assert not set(outcome.passed) & set(ATTACKS[attack].lacks), outcome.told


@pytest.mark.parametrize(
    ("level", "attack"), [each for each in GRADINGS if each.values[1] == "has_privileges"]
)
def test_the_result_names_the_level(graded: Graded, level: str, attack: str) -> None:
    outcome = graded(level, attack)
    assert outcome.isolation.startswith(levels.LEVELS[level].grader), outcome.told


#: What a program achieves that nothing confines: for each, one of the sentences about it.
UNCONFINED = {
    "reads_home": "told a secret: home",
    "writes_home": "changed: ",
    "neighbours": "told a secret: neighbour",
    "reads_environment": "told a secret: environment",
    "process_vm": "another process was changed",
    "kills_each": "another process was ended or stopped",
    "reaches_services": "a service was reached: TCP",
    "types_into_the_terminal": "typed into the terminal",
    "daemons": "left running",
    "leaves_files": "changed: /dev/shm",
}


@pytest.mark.parametrize("alone", UNCONFINED)
def test_the_canaries_sing_where_nothing_confines_an_attack(told: Told, alone: str) -> None:
    seen = told("unconfined", list(UNCONFINED))
    assert any(harm.startswith(UNCONFINED[alone]) for harm in seen[alone]["harm"]), seen


def test_every_submission_is_tried() -> None:
    there = {path.stem for path in SUBMISSIONS.glob("*.py")} - {"tools"}
    tried = {attack.program or name for name, attack in ATTACKS.items()}
    assert there <= tried, there - tried
