"""Who may look at the page and drive: by where a request comes from, or by a token in its address.

A page of somebody else's in the user's own browser must not reach a simulator on the user's own
machine: browsers say in `Origin` whose page asks, and in `Host` by which name. A name that leads to
127.0.0.1 for a while (DNS rebinding) is one in `Host` that is not this machine's.
"""

from __future__ import annotations

import hmac
import ipaddress
from collections.abc import Mapping
from dataclasses import dataclass
from urllib.parse import parse_qs, urlsplit

#: What this machine calls itself.
_LOCAL = frozenset(("localhost", "127.0.0.1", "::1"))


@dataclass(frozen=True)
class Admission:
    """The rule.

    Attributes:
        token: whoever shows it is let in, from wherever.
        needs_token: whether nobody else is: where the page is served to other machines.
    """

    token: str
    needs_token: bool

    def refusal(self, path: str, headers: Mapping[str, str]) -> str:
        """Why a request is refused, in a sentence; '' where it is let in.

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
        # what stands behind a forwarded port: the name by which the browser knows it
        forwarded = headers.get("x-forwarded-host", "").split(",")[0].strip()
        if _host(origin) in _LOCAL or (forwarded and _host(origin) == _host(f"//{forwarded}")):
            return ""
        return f"A page of {origin!r:.80} asks for this one: {_ADVICE}"


_ADVICE = "open the whole address that was printed, with its token."


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
