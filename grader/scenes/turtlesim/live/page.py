"""The simulator's own page, for looking only, served by the grader.

Nobody comes in without the token: a submission's process may have the same network, and is to see
no verdict. There is no ROS graph behind the page, so nothing that a viewer says leads to a run.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from grader.language.catalogue import spoken
from grader.scenes.live import Grading
from grader.scenes.turtlesim.live.mirror import Mirror
from turtlesim_py.live.server import LiveServer, Settings

_ABOUT = {"node": "/turtlesim", "namespace": "/", "interfaces": "turtlesim"}


class TurtlesimPage:
    """A `grader.scenes.live.LivePage`."""

    def __init__(self, port: int) -> None:
        """Serve it; OSError: that cannot be, as where another one does."""
        settings = Settings(
            port,
            is_read_only=True,
            needs_token=True,
            has_graph=False,
            language=spoken(),  # that of the verdicts
        )
        self._server = LiveServer(Mirror, settings, _ABOUT)
        self._mirror = self._server.feed
        self._server.start()

    @property
    def address(self) -> str:
        """With the token."""
        return self._server.address

    def await_viewer(self, patience_s: float) -> bool:
        """Wait until somebody looks; whether anybody has."""
        return self._mirror.has_been_seen.wait(patience_s)

    def tell(self, grading: Grading) -> None:
        """Show what is known now."""
        self._mirror.tell(grading)

    def begin(self) -> None:
        """Show an empty window."""
        self._mirror.begin()

    def hear(self, news: Sequence[Mapping[str, Any]]) -> None:
        """Show what happens."""
        self._mirror.hear(news)

    def close(self) -> None:
        """Send everybody away."""
        self._server.stop()


def serve(port: int) -> TurtlesimPage:
    """Serve the page at a port of this machine."""
    return TurtlesimPage(port)
