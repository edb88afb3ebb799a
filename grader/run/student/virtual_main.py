"""The submission's process in virtual time: replace what tells time, run what was handed in.

    python virtual_main.py FD EVIDENCE SCENE ROOT module:function
    python virtual_main.py FD EVIDENCE SCENE ROOT path/to/script.py [function]
    python virtual_main.py --zygote SOCKET MESSAGES

FD is the link to the simulator, EVIDENCE a pipe to the grader (`telling`), SCENE a JSON list of the
simulator's nodes, with names and namespaces, and of whether two stamps have to be told apart.
Started by path, like `grader.run.student.main`, whose rules for what a submission may import are
the same. Everything of ours is imported before the submission is, and then forgotten by the import
system.

As a zygote it does the same up to where the link comes in, imports what nearly every submission
needs (MESSAGES: a JSON list of packages), and forks for each order; a child goes on with the
arguments of the first two forms, and looks to a submission as if it had been started with them.
"""

import sys
from pathlib import Path

sys.path[0] = str(Path(__file__).resolve().parents[3])

import atexit  # noqa: E402
import json  # noqa: E402
import random  # noqa: E402
import socket  # noqa: E402
from collections.abc import Callable, Sequence  # noqa: E402
from contextlib import suppress  # noqa: E402

from grader.run.lockstep import contract, faults, real  # noqa: E402
from grader.run.lockstep.protocol import Kind, Note, encode  # noqa: E402
from grader.run.processes import ZYGOTE  # noqa: E402
from grader.run.student import (  # noqa: E402
    chance,
    clocks,
    deadlock,
    refusal,
    signals,
    sockets,
    telling,
    threads,
)

# ours, in the order in which they must take hold: threads and time before anything uses them
from grader.run.student import main as student_main  # noqa: E402
from grader.run.student.scheduler import Scheduler  # noqa: E402


def main() -> None:
    """Run one submission; does not return."""
    words = sys.argv
    is_zygote = words[1] == ZYGOTE
    scheduler = Scheduler()
    fault, state = prepare(scheduler)
    if is_zygote:
        if fault:
            sys.exit(fault)  # the run says so, when it has started from nothing
        words = become_one_of_many(scheduler, state, words[2:])
    _, fd, page, introduction, root, target, *more = words
    connection = socket.socket(fileno=int(fd))
    teller = telling.Teller(int(page), root, lambda: scheduler.now_ns / 1e9)

    def give_up(kind: Kind, what: str) -> None:
        with suppress(OSError):  # the simulator is gone
            connection.send(encode(Note(kind, what)))
        real.leave(0)

    def refuse(what: str) -> None:
        give_up(Kind.UNSUPPORTED, what)

    faults.on_fault = lambda what: give_up(Kind.FAILED, what)
    if fault:
        give_up(Kind.FAILED, fault)
    try:
        chance.replace_surroundings()
        signals.install(scheduler, refuse)
        from grader.run.student import install as inside_rclpy

        nodes, tells_apart = json.loads(introduction)
        known = [(name, namespace) for name, namespace in nodes]
        link, witness = inside_rclpy.install(scheduler, known, refuse, teller, tells_apart)
        link.take_up(connection)
    except refusal.Unsupported as lack:
        give_up(Kind.FAILED, f"virtual time does not work here: {lack}")
    except Exception as error:
        give_up(Kind.FAILED, faults.failed(faults.whose(error) or repr(error)))

    connect = faults.guarded(link.connect)

    def on_error(error: BaseException) -> None:
        """An exception has ended the main thread."""
        faults.report(error)
        if stuck := deadlock.find_refused(error, scheduler.now_ns):
            print(stuck.text, file=sys.stderr, flush=True)
            witness.stuck(stuck.kind, stuck.lines)
            link.note(Kind.STUCK)
            while True:
                scheduler.block()
        connect()  # so that it is known who has the other ends
        witness.raised(error)
        faults.hide_our_frames(error)

    refusal.watch(refuse)
    student_main.forget_ourselves(root, target)
    code = student_main.call(root, target, more[0] if more else None, on_error)
    threads.join_all()
    connect()
    witness.returned(code)
    atexit._run_exitfuncs()
    faults.guarded(link.synchronise)()
    real.leave(code)


def prepare(scheduler: Scheduler) -> tuple[str, Callable[[], object]]:
    """Replace all that needs no link; what is wrong, or '', and what tells the state of chance."""
    state: Callable[[], object] = object
    try:
        # before rclpy is imported, which uses all of it
        clocks.install(scheduler)
        threads.install(scheduler)
        state = chance.install()
        sockets.install(scheduler)
        if broken := contract.broken(contract.ENTITIES, contract.PROGRAM):
            return broken, state
        from grader.run.student import install as inside_rclpy

        inside_rclpy.prepare()
    except refusal.Unsupported as lack:
        return f"virtual time does not work here: {lack}", state
    except Exception as error:
        return faults.failed(faults.whose(error) or repr(error)), state
    return "", state


def become_one_of_many(
    scheduler: Scheduler, state: Callable[[], object], words: Sequence[str]
) -> list[str]:
    """Be a zygote; returns in each child, with the arguments that it would have been started with.

    Args:
        state: tells whether anything has drawn random numbers.
        words: the number of the socket, and which packages' messages to import.
    """
    number, packages = words
    before, loaded = (state(), vars(scheduler).copy()), _loaded()
    from grader.run.lockstep import preloading
    from grader.run.processes import forking

    preloading.import_messages(json.loads(packages))
    if (state(), vars(scheduler)) != before:
        sys.exit("what is imported beforehand draws random numbers, or takes time")
    drawn = random.getstate()
    command = forking.serve(number, _loaded() - loaded)
    random.setstate(drawn)  # Python has drawn others for each fork
    sys.argv = command[1:]
    return sys.argv


def _loaded() -> set[str]:
    """The top-level modules that are loaded, but for those that a submission may not have."""
    found = {name.partition(".")[0] for name in sys.modules}
    return found - set(student_main.OURS)


if __name__ == "__main__":
    main()
