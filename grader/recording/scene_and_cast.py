"""The trace of a scene and that of the cast beside it, kept as one: in one bag, with one hash."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

from grader.recording.mcap import Channel
from grader.recording.subject import CAST_SCENE, BagMessage, Keeper, Start, Trace, load_keeper
from grader.ros.bag_types import OF_ROS

#: Before the topics of a cast: a scene may have some of the same names.
PREFIX: Final = "/cast"


@dataclass(frozen=True)
class TwoTraces:
    """Two traces of one run."""

    trace: Trace
    cast: Trace

    @property
    def duration_ns(self) -> int:
        return self.trace.duration_ns

    @property
    def ticks(self) -> int:
        return self.trace.ticks

    def sha256(self) -> str:
        return hashlib.sha256(f"{self.trace.sha256()}{self.cast.sha256()}".encode()).hexdigest()


class CastKeeper(Keeper):
    """Keeps a trace of a scene, and one of a cast, as one."""

    def __init__(self, scene: Keeper) -> None:
        self._scene = scene
        self._cast = load_keeper(CAST_SCENE)

    @property
    def name(self) -> str:  # type: ignore[override]
        return self._scene.name

    def untouched(self, start: Start | None) -> Trace:
        return TwoTraces(self._scene.untouched(start), self._cast.untouched(None))

    def definitions_of(self, trace: Trace) -> Mapping[str, str]:
        assert isinstance(trace, TwoTraces)
        others = self._cast.definitions_of(trace.cast)
        # those of ROS's own may have constants that a cast does not record: a scene's log
        usual = {name: text for name, text in OF_ROS.items() if name in others}
        return {**others, **usual, **self._scene.definitions_of(trace.trace)}

    def bag_topics(self, trace: Trace) -> Iterable[tuple[str, str]]:
        assert isinstance(trace, TwoTraces)
        others = self._cast.bag_topics(trace.cast)
        return [
            *self._scene.bag_topics(trace.trace),
            *((PREFIX + topic, msgtype) for topic, msgtype in others),
        ]

    def to_messages(self, trace: Trace) -> list[BagMessage]:
        assert isinstance(trace, TwoTraces)
        others = self._cast.to_messages(trace.cast)
        made = self._scene.to_messages(trace.trace)
        made += [each._replace(topic=PREFIX + each.topic) for each in others]
        return sorted(made, key=lambda message: message.time_ns)

    def from_channels(self, channels: Sequence[Channel], duration_ns: int) -> Trace:
        prefix = f"{PREFIX}/"
        own = [each for each in channels if not each.topic.startswith(prefix)]
        others = [
            replace(each, topic=each.topic.removeprefix(PREFIX))
            for each in channels
            if each.topic.startswith(prefix)
        ]
        return TwoTraces(
            self._scene.from_channels(own, duration_ns),
            self._cast.from_channels(others, duration_ns),
        )


def merge(trace: Trace, cast: Trace | None, subject: Keeper) -> tuple[Trace, Keeper]:
    """Return a trace with that of the cast beside it, if there is one, and who keeps it."""
    return (trace, subject) if cast is None else (TwoTraces(trace, cast), CastKeeper(subject))


def split(kept: Trace) -> tuple[Trace, Trace | None]:
    return (kept.trace, kept.cast) if isinstance(kept, TwoTraces) else (kept, None)
