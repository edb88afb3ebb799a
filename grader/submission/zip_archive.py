"""The members of a zip, read without trusting its headers."""

from __future__ import annotations

import stat
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Final

from grader.submission.archive_members import PACK_AGAIN, Bounded, Member
from grader.submission.folder import shown

#: Of the list of members, all of them. It is read at once, and becomes 50 times as large.
MAX_LIST_BYTES: Final = 6_000_000

_ENCRYPTED: Final = 0x1  # bit 0 of the general purpose flags (APPNOTE.TXT 4.4.4)


@contextmanager
def opened(archive: Path) -> Iterator[list[Member]]:
    """What is in it.

    Raises:
        ListTooLong: there are too many members, or their names are too long.
        NotImplementedError: it is packed in a way that Python does not know.
        Exception: it is damaged; see `archive.DAMAGED`.
    """
    why = f"its list has more than {MAX_LIST_BYTES / 1e6:g} MB"
    with Bounded(archive, MAX_LIST_BYTES, why) as file, zipfile.ZipFile(file) as packed:
        yield [
            Member(
                info.filename,
                info.filename.endswith(("/", "\\")),
                _refusal(info),
                partial(packed.open, info),
            )
            for info in packed.infolist()
        ]


def _refusal(info: zipfile.ZipInfo) -> str:
    path = shown(info.filename.replace("\\", "/"))
    if info.flag_bits & _ENCRYPTED:
        return f"is encrypted: {path} asks for a password. Pack it again without a password."
    kind = stat.S_IFMT(info.external_attr >> 16)
    if kind == stat.S_IFLNK:
        return f"holds {path} as a symbolic link. Pack it again with the file itself in that place."
    if kind not in (0, stat.S_IFREG):
        return f"holds {path}, which is not an ordinary file. {PACK_AGAIN}"
    return ""
