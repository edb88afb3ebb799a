"""From which lines of the submission's own somebody sends, in order; told when the run is over."""

from __future__ import annotations

from types import CodeType, FrameType

#: So many lines of one end, and changes between them, are kept.
MOST_LINES, MOST_CHANGES = 8, 150


class Sending:
    """What is sent through one end.

    Attributes:
        sent: [[number of the line, how often in a row], ...].
    """

    def __init__(self) -> None:
        self.sent: list[list[int]] = []
        self._numbers: dict[tuple[CodeType, int], int] = {}
        self._is_full = False

    @property
    def lines(self) -> list[tuple[CodeType, int]]:
        """The lines, by their numbers."""
        return list(self._numbers)

    def count(self, frame: FrameType | None) -> None:
        """Count one more, sent from where this frame is.

        None, or too many of them: nothing is counted from here on, so that what was counted stays
        the first that was sent.
        """
        if self._is_full or frame is None:
            self._is_full = True
            return
        line = (frame.f_code, frame.f_lineno)
        number = self._numbers.get(line, len(self._numbers))
        if self.sent and self.sent[-1][0] == number:
            self.sent[-1][1] += 1
        elif number >= MOST_LINES or len(self.sent) >= MOST_CHANGES:
            self._is_full = True
        else:
            self._numbers[line] = number
            self.sent.append([number, 1])
