"""Which Python thread runs, and when virtual time moves.

One thread holds the baton and runs; the others wait at their gates. The baton is passed on only
where a thread would block, always in the same order, so a program of many threads runs the same
way every time. Time moves only when no thread can run: then the simulator is asked for the next
event. A program that never blocks would stop time, so reading a clock, publishing and polling cost
a little of it.
"""

from __future__ import annotations

import heapq
from collections import deque
from collections.abc import Callable

from grader.run.lockstep import real
from grader.run.lockstep.faults import pass_on
from grader.run.lockstep.protocol import NEVER

#: Reading a clock or the like costs a unit; so many units make a pause.
UNITS_A_PAUSE = 200
#: A pause [ns]. One unit stands for 5 us of a real machine.
PAUSE_NS = 1_000_000
UNIT_NS = PAUSE_NS // UNITS_A_PAUSE
#: A program that never rests pays more and more, so that minutes of busy waiting or of floods end
#: in seconds: (after so many units without rest, the factor).
COARSER = ((20_000, 10), (100_000, 40))
#: The least that a real sleep takes [ns]; a loop of tiny sleeps would otherwise never end.
LEAST_SLEEP_NS = 50_000
#: How often the main thread checks for signals while others run, in real time [s].
SIGNAL_S = 0.05


class Runner:
    """A Python thread: runs, waits at its gate for the baton, or is blocked."""

    __slots__ = ("alarm", "at_exit", "gate", "ident", "ready")

    def __init__(self, ident: int = 0) -> None:
        self.gate = real.allocate_lock()
        self.gate.acquire()
        self.ident = ident
        self.ready = True
        self.alarm = 0  # the valid entry of the scheduler's alarms, if any
        self.at_exit: Callable[[], None] | None = None


class Scheduler:
    """The baton, the alarms and the time [ns since the start of the run]."""

    def __init__(self) -> None:
        self.now_ns = 0
        self.main = self.current = Runner(real.get_ident())
        self.runners = [self.main]
        #: has the simulator go on: sets the time, at most to a deadline, and wakes runners
        self.advance: Callable[[int], None]
        #: called with the new time whenever it moves
        self.on_moved: Callable[[int], None] = lambda _: None
        #: called before time moves: something from outside Python may have woken a runner
        self.poll: Callable[[], None] = lambda: None
        #: called where a thread that we did not start wants to block
        self.on_unknown_thread: Callable[[], None] = _no_unknown_threads
        #: called in a thread that has waited, with how long [s]
        self.on_waited: Callable[[float], None] = lambda _: None
        #: main runner: signals wait until it is out of here
        self.inside = 0
        self.on_leaving: Callable[[], None] | None = None
        #: a signal waits for the main thread
        self.interrupted = False
        self._queue: deque[Runner] = deque()
        self._alarms: list[tuple[int, int, Runner]] = []
        self._serial = 0
        self._units = 0
        self._streak = 0

    # Threads ----------------------------------------------------------------------------------

    def spawn(self, function: Callable[[], None], at_exit: Callable[[], None] | None = None) -> int:
        """Start a thread; it runs when its turn comes. Returns its identifier."""
        runner = Runner()
        runner.at_exit = at_exit
        self.runners.append(runner)

        def run() -> None:
            runner.ident = real.get_ident()
            runner.gate.acquire()
            try:
                function()
            finally:
                self._end(runner)

        self._queue.append(runner)
        try:
            runner.ident = pass_on(real.start_new_thread, run, ())
        except RuntimeError:  # there are too many
            self.runners.remove(runner)
            self._queue.remove(runner)
            raise
        return runner.ident

    def _end(self, runner: Runner) -> None:
        self.runners.remove(runner)
        if runner.at_exit is not None:
            runner.at_exit()
        runner.ready = False
        while not self._queue:
            self._idle()
        self.current = self._queue.popleft()
        self.current.gate.release()

    def wake(self, runner: Runner) -> None:
        """Let a blocked runner run again, after those that can already."""
        if not runner.ready:
            runner.ready = True
            self._queue.append(runner)

    def block(self, deadline_ns: int = NEVER) -> None:
        """Let others run until this thread is woken or the deadline has come.

        The time that passes covers what was to be paid.
        """
        started_ns = self.now_ns
        self._block(deadline_ns)
        if self.now_ns > started_ns:
            self.on_waited((self.now_ns - started_ns) / 1e9)
        covered = (self.now_ns - started_ns) // UNIT_NS
        self._units = max(0, self._units - covered)
        self._streak = max(0, self._streak - covered)

    def pass_on(self) -> None:
        """Let the others that can run do so first."""
        if self._queue:
            self._queue.append(self.current)
            self._switch(self.current)

    # Time -------------------------------------------------------------------------------------

    def sleep(self, duration_ns: int) -> None:
        """Block for a while; a sleep of no time does not block, but is charged."""
        if duration_ns <= 0:
            self.charge(20)
            self.pass_on()
            return
        deadline_ns = self.now_ns + max(duration_ns, LEAST_SLEEP_NS)
        while self.now_ns < deadline_ns:
            self.block(deadline_ns)

    def charge(self, units: int = 1) -> None:
        """Charge the running thread for what it did without blocking."""
        self._units += units
        if self._units < UNITS_A_PAUSE:
            return
        self._streak += self._units
        self._units = 0
        factor = next((f for units, f in reversed(COARSER) if self._streak > units), 1)
        started_ns, deadline_ns = self.now_ns, self.now_ns + PAUSE_NS * factor
        while self.now_ns < deadline_ns:
            self._block(deadline_ns)
        self.on_waited((self.now_ns - started_ns) / 1e9)

    @property
    def unpaid_ns(self) -> int:
        """The cost of what the running thread has done since time last moved [ns]."""
        return self._units * UNIT_NS

    def set_now(self, now_ns: int) -> None:
        """Move time on, and wake those whose deadline has come."""
        self.now_ns = now_ns
        self.on_moved(now_ns)
        alarms = self._alarms
        while alarms and alarms[0][0] <= now_ns:
            _, serial, runner = heapq.heappop(alarms)
            if runner.alarm == serial:
                self.wake(runner)

    # The baton --------------------------------------------------------------------------------

    def _block(self, deadline_ns: int) -> None:
        me = self.current
        if me.ident != real.get_ident():
            self.on_unknown_thread()
        me.ready = False
        if deadline_ns < NEVER:
            self._serial += 1
            me.alarm = self._serial
            heapq.heappush(self._alarms, (deadline_ns, self._serial, me))
        try:
            self._switch(me)
        finally:
            me.alarm = 0

    def _switch(self, me: Runner) -> None:
        if me is self.main:
            self.inside += 1
        while not self._queue:
            self._idle()
        chosen = self._queue.popleft()
        if chosen is not me:
            self.current = chosen
            chosen.gate.release()
            # a signal that comes just before the main thread waits is noticed between two waits
            while not me.gate.acquire(timeout=SIGNAL_S if me is self.main else -1):
                pass
        if me is self.main:
            self.inside -= 1
            if self.on_leaving is not None and not self.inside:
                self.on_leaving()

    def _idle(self) -> None:
        """Poll for outside events when no thread can run; if there are none, move time."""
        if self.interrupted:
            self.interrupted = False
            self.wake(self.main)
            return
        self.poll()
        if self._queue:
            return
        alarms = self._alarms
        while alarms and alarms[0][2].alarm != alarms[0][1]:
            heapq.heappop(alarms)
        self.advance(alarms[0][0] if alarms else NEVER)


def _no_unknown_threads() -> None:
    raise RuntimeError("a thread that was not started by Python's threading wants to block")
