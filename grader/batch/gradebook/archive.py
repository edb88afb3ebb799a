"""A zip that is the same whenever it is made, one member in memory at a time."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterable
from pathlib import Path
from typing import BinaryIO

from grader import files

#: The first day that a zip can tell.
_DATE = (1980, 1, 1, 0, 0, 0)
_UNIX, _PLAIN_FILE = 3, 0o100644 << 16


def put(path: Path, members: Iterable[tuple[str, bytes]]) -> None:
    """Write a zip, whole or not at all.

    Args:
        members: names, each once, and contents; in the order of the zip.

    Raises:
        UsageError: it cannot be written.
    """
    with files.putting(path) as file:
        _write(file, members)


def packed(members: Iterable[tuple[str, bytes]]) -> bytes:
    """The same as bytes, for one that is to lie in another one."""
    file = io.BytesIO()
    _write(file, members)
    return file.getvalue()


def _write(file: BinaryIO, members: Iterable[tuple[str, bytes]]) -> None:
    with zipfile.ZipFile(file, "w") as archive:
        for name, content in members:
            member = zipfile.ZipInfo(name, _DATE)
            member.compress_type = zipfile.ZIP_DEFLATED
            member.create_system = _UNIX
            member.external_attr = _PLAIN_FILE
            archive.writestr(member, content)
