"""A run as the rules see it, and how they put a place, a time and a foreign text into words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from grader.diagnosis import printed
from grader.language.phrase import Phrase, joined, say
from grader.recording.conduct import Conduct, End, EndKind, Place, Raised, Stop
from grader.recording.recording import Recording, Run
from grader.scenes import load_scene
from grader.scenes.scene import Endpoint, EndpointKind
from grader.text import clip, one_line, plain

#: What an end of the submission's has to meet, to be of any use.
OPPOSITE: dict[EndKind, EndpointKind] = {
    "subscription": "publisher",
    "publisher": "subscription",
    "client": "service",
    "action_client": "action",
}
_LONGEST = 200
#: Shown as 0.0 [s].
_AT_ONCE_S = 0.05


@dataclass(frozen=True)
class Case:
    """All that is known of one run."""

    recording: Recording

    @property
    def run(self) -> Run:
        """How it went."""
        return self.recording.run

    @property
    def conduct(self) -> Conduct:
        """What its process has told of itself."""
        return self.recording.conduct

    @cached_property
    def raised(self) -> Raised | None:
        """The exception or signal that ended it; only for a run that ended so."""
        if self.run.outcome not in ("crashed", "killed"):
            return None
        if self.conduct.is_told and self.conduct.raised is not None:
            return self.conduct.raised
        if self.run.outcome == "killed":
            return printed.fatal_signal(self.recording.output)
        return printed.last_exception(self.recording.output)

    @cached_property
    def stop(self) -> Stop | None:
        """Where it got stuck."""
        if self.conduct.is_told and self.conduct.stop is not None:
            return self.conduct.stop
        return printed.stuck(self.recording.output) if self.run.outcome == "stalled" else None

    @property
    def ended_s(self) -> float | None:
        """When the program came to its end by itself, without an error; None if it did not."""
        conduct = self.conduct
        if conduct.is_told and conduct.raised is not None and self.run.outcome == "exited":
            return conduct.raised.time_s  # sys.exit()
        return conduct.returned_s if conduct.is_told else None

    @property
    def knows_when(self) -> bool:
        """Whether times are known; in an output they are not."""
        return self.conduct.is_told

    @cached_property
    def ends(self) -> tuple[End, ...]:
        """The submission's ends of topics, services and actions, as far as they are known."""
        if self.conduct.is_told:
            return self.conduct.ends
        listened = {e.name for e in self.scene_has if e.kind == "subscription"}
        return tuple(
            End("publisher", topic.topic, topic.type, topic.topic in listened, 1)
            for topic in self.recording.topics
        )

    @cached_property
    def scene_has(self) -> Sequence[Endpoint]:
        """What the scene publishes, listens to and serves."""
        scene = load_scene(self.recording.scene)
        return scene.endpoints(self.recording.trace, self.run.interfaces)

    @cached_property
    def the_thing(self) -> str:
        """What is driven, with its article: 'the robot'."""
        return load_scene(self.recording.scene).the_thing


def told(text: str) -> Phrase:
    """A text of the submission's as it may stand in a line of ours; the same in any language."""
    return Phrase(clip(one_line(plain(text[: 4 * _LONGEST])), _LONGEST))


def sentences(*texts: str) -> Phrase:
    """One behind the other; those that are '' are left out."""
    return joined([text for text in texts if text], " ")


def line(place: Place | None) -> str:
    """' (drive.py, line 39)', with a space before it; '' for no place."""
    if place is None:
        return ""
    return say(" ({file}, line {line})", file=told(place.file), line=place.line)


def function(place: Place | None) -> str:
    """'on_pose()'; '' for no function."""
    name = told(place.function).rpartition(".")[2] if place is not None else ""
    return f"{name}()" if name else ""


def at(time_s: float | None) -> str:
    """' at 6.0 s', ' right at the start'; '' for no time."""
    if time_s is None:
        return ""
    if time_s < _AT_ONCE_S:
        return say(" right at the start")
    return say(" at {time_s:.1f} s", time_s=time_s)


def after(time_s: float) -> str:
    """'after 6.0 s'."""
    return say("after {time_s:.1f} s", time_s=time_s) if time_s >= _AT_ONCE_S else say("at once")


def since(time_s: float) -> str:
    """' from 1.5 s on', ' from the start'."""
    if time_s < _AT_ONCE_S:
        return say(" from the start")
    return say(" from {time_s:.1f} s on", time_s=time_s)
