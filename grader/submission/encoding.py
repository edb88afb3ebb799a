"""Checks whether Python can read the bytes of a file as a program, and says why if not.

`python3 FILE` refuses what is not in the encoding that the file declares, UTF-8 where it declares
none. An import of the same file is laxer in older Pythons: it passes over such bytes in comments.
"""

from __future__ import annotations

import codecs
import io
import tokenize
from collections.abc import Iterable
from pathlib import Path
from typing import Final

from grader.message import NOTHING, Message, joined, msg
from grader.submission.folder import read_bounded, shown

_SAVE: Final = msg("save it as UTF-8")
_UTF_16: Final = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)


def fault(data: bytes) -> Message:
    """Say why Python refuses a file with these bytes, as what follows its name; '' if it does not.

    "is saved as UTF-16, and Python reads UTF-8: save it as UTF-8"
    """
    if data.startswith(_UTF_16):
        return msg("is saved as UTF-16, and Python reads UTF-8: {save}", save=_SAVE)
    if b"\0" in data:
        return msg(
            "has a null byte in line {line}, as no text has: {save}",
            line=_line(data, data.index(0)),
            save=_SAVE,
        )
    try:
        encoding = _declared(data)
        data.decode(encoding)
    except UnicodeDecodeError as error:
        return msg(
            "has a byte (0x{byte:02x}) in line {line} that is no {encoding}, so that"
            " `python3` refuses it: {save}",
            byte=error.object[error.start],
            line=_line(data, error.start),
            encoding=shown(encoding.removesuffix("-sig").upper()),
            save=_SAVE,
        )
    except (SyntaxError, LookupError, ValueError):
        pass  # of the declaration: Python's own words are clear
    return NOTHING


def faults(files: Iterable[Path], root: Path) -> list[Message]:
    """A sentence on each of some files below a folder that Python refuses for its bytes."""
    found: list[Message] = []
    for file in files:
        try:
            why = fault(read_bounded(file) or b"")
        except OSError:
            continue
        found += [joined([shown(file.relative_to(root)), why], " ")] if why else []
    return found


def _declared(data: bytes) -> str:
    """The encoding by the first two lines; their own bytes are not judged here.

    Raises:
        SyntaxError: there is no such encoding, or it contradicts the mark at the beginning.
    """
    mark = codecs.BOM_UTF8 if data.startswith(codecs.BOM_UTF8) else b""
    plain = data[len(mark) :].decode("ascii", "replace").encode("ascii", "replace")
    return tokenize.detect_encoding(io.BytesIO(mark + plain).readline)[0]


def _line(data: bytes, at: int) -> int:
    return data.count(b"\n", 0, at) + 1
