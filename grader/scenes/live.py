"""What a page is that shows runs while they go on, and what it is told of their grading."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from grader.recording.playback import JudgedCheck


@dataclass(frozen=True)
class Grading:
    """What is known of a grading at a moment.

    Attributes:
        heading: whose submission, to which exercise.
        run: which run is to be seen, and how fast it goes.
        score: in words; '' while it is not known.
        first: the first thing to mend; '' while it is not known.
        judged: what the checks say that have been decided.
        is_over: whether all is known.
    """

    heading: str
    run: str = ""
    score: str = ""
    first: str = ""
    judged: tuple[JudgedCheck, ...] = ()
    is_over: bool = False


class LivePage(Protocol):
    """A page in a browser, served by this process; its viewers can do nothing but look."""

    @property
    def address(self) -> str:
        """What to open."""

    def await_viewer(self, patience_s: float) -> bool:
        """Wait until somebody looks; whether anybody has."""

    def tell(self, grading: Grading) -> None:
        """Show what is known now."""

    def begin(self) -> None:
        """Show the scene as it is before a run."""

    def hear(self, news: Sequence[Mapping[str, Any]]) -> None:
        """Show what `grader.scenes.scene.Hooks.tell` has got, in order."""

    def close(self) -> None:
        """Show no more: who looks keeps what he sees."""
