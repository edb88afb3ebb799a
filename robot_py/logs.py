"""What a node would print, as data."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Severity(StrEnum):
    """ROS's levels, of those that the two nodes use."""

    INFO = "INFO"
    WARN = "WARN"
    ERROR = "ERROR"
    FATAL = "FATAL"


@dataclass(frozen=True, slots=True)
class Log:
    """A line in the log.

    Attributes:
        logger: who says it; '' for the node itself.
    """

    severity: Severity
    text: str
    logger: str = ""
