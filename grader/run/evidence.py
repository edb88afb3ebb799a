"""What a submission's process tells of itself, on its way to the recording.

Its account lies in a page that both have (`student.account`), and so does what Python's
faulthandler writes at a signal, or where the process dies by a mistake in C. Both are read
strictly: where anything is not as our own code would have written it, nothing was told.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from itertools import chain
from typing import Any

from grader import strict_json, usage
from grader.recording.conduct import STRANGERS, Conduct
from grader.run import dumps
from grader.run.student import account
from grader.run.student.telling import asking_signal
from grader.submission.opening import Submission
from grader.submission.start import Slip

#: How long a process may take to say where it is [s]; it has nothing else to do.
PATIENCE_S = 1.0
#: A dump comes line by line, and is over when nothing more comes for so long [s].
QUIET_S = 0.1
_LISTS = ("ends", "slips", "waits", "slow", "timers", "caught")
#: How often it is looked at meanwhile, and how long a busy machine may keep it waiting [s].
LOOK_S, LONGEST_S = 0.002, 20.0


class Evidence:
    """The grader's side of the page.

    Attributes:
        page: a descriptor that the submission's process inherits.
    """

    def __init__(self) -> None:
        self.page = account.make()
        self._account = self._dump = b""

    def close(self) -> None:
        """Read what was told till now, and give back what is open."""
        if self.page >= 0:
            self._account, _ = account.read(self.page)
            self._dump = account.dumped(self.page)
            os.close(self.page)
            self.page = -1

    def ask(self, pid: int) -> None:
        """Have a process that still runs say where its threads are, and wait for that."""
        before, patience_s = account.dumped(self.page), PATIENCE_S

        def has_more() -> bool:
            return account.dumped(self.page) != before

        with suppress(OSError):
            os.kill(pid, asking_signal())
            while _awaited(pid, has_more, patience_s):
                before, patience_s = account.dumped(self.page), QUIET_S

    def hear_out(self, pid: int) -> None:
        """Wait until a process has said all, or has ended, which it does when its run is over."""
        _awaited(pid, lambda: account.read(self.page)[1], PATIENCE_S)

    def conduct(self, submission: Submission, ended_s: float, *, computes: bool) -> Conduct:
        """All that was told; of a process that has told nothing, or nonsense, that it has not.

        Args:
            ended_s: how far the process has got, on the clock of the run [s].
            computes: it would have gone on without waiting for anything.
        """
        self.close()
        try:
            return _conduct(self._account, self._dump, submission, ended_s, computes)
        except (ValueError, TypeError, LookupError, AttributeError, RecursionError):
            return Conduct()


def _awaited(pid: int, has_come: Callable[[], bool], patience_s: float) -> bool:
    """Whether something comes; while a process waits for a processor, its time stands still."""
    used_s, slept_s = usage.look(pid).cpu_s, 0.0
    gives_up = time.monotonic() + LONGEST_S
    while not has_come():
        now = usage.look(pid)
        if now.has_ended or now.cpu_s - used_s + slept_s >= patience_s:
            return has_come()
        if time.monotonic() > gives_up:
            return False
        time.sleep(LOOK_S)
        slept_s += 0.0 if now.state == "R" else LOOK_S
    return True


@contextmanager
def open_evidence() -> Iterator[Evidence]:
    """A page for one run."""
    evidence = Evidence()
    try:
        yield evidence
    finally:
        evidence.close()


def _conduct(
    data: bytes, dumped: bytes, submission: Submission, ended_s: float, computes: bool
) -> Conduct:
    """Raises ValueError and its like: it is not what our own code writes."""
    dump = dumps.read(dumped.decode("ascii").splitlines())
    if not data and not dump.threads:
        return Conduct()
    told = strict_json.loads(data.decode("ascii")) if data else _nothing()
    if told.pop("is_blind"):
        raise ValueError("our own code does not know this rclpy")
    told |= {"is_told": True, "slips": [_slip(each) for each in submission.slips]}
    own = dumps.Own(submission)
    if all(told[key] is None for key in ("stop", "raised", "returned_s")):
        told |= dumps.ending(dump, own, ended_s, computes=computes)
    for place in _places(told):
        place["file"] = own.as_handed_in(place["file"])
    for error in filter(None, (told["raised"], *told["caught"])):
        error["text"] = submission.as_handed_in(error["text"])[: int(STRANGERS.characters)]
    return Conduct.from_json(told)


def _nothing() -> dict[str, Any]:
    """Of a process that has left no account, and says where it is all the same."""
    lists: dict[str, Any] = {name: [] for name in _LISTS if name != "slips"}
    once = dict.fromkeys(("spun_s", "stop", "raised", "returned_s"))
    return {"is_blind": False, **lists, **once}


def _slip(found: Slip) -> dict[str, Any]:
    """What the source has shown where it was read; it stands with what the process tells."""
    place = {"file": found.file, "line": found.line, "function": "", "text": found.text}
    return {"kind": found.kind, "name": found.name, "near": found.near, "place": place}


def _places(told: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Every place in it that there is."""
    lists = (told[name] for name in _LISTS)
    ends = [end for end in (told["stop"], told["raised"]) if end is not None]
    for end in told["ends"]:
        yield from end["lines"]
    for entry in (*chain.from_iterable(lists), *ends):
        for name in ("place", "used_at", "by"):
            if entry.get(name) is not None:
                yield entry[name]
