"""Serves the page and those who look at it, in a thread of its own.

Nothing here makes the simulator wait: what it hands over is plain data, put on this thread's queue,
and who cannot follow loses changes, and gets the whole picture when he can follow again.
"""

from __future__ import annotations

import asyncio
import base64
import json
import secrets
import threading
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property, partial
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Generic, TypeVar
from urllib.parse import urlencode, urlsplit

import PIL.Image
from websockets.asyncio.server import ServerConnection, broadcast, serve
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response

from turtlesim_py.live.admission import Admission, is_loopback
from turtlesim_py.live.feed import Change, Deliver, Source, Whole
from turtlesim_py.live.messages import NotThere
from turtlesim_py.live.rosbridge import LIVE, Session
from turtlesim_py.world import sprites

if TYPE_CHECKING:
    from turtlesim_py.live.graph import Graph

_Source = TypeVar("_Source", bound=Source)

#: A frame of a viewer's may have so many bytes.
LONGEST_FRAME: Final = 256 * 1024
#: Who has not taken so many bytes yet gets no more until he has [bytes].
MOST_WAITING: Final = 1_000_000
MOST_VIEWERS: Final = 100
#: How often to see whether somebody slow has caught up [s].
RETRY_S: Final = 0.25
#: All of the arena, which is much to send, is sent to a viewer so often at most [s].
WHOLE_EVERY_S: Final = 0.25
#: How long to wait for this thread to begin or end [s].
PATIENCE_S: Final = 10.0

_PAGE: Final = Path(__file__).with_name("page")
_TYPES: Final = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".svg": "image/svg+xml",
    ".json": "application/json",
}
#: Nothing but what this server sends is run or shown.
_POLICY: Final = "default-src 'self'; img-src 'self' data:; connect-src 'self' ws: wss:"


@dataclass(frozen=True)
class Settings:
    """Where and for whom the page is served.

    Attributes:
        port: 0 takes any that is free.
        host: the address to listen at.
        is_read_only: whether viewers can only look.
        token: '' makes one.
        needs_token: whether nobody comes in without; elsewhere than at 127.0.0.1 nobody does.
        has_graph: whether viewers may look at the topics and services of a ROS graph.
        language: what the page speaks; '' for what a viewer's browser prefers.
    """

    port: int
    host: str = "127.0.0.1"
    is_read_only: bool = False
    token: str = ""
    needs_token: bool = False
    has_graph: bool = True
    language: str = ""


class _Viewer:
    """One connection."""

    def __init__(self, connection: ServerConnection) -> None:
        self._connection = connection
        self.is_behind = False
        self.next_whole_at = 0.0

    @property
    def is_slow(self) -> bool:
        return self._connection.transport.get_write_buffer_size() > MOST_WAITING

    def send(self, text: str) -> bool:
        """Send, unless too much waits for him already."""
        if self.is_slow:
            self.is_behind = True
            return False
        broadcast((self._connection,), text)
        return True


