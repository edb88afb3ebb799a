"""What a simulator's process does by either clock: protect itself, run a scene, send news.

It sends its progress to the grader. To the audience of a run it sends news of the scene, and keeps
the run slow enough to watch: over a socket from which it reads nothing, so that the outcome of a
run does not depend on its audience. News that is not received at once is kept, up to a limit; then
the run waits a little, and then it goes on without an audience. Both are JSON lines.
"""

from __future__ import annotations

import json
import resource
import select
import signal
import socket
import time
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from grader.recording.subject import overdue, scene_at_work
from grader.run import handover
from grader.run.handover import Plan
from grader.run.limits import SCENE_S, SIMULATOR_BYTES
from grader.scenes.scene import STEP_NS, Hooks, Reason, expect_reason, load_scene
from grader.system import linux
from grader.text.message import Message

if TYPE_CHECKING:
    from grader.scenes.cast.playing import Playing

#: So much may wait to be received [bytes]; then the run waits so long for that, in all [s].
MOST_BYTES: Final = 8_000_000
PATIENCE_S: Final = 10.0
#: A run that is this late does not hurry to make up for it [s].
LATE_S: Final = 0.1
#: The last line of a run whose news was sent to its end.
END: Final = {"over": True}


def protect_process() -> None:
    """Protect this process from the submission, and the machine from it; call this first."""
    linux.control(linux.PR_SET_DUMPABLE, 0)  # nobody else reads our memory and descriptors
    linux.lower_limit(resource.RLIMIT_DATA, SIMULATOR_BYTES, resource.RLIM_INFINITY)
    # Ctrl-C in a terminal reaches the whole group; the grader decides what happens then.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGALRM, overdue)


class SceneRun:
    """A scene at work, with its cast and its audience."""

    def __init__(
        self,
        plan: Plan,
        shown: str,
        wire: Any,
        has_unread: Callable[[], bool] = lambda: True,
        *,
        are_compiled: bool = False,
    ) -> None:
        """Set up the scene; ROS is up.

        Args:
            shown: the argument of a `LiveFeed`; '' where there is no audience.
            wire: a `grader.scenes.cast.playing.Wire`, for a cast.
            has_unread: as in `Hooks`.
            are_compiled: whether interfaces that are not installed were compiled for this run.
        """
        self._scene = load_scene(plan.scene)
        self._feed = FeedWriter(**json.loads(shown)) if shown else None
        self._cast: Playing | None = None
        if plan.cast is not None:
            from grader.scenes.cast import script  # here: most runs have none
            from grader.scenes.cast.playing import Playing

            definitions = {**plan.own_definitions, **plan.definitions}
            peers, end_s = script.parse(plan.cast), plan.limits.total_s
            self._cast = Playing(
                peers, plan.hears, definitions, end_s, wire, are_compiled=are_compiled
            )
        hooks = Hooks(has_unread, None if self._feed is None else self._feed.write, self._cast)
        with self._in_time():
            self._simulation = self._scene.simulate(
                plan.limits, plan.start, hooks, plan.interfaces, plan.setting
            )

    def _in_time(self) -> AbstractContextManager[None]:
        """Raise a `SceneFailure` also for the scene's code that takes longer than `SCENE_S`."""
        return scene_at_work(self._scene.name, within_s=SCENE_S)

    def _tick_scene(self, *now_ns: int) -> Reason:
        with self._in_time():
            reason = self._simulation.tick(*now_ns)
        return expect_reason(self._scene.name, reason)

    def _scene_flags(self) -> tuple[Message, ...]:
        """The remarks of the scene and its cast."""
        return (*self._simulation.flags, *(() if self._cast is None else self._cast.flags))

    def _save(self, file: Path, published: Mapping[str, str]) -> None:
        """Write the recording where the grader finds it.

        Args:
            published: the topics on which the submission has published: topic -> type.
        """
        with self._in_time():
            trace = self._simulation.trace()
            handover.leave(file, self._scene, trace, published, self._cast)


def send_message(control: socket.socket, what: str, **more: Any) -> None:
    """Send a message between the grader and the simulator, either way; wait until it is sent."""
    control.sendall(_line({"say": what, **more}))


def _line(news: Mapping[str, Any]) -> bytes:
    return json.dumps(news, separators=(",", ":")).encode() + b"\n"


class FeedWriter:
    """Writes the news of a run for its audience.

    Attributes:
        cpu_s: the processor time that this has cost [s].
    """

    def __init__(self, descriptor: int, speed: float | None) -> None:
        """Write to a socket.

        Args:
            speed: of the run, as a multiple of real time; None: as fast as it can.
        """
        self.cpu_s = 0.0
        self._socket = socket.socket(fileno=descriptor)
        self._socket.setblocking(False)
        self._waiting = bytearray()
        self._patience_s = PATIENCE_S
        self._is_heard = True
        self._tick_s = STEP_NS / 1e9 / speed if speed else 0.0
        self._due_s = 0.0

    def write(self, news: Mapping[str, Any]) -> None:
        """Write some news; never waits for long."""
        if not self._is_heard:
            return
        began_s = time.process_time()
        self._waiting += _line(news)
        self._send()
        if len(self._waiting) > MOST_BYTES:
            self._wait_for_room()
        self.cpu_s += time.process_time() - began_s

    def pace(self) -> None:
        """Wait until the next tick is due."""
        if not self._tick_s:
            return
        now_s = time.monotonic()
        if now_s < self._due_s:
            time.sleep(self._due_s - now_s)
        elif now_s > self._due_s + LATE_S:
            self._due_s = now_s
        self._due_s += self._tick_s

    def close(self) -> None:
        """Write the last line, and wait until all is received."""
        self.write(END)
        self._wait_for_room(0)
        self._socket.close()

    def _send(self) -> None:
        try:
            while self._waiting:
                del self._waiting[: self._socket.send(self._waiting)]
        except BlockingIOError:
            return
        except OSError:  # nobody is there any more
            self._give_up()

    def _wait_for_room(self, most_bytes: int = MOST_BYTES) -> None:
        while self._is_heard and len(self._waiting) > most_bytes:
            began_s = time.monotonic()
            select.select((), (self._socket,), (), max(0.0, self._patience_s))
            self._patience_s -= time.monotonic() - began_s
            self._send()
            if self._patience_s <= 0.0 and len(self._waiting) > most_bytes:
                self._give_up()

    def _give_up(self) -> None:
        self._is_heard = False
        self._waiting.clear()
