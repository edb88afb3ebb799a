"""The page as a web site: the answers to requests, and which requests are let in.

An external page in the user's browser must not reach a simulator on the user's machine. Browsers
send the origin of the requesting page in `Origin`, and the requested name in `Host`. With DNS
rebinding, `Host` has a name that is not this machine's, although it resolves to 127.0.0.1.
"""

from __future__ import annotations

import base64
import hmac
import ipaddress
import json
from collections.abc import Mapping
from http import HTTPStatus
from pathlib import Path
from typing import Final
from urllib.parse import parse_qs, urlsplit

from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from turtlesim_py.world import picture
from turtlesim_py.world.turtle import SPRITES

#: What this machine calls itself.
_LOCAL: Final = frozenset(("localhost", "127.0.0.1", "::1"))
_ADVICE: Final = "open the whole address that was printed, with its token."
_TYPES: Final = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".json": "application/json",
}
_TEXT: Final = "text/plain; charset=utf-8"
#: Nothing but what this server sends is run or shown.
_POLICY: Final = "default-src 'self'; img-src 'self' data:; connect-src 'self' ws: wss:"


class Site:
    """The files of the page, and the rule by which requests are let in.

    Args:
        token: a request that shows it is let in, from wherever.
        needs_token: whether no other is: where the page is served to other machines.
        page: a folder with another page, whose files stand before those of this one.
    """

    def __init__(self, token: str, needs_token: bool, page: Path | None = None) -> None:
        self.token = token
        self.needs_token = needs_token
        folders = [Path(__file__).with_name("page"), *([] if page is None else [page])]
        files = (path for folder in folders for path in folder.iterdir())
        self._files = {path.name: path.read_bytes() for path in files}

    def answer(self, request: Request) -> Response | None:
        """Answer a request; None where it asks for a WebSocket and is let in."""
        headers = {name.lower(): value for name, value in request.headers.raw_items()}
        is_viewer = "upgrade" in headers.get("connection", "").lower()
        try:
            path = urlsplit(request.path).path
        except ValueError:  # as //[x]
            return plain(404, "There is no such page.")
        # behind a proxy the page may have a prefix, which the proxy keeps or removes
        name = path.rpartition("/")[2] or "index.html"
        # the parts of the page are no secret, and are requested without the token of the address
        if is_viewer or name == "index.html":
            refusal = self.refusal(request.path, headers)
            if refusal:
                return plain(403, refusal)
        if is_viewer:
            return None
        if name == "sprites.json":
            return _response(200, _sprites(), _TYPES[".json"])
        if name not in self._files:
            return plain(404, "There is no such page.")
        return _response(200, self._files[name], _TYPES[Path(name).suffix])

    def refusal(self, path: str, headers: Mapping[str, str]) -> str:
        """Return why a request is refused, in a sentence; '' where it is let in.

        Args:
            path: with what follows a question mark.
            headers: names in lower case.
        """
        shown = parse_qs(urlsplit(path).query).get("token", [""])[0]
        if shown and hmac.compare_digest(shown.encode(), self.token.encode()):
            return ""
        if shown:
            return "The token in this address is not this page's: it changes at each start."
        if self.needs_token:
            return "This page needs the token: open the whole address that was printed."
        host = _host(f"//{headers.get('host', '')}")
        if host not in _LOCAL:
            return f"This page is asked for as {host!r:.80}: {_ADVICE}"
        origin = headers.get("origin")
        if origin is None:
            return ""
        # behind a forwarded port: the name by which the browser knows this page
        forwarded = headers.get("x-forwarded-host", "").split(",")[0].strip()
        if _host(origin) in _LOCAL or (forwarded and _host(origin) == _host(f"//{forwarded}")):
            return ""
        return f"A page of {origin!r:.80} asks for this one: {_ADVICE}"


def _host(url: str) -> str:
    try:
        return (urlsplit(url).hostname or "").lower()
    except ValueError:
        return ""


def is_loopback(address: str) -> bool:
    """Whether a server that listens there can be reached from this machine alone."""
    if address == "localhost":
        return True
    try:
        return ipaddress.ip_address(address).is_loopback
    except ValueError:
        return False


def _sprites() -> bytes:
    """Serialise name -> the pixels of a turtle's picture, RGBA, row after row, in base64."""
    pictures = {name: base64.b64encode(picture.sprite(name).tobytes()).decode() for name in SPRITES}
    return json.dumps(pictures).encode()


def plain(status: int, text: str) -> Response:
    """Return an answer that is a line of text."""
    return _response(status, text.encode(), _TEXT)


def _response(status: int, body: bytes, content_type: str) -> Response:
    headers = {
        "Content-Type": content_type,
        "Content-Length": str(len(body)),
        "Connection": "close",
        "Cache-Control": "no-store",
        "Content-Security-Policy": _POLICY,
        "Referrer-Policy": "no-referrer",
        "X-Content-Type-Options": "nosniff",
    }
    return Response(status, HTTPStatus(status).phrase, Headers(headers), body)
