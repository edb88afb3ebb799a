"""The members of a zip, read without trusting its headers."""

from __future__ import annotations

import stat
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Final

from grader.message import NOTHING, Message, msg
from grader.submission.folder import shown
from grader.submission.safe_members import PACK_AGAIN, Bounded, Member

#: Of the list of members, all of them. It is read at once, and becomes 50 times as large.
MAX_LIST_BYTES: Final = 6_000_000

# bits of the general purpose flags (APPNOTE.TXT 4.4.4)
_ENCRYPTED: Final = 0x1
_UTF_8: Final = 0x800


@contextmanager
def opened(archive: Path, most: int | None = None) -> Iterator[list[Member]]:
    """Open a zip: its members.

    Args:
        most: so large the list of members may be [bytes]; else as large as a submission's.

    Raises:
        ListTooLong: there are too many members, or their names are too long.
        NotImplementedError: it is packed in a way that Python does not know.
        Exception: it is damaged; see `archive.DAMAGED`.
    """
    most = most or MAX_LIST_BYTES
    why = msg("its list has more than {most:g} MB", most=most / 1e6)
    with Bounded(archive, most, why) as file, zipfile.ZipFile(file) as packed:
        yield [
            Member(
                _name(info),
                info.filename.endswith(("/", "\\")),
                _refusal(info),
                partial(packed.open, info),
            )
            for info in packed.infolist()
        ]


def _name(info: zipfile.ZipInfo) -> str:
    """A member's name, also where a program writes UTF-8 without its flag, as that of macOS."""
    if info.flag_bits & _UTF_8 or info.filename.isascii():
        return info.filename
    try:
        return info.filename.encode("cp437").decode("utf-8")
    except UnicodeError:
        return info.filename


def _refusal(info: zipfile.ZipInfo) -> Message:
    path = shown(_name(info).replace("\\", "/"))
    if info.flag_bits & _ENCRYPTED:
        return msg(
            "is encrypted: {path} asks for a password. Pack it again without a password.", path=path
        )
    kind = stat.S_IFMT(info.external_attr >> 16)
    if kind == stat.S_IFLNK:
        return msg(
            "holds {path} as a symbolic link. Pack it again with the file itself in that place.",
            path=path,
        )
    if kind not in (0, stat.S_IFREG):
        return msg(
            "holds {path}, which is not an ordinary file. {pack_again}",
            path=path,
            pack_again=PACK_AGAIN,
        )
    return NOTHING
