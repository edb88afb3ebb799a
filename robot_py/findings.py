"""What there is to say of a URDF, in urdfdom's own words."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Consequence(StrEnum):
    """What became of the robot."""

    #: There is no robot: robot_state_publisher ends, or refuses the change.
    REFUSED = "refused"
    #: An `Error:` line, yet a robot: it goes without the rest of that link, or that colour.
    DROPPED = "dropped"
    #: Nothing is left out.
    WARNED = "warned"


@dataclass(frozen=True, slots=True)
class Finding:
    """One line of what urdfdom prints.

    Attributes:
        text: without the `Error:` or `Warning:` that stands before it.
        line: of the element that it is about, in the file, from 1; 0 where it is about the whole.
    """

    consequence: Consequence
    text: str
    line: int = 0

    def __str__(self) -> str:
        """As console_bridge prints it, but for the second line, which names a place in urdfdom."""
        prefix = "Warning: " if self.consequence is Consequence.WARNED else "Error:   "
        return prefix + self.text


class Malformed(ValueError):
    """A part of a URDF that urdfdom gives up: the lines that it prints, innermost first."""

    def __init__(self, *texts: str, line: int = 0) -> None:
        super().__init__(*texts)
        self.texts = texts
        self.line = line

    def within(self, text: str) -> Malformed:
        """The same, and what the part around it adds."""
        return Malformed(*self.texts, text, line=self.line)

    def findings(self, consequence: Consequence) -> list[Finding]:
        """One for each line."""
        return [Finding(consequence, text, self.line) for text in self.texts]
