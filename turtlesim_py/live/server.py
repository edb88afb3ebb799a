"""Serves the page and its viewers, in a separate thread.

Nothing here makes the simulator wait: what it delivers is plain data, put on this thread's queue,
and a viewer that cannot follow loses changes, and gets the whole picture when it can follow again.
"""

from __future__ import annotations

import asyncio
import base64
import json
import secrets
import threading
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final
from urllib.parse import urlencode

import PIL.Image
from websockets.asyncio.server import ServerConnection, broadcast, serve
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response

from turtlesim_py.live.feed import News, Source
from turtlesim_py.live.messages import Rejected
from turtlesim_py.live.rosbridge import LIVE, Session
from turtlesim_py.live.site import Site, is_loopback, plain

if TYPE_CHECKING:
    from turtlesim_py.live.graph import Graph

#: The longest frame from a viewer [bytes].
LONGEST_FRAME: Final = 256 * 1024
#: A viewer with more unread bytes is sent nothing until it has read them [bytes].
MOST_WAITING: Final = 1_000_000
MOST_VIEWERS: Final = 100
#: How often to see whether a slow viewer has caught up [s].
RETRY_S: Final = 0.25
#: All of the arena, which is much to send, is sent to a viewer so often at most [s].
WHOLE_EVERY_S: Final = 0.25
#: How long to wait for this thread to begin or end [s].
PATIENCE_S: Final = 10.0


@dataclass(frozen=True)
class Settings:
    """Where and for whom the page is served.

    Attributes:
        port: 0 for any free one.
        host: the address to listen at.
        is_read_only: whether viewers can only watch.
        token: '' makes one.
        needs_token: whether nobody comes in without; elsewhere than at 127.0.0.1 nobody does.
        has_graph: whether viewers may see the topics and services of a ROS graph.
        language: of the page; '' for the one that a viewer's browser prefers.
        page: a folder with another page than the turtles'.
    """

    port: int
    host: str = "127.0.0.1"
    is_read_only: bool = False
    token: str = ""
    needs_token: bool = False
    has_graph: bool = True
    language: str = ""
    page: Path | None = None


class _Viewer:
    """One connection."""

    def __init__(self, connection: ServerConnection) -> None:
        self._connection = connection
        self.is_behind = False
        self.next_whole_at = 0.0

    @property
    def is_slow(self) -> bool:
        return self._connection.transport.get_write_buffer_size() > MOST_WAITING

    def send(self, content: str | Mapping[str, Any]) -> bool:
        """Send text or JSON, unless too much is unread already; return whether it was sent."""
        if self.is_slow:
            self.is_behind = True
            return False
        text = content if isinstance(content, str) else _encoded(content)
        broadcast((self._connection,), text)
        return True


