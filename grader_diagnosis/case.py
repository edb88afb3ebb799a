"""A run as the rules see it, and their words for a place and a time.

Where a process has reported no observations, its output is searched for how it ended. What a
program prints is as untrusted as what it reports.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from string import Formatter
from typing import Any

from grader import Recording
from grader.exercise import Diagnosis
from grader.recording import Endpoint, EndpointKind, ProgramRun, Run
from grader.recording.observations import (
    End,
    EndKind,
    LintFinding,
    Observations,
    Raised,
    SourceLine,
    Standstill,
    last_exception,
)
from grader.scenes import load_subject
from grader.text import NOTHING, Message, joined, msg, shown

#: The endpoint that an end of the submission's needs on the other side.
OPPOSITE: dict[EndKind, EndpointKind] = {
    "subscription": "publisher",
    "publisher": "subscription",
    "client": "service",
    "action_client": "action",
}
#: Shown as 0.0 [s].
_AT_ONCE_S = 0.05
#: So much of the end of an output is searched [characters].
_TAIL = 65_536
#: Of the submission's ends those that others can meet.
_OFFERED: Mapping[str, EndpointKind] = {
    "publisher": "publisher",
    "subscription": "subscription",
    "service": "service",
    "action_server": "action",
}


@dataclass(frozen=True)
class Case:
    """All that is known of one run.

    Attributes:
        is_to_end: whether the program is to end by itself.
        peers_have: what of the scripted peers it may meet.
    """

    recording: Recording
    is_to_end: bool = False
    peers_have: tuple[Endpoint, ...] = ()

    @property
    def run(self) -> Run:
        return self.recording.run

    @property
    def observed(self) -> Observations:
        """The observations that its process has reported."""
        return self.recording.observations

    @property
    def tail(self) -> str:
        """The end of its output, as far as that is searched; of several, that of who has failed."""
        output = self.recording.output if self.failed is None else self.failed.output
        return output[-_TAIL:]

    @property
    def several(self) -> Sequence[ProgramRun]:
        """The programs, where there are several; a single one is not told apart."""
        return self.run.programs if len(self.run.programs) > 1 else ()

    @cached_property
    def failed(self) -> ProgramRun | None:
        """The one of several programs that the outcome is due to; None where none has failed."""
        run = self.run
        if run.outcome == "finished":
            return None
        ends = (each for each in self.several if each.outcome == run.outcome)
        return next((each for each in ends if each.exit_code == run.exit_code), None)

    @cached_property
    def heard(self) -> frozenset[str]:
        """The topics on which the exercise hears what several programs send to each other."""
        messages = getattr(self.recording.trace, "messages", ()) if self.several else ()
        return frozenset(each.topic for each in messages)

    @property
    def last_line(self) -> str:
        """The last line of its output with anything in it; '' for none."""
        return next((line for line in reversed(self.tail.splitlines()) if line.strip()), "")

    @cached_property
    def raised(self) -> Raised | None:
        """The exception or signal that ended it; only for a run that ended so."""
        if self.run.outcome not in ("crashed", "killed"):
            return None
        if self.observed.is_known and self.observed.raised is not None:
            return self.observed.raised
        crashed = self.run.outcome == "crashed"
        return last_exception(self.tail) if crashed else None

    @property
    def is_shut_down(self) -> bool:
        """Whether it has shut ROS down itself, and then went on spinning: that is no crash."""
        raised = self.raised
        return raised is not None and raised.type.endswith("ExternalShutdownException")

    @property
    def stop(self) -> Standstill | None:
        """The place where it got stuck; None for none."""
        return self.observed.stop if self.observed.is_known else None

    @property
    def ended_s(self) -> float | None:
        """When the program ended by itself, without an error; None if it did not."""
        observed = self.observed
        has_one_ended = any(each.exit_code == 0 for each in self.several)
        is_end = self.run.outcome == "exited" or self.is_shut_down or has_one_ended
        if observed.is_known and observed.raised is not None and is_end:
            return observed.raised.time_s  # sys.exit()
        return observed.returned_s if observed.is_known else None

    @cached_property
    def ends(self) -> tuple[End, ...]:
        """The submission's ends of topics, services and actions, as far as they are known."""
        if self.observed.is_known:
            return self.observed.ends
        listened = {e.name for e in self.scene_has if e.kind == "subscription"}
        return tuple(
            End("publisher", topic.topic, topic.type, topic.topic in listened, 1)
            for topic in self.recording.topics
        )

    @cached_property
    def scene_has(self) -> Sequence[Endpoint]:
        """The endpoints of the scene and the peers: topics, services and actions."""
        scene = load_subject(self.recording.scene)
        return (*scene.endpoints(self.recording.trace, self.run.interfaces), *self.peers_have)

    @cached_property
    def all_have(self) -> Sequence[Endpoint]:
        """Those, and of several programs what they have for each other."""
        ends = self._each_others
        own = (Endpoint(_OFFERED[e.kind], e.name, e.type) for e in ends if e.kind in _OFFERED)
        return (*self.scene_has, *own)

    @cached_property
    def near_misses(self) -> Sequence[Endpoint]:
        """Those that may have been meant: of the programs' own, what meets nobody."""
        met = {(each.name, each.type) for each in self._each_others if each.is_met}
        known = {*self.scene_has}
        return [e for e in self.all_have if e in known or (e.name, e.type) not in met]

    @property
    def _each_others(self) -> Sequence[End]:
        """The ends that several programs may have for each other; a single one has none."""
        return self.observed.ends if self.several else ()

    def whose(self, endpoint: Endpoint) -> str | Message:
        """Return a name for the node of an endpoint."""
        is_known = endpoint in self.scene_has
        return endpoint.node or (self.the_thing if is_known else msg("another node"))

    @cached_property
    def the_thing(self) -> Message:
        """What the submission drives, with its article: 'the robot'."""
        return load_subject(self.recording.scene).the_thing


