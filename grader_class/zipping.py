"""Makes zips that are the same for the same contents."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterable

#: The first day that a zip can store.
_DATE = (1980, 1, 1, 0, 0, 0)
_UNIX, _PLAIN_FILE = 3, 0o100644 << 16


def zipped(members: Iterable[tuple[str, bytes]]) -> bytes:
    """Return a zip of these names, each once, and contents, in this order; without the time."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        for name, content in members:
            member = zipfile.ZipInfo(name, _DATE)
            member.compress_type = zipfile.ZIP_DEFLATED
            member.create_system = _UNIX
            member.external_attr = _PLAIN_FILE
            archive.writestr(member, content)
    return file.getvalue()
