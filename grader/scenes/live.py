"""A page that shows runs live, and the state of a grading that it shows."""

from __future__ import annotations

import threading
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Self

from grader.text.translations import current

if TYPE_CHECKING:  # few want a page
    from grader.scenes.playback import JudgedCheck
    from turtlesim_py.live.feed import Deliver
    from turtlesim_py.live.server import LiveServer
    from turtlesim_py.world.canvas import Canvas


@dataclass(frozen=True)
class Grading:
    """The state of a grading.

    Attributes:
        heading: the submission and the exercise.
        run: the run that is shown, and its speed.
        score: in words; '' while it is not known.
        first: the first thing to fix; '' while it is not known.
        judged: the verdicts up to now.
        is_over: whether this is the final state.
    """

    heading: str
    run: str = ""
    score: str = ""
    first: str = ""
    judged: tuple[JudgedCheck, ...] = ()
    is_over: bool = False


class LivePage(ABC):
    """A page in a browser, served by this process; viewers can only watch.

    It knows a run in another process by its news, and is the `turtlesim_py.live.feed.Source` of its
    server; its methods may be called from any thread. It needs the token, because a submission's
    process may have the same network and must not see verdicts. There is no ROS graph behind it, so
    a viewer cannot affect a run.
    """

    #: The node, for the page; and the folder of another page than the turtles'.
    ABOUT: ClassVar[Mapping[str, Any]] = {}
    PAGE: ClassVar[Path | None] = None
    _server: LiveServer

    def __init__(self, deliver: Deliver) -> None:
        self.is_watched = False
        self._has_been_seen = threading.Event()
        self._deliver = deliver
        self._lock = threading.Lock()
        self._grading: Mapping[str, Any] = {}
        self._start()

    @classmethod
    def serve(cls, port: int) -> Self:
        """Serve the page; OSError: that is not possible, as where the port is in use."""
        from turtlesim_py.live.server import LiveServer, Settings

        settings = Settings(
            port,
            is_read_only=True,
            needs_token=True,
            has_graph=False,
            language=current(),  # that of the verdicts
            page=cls.PAGE,
        )
        server = LiveServer(settings, cls.ABOUT)
        page = cls(server.deliver)
        page._server = server
        server.start(page)
        return page

    @property
    def address(self) -> str:
        """The address to open, with the token."""
        return self._server.address

    def close(self) -> None:
        """Stop serving; open pages keep their content."""
        self._server.stop()

    def await_viewer(self, patience_s: float) -> bool:
        """Wait for a viewer; return whether one has come."""
        return self._has_been_seen.wait(patience_s)

    def ask(self, viewer: object) -> None:
        with self._lock:
            content, canvas = self._everything()
            self._tell({**content, "grading": self._grading}, canvas, viewer)
        self._has_been_seen.set()

    def begin(self) -> None:
        with self._lock:
            self._tell({**self._start(), "begins": True})

    def update(self, grading: Grading) -> None:
        shown = ("status", "word", "title", "rationale", "help")
        checks = [{name: getattr(each, name) for name in shown} for each in grading.judged]
        rest = {name: value for name, value in asdict(grading).items() if name != "judged"}
        with self._lock:
            self._grading = {**rest, "checks": checks}
            self._tell({**self._nothing_new(), "grading": self._grading})

    def _tell(
        self, content: Mapping[str, Any], canvas: Canvas | None = None, viewer: object = None
    ) -> None:
        from turtlesim_py.live.feed import News

        self._deliver(News(content, canvas, viewer))

    @abstractmethod
    def hear(self, news: Sequence[Mapping[str, Any]]) -> None:
        """Show the news that `grader.scenes.scene.Hooks.send_news` has received, in order."""

    @abstractmethod
    def _start(self) -> Mapping[str, Any]:
        """Forget the run; return the scene before one."""

    @abstractmethod
    def _everything(self) -> tuple[Mapping[str, Any], Canvas | None]:
        """Return the run up to now, and a copy of what is painted."""

    @abstractmethod
    def _nothing_new(self) -> Mapping[str, Any]:
        """Return news without a change."""