def of_kind(case: Case, *kinds: str) -> Iterator[LintFinding]:
    """Yield the lint findings of these kinds."""
    return (finding for finding in case.observed.lint_findings if finding.kind in kinds)


def first_of(case: Case, kind: str) -> SourceLine | None:
    """Return the place of the first finding of a kind."""
    return next((finding.place for finding in of_kind(case, kind)), None)


def sentences(*texts: Message) -> Message:
    """Join sentences by blanks; empty ones are left out."""
    return joined([text for text in texts if text], " ")


def line(place: SourceLine | None) -> Message:
    """' (drive.py, line 39)', with a space before it; '' for no place."""
    if place is None:
        return NOTHING
    return msg(" ({file}, line {line})", file=shown(place.file), line=place.line)


def function(place: SourceLine | None) -> str:
    """'on_pose()'; '' for no function."""
    name = shown(place.function).rpartition(".")[2] if place is not None else ""
    return f"{name}()" if name else ""


def at(time_s: float | None) -> Message:
    """' at 6.0 s', ' right at the start'; '' for no time."""
    if time_s is None:
        return NOTHING
    if time_s < _AT_ONCE_S:
        return msg(" right at the start")
    return msg(" at {time_s:.1f} s", time_s=time_s)


def after(time_s: float) -> Message:
    """'after 6.0 s'."""
    return msg("after {time_s:.1f} s", time_s=time_s) if time_s >= _AT_ONCE_S else msg("at once")


def since(time_s: float) -> Message:
    """' from 1.5 s on', ' from the start'."""
    if time_s < _AT_ONCE_S:
        return msg(" from the start")
    return msg(" from {time_s:.1f} s on", time_s=time_s)


def filled(sentence: Message, words: Mapping[str, Any]) -> Message:
    """Return a sentence with those of the words that it has names for, and no values yet."""
    names = {name for _, name, _, _ in Formatter().parse(sentence.key)} - sentence.values.keys()
    return sentence.given(**{name: word for name, word in words.items() if name in names})


def words_of(finding: LintFinding) -> dict[str, Any]:
    """Return the words of sentences about a lint finding."""
    code, where = shown(finding.place.text), line(finding.place)
    return {
        "name": shown(finding.name),
        "near": shown(finding.near),
        "code": code,
        "where": where,
    }


def diagnosed(
    key: str,
    cause: Message,
    help_: Message,
    place: SourceLine | None = None,
    time_s: float | None = None,
    /,
    **words: Any,
) -> Diagnosis:
    """Make a diagnosis; its sentences may name its place `{where}`, its time `{at}`, and words."""
    words = {"where": line(place), "at": at(time_s), **words}
    return Diagnosis(key, filled(cause, words), filled(help_, words), time_s=time_s, place=place)


def diagnosed_by(finding: LintFinding, key: str, cause: Message, help_: Message) -> Diagnosis:
    """Make a diagnosis of a lint finding, at its place."""
    return diagnosed(key, cause, help_, finding.place, **words_of(finding))
