"""The exceptions in what a program has printed, which may be made to be hard to read."""

from __future__ import annotations

import re
from pathlib import PurePath

from grader.recording.observations import Raised, SourceLine

# blanks of one line only: lines of nothing would be gone through again from each of them
_FRAME = re.compile(
    r'^[^\S\n]*File "(?P<file>[^"\n]{1,1000})", line (?P<line>\d{1,9})'
    r"(?:, in (?P<function>[^\n]{1,200}))?"
    r'(?:\n[^\S\n]{3,40}(?!\s|File ")(?P<text>[^\n]{0,1000}))?',
    re.MULTILINE,
)
_ERROR = re.compile(r"^(?P<name>[A-Za-z_][\w.]{0,200})(?:: (?P<text>.*))?$")
#: As far as the line that begins with the exception's name.
_IN_THREAD = re.compile(
    r"^(?:Exception in thread [^\n]{0,200}:|[^\n]{0,200}: Error raised in [^\n]{0,400})\n"
    r"(Traceback [^\n]*\n(?:[ \t][^\n]*\n)+[^\n]*)",
    re.MULTILINE,
)
#: Parts of the paths of Python's, ROS's and the grader's files; no submission's.
_LIBRARIES = ("/site-packages/", "/dist-packages/", "/lib/python3", "/grader/run/", "<frozen ")


def is_library(file: str) -> bool:
    """Whether a file is Python's, ROS's or the grader's, and not the submission's."""
    return any(part in file for part in _LIBRARIES)


def thread_exception(text: str) -> Raised | None:
    """Parse the first exception that ended a thread, as Python prints it."""
    found = _IN_THREAD.search(text)
    return last_exception(found[0]) if found else None


def last_exception(text: str) -> Raised | None:
    """Parse the last traceback: its exception, at the last line of the submission's files."""
    start = text.rfind("Traceback (most recent call last)")
    # a SyntaxError in the file that was started has no traceback of its own
    part = text[max(start, 0) :]
    frames = list(_FRAME.finditer(part))
    if not frames:
        return None
    lines = part[frames[-1].end() :].splitlines()
    error = next((match for line in lines if (match := _ERROR.match(line))), None)
    if error is None:
        return None
    return Raised(error["name"], error["text"] or "", 0.0, _submission_line(frames))


def _submission_line(frames: list[re.Match[str]]) -> SourceLine | None:
    """Return the last of the frames that is no library's."""
    frame = next((f for f in reversed(frames) if not is_library(f["file"])), None)
    if frame is None:
        return None
    function, text = (frame["function"] or "").strip(), (frame["text"] or "").strip()
    function = "" if function.startswith("<") else function
    return SourceLine(PurePath(frame["file"]).name, int(frame["line"]), function, text)
