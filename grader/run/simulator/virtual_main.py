"""Starts the simulator of a run in virtual time; where that cannot work, reports it and ends.

    python -m grader.run.simulator.virtual_main ...
    python -m grader.run.simulator.virtual_main --fork-server SOCKET MESSAGES SCENE

The arguments are those of `grader.run.simulator.hub`. Whatever fails in this process
fails here: the grader then runs the submission in real time, and the result says why. Should that
fail as well, it is the grader's failure.

As a fork server it imports a scene and packages of messages (MESSAGES: a JSON list of names), and
forks for each order; a child goes on with the arguments of the first form, or is the simulator of a
run in real time. Another scene is imported when the first order for it comes.
"""

from __future__ import annotations

import importlib
import json
import os
import socket
import sys
import traceback
from collections.abc import Sequence
from contextlib import suppress
from functools import cache

from grader.run.lockstep import faults
from grader.run.processes import FORK_SERVER
from grader.run.simulator.process import send_message
from grader.text.message import Message

IN_REAL_TIME = "grader.run.simulator.real_time"


def main(argv: list[str]) -> int:
    """Run one simulation in lockstep; the grader reads the exit code."""
    if argv[0] == FORK_SERVER:
        module, *argv = serve_runs(argv[1:])
        if module == IN_REAL_TIME:
            return int(importlib.import_module(module).main(argv))
    try:
        from grader.run.lockstep import contract

        if broken := contract.broken():
            return _refuse(argv, broken)
        from grader.run.lockstep import endpoints
        from grader.run.simulator import hub

        endpoints.import_uncompiled()
        return hub.main(argv)
    except Exception as error:
        traceback.print_exc()
        return _refuse(argv, faults.failed(error))


def serve_runs(words: Sequence[str]) -> list[str]:
    """Be a fork server; returns in each child, with its module and the arguments of its start.

    Args:
        words: the number of the socket, and what to import beforehand.
    """
    from grader.run.lockstep import contract

    if contract.broken():
        sys.exit(1)  # the run reports it, after a cold start
    from grader.run.lockstep import endpoints
    from grader.run.processes import fork_server_main
    from grader.run.simulator import hub  # noqa: F401
    from grader.scenes.scene import load_scene

    @cache
    def load(scene: str) -> None:
        with suppress(Exception):  # a scene that cannot be loaded fails in its own runs
            load_scene(scene).preload()

    number, messages, scene = words
    endpoints.import_uncompiled()
    load(scene)
    endpoints.import_messages(json.loads(messages))
    command = fork_server_main.serve(number, (), load)
    return command[command.index("-m") + 1 :]


def _refuse(argv: list[str], why: Message) -> int:
    with socket.socket(fileno=int(argv[0])) as grader:
        send_message(grader, "refused", reason=why.serialise())
    return 0


if __name__ == "__main__":
    code = main(sys.argv[1:])
    # All is sent and saved. What ROS and Python would still tear down goes with the process.
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    os._exit(code)
