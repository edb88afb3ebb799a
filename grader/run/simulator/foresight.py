"""Forecasts the next ticks for the case that the submission sends nothing.

Its process gets the forecast in advance, and need not ask for each tick. The ticks are made when it
has used them, and must then publish, byte for byte, what the forecast holds.
"""

from __future__ import annotations

from grader.run.lockstep.matching import Writer
from grader.run.lockstep.protocol import TICK_NS, Advance, Parcel, Parcels
from grader.run.simulator.endpoints import SimulatorEndpoints
from grader.scenes.scene import Forecast, Reason, Simulation

#: The most ticks of a forecast: a second.
MOST_TICKS = 64
#: A submission that sends something in each tick makes forecasts useless. After so many useless
#: ones only one request in `SELDOM` gets one.
PATIENCE, SELDOM = 3, 16


class Foresight:
    """The ticks of the last forecast that are still to be made.

    Attributes:
        end: the last of them; 0, or a past tick, where there is no forecast.
        parcels: what they send.
    """

    def __init__(self, simulation: Simulation, registry: SimulatorEndpoints) -> None:
        self.end = 0
        self.parcels: Parcels = []
        self._simulation = simulation
        self._registry = registry
        self._forecast = Forecast((), [])
        self._writers: list[Writer] = []
        self._made = 0
        self._length = 1
        self._vain = 0

    def foresee(self, tick: int, request: Advance, quiet: int) -> None:
        """Forecast the ticks after this one, as far as is worth while.

        Args:
            quiet: so many will pass without anything that the scene does not know of.
        """
        self.end = tick
        most = min(quiet, self._worth_while(tick, request))
        self._made = 0
        if most <= 0 or self._registry.has_unread():
            return
        forecast = self._simulation.foresee(most)
        writers: list[Writer] = [each.handle.writer for each in forecast.publishers]
        is_heard_here = any(writer.local for writer in writers)
        if not forecast.ticks or is_heard_here or self._registry.others_are_read(writers):
            return
        read = [(i, each.number, each.sent) for i, each in enumerate(writers) if each.remote]
        self._forecast, self._writers = forecast, writers
        self.end = tick + len(forecast.ticks)
        self.parcels = [
            Parcel(number, 0, sent + ahead, (tick + ahead) * TICK_NS, published[index])
            for ahead, published in enumerate(forecast.ticks, 1)
            for index, number, sent in read
        ]

    def _worth_while(self, tick: int, request: Advance) -> int:
        """Return how many ticks the student's side will probably use before it sends something."""
        if request.target_ns == 0:
            return 0
        if request.has_mailed:
            self._vain = 0 if self._made else self._vain + 1
            if self._vain > PATIENCE and self._vain % SELDOM:
                return 0
            self._length = 2 * self._made + 1
        else:
            self._vain = 0
            self._length = 2 * self._length + 1
        self._length = min(MOST_TICKS, self._length)
        return min(self._length, request.target_ns // TICK_NS - tick)

    def make_tick(self, now_ns: int) -> Reason:
        """Make the next of these ticks, at this time on the scene's clock [ns].

        Raises:
            RuntimeError: it was not as forecast.
        """
        reason, published = self._simulation.pass_tick(now_ns)
        if published != self._forecast.ticks[self._made]:
            raise RuntimeError("a tick was not as it was foreseen")
        for writer in self._writers:
            writer.sent += 1
        self._made += 1
        return reason

    def forget(self) -> None:
        """Drop the unused rest of the forecast."""
        self._forecast, self.parcels, self.end = Forecast((), []), [], 0
