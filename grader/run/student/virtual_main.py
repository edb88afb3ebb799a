"""Starts a submission in virtual time: replaces the clocks, observes, runs its program.

    python virtual_main.py FD EVIDENCE INTRODUCTION START
    python virtual_main.py --fork-server SOCKET MESSAGES

FD is the link to the simulator, EVIDENCE the page of the submission's account. INTRODUCTION is a
JSON list: whether two stamps have to differ, the definitions of interfaces, those that the
simulator has otherwise, whether it records what is published and logged, and its number among
several programs (0: it is alone). START is a `ProgramStart` as JSON.
Started by path, like `grader.run.student.main`, whose rules for what a submission may import are
the same. Everything of ours is imported before the submission is, and then forgotten by the import
system.

As a fork server it does the same up to where the link comes in, imports what nearly every
submission needs (MESSAGES: a JSON list of packages), and forks for each order; a child goes on with
the arguments of the first form, and a submission finds it as if it had been started with them.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path[0] = str(Path(__file__).resolve().parents[3])

import atexit  # noqa: E402
import json  # noqa: E402
import random  # noqa: E402
import socket  # noqa: E402
from collections.abc import Callable, Sequence  # noqa: E402
from contextlib import suppress  # noqa: E402
from typing import TYPE_CHECKING, Any  # noqa: E402

from grader.run.clock import threads, time_and_chance, unsupported_calls  # noqa: E402
from grader.run.clock.scheduler import Scheduler  # noqa: E402
from grader.run.lockstep import contract, faults, real  # noqa: E402
from grader.run.lockstep.protocol import Kind, Note, encode  # noqa: E402
from grader.run.observe import hooks  # noqa: E402
from grader.run.observe.witness import Witness  # noqa: E402
from grader.run.processes import FORK_SERVER  # noqa: E402
from grader.run.student import loading  # noqa: E402
from grader.text.message import NOTHING, Message  # noqa: E402

if TYPE_CHECKING:  # which imports rclpy
    from grader.run.clock.link import SimulatorLink


def main() -> None:
    """Run one submission; does not return."""
    words = sys.argv
    is_server = words[1] == FORK_SERVER
    scheduler = Scheduler()
    fault, state = prepare(scheduler)
    if is_server:
        if fault:
            sys.exit(str(fault))  # the run reports it, after a cold start
        words = become_one_of_many(scheduler, state, words[2:])
    fd, page, introduction, program = words[1:]
    start = loading.ProgramStart(*json.loads(program))
    connection = socket.socket(fileno=int(fd))
    witness = Witness(int(page), start.root, lambda: scheduler.now_ns / 1e9, is_met)

    def give_up(kind: Kind, what: Message) -> None:
        with suppress(OSError):  # the simulator is gone
            connection.send(encode(Note(kind, what)))
        real.leave(0)

    def refuse(what: Message) -> None:
        give_up(Kind.UNSUPPORTED, what)

    faults.on_fault = lambda what: give_up(Kind.FAILED, what)
    if fault:
        give_up(Kind.FAILED, fault)
    try:
        time_and_chance.replace_user_and_devices()
        unsupported_calls.replace_signals(scheduler, refuse)
        link = install(scheduler, connection, int(page), refuse, witness, introduction)
    except Exception as error:
        give_up(Kind.FAILED, faults.failed(error))

    connect = faults.guarded(link.connect)

    def on_error(error: BaseException) -> None:
        """Report an exception that has ended the main thread."""
        faults.report(error)
        connect()  # so that the counterparts are known
        witness.ending.raised(error)

    unsupported_calls.refuse_processes(refuse)
    loading.hide_the_grader(start)
    witness.lines.install()
    code = loading.call(start, on_error)
    threads.join_all()
    connect()
    witness.ending.returned(code)
    atexit._run_exitfuncs()
    faults.guarded(link.synchronise)()
    real.leave(code)


def prepare(scheduler: Scheduler) -> tuple[Message, Callable[[], object]]:
    """Replace everything that needs no link.

    Returns:
        What is wrong, NOTHING for nothing; and a function that returns the state of chance.
    """
    state: Callable[[], object] = object
    try:
        # before rclpy is imported, which uses all of it
        time_and_chance.replace_clocks(scheduler)
        threads.install(scheduler)
        state = time_and_chance.seed_chance()
        unsupported_calls.replace_select(scheduler)
        if lack := contract.broken(contract.ENTITIES, contract.PROGRAM):
            return lack, state
        from grader.run.clock import rclpy_time  # noqa: F401  imports what every run needs
        from grader.run.lockstep import endpoints

        endpoints.import_uncompiled()
    except Exception as error:
        return faults.failed(error), state
    return NOTHING, state


def install(
    scheduler: Scheduler,
    connection: socket.socket,
    page: int,
    refuse: Callable[[Message], None],
    witness: Witness,
    introduction: str,
) -> SimulatorLink:
    """Put rclpy into virtual time, and then have a witness observe it; return the link."""
    import rclpy.publisher

    from grader.run.clock import rclpy_time
    from grader.run.clock.link import SimulatorLink
    from grader.run.lockstep import endpoints

    compares_stamps, texts, unlike, is_recorded, number = json.loads(introduction)
    link = SimulatorLink(scheduler, connection, page, refuse, number)
    main = scheduler.main.ident

    def on_deadlock() -> None:
        is_stuck = witness.ending.deadlocked([each.ident for each in scheduler.runners], main)
        link.note(Kind.STUCK if is_stuck else Kind.WAITING)

    if texts:
        endpoints.make_importable(texts, unlike)
    rclpy_time.install(scheduler, link, compares_stamps=compares_stamps, on_deadlock=on_deadlock)
    if is_recorded:
        link.is_recorded = True
        rclpy_time.publish_logs(link)
    link.on_over = lambda: witness.ending.over(main)
    scheduler.on_waited = witness.waited
    loading.accept_numbers(rclpy.publisher)
    hooks.install_in_threads(witness)
    hooks.install(witness)
    hooks.install_actions(witness)
    if number > 1:
        time_and_chance.vary_chance(number)
    if number:
        link.connect()  # waits for the turn of this program
    return link


def is_met(kind: str, entity: Any) -> Callable[[], bool]:
    """Return a function that returns whether an end ever had a counterpart.

    It holds no reference to the entity itself.
    """
    handle = entity._client_handle if kind == "action_client" else entity.handle
    endpoint = handle.endpoints[0]
    return lambda: endpoint.matches > 0


def become_one_of_many(
    scheduler: Scheduler, state: Callable[[], object], words: Sequence[str]
) -> list[str]:
    """Be a fork server; return in each child, with its arguments.

    Args:
        state: returns another value when anything has drawn random numbers.
        words: the number of the socket, and which packages' messages to import.
    """
    number, packages = words
    before, loaded = (state(), vars(scheduler).copy()), _loaded()
    from grader.run.lockstep import endpoints
    from grader.run.processes import fork_server_main

    endpoints.import_messages(json.loads(packages))
    if (state(), vars(scheduler)) != before:
        sys.exit("what is imported beforehand draws random numbers, or takes time")
    drawn = random.getstate()
    command = fork_server_main.serve(number, _loaded() - loaded)
    random.setstate(drawn)  # Python has drawn others for each fork
    sys.argv = command[1:]
    return sys.argv


def _loaded() -> set[str]:
    """The top-level modules that are loaded, but for those that a submission may not have."""
    found = {name.partition(".")[0] for name in sys.modules}
    return found - set(loading.OURS)


if __name__ == "__main__":
    main()
