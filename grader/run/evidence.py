"""What a submission's process tells of itself, on its way to the recording.

A pipe, into which the process writes lines of JSON (`student.telling`) and, at a signal or where it
dies by a mistake in C, where its threads are (Python's faulthandler). A pipe holds 64 KB at most,
whoever writes. What is in it is read when the process has ended, strictly: where anything of it is
not as our own code would have written it, nothing was told.
"""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from itertools import chain
from typing import Any

from grader import strict_json
from grader.recording.conduct import Conduct
from grader.run import dumps
from grader.run.processes import usage
from grader.run.processes.process import await_readable
from grader.run.student.telling import asking_signal
from grader.submission.opening import Submission
from grader.submission.start import Slip

MOST_BYTES = 65_536
#: How long a process may take to say where it is [s]; it has nothing else to do.
PATIENCE_S = 1.0
#: It writes line by line, and has said all when nothing more comes for so long [s].
QUIET_S = 0.1
#: How often it is looked at meanwhile, and how long a busy machine may keep it waiting [s].
LOOK_S, LONGEST_S = 0.05, 20.0
#: What is told by number, and again when it is more -> where it is kept.
_LISTS = {"wait": "waits", "slow": "slow", "timer": "timers", "caught": "caught"}


class Evidence:
    """The grader's end of the pipe.

    Attributes:
        descriptor: what the submission's process inherits; -1: it can inherit none.
    """

    def __init__(self) -> None:
        self._reads, self.descriptor = os.pipe()
        self._data = b""
        if self._reads >= 0:
            os.set_blocking(self._reads, False)

    def has_begun(self) -> None:
        """The process has its end of the pipe now; ours of it is closed."""
        if self.descriptor >= 0:
            os.close(self.descriptor)
            self.descriptor = -1

    def close(self) -> None:
        """Give back what is open; what was told can be asked for afterwards."""
        self.has_begun()
        self._read()
        if self._reads >= 0:
            os.close(self._reads)
            self._reads = -1

    def ask(self, pid: int) -> None:
        """Have a process that still runs say where its threads are, and wait for that."""
        number = asking_signal()
        self._read()
        if self._reads >= 0 and number:
            with suppress(OSError):
                os.kill(pid, number)
                self.hear_out(pid, QUIET_S)

    def hear_out(self, pid: int, quiet_s: float = PATIENCE_S) -> None:
        """Wait until a process has said all, or has ended, which it does when its run is over.

        Args:
            quiet_s: it says nothing more where after a line nothing comes for so long.
        """
        patience_s = PATIENCE_S
        while len(self._data) < MOST_BYTES and self._says_more(pid, patience_s) and self._read():
            patience_s = quiet_s

    def _says_more(self, pid: int, patience_s: float) -> bool:
        """Whether a process says more; while it waits for a processor, its time stands still."""
        if self._reads < 0:
            return False
        used_s, slept_s = usage.look(pid).cpu_s, 0.0
        gives_up = time.monotonic() + LONGEST_S
        while not await_readable(self._reads, LOOK_S):
            now = usage.look(pid)
            if now.has_ended:  # something that it has started keeps the pipe open
                return await_readable(self._reads, 0.0)
            slept_s += 0.0 if now.state == "R" else LOOK_S
            if now.cpu_s - used_s + slept_s >= patience_s or time.monotonic() > gives_up:
                return False
        return True

    def conduct(self, submission: Submission, ended_s: float, *, computes: bool) -> Conduct:
        """All that was told; of a process that has told nothing, or nonsense, that it has not.

        Args:
            ended_s: how far the process has got, on the clock of the run [s].
            computes: it would have gone on without waiting for anything.
        """
        self._read()
        if not self._data:
            return Conduct()
        try:
            return _conduct(self._data.decode("ascii"), submission, ended_s, computes)
        except (ValueError, TypeError, LookupError, AttributeError, RecursionError):
            return Conduct()

    def _read(self) -> bool:
        """Take what is there; whether that was anything."""
        before = len(self._data)
        with suppress(OSError):
            while self._reads >= 0 and len(self._data) <= MOST_BYTES:
                chunk = os.read(self._reads, MOST_BYTES)
                self._data += chunk
                if not chunk:
                    break
        return len(self._data) > before


@contextmanager
def open_evidence() -> Iterator[Evidence]:
    """A pipe for one run."""
    evidence = Evidence()
    try:
        yield evidence
    finally:
        evidence.close()


def _conduct(text: str, submission: Submission, ended_s: float, computes: bool) -> Conduct:
    """Raises ValueError and its like: it is not what our own code writes."""
    if len(text) > MOST_BYTES:
        raise ValueError(f"more than {MOST_BYTES} bytes")
    told: dict[str, Any] = {
        **{"is_told": True, "ends": [], "spun_s": None, "waits": [], "slow": []},
        **{"timers": [], "caught": [], "slips": [_slip(each) for each in submission.slips]},
        **{"stop": None, "raised": None, "returned_s": None},
    }
    lines = text.splitlines()
    dump = dumps.read([line for line in lines if not line.startswith("{")])
    said = [line for line in lines if line.startswith("{")]
    if not said and not dump.threads:
        return Conduct()
    for line in said:
        _add(told, strict_json.loads(line))
    own = dumps.Own(submission)
    if all(told[key] is None for key in ("stop", "raised", "returned_s")):
        told.update(dumps.ending(dump, own, ended_s, computes=computes))
    for place in _places(told):
        place["file"] = own.as_handed_in(place["file"])
    return Conduct.from_json(told)


def _add(told: dict[str, Any], line: Any) -> None:
    ((what, value),) = line.items()
    match what:
        case "end":
            unsent: dict[str, Any] = {"used_at": None, "lines": [], "sent": []}
            told["ends"].append({**value, "is_met": False, "used": 0, **unsent})
        case "used":
            number, used, is_met = value
            told["ends"][number].update(used=used, is_met=is_met)
        case "used_at":
            number, place = value
            told["ends"][number].update(used_at=place)
        case "sent":
            number, lines, sent = value
            bursts = [{"line": line, "times": times} for line, times in sent]
            told["ends"][number].update(lines=lines, sent=bursts)
        case "wait" | "slow" | "timer" | "caught":
            number, value = value
            entries = told[_LISTS[what]]
            if number == len(entries):
                entries.append(value)
            else:
                entries[number] = value
        case "begun":  # it has started, whatever becomes of it
            pass
        case "spun":
            told["spun_s"] = value
        case "returned":
            told["returned_s"] = value
        case "stop" | "raised":
            told[what] = value
        case _:  # also `blind`: our own code does not know this rclpy
            raise ValueError(f"told of {what!r:.40}")


def _slip(found: Slip) -> dict[str, Any]:
    """What the source has shown where it was read; it stands with what the process tells."""
    place = {"file": found.file, "line": found.line, "function": "", "text": found.text}
    return {"kind": found.kind, "name": found.name, "near": found.near, "place": place}


def _places(told: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Every place in it that there is."""
    lists = (told[name] for name in ("ends", "slips", *_LISTS.values()))
    ends = [end for end in (told["stop"], told["raised"]) if end is not None]
    for end in told["ends"]:
        yield from end["lines"]
    for entry in (*chain.from_iterable(lists), *ends):
        for name in ("place", "used_at", "by"):
            if entry.get(name) is not None:
                yield entry[name]
