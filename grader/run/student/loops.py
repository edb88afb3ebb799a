"""The loop that a program is in, and whether it has got out of its `__init__`.

Nothing is parsed: a file can be made so that Python's parser does not survive it.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

#: How a loop begins, one that has no condition, and what else is looked no further than.
LOOP = re.compile(r"\s*(?:async\s+)?(?:while|for)\b")
ENDLESS = re.compile(r"while\s*\(?(?:True|1)\)?\s*:.*")
BLOCK = re.compile(r"\s*(?:async\s+)?(?:def|class)\b")
MOST_INDENT = 10_000
#: Where callbacks are called from, and what spins.
CALLBACK = "rclpy/task.py"
SPINS = ("rclpy/executors.py", "rclpy/__init__.py")


@dataclass(frozen=True)
class Seen:
    """A frame of a thread.

    Attributes:
        source: the lines of its file where that is the submission's own; None for others.
    """

    file: str
    function: str
    line: int
    source: Sequence[str] | None


@dataclass(frozen=True)
class Standing:
    """Where a thread was that had not ended.

    Attributes:
        kind: as in `grader.recording.conduct.Stop`.
        at: which of its frames that is.
        line: of that frame's file.
    """

    kind: str
    at: int
    line: int


def standing(frames: Sequence[Seen]) -> Standing | None:
    """Where a main thread was at the end of a run, innermost first; None where it just spun."""
    own = next((at for at, frame in enumerate(frames) if frame.source is not None), -1)
    if own < 0:
        return None
    spins = any(frame.function == "spin" and frame.file.endswith(SPINS) for frame in frames[:own])
    in_callback = any(frame.file.endswith(CALLBACK) for frame in frames)
    inits = (at for at, frame in enumerate(frames) if frame.source is not None)
    init = max((at for at in inits if frames[at].function == "__init__"), default=-1)
    if init >= 0 and not in_callback:
        if spins:
            return Standing("init", own, frames[own].line)  # no chance: there it stays
        found = head(frames[own : init + 1])
        at, line = (own + found[0], found[1]) if found else (init, frames[init].line)
        return Standing("init", at, line)
    if spins and around(frames[own].source or (), frames[own].line):
        return Standing("spin", own, frames[own].line)
    if any("spin" in frame.function and frame.file.endswith(SPINS) for frame in frames[:own]):
        return None
    found = head(frames[own:])
    return Standing("going", own + found[0], found[1]) if found else None


def head(frames: Sequence[Seen]) -> tuple[int, int] | None:
    """Where the loop begins in which a thread is: which frame, which line; None for no loop.

    Where in it the thread is, is chance; where it begins, is not. Of several it is the innermost
    that has no condition, else the outermost.
    """
    heads: list[tuple[int, int]] = []
    texts: dict[tuple[int, int], str] = {}
    for at, frame in enumerate(frames):
        if frame.source is None:
            break
        for number in around(frame.source, frame.line):
            heads.append((at, number))
            texts[at, number] = frame.source[number - 1].split("#")[0].strip()
    endless = [each for each in heads if ENDLESS.fullmatch(texts[each])]
    whiles = [each for each in heads if texts[each].startswith("while")]
    return next(iter(endless or whiles[::-1] or heads[::-1]), None)


def around(lines: Sequence[str], number: int) -> list[int]:
    """The first lines of the loops that a line is in, innermost first, by indentation."""
    found, indent = [], MOST_INDENT
    for at in range(min(number, len(lines)), 0, -1):
        text = lines[at - 1].expandtabs()
        blanks = len(text) - len(text.lstrip())
        if blanks == len(text) or blanks >= indent or text.lstrip().startswith("#"):
            continue
        indent = blanks
        if LOOP.match(text):
            found.append(at)
        elif BLOCK.match(text):
            break
    return found