class LiveServer:
    """The page and its viewers.

    Args:
        about: the node, for the page: its name, its namespace, its package of messages.

    Attributes:
        address: where the page is; with the token where nobody comes in without.
        forwarded_address: what to put behind the name of a machine that forwards the port.
    """

    def __init__(self, settings: Settings, about: Mapping[str, Any]) -> None:
        self._settings = settings
        self._about = {
            **about,
            "read_only": settings.is_read_only,
            "has_graph": settings.has_graph,
        }
        needs_token = settings.needs_token or not is_loopback(settings.host)
        self._site = Site(settings.token or secrets.token_urlsafe(12), needs_token, settings.page)
        self.forwarded_address = f"/?token={self._site.token}"
        self.address = ""
        self._source: Source
        self._viewers: set[_Viewer] = set()
        self._watching: set[_Viewer] = set()
        self._graph: Graph | None = None
        self._loop: asyncio.AbstractEventLoop
        self._begun = threading.Event()
        self._end: asyncio.Event
        self._failure: OSError | None = None
        self._thread = threading.Thread(target=self._run, name="live", daemon=True)

    def start(self, source: Source) -> None:
        """Listen, and show the news of a source."""
        self._source = source
        self._thread.start()
        self._begun.wait(PATIENCE_S)
        if self._failure is not None:
            raise self._failure

    def stop(self) -> None:
        """Disconnect all viewers, and end the thread."""
        if self._failure is None and self._thread.is_alive():
            self._loop.call_soon_threadsafe(self._end.set)
            self._thread.join(PATIENCE_S)

    def deliver(self, news: News) -> None:
        """Send news to the viewers; from any thread."""
        with suppress(RuntimeError):  # the loop has just ended
            self._loop.call_soon_threadsafe(self._send, news)

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
            self._settings.host,
            self._settings.port,
            process_request=self._on_request,
            compression=None,  # frames are short and many
            max_size=LONGEST_FRAME,
            max_queue=16,
            server_header=None,
        ) as server:
            port = next(iter(server.sockets)).getsockname()[1]
            self.address = self._address(port)
            self._begun.set()
            await self._end.wait()
        if self._graph is not None:
            self._graph.close()

    def _address(self, port: int) -> str:
        host = self._settings.host
        host = f"[{host}]" if ":" in host else host
        query = {"token": self._site.token} if self._site.needs_token else {}
        if self._settings.language:
            query["lang"] = self._settings.language
        return f"http://{host}:{port}/{'?' if query else ''}{urlencode(query)}"

    def _on_request(self, connection: ServerConnection, request: Request) -> Response | None:
        answer = self._site.answer(request)
        if answer is None and len(self._viewers) >= MOST_VIEWERS:
            return plain(503, f"{MOST_VIEWERS} look already.")
        return answer

    async def _on_viewer(self, connection: ServerConnection) -> None:
        viewer = _Viewer(connection)
        session = Session(
            self._open_graph,
            self._settings.is_read_only,
            viewer.send,
            partial(self._watch, viewer),
            self._loop.time,
        )
        self._viewers.add(viewer)
        try:
            async for frame in connection:
                session.handle(frame)
        except ConnectionClosed:
            pass
        finally:
            self._viewers.discard(viewer)
            session.close()

    def _open_graph(self) -> Graph:
        """Return the ROS graph, made at its first use: to watch needs none."""
        if not self._settings.has_graph:
            raise Rejected("there are no topics and services to be seen here")
        if self._graph is None:
            from turtlesim_py.live.graph import Graph  # here: it brings all of ROS

            self._graph = Graph()
        return self._graph

    # News -------------------------------------------------------------------------------------

    def _watch(self, viewer: _Viewer, watches: bool) -> None:
        """Begin or end to send a viewer the news of the arena."""
        if not watches:
            self._watching.discard(viewer)
        elif viewer not in self._watching:  # all of the arena is much to send: else it has it
            self._watching.add(viewer)
            viewer.is_behind = True
            now = self._loop.time()
            pause = viewer.next_whole_at - now  # a viewer that comes and goes has to wait
            viewer.next_whole_at = max(viewer.next_whole_at, now) + WHOLE_EVERY_S
            if pause > 0:
                self._loop.call_later(pause, self._catch_up, viewer)
            else:
                self._source.ask(viewer)
        self._source.is_watched = bool(self._watching)

    def _send(self, news: News) -> None:
        if news.viewer is not None:
            self._send_whole(news)
            return
        text = _live(news.content)
        for viewer in list(self._watching):
            if not viewer.is_behind and not viewer.send(text):
                self._catch_up(viewer)

    def _catch_up(self, viewer: _Viewer) -> None:
        """Request all of the arena as soon as the viewer has read all that was sent."""
        if viewer not in self._watching:
            return
        if viewer.is_slow:
            self._loop.call_later(RETRY_S, self._catch_up, viewer)
        else:
            self._source.ask(viewer)

    def _send_whole(self, news: News) -> None:
        viewer = news.viewer
        if not isinstance(viewer, _Viewer) or viewer not in self._watching:
            return
        picture = ""
        if news.canvas is not None:
            file = BytesIO()
            PIL.Image.fromarray(news.canvas.rgba()).save(file, format="PNG", compress_level=1)
            picture = base64.b64encode(file.getvalue()).decode("ascii")
        viewer.is_behind = False
        viewer.send(_live({**news.content, "whole": picture, "about": self._about}))


def _live(content: Mapping[str, Any]) -> str:
    return _encoded({"op": "publish", "topic": LIVE, "msg": content})


def _encoded(content: Mapping[str, Any]) -> str:
    return json.dumps(content, separators=(",", ":"), allow_nan=False)
