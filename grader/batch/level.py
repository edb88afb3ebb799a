"""The one level at which all of a class are confined: what makes two hand-ins comparable, and safe.

It is the best that there is where the class is begun, stands in class.json, and holds for all that
is graded into that folder later.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

from grader.batch.class_file import CLASS, ClassFile
from grader.batch.store import Store
from grader.errors import NotOffered, UsageError
from grader.language.phrase import say
from grader.run.processes import levels
from grader.run.processes.levels import ADVICE, LEVELS


def begun_at(store: Store, again: str = "", least: str = "") -> str:
    """The level at which a class goes on; '' where it is new, or everything is done anew.

    Where that is less than `least`, the latter, which is not what class.json says.
    """
    if not (store.out / CLASS).is_file() or again == "all":
        return ""
    level = ClassFile.read(store.out).isolation
    return least if level and least and _is_less(level, least) else level


def note(store: Store, level: str) -> None:
    """Write down at which level a class is graded."""
    found = ClassFile.read(store.out)
    if found.isolation != level:
        replace(found, isolation=level).put(store.out)


def on_this_machine(level: str) -> str:
    """The level at which this machine grades all of a class: that of its beginning, or the best.

    Raises:
        UsageError: that is not to be had here.
        NotNow: it may be, but not now.
    """
    try:
        return levels.here(level).level
    except NotOffered as error:
        raise UsageError(
            say(
                "{why}. To get it: {advice}. Or give another --out, or have everything graded by "
                "this one: --again all.",
                why=error.message,
                advice=ADVICE[level],
            )
        ) from None


@dataclass
class OfCluster:
    """The level at which the workers of a cluster grade a class.

    Attributes:
        level: '' until it is chosen.
        least: the lowest that may be; '' for any.
        settle: is told what was chosen.
    """

    level: str = ""
    least: str = ""
    settle: Callable[[str], None] = lambda _: None

    def choose(self, offered: Iterable[str]) -> None:
        """Unless that is done, take the best that workers offer; without any, that of this machine.

        Raises:
            UsageError: it is too low.
        """
        if self.level:
            return
        there = set(filter(None, offered)) or {levels.here().level, self.least}
        self.level = next((level for level in LEVELS if level in there), "")
        if self.least and (not self.level or _is_less(self.level, self.least)):
            raise self.none_offers(self.least)
        self.settle(self.level)

    def none_offers(self, level: str) -> UsageError:
        """Why a cluster cannot grade at a level."""
        return UsageError(
            say(
                "no worker of the cluster offers isolation by {level}. To get it: {advice}.",
                level=level,
                advice=ADVICE[level],
            )
        )


def _is_less(level: str, than: str) -> bool:
    return LEVELS.index(level) > LEVELS.index(than)
