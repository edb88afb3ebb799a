"""Where to see in a recording what a check has found."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated

from grader.system.strict_json import SPARSE, not_negative
from grader.text.message import Message


@dataclass(frozen=True)
class Evidence:
    """A moment of the recording that a verdict points to.

    Attributes:
        time_s: when, in simulated seconds.
        note: what happened then.
        x, y: where it happened [m]; None for what has no place.
        run: 0 for the nominal run, 1, 2, ... for the varied ones.
        tick: when, as the scene counts its steps; None where it counts none.
    """

    time_s: Annotated[float, not_negative]
    note: Message
    x: float | None = field(default=None, metadata=SPARSE)
    y: float | None = field(default=None, metadata=SPARSE)
    run: Annotated[int, not_negative] = 0
    tick: Annotated[int, not_negative] | None = field(default=None, metadata=SPARSE)

    def __post_init__(self) -> None:
        """Convert a plain text to a message."""
        convert_texts(self, "note")

    @property
    def place(self) -> tuple[float, float] | None:
        """Its place [m]; None for none."""
        return None if self.x is None or self.y is None else (self.x, self.y)


def convert_texts(made: object, *names: str) -> None:
    """Convert plain texts, of checks whose authors translate nothing, to messages."""
    for name in names:
        if isinstance(text := getattr(made, name), str):
            object.__setattr__(made, name, Message.of(text))
