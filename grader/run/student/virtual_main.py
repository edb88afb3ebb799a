"""The submission's process in virtual time: replace what tells time, run what was handed in.

    python virtual_main.py FD CORE NODES ROOT module:function
    python virtual_main.py FD CORE NODES ROOT path/to/script.py [function]

FD is the link to the simulator, CORE the processor core to share with it (-1: any), NODES a JSON
list of the names and namespaces of the simulator's nodes. Started by path, like
`grader.run.student.main`, whose rules for what a submission may import are the same. Everything of
ours is imported before the submission is, and then forgotten by the import system.
"""

import sys
from pathlib import Path

sys.path[0] = str(Path(__file__).resolve().parents[3])

import atexit  # noqa: E402
import json  # noqa: E402
import socket  # noqa: E402
from contextlib import suppress  # noqa: E402

from grader.run.lockstep import contract, faults, real  # noqa: E402
from grader.run.lockstep.protocol import Kind, Note, encode  # noqa: E402
from grader.run.student import (  # noqa: E402
    chance,
    clocks,
    deadlock,
    refusal,
    signals,
    sockets,
    threads,
)

# ours, in the order in which they must take hold: threads and time before anything uses them
from grader.run.student import main as student_main  # noqa: E402
from grader.run.student.scheduler import Scheduler  # noqa: E402


def main() -> None:
    """Run one submission; does not return."""
    _, fd, core, nodes, root, target, *more = sys.argv
    student_main.die_with_parent()
    connection = socket.socket(fileno=int(fd))
    scheduler = Scheduler()

    def give_up(kind: Kind, what: str) -> None:
        with suppress(OSError):  # the simulator is gone
            connection.send(encode(Note(kind, what)))
        real.leave(0)

    def refuse(what: str) -> None:
        give_up(Kind.UNSUPPORTED, what)

    faults.on_fault = lambda what: give_up(Kind.FAILED, what)
    try:
        # before rclpy is imported, which uses all of it
        clocks.install(scheduler)
        threads.install(scheduler)
        chance.install()
        sockets.install(scheduler)
        signals.install(scheduler, refuse)
        if broken := contract.broken(contract.ENTITIES, contract.PROGRAM):
            give_up(Kind.FAILED, broken)
        from grader.run.student import install as inside_rclpy

        known = [(name, namespace) for name, namespace in json.loads(nodes)]
        link = inside_rclpy.install(scheduler, known, refuse)
        link.take_up(connection, int(core))
    except refusal.Unsupported as lack:
        give_up(Kind.FAILED, f"virtual time does not work here: {lack}")
    except Exception as error:
        give_up(Kind.FAILED, faults.failed(faults.whose(error) or repr(error)))

    def on_error(error: BaseException) -> None:
        """An exception has ended the main thread."""
        faults.report(error)
        if stuck := deadlock.find_refused(error, scheduler.now_ns):
            print(stuck, file=sys.stderr, flush=True)
            link.note(Kind.STUCK)
            while True:
                scheduler.block()
        faults.hide_our_frames(error)

    refusal.watch(refuse)
    student_main.forget_ourselves(root, target)
    code = student_main.call(root, target, more[0] if more else None, on_error)
    threads.join_all()
    atexit._run_exitfuncs()
    faults.guarded(link.synchronise)()
    link.note(Kind.LEAVING)
    real.leave(code)


if __name__ == "__main__":
    main()
