"""Refusals by the system of what a level needs: for good, or for now.

A final refusal is not tried again. Any other (no descriptor is free, no memory, a trial that takes
too long) may pass: it is tried again, a few times, and then reported. It never lowers a level.
"""

from __future__ import annotations

import errno
import os
import time
from collections.abc import Callable
from types import FrameType
from typing import TYPE_CHECKING, NamedTuple, Self, TypeVar

if TYPE_CHECKING:  # no dataclass, no re: a supervisor starts in milliseconds
    from grader.text.message import Message

#: The numbers of errors that are final.
FINAL = frozenset(
    getattr(errno, name) for name in ("EPERM", "EACCES", "ENOSYS", "EINVAL", "EOPNOTSUPP", "EUSERS")
)
#: The pauses between tries [s].
PAUSES_S = (0.1, 0.5)
TRIES = len(PAUSES_S) + 1
#: The file with the most namespaces of a kind that there may be.
MOST = "/proc/sys/user/max_{kind}_namespaces"

Made = TypeVar("Made")


class Refusal(NamedTuple):
    """What was refused.

    Attributes:
        number: the system's number of the error; 0 for none.
        step: the refused step: "unshare (net)", a path, a function: "confinement._become".
        words: the reason, for people; a message where there is no step.
    """

    number: int
    step: str
    words: str | Message

    @classmethod
    def of(cls, error: BaseException) -> Self:
        """Make one from an error; its file is the step, or else the function that raised it."""
        place = error.__traceback__
        while place is not None and place.tb_next is not None:
            place = place.tb_next
        step = "" if place is None else _name(place.tb_frame)
        if not isinstance(error, OSError):
            return cls(0, step, " ".join(str(error).split()) or repr(error))
        words = error.strerror or str(error)
        return cls(error.errno or 0, os.fsdecode(error.filename or step), " ".join(words.split()))

    @classmethod
    def from_line(cls, line: str) -> Self:
        """Parse what `to_line` has written, or anything else."""
        number, _, rest = line.partition(" ")
        step, colon, words = rest.partition(": ")
        if colon and number.isascii() and number.isdigit() and len(number) < 5:
            return cls(int(number), step, words)
        return cls(0, "", line)

    def to_line(self) -> str:
        step = " ".join(self.step.replace(": ", " ").split())
        return f"{self.number} {step}: {self.words}"

    @property
    def why(self) -> str | Message:
        """The step and the reason, for people, in one line."""
        return f"{self.step}: {self.words}" if self.step else self.words

    @property
    def is_final(self) -> bool:
        """Whether a retry is useless: the system lacks it, or forbids it."""
        if self.number == errno.ENOSPC and self.step.startswith("unshare"):
            kinds = self.step.removeprefix("unshare (").removesuffix(")").split(", ")
            return any(_most(kind) == 0 for kind in kinds)
        return self.number in FINAL


def insist(attempt: Callable[[], Made | Refusal]) -> Made | Refusal:
    """Return what an attempt makes; try up to `TRIES` times, until a refusal is final."""
    for pause_s in PAUSES_S:
        answer = attempt()
        if not isinstance(answer, Refusal) or answer.is_final:
            return answer
        time.sleep(pause_s)
    return attempt()


def _name(frame: FrameType) -> str:
    module = frame.f_globals.get("__name__", "").rpartition(".")[2]
    return f"{module}.{frame.f_code.co_name}"


def _most(kind: str) -> int | None:
    try:
        with open(MOST.format(kind=kind), "rb") as file:  # noqa: PTH123  pathlib is slow to import
            return int(file.read())
    except (OSError, ValueError):
        return None