class LiveServer(Generic[_Source]):
    """The page and its viewers.

    Args:
        make_feed: what viewers are told; gets what delivers it, from any thread.
        about: what the page has to know of the node: its name, its namespace, its messages.

    Attributes:
        feed: what `make_feed` has made.
        port: where it listens.
    """

    def __init__(
        self, make_feed: Callable[[Deliver], _Source], settings: Settings, about: Mapping[str, Any]
    ) -> None:
        self.feed = make_feed(self._deliver)
        self.is_read_only = settings.is_read_only
        self.about = {
            **about,
            "read_only": settings.is_read_only,
            "has_graph": settings.has_graph,
        }
        self.port = settings.port
        self._host = settings.host
        self._has_graph = settings.has_graph
        self._language = settings.language
        needs_token = settings.needs_token or not is_loopback(settings.host)
        self._admission = Admission(settings.token or secrets.token_urlsafe(12), needs_token)
        self._files = {path.name: path.read_bytes() for path in _PAGE.iterdir()}
        self._viewers: set[_Viewer] = set()
        self._watching: set[_Viewer] = set()
        self._graph: Graph | None = None
        self._loop: asyncio.AbstractEventLoop
        self._begun = threading.Event()
        self._end: asyncio.Event
        self._failure: OSError | None = None
        self._thread = threading.Thread(target=self._run, name="live", daemon=True)

    @cached_property
    def address(self) -> str:
        """Where the page is; with the token where nobody comes in without."""
        host = f"[{self._host}]" if ":" in self._host else self._host
        asked = {"token": self._admission.token} if self._admission.needs_token else {}
        if self._language:
            asked["lang"] = self._language
        query = f"?{urlencode(asked)}" if asked else ""
        return f"http://{host}:{self.port}/{query}"

    @property
    def forwarded_address(self) -> str:
        """What to put behind the name of a machine that forwards the port."""
        return f"/?token={self._admission.token}"

    def start(self) -> None:
        """Listen; OSError: that cannot be, as where another one listens."""
        self._thread.start()
        self._begun.wait(PATIENCE_S)
        if self._failure is not None:
            raise self._failure

    def stop(self) -> None:
        """Send everybody away, and end the thread."""
        if self._failure is None and self._thread.is_alive():
            self._loop.call_soon_threadsafe(self._end.set)
            self._thread.join(PATIENCE_S)
        if self._graph is not None:
            self._graph.close()

    # For sessions -----------------------------------------------------------------------------

    def graph(self) -> Graph:
        """The ROS graph; made when it is needed first: who only looks needs none.

        Raises:
            NotThere: viewers have none.
        """
        if not self._has_graph:
            raise NotThere("there are no topics and services to be seen here")
        if self._graph is None:
            from turtlesim_py.live.graph import Graph  # here: it brings all of ROS

            self._graph = Graph()
        return self._graph

    # The thread -------------------------------------------------------------------------------

    def _run(self) -> None:
        try:
            asyncio.run(self._serve())
        except OSError as error:
            self._failure = error
        finally:
            self._begun.set()

    async def _serve(self) -> None:
        self._loop = asyncio.get_running_loop()
        self._end = asyncio.Event()
        async with serve(
            self._on_viewer,
            self._host,
            self.port,
            process_request=self._on_request,
            compression=None,  # frames are short and many
            max_size=LONGEST_FRAME,
            max_queue=16,
            server_header=None,
        ) as server:
            self.port = next(iter(server.sockets)).getsockname()[1]
            self._begun.set()
            await self._end.wait()

    def _on_request(self, connection: ServerConnection, request: Request) -> Response | None:
        headers = {name.lower(): value for name, value in request.headers.raw_items()}
        try:
            path = urlsplit(request.path).path
        except ValueError:  # as //[x]
            return _response(404, "Not Found", b"There is no such page.", "text/plain")
        # behind a proxy the page may lie below a prefix that is handed on, or not
        name = path.rpartition("/")[2] or "index.html"
        is_viewer = "upgrade" in headers.get("connection", "").lower()
        # the page's own parts are no secret, and are asked for without what the address says
        if is_viewer or name == "index.html":
            refusal = self._admission.refusal(request.path, headers)
            if refusal:
                return _response(403, "Forbidden", refusal.encode(), "text/plain; charset=utf-8")
        if is_viewer:
            if len(self._viewers) < MOST_VIEWERS:
                return None
            text = f"{MOST_VIEWERS} look already."
            return _response(503, "Service Unavailable", text.encode(), "text/plain")
        if name == "sprites.json":
            return _response(200, "OK", _sprites(), "application/json")
        if name not in self._files:
            return _response(404, "Not Found", b"There is no such page.", "text/plain")
        return _response(200, "OK", self._files[name], _TYPES[Path(name).suffix])

    def _watch(self, viewer: _Viewer, watches: bool) -> None:
        """Begin or end to tell a viewer of the arena."""
        if not watches:
            self._watching.discard(viewer)
        elif viewer not in self._watching:  # all of the arena is much to send: else he has it
            self._watching.add(viewer)
            viewer.is_behind = True
            now = self._loop.time()
            pause = viewer.next_whole_at - now  # who comes and goes all the time has to wait
            viewer.next_whole_at = max(viewer.next_whole_at, now) + WHOLE_EVERY_S
            if pause > 0:
                self._loop.call_later(pause, self._catch_up, viewer)
            else:
                self.feed.ask(viewer)
        self.feed.is_watched = bool(self._watching)

    async def _on_viewer(self, connection: ServerConnection) -> None:
        viewer = _Viewer(connection)
        loop = asyncio.get_running_loop()
        watch = partial(self._watch, viewer)
        session = Session(self, lambda said: viewer.send(_encoded(said)), watch, loop.time)
        self._viewers.add(viewer)
        try:
            async for frame in connection:
                await session.hear(frame)
        except ConnectionClosed:
            pass
        finally:
            self._viewers.discard(viewer)
            await session.close()

    # From the simulator's thread --------------------------------------------------------------

    def _deliver(self, news: Change | Whole) -> None:
        with suppress(RuntimeError):  # the loop has just ended
            self._loop.call_soon_threadsafe(self._hand_on, news)

    def _hand_on(self, news: Change | Whole) -> None:
        if isinstance(news, Whole):
            self._hand_on_whole(news)
            return
        text = _live(news.content)
        for viewer in list(self._watching):
            if not viewer.is_behind and not viewer.send(text):
                self._catch_up(viewer)

    def _catch_up(self, viewer: _Viewer) -> None:
        """Ask for all of the arena as soon as the viewer has taken what waits for him."""
        if viewer not in self._watching:
            return
        if viewer.is_slow:
            self._loop.call_later(RETRY_S, self._catch_up, viewer)
        else:
            self.feed.ask(viewer)

    def _hand_on_whole(self, whole: Whole) -> None:
        viewer = whole.viewer
        if not isinstance(viewer, _Viewer) or viewer not in self._watching:
            return
        file = BytesIO()
        PIL.Image.fromarray(whole.canvas.rgba()).save(file, format="PNG", compress_level=1)
        picture = base64.b64encode(file.getvalue()).decode("ascii")
        viewer.is_behind = False
        viewer.send(_live({**whole.content, "whole": picture, "about": self.about}))


def _live(content: Mapping[str, Any]) -> str:
    return _encoded({"op": "publish", "topic": LIVE, "msg": content})


def _encoded(said: Mapping[str, Any]) -> str:
    return json.dumps(said, separators=(",", ":"), allow_nan=False)


def _sprites() -> bytes:
    """Name -> the pixels of a turtle's picture, RGBA, row after row, in base64."""
    pictures = {
        name: base64.b64encode(sprites.sprite(name).tobytes()).decode() for name in sprites.NAMES
    }
    return json.dumps(pictures).encode()


def _response(status: int, reason: str, body: bytes, content_type: str) -> Response:
    headers = Headers(
        [
            ("Content-Type", content_type),
            ("Content-Length", str(len(body))),
            ("Connection", "close"),
            ("Cache-Control", "no-store"),
            ("Content-Security-Policy", _POLICY),
            ("Referrer-Policy", "no-referrer"),
            ("X-Content-Type-Options", "nosniff"),
        ]
    )
    return Response(status, reason, headers, body)
