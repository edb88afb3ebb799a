"""What is behind something that was found."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Cause:
    """What went wrong: a sentence with numbers, and what to do."""

    text: str
    help: str
