"""docs/threat-model.md says what the attack suite proves, and nothing else."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.attacks.attacks import ATTACKS, SECOND, what_happens

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "threat-model.md").read_text(encoding="utf-8")
LEVELS = ("namespaces", "landlock", "limits")
ALONE = [name for name in ATTACKS if not name.endswith(SECOND)]


def rows() -> dict[str, tuple[str, ...]]:
    """The table of attacks: name -> what happens at each level."""
    found = re.findall(r"^\| `(\w+)` \| .* \| (\w+) \| (\w+) \| (\w+) \|$", PAGE, re.MULTILINE)
    return {name: tuple(at_levels) for name, *at_levels in found}


def test_every_attack_is_in_the_table_and_no_other() -> None:
    assert list(rows()) == ALONE


@pytest.mark.parametrize("attack", ALONE)
def test_the_table_says_what_stops_it(attack: str) -> None:
    assert rows()[attack] == tuple(what_happens(attack, level) for level in LEVELS)


def test_every_test_that_is_named_is_there() -> None:
    for file, test in re.findall(r"`(tests/[\w/]+\.py)::(\w+)`", PAGE):
        assert f"def {test}(" in (ROOT / file).read_text(encoding="utf-8"), (file, test)
