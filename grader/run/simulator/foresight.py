"""What the next ticks will bring if the submission sends nothing, so that it need not ask for each.

Its process is told in advance. The ticks are lived through when it has used them, and must then
publish, byte for byte, what was told.
"""

from __future__ import annotations

from grader.run.lockstep.protocol import Advance, Parcel, Parcels
from grader.run.lockstep.registry import Writer
from grader.run.simulator.endpoints import SimulatorEndpoints, writer_of
from grader.scenes.scene import Forecast, Reason, Simulation

#: How many ticks are told in advance at most: a second.
MOST_TICKS = 64
#: A submission that sends something in each tick makes foresight vain. After so many vain ones it
#: is tried now and then only.
PATIENCE, SELDOM = 3, 16


class Foresight:
    """The ticks that were told and are still to be lived through.

    Attributes:
        end: the last of them; before the first look, and when forgotten, not after the last lived.
        parcels: what they send.
    """

    def __init__(self, simulation: Simulation, registry: SimulatorEndpoints) -> None:
        self.end = 0
        self.parcels: Parcels = []
        self._simulation = simulation
        self._registry = registry
        self._told = Forecast((), [])
        self._writers: list[Writer] = []
        self._lived = 0
        self._length = 1
        self._vain = 0

    def look_ahead(self, tick: int, request: Advance) -> None:
        """Foresee what follows a tick, as far as is worth while."""
        self.end = tick
        most = self._worth_while(tick, request)
        self._lived = 0
        if most <= 0 or self._registry.has_unread():
            return
        told = self._simulation.foresee(most)
        writers = [writer_of(publisher) for publisher in told.publishers]
        if not told.ticks or self._registry.others_are_read(writers):
            return
        read = [
            (index, writer.number, writer.sent)
            for index, writer in enumerate(writers)
            if self._registry.is_read(writer)
        ]
        self._told, self._writers = told, writers
        self.end = tick + len(told.ticks)
        self.parcels = [
            Parcel(number, 0, sent + ahead, tick + ahead, published[index])
            for ahead, published in enumerate(told.ticks, 1)
            for index, number, sent in read
        ]

    def _worth_while(self, tick: int, request: Advance) -> int:
        """How many ticks the student's side will probably use before it sends something."""
        if request.most == 0:
            return 0
        if request.has_mailed:
            self._vain = 0 if self._lived else self._vain + 1
            if self._vain > PATIENCE and self._vain % SELDOM:
                return 0
            self._length = 2 * self._lived + 1
        else:
            self._vain = 0
            self._length = 2 * self._length + 1
        self._length = min(MOST_TICKS, self._length)
        return min(self._length, request.target - tick)

    def live_through(self, now_ns: int) -> Reason:
        """Let the next of these ticks be, at this time on the scene's clock [ns].

        Raises:
            RuntimeError: it was not as it was told.
        """
        reason, published = self._simulation.pass_tick(now_ns)
        if published != self._told.ticks[self._lived]:
            raise RuntimeError("a tick was not as it was foreseen")
        for writer in self._writers:
            writer.sent += 1
        self._lived += 1
        return reason

    def forget(self) -> None:
        """What was told and not used will not be."""
        self._told, self.parcels, self.end = Forecast((), []), [], 0
