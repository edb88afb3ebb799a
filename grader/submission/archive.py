"""Unpacks a submitted archive without trusting it: nothing outside its folder, no links, no bomb.

A zip in a zip is unpacked as well (`finding.py`); all levels share one `Budget`.
"""

from __future__ import annotations

import errno
import lzma
import struct
import tarfile
import zipfile
import zlib
from pathlib import Path
from typing import Final

from grader.errors import SubmissionError
from grader.message import Message, as_message, msg, plain_text
from grader.submission import archive_members
from grader.submission.folder import MAX_BYTES, shown
from grader.submission.safe_members import PACK_AGAIN, Budget, ListTooLong, write

#: What an archive that is damaged, or made to look so, makes its reader raise.
DAMAGED: Final = (
    *(zipfile.BadZipFile, tarfile.TarError, zlib.error, lzma.LZMAError, struct.error, EOFError),
    *(ValueError, OverflowError, RuntimeError),
)
# damage as an OSError: bz2's and gzip's have no number, EINVAL is a position before the file's
# start; the others are members in each other's way
_DAMAGED_ERRNOS: Final = (
    *(None, errno.EINVAL, errno.ENOTDIR),
    *(errno.EISDIR, errno.EEXIST, errno.ENAMETOOLONG),
)


def unpack(archive: Path, into: Path, budget: Budget) -> None:
    """Write the files of an archive below `into`; caches, venvs and colcon's output stay out.

    Args:
        into: an empty folder.

    Raises:
        SubmissionError: it is empty, damaged, encrypted or too large, or it reaches outside.
    """
    name = shown(archive.name)
    size = archive.stat().st_size
    if size == 0:
        raise SubmissionError(
            "{name} is empty (0 bytes). {pack_again}", name=name, pack_again=PACK_AGAIN
        )
    if size > MAX_BYTES:
        raise SubmissionError(
            "{name} has more than {max_bytes:g} MB, the limit for a submission. "
            "Leave out recordings, videos and virtual environments, and pack it "
            "again.",
            name=name,
            max_bytes=MAX_BYTES / 1e6,
        )
    is_zip = archive.suffix.lower() == ".zip"
    kind = "zip" if is_zip else "tar"
    try:
        with (
            archive_members.opened_zip(archive)
            if is_zip
            else archive_members.opened_tar(archive, into.with_suffix(".tar"))
        ) as members:
            write(name, members, into, budget)
    except ListTooLong as error:
        raise SubmissionError(
            "{name} lists too many files, or too long names: {error}. {pack_again}",
            name=name,
            error=error.args[0],
            pack_again=PACK_AGAIN,
        ) from error
    except NotImplementedError as error:
        raise SubmissionError(
            "{name} is packed in a way that cannot be read here ({why}). {pack_again}",
            name=name,
            why=shown(str(error)),
            pack_again=PACK_AGAIN,
        ) from error
    except DAMAGED as error:
        raise _damaged(
            name, kind, as_message(shown(str(error))) or msg("it ends too early")
        ) from error
    except OSError as error:
        if error.errno not in _DAMAGED_ERRNOS:
            raise
        raise _damaged(name, kind, plain_text(shown(error.strerror or str(error)))) from error


def _damaged(name: str, kind: str, why: Message) -> SubmissionError:
    return SubmissionError(
        "{name} cannot be unpacked as a {kind} file: {why}. {pack_again}",
        name=name,
        kind=kind,
        why=why,
        pack_again=PACK_AGAIN,
    )
