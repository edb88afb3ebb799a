"""What a worker is asked for, and what it answers: a line of JSON each."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Literal, Self

from grader import strict_json
from grader.batch.hand_in import HandIn
from grader.language import stored
from grader.language.catalogue import spoken
from grader.language.phrase import say
from grader.recording.recording import Clock
from grader.result import json_file


@dataclass(frozen=True)
class Task:
    """One content, to be run and judged for everybody who has handed it in.

    Attributes:
        key: the run's; see `grader.batch.key`.
        hand_ins: everybody's; their paths are not carried along.
        path: what was handed in; None where nothing is run any more.
        filename: what it was called there.
        exercise: its name or path.
        time: the clock that it lives by.
        seed: chooses where the varied runs start; None takes the exercise's own.
        run: the folder of the run, if it is made already; one that cannot be read is made anew.
        into: an empty folder for what is made; see `grader.batch.store`.
        judge_only: whether results alone are asked for: no pages, no pictures.
        isolation: the level at which it is run, of `grader.run.processes.levels`; '': the best.
        language: of the pages; that of whoever asks.
    """

    key: str
    hand_ins: tuple[HandIn, ...]
    path: Path | None
    filename: str
    exercise: str
    time: Clock
    seed: int | None
    run: Path | None
    into: Path
    judge_only: bool = False
    isolation: str = ""
    language: str = field(default_factory=spoken)

    def to_line(self) -> bytes:
        """As it is sent."""
        return json.dumps(strict_json.to_json(self, strict_json.OURS)).encode() + b"\n"

    @classmethod
    def from_line(cls, line: bytes) -> Self:
        """What was sent."""
        return json_file.typed(cls, strict_json.loads(line.decode()))


@dataclass(frozen=True)
class Answer:
    """How a task ended.

    Attributes:
        state: "done": everything is in its folder. "failed": the grader could not; "exercise":
            the exercise's own code failed; "again": it could not now, but may the next time;
            "unfit": it cannot confine submissions as the task asks.
        message: why.
        ran: whether there was a run.
    """

    state: Literal["done", "failed", "exercise", "again", "unfit"]
    message: str = ""
    ran: bool = True

    @property
    def why(self) -> str:
        """Why it is not done, for people."""
        if self.state == "exercise":
            return say("The exercise's own code failed: {why}", why=self.message)
        return self.message

    def to_line(self) -> bytes:
        """As it is sent."""
        data = {**asdict(self), "phrases": stored.phrases_in(self.message)}
        return json.dumps(data).encode() + b"\n"

    @classmethod
    def from_line(cls, line: bytes) -> Self:
        """What was sent.

        Raises:
            ValueError: it is none.
        """
        try:
            data = strict_json.loads(line.decode())
            phrases = data.pop("phrases", {})
            return stored.restored(json_file.typed(cls, data), phrases)
        except (TypeError, AttributeError, UnicodeDecodeError) as error:
            raise ValueError(say("is no answer: {why}", why=str(error))) from None
