"""The interface of a page that shows runs live, and the state of a grading that it shows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Protocol

from grader.recording.playback import JudgedCheck


@dataclass(frozen=True)
class Grading:
    """The state of a grading.

    Attributes:
        heading: the submission and the exercise.
        run: the run that is shown, and its speed.
        score: in words; '' while it is not known.
        first: the first thing to fix; '' while it is not known.
        judged: the verdicts up to now.
        is_over: whether this is the final state.
    """

    heading: str
    run: str = ""
    score: str = ""
    first: str = ""
    judged: tuple[JudgedCheck, ...] = ()
    is_over: bool = False


def content_of(grading: Grading) -> Mapping[str, Any]:
    """Return the state of a grading as plain data for the page."""
    shown = ("status", "word", "title", "rationale", "help")
    checks = [{name: getattr(each, name) for name in shown} for each in grading.judged]
    rest = {name: value for name, value in asdict(grading).items() if name != "judged"}
    return {**rest, "checks": checks}


class LivePage(Protocol):
    """A page in a browser, served by this process; viewers can only watch."""

    @property
    def address(self) -> str:
        """The address to open."""

    def await_viewer(self, patience_s: float) -> bool:
        """Wait for a viewer; return whether one has come."""

    def update(self, grading: Grading) -> None:
        """Show the state of the grading."""

    def begin(self) -> None:
        """Show the scene before a run."""

    def hear(self, news: Sequence[Mapping[str, Any]]) -> None:
        """Show the news that `grader.scenes.scene.Hooks.send_news` has received, in order."""

    def close(self) -> None:
        """Stop serving; open pages keep their content."""
