"""What of its scene a hand-in may use: the keys `may` and `drives` of an exercise.yaml.

    may: [spawn, set_pen]
    drives: [turtle2]

What goes beyond fails a check of its own, `allowed`, which `points` lists, be it with 0. What it
moved ends there for all checks: nobody has driven it. It may read everything.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Final

from grader.exercise.asking import Check
from grader.exercise.verdict import Evidence, Finding
from grader.recording.recording import Recording, Recordings
from grader.scenes.scene import STEP_NS
from grader.scenes.subject import Rules, Subject
from grader.system.yaml_file import decoded, expect
from grader.text.message import NOTHING, Message, msg

KEYS: Final = ("may", "drives")


@dataclass(frozen=True)
class Allowed:
    """The rules of an exercise for its scene."""

    subject: Subject
    rules: Rules

    @property
    def text(self) -> Message:
        """What a program may use, for the sheet."""
        names = [*self.rules.may, *(f"{each}/cmd_vel" for each in self.rules.drives)]
        return msg(
            "Of the simulator's services, actions and commands your program may use only {names}; "
            "it may read everything. What else it moves counts as driven by nobody.",
            names=", ".join(f"`{name}`" for name in names),
        )

    @property
    def check(self) -> Check:
        title = msg("It uses only what it may of the simulator")
        return Check("allowed", title, self._judge, (), self.text, "who does nothing may")

    def within(self, recording: Recording) -> Recording:
        """Return a recording without what was moved by what goes beyond."""
        trace, _beyond = self.subject.within(recording.trace, recording.cast, self.rules)
        return replace(recording, trace=trace)

    def _judge(self, recordings: Recordings, tolerances: Mapping[str, Any]) -> Finding:
        for number, each in enumerate(recordings):
            _, beyond = self.subject.within(each.trace, each.cast, self.rules)
            for time_ns, name in beyond[:1]:
                text = _told(name, time_ns, each)
                seen = Evidence(time_ns / 1e9, text, run=number, tick=time_ns // STEP_NS)
                return Finding(0, text, self.text, (seen,))
        return Finding(1, msg("It used only what it may."))


def _told(name: str, time_ns: int, recording: Recording) -> Message:
    """Say what was used, and from which line, where that is known."""
    where = NOTHING
    for end in recording.observations.ends:
        if end.name == name and end.kind != "subscription" and (line := end.used_at):
            where = msg(" ({file}, line {line})", file=line.file, line=str(line.line))
    return msg("Your program used {name} at {time} s{where}.",
               name=name, time=f"{time_ns / 1e9:.2f}", where=where)  # fmt: skip


def read_allowed(data: Mapping[str, Any], subject: Subject, setting: str) -> Allowed | None:
    """Read what an exercise lets a program use; None: everything."""
    if not data.keys() & {*KEYS}:
        return None
    may, drives = (decoded(tuple[str, ...], data.get(key) or [], key) for key in KEYS)
    unknown = [each for each in may if each.rpartition("/")[2] not in subject.inputs]
    for key, found in zip(KEYS, (unknown, [] if subject.inputs else [*drives]), strict=True):
        known = ", ".join(subject.inputs) or msg("none")
        expect(not found, (key,), "expected some of {known}, found {found}", found, known=known)
    return Allowed(subject, Rules(may, drives, setting))
