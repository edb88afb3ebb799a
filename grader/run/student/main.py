"""Starts a program of a submission in real time.

    python main.py EVIDENCE INTRODUCTION START

EVIDENCE is the page of its account, -1 for none. INTRODUCTION is a JSON list of two lists: topics
and services that have to be connected when the submission gets them, see `Introduced`. START is a
`ProgramStart` as JSON.

Started by path, not with -m, and of the grader it imports only what loads and observes a program,
so that the submission finds the interpreter as on a student's machine.
"""

from __future__ import annotations

import sys
from pathlib import Path

if __name__ == "__main__":
    sys.path[0] = str(Path(__file__).resolve().parents[3])

import atexit
import json
import time
from collections import Counter
from collections.abc import Callable
from typing import Any

from grader.run.observe import hooks
from grader.run.observe.witness import Witness
from grader.run.student import loading


def main() -> None:
    """Start a program, and leave with its exit code."""
    page, introduction, words = sys.argv[1:]
    sys.exit(run(int(page), Introduced(*json.loads(introduction)), words))


def run(page: int, introduced: Introduced, words: str) -> int:
    """Run a program to its end; return its exit code."""
    start = loading.ProgramStart(*json.loads(words))
    now_s, started_s = time.monotonic, time.monotonic()
    witness = Witness(page, start.root, lambda: now_s() - started_s, hooks.is_met)
    hooks.install_in_threads(witness)
    hooks.time_waits(witness, time, "sleep")
    code: int | None = None

    # registered first, so called last: when all threads have ended that Python waits for
    @atexit.register
    def at_end() -> None:
        if code is not None:
            witness.ending.returned(code)

    loading.hide_the_grader(start)
    sys.meta_path.insert(
        0,
        loading.AfterImport(
            {
                "rclpy.publisher": [loading.accept_numbers],
                "rclpy.node": [introduced.patch, lambda _: hooks.install_in_real_time(witness)],
                "rclpy.action.client": [lambda _: hooks.install_actions(witness)],
                "rclpy.experimental.events_executor": [
                    lambda module: hooks.install_in_events_executor(witness, module)
                ],
            }
        ),
    )
    witness.lines.install()
    code = loading.call(start, witness.ending.raised)
    return code


# Connections ----------------------------------------------------------------------------------


class Introduced:
    """Has publishers and clients of the scene's names wait until they are connected, in real time.

    ROS drops what is published before the other side is found, which takes some tenths of a
    second, and seconds on a busy machine: the same submission would do something else each time.
    A name that only ends like one of the scene's may be wrong, or that of something yet to come:
    these wait for `patience_s` at most, all together.

    Args:
        topics: each so many times as it has readers.
    """

    def __init__(self, topics: list[str], services: list[str]) -> None:
        self.patience_s = 4.0
        #: of the very names: they are there, and will be found, unless their types are wrong
        self.sure_patience_s = 10.0
        self._readers, self._topics, self._services = Counter(topics), topics, services

    def patch(self, module: Any) -> None:
        """Add to the methods of `rclpy.node` that make publishers and clients."""
        hooks.after(module.Node, "create_publisher", self._await_readers)
        hooks.after(module.Node, "create_client", self._await_service)

    def _await_readers(self, _: Any, publisher: Any) -> None:
        name, least = publisher.topic_name, max(1, self._readers[publisher.topic_name])
        self._await(name, self._topics, lambda: publisher.get_subscription_count() >= least)

    def _await_service(self, node: Any, client: Any) -> None:
        name = node.resolve_service_name(client.srv_name)
        self._await(name, self._services, client.service_is_ready)

    def _await(self, name: str, names: list[str], is_connected: Callable[[], bool]) -> None:
        if name in names:
            self.sure_patience_s -= _wait_for(is_connected, self.sure_patience_s)
        elif name.rpartition("/")[2] in [each.rpartition("/")[2] for each in names]:
            self.patience_s -= _wait_for(is_connected, self.patience_s)


def _wait_for(is_connected: Callable[[], bool], patience_s: float) -> float:
    """Wait for a connection; return how long that has lasted [s]."""
    began = time.monotonic()
    is_new = not is_connected()
    while is_new and time.monotonic() < began + patience_s:
        is_new = not is_connected()
        # ROS reports a service a moment before a request would reach it, so not too short
        time.sleep(0.02)
    return time.monotonic() - began


if __name__ == "__main__":
    main()
