"""What a program's output tells of its end, where its process has told nothing by itself.

That is so for recordings of older graders. What a program prints is as untrusted as what it tells.
"""

from __future__ import annotations

import re
from pathlib import PurePath

from grader.recording.conduct import Place, Raised, Stop, StopKind

#: So much of the end of an output is looked at [characters].
_LOOKED_AT = 65_536
# blanks of one line only: lines of nothing would be gone through again from each of them
_FRAME = re.compile(
    r'^[^\S\n]*File "(?P<file>[^"\n]{1,1000})", line (?P<line>\d{1,9})'
    r"(?:,? in (?P<function>[^\n]{1,200}))?"
    r'(?:\n[^\S\n]{3,40}(?!\s|File ")(?P<text>[^\n]{0,1000}))?',
    re.MULTILINE,
)
_ERROR = re.compile(r"^(?P<name>[A-Za-z_][\w.]{0,200})(?:: (?P<text>.*))?$")
_STUCK = re.compile(r"^Your node is stuck here, at (?P<time>\d{1,9}\.\d\d) s:", re.MULTILINE)
_FATAL = re.compile(r"^Fatal Python error: (?P<what>[^\n]{1,100})", re.MULTILINE)
#: As far as the line that begins with the exception's name.
_IN_THREAD = re.compile(
    r"^Exception in thread [^\n]{0,200}:\n(Traceback [^\n]*\n(?:[ \t][^\n]*\n)+[^\n]*)",
    re.MULTILINE,
)
#: Of Python's, of ROS's and of our own files; no submission's.
_LIBRARIES = ("/site-packages/", "/dist-packages/", "/lib/python3", "/grader/run/", "<frozen ")
#: Python's words for the signals that end a program.
_SIGNALS = {
    "Aborted": "SIGABRT",
    "Segmentation fault": "SIGSEGV",
    "Bus error": "SIGBUS",
    "Floating-point exception": "SIGFPE",
}


def end(output: str) -> str:
    """The part of it that is looked at."""
    return output[-_LOOKED_AT:]


def last_line(output: str) -> str:
    """The last line with anything in it; '' for none."""
    return next((line for line in reversed(end(output).splitlines()) if line.strip()), "")


def is_library(file: str) -> bool:
    """Whether a file is of Python's, of ROS's or our own, and no submission's."""
    return any(part in file for part in _LIBRARIES)


def in_thread(output: str) -> Raised | None:
    """The first exception that ended a thread, as Python tells of it."""
    found = _IN_THREAD.search(end(output))
    return last_exception(found[0]) if found else None


def last_exception(output: str) -> Raised | None:
    """The exception of the last traceback, with the last line of the submission's own in it."""
    text = end(output)
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
    return Raised(error["name"], error["text"] or "", 0.0, _own_place(frames))


def fatal_signal(output: str) -> Raised | None:
    """The signal by which the program ended itself, as Python's fault handler has told it."""
    text = end(output)
    found = list(_FATAL.finditer(text))
    if not found:
        return None
    frames = list(_FRAME.finditer(text, found[-1].end()))
    signal = _SIGNALS.get(found[-1]["what"].strip(), "")
    return Raised(signal, "", 0.0, _own_place(frames[::-1])) if signal else None


def stuck(output: str) -> Stop | None:
    """Where a node waited for what could no longer happen."""
    text = end(output)
    found = list(_STUCK.finditer(text))
    if not found:
        return None
    part = text[found[-1].end() :]
    kind: StopKind = "callback" if "\nThis is a callback." in part else "call"
    return Stop(kind, float(found[-1]["time"]), "", _own_place(list(_FRAME.finditer(part))))


def _own_place(frames: list[re.Match[str]]) -> Place | None:
    """The last of the frames that is no library's."""
    own = (f for f in reversed(frames) if not is_library(f["file"]))
    frame = next(own, None)
    if frame is None:
        return None
    function, text = (frame["function"] or "").strip(), (frame["text"] or "").strip()
    function = "" if function.startswith("<") else function
    return Place(PurePath(frame["file"]).name, int(frame["line"]), function, text)
