"""Takes down every message on the robot's topics while they come."""

from __future__ import annotations

from collections import Counter

from grader.scenes.robot.trace import Heard, RobotTrace

#: Messages of a run, and their bytes: far above what moves a robot.
MOST_MESSAGES, MOST_BYTES = 20_000, 20_000_000


class Recorder:
    """Knows what the scene has published itself when it is heard again.

    Attributes:
        ticks: how many have been recorded.
        heard: messages of the submission's.
        flags: what of them was not taken.
    """

    def __init__(self) -> None:
        self.ticks = 0
        self.heard = 0
        self.flags: tuple[str, ...] = ()
        self._messages: list[Heard] = []
        self._bytes = 0
        self._own: Counter[tuple[str, bytes]] = Counter()

    def publishes(self, topic: str, data: bytes) -> None:
        """The scene publishes a message, and will hear it as anybody's."""
        self._own[topic, data] += 1
        self._messages.append(Heard(self.ticks + 1, topic, "scene", data))

    def hears(self, topic: str, data: bytes) -> bool:
        """A message is heard; whether it is the submission's, and taken."""
        if self._own[topic, data]:
            self._own[topic, data] -= 1
            return False
        self.heard += 1
        self._bytes += len(data)
        if self.heard > MOST_MESSAGES or self._bytes > MOST_BYTES:
            most = f"the first {MOST_MESSAGES}, or {MOST_BYTES // 1_000_000} MB"
            self.flags = (f"of the node's messages {most}, were taken",)
            return False
        self._messages.append(Heard(self.ticks + 1, topic, "submission", data))
        return True

    def trace(self) -> RobotTrace:
        """Everything up to now."""
        return RobotTrace(self.ticks, tuple(self._messages))
