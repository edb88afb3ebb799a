"""Unpack the archive of a whole class, by the unpacker of submissions, within larger limits.

A course's server made it, with names and contents from students. A member that cannot be used is
left out and reported: one student must not keep the others from being graded. The students'
archives inside of it are not unpacked here.
"""

from __future__ import annotations

import errno
from collections import defaultdict
from pathlib import Path
from typing import Final

from grader.errors import SubmissionError, UsageError
from grader.message import Message, msg
from grader.submission.archive import unpack as unpack_archive
from grader.submission.folder import listed, shown
from grader.submission.safe_members import ArchiveLimits, Budget, Member, TooMuch

LIMITS: Final = ArchiveLimits(
    most_bytes=50_000_000_000, most_files=500_000, list_bytes=20_000_000, headers=500_000
)
_INSTEAD: Final = msg("Unpack it yourself, and give the folder.")
#: Of a member whose name or place does not suit this system: of no other, as a full disk is.
_UNWRITABLE: Final = (
    *(errno.EINVAL, errno.EILSEQ, errno.ENAMETOOLONG),
    *(errno.ENOTDIR, errno.EISDIR, errno.EEXIST),
)
_REFUSED: Final = msg(
    "is encrypted, a link, no ordinary file or would be written outside of its folder, and is left "
    "out"
)
_CANNOT_BE_WRITTEN: Final = msg("cannot be written here")
_DAMAGED: Final = msg("is damaged, and kept as far as it goes")


def unpack(archive: Path, into: Path) -> list[Message]:
    """Unpack the archive of a class into `into`, a folder to be made; return notes."""
    odd: dict[Message, list[str]] = defaultdict(list)

    def report(member: Member, error: Exception) -> None:
        if isinstance(error, SubmissionError):
            odd[_REFUSED].append(member.name)
        elif isinstance(error, OSError) and error.errno in _UNWRITABLE:
            odd[_CANNOT_BE_WRITTEN].append(member.name)
        elif isinstance(error, OSError) and error.errno is not None:
            raise error
        else:
            odd[_DAMAGED].append(member.name)

    into.mkdir()
    try:
        unpack_archive(archive, into, Budget(LIMITS), report)
    except TooMuch:
        raise UsageError(
            "{name} unpacks to more than {size:g} GB, or {files:,} files, the limit for a class. "
            "{instead}",
            name=shown(archive.name),
            size=LIMITS.most_bytes / 1e9,
            files=LIMITS.most_files,
            instead=_INSTEAD,
        ) from None
    except SubmissionError as error:
        raise UsageError(error.message.given(pack_again=_INSTEAD)) from None
    return [
        msg(
            "Of what {name} holds, some {what}: {names}.",
            name=shown(archive.name),
            what=what,
            names=listed(names),
        )
        for what, names in odd.items()
    ]
