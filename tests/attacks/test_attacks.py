"""Hostile submissions, graded as in a course: what they gain, and what they do to anything else.

`attacks.ATTACKS` says what there is. Each is graded by the real command line, in a container that
makes a machine of each kind out of this one (`levels`), among canaries (`observing`); those of one
kind one after the other, by one grader.
"""

import compileall
import os
from collections.abc import Iterator
from typing import Any

import pytest

from tests.attacks import container, levels, observing
from tests.attacks.attacks import ATTACKS, KINDS, LEVELS, what_happens
from tests.needs import needs

pytestmark = [
    pytest.mark.more("test_one_of_each_kind, without a container, at the best level"),
    pytest.mark.timeout(900),
    needs("container"),
]

#: What is wrong wherever it happens, whatever the level lets through.
NEVER = ("the grader failed", "the grading never ended", "the next submission", "an escape on")


def gradings() -> Iterator[Any]:
    """A level, and the attacks of one kind; but not where nothing is promised of them."""
    for level, machine in levels.LEVELS.items():
        can_be_made = (levels.can_filter() or not machine.is_confined) and (
            os.getuid() == 0 or not machine.is_root
        )
        mark = pytest.mark.applies(can_be_made, reason="nobody but root can grade as root")
        for kind in KINDS:
            names = [name for name, each in ATTACKS.items() if each.kind == kind]
            names = [name for name in names if what_happens(name, machine.grader) != "open"]
            if names:
                yield pytest.param(level, names, marks=mark, id=f"{level}-{kind}")


@pytest.fixture(scope="module", autouse=True)
def compiled():
    """Else whoever imports first would write into the copies."""
    for package in observing.PACKAGES:
        compileall.compile_dir(container.ROOT / package, quiet=2)


@pytest.mark.parametrize(("level", "names"), list(gradings()))
def test_they_do_no_harm_and_earn_no_points(level, names):
    found = container.run({"level": level, "attacks": names})
    assert [each["attack"] for each in found] == names
    wrong = {each["attack"]: (why, each) for each in found for why in _wrong(level, each)}
    assert not wrong


def _wrong(level: str, found: dict[str, Any]) -> Iterator[str]:
    grader, attack = levels.LEVELS[level].grader, ATTACKS[found["attack"]]
    is_stopped = grader in LEVELS[attack.stopped_by]
    yield from (each for each in found["harm"] if is_stopped or each.startswith(NEVER))
    if found["code"] not in attack.codes:
        yield f"exit code {found['code']}"
    if attack.outcome not in ("", found["outcome"]):
        yield f"it ended as {found['outcome']}"
    if (found["score"] or 0) > attack.most or set(found["passed"]) & set(attack.lacks):
        yield f"{found['score']} points, for {found['passed']}"
    if found["isolation"] and not found["isolation"].startswith(grader):
        yield f"graded at {found['isolation']}"


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


def test_the_canaries_sing_where_nothing_confines_an_attack():
    found = container.run({"level": "unconfined", "attacks": list(UNCONFINED)})
    for each in found:
        sung = UNCONFINED[each["attack"]]
        assert any(harm.startswith(sung) for harm in each["harm"]), each
