"""Takes down every message on the robot's topics while they come."""

from __future__ import annotations

from collections import Counter

from grader.language.phrase import say
from grader.scenes.robot.trace import Heard, RobotTrace

#: Messages of a run, and their bytes: far above what moves a robot.
MOST_MESSAGES, MOST_BYTES = 20_000, 20_000_000
#: With the numbers in it: it goes from process to process as a text, by which it is found again.
_NOT_ALL = say("of the node's messages the first 20000, or 20 MB, were taken")


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
            self.flags = (_NOT_ALL,)
            return False
        self._messages.append(Heard(self.ticks + 1, topic, "submission", data))
        return True

    def trace(self) -> RobotTrace:
        """Everything up to now."""
        return RobotTrace(self.ticks, tuple(self._messages))
