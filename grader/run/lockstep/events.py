"""DDS's events of a publisher or a subscription: counterparts that it has found."""

from __future__ import annotations

from typing import Any

from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy

from grader.run.lockstep.faults import pass_on
from grader.run.lockstep.registry import Endpoint

_EventHandle = _rclpy.EventHandle


class MatchedStatus(_rclpy.rmw_matched_status_t):
    """How many counterparts there are; rclpy's own cannot be set."""

    total_count = 0
    total_count_change = 0
    current_count = 0
    current_count_change = 0


class EventHandle(_rclpy.EventHandle):
    """An event of DDS: counterparts have come or gone, or their quality of service does not fit.

    We know them as soon as they are there, and tell of those that come and go. Of what does not fit
    DDS tells more than we know: whoever looks waits until it does. Other events tell of real time
    or of real networks, and never come.
    """

    #: somebody wants it destroyed
    is_gone = False

    def __init__(self, parent: Any, kind: Any) -> None:
        pass_on(_EventHandle.__init__, self, parent, kind)
        self._endpoint: Endpoint = parent.endpoints[0]
        self._counts_matches = kind.name.endswith("_MATCHED")
        #: DDS must tell of it
        self.is_unfit = bool(kind.name.endswith("_INCOMPATIBLE_QOS"))
        #: how many there had been and were when the program was told
        self._told = (0, 0)

    def destroy_when_not_in_use(self) -> None:
        """As in rclpy; a wait set may still hold it."""
        self.is_gone = True
        _EventHandle.destroy_when_not_in_use(self)

    def is_due(self) -> bool:
        """Whether there is something to tell; DDS may still have to find it."""
        if self.is_gone:
            return False
        if self.is_unfit:
            return self._endpoint.unfit > self._told[0]
        return self._counts_matches and self._matches() != self._told

    def _matches(self) -> tuple[int, int]:
        return self._endpoint.matches, self._endpoint.matched

    def take_event(self) -> Any:
        """As in rclpy."""
        if not self._counts_matches:
            status = pass_on(_EventHandle.take_event, self)
            if self.is_unfit and status is not None:
                self._told = (status.total_count, 0)
            return status
        status = MatchedStatus.__new__(MatchedStatus)
        before, self._told = self._told, self._matches()
        status.total_count, status.current_count = self._told
        status.total_count_change = self._told[0] - before[0]
        status.current_count_change = self._told[1] - before[1]
        return status
