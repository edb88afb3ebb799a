"""Zstandard, with which the chunks of a bag are compressed.

Python has it from 3.14 on, and pip brings it to an older one. ROS's package index has neither for
Ubuntu 24.04: there the C library is called, without which Ubuntu installs no package.
"""

from __future__ import annotations

import ctypes
import sys
from contextlib import suppress
from functools import cache
from typing import Any, Final

from grader.system.requirements import require

_LIBRARY: Final = "libzstd.so.1"
#: zstd's own default, as Python's is.
_LEVEL: Final = 3


def compress(data: bytes) -> bytes:
    if found := python():
        return bytes(found.compress(data))
    library = c_library()
    room = ctypes.create_string_buffer(library.ZSTD_compressBound(len(data)))
    size = library.ZSTD_compress(room, len(room), data, len(data), _LEVEL)
    return ctypes.string_at(room, size)


def decompress(packed: bytes, size: int) -> bytes:
    """Decompress a frame of so many bytes; nothing is made of one of more."""
    wrong = f"expected {size} bytes compressed by zstd"
    if found := python():
        unpacking = found.ZstdDecompressor()
        try:
            data = bytes(unpacking.decompress(packed, size + 1))
        except found.ZstdError as error:
            raise ValueError(f"{wrong}: {error}") from None
        if len(data) != size or not unpacking.eof or unpacking.unused_data:
            raise ValueError(wrong)
        return data
    library = c_library()
    room = ctypes.create_string_buffer(size or 1)
    # an error is a number near the greatest one
    if library.ZSTD_decompress(room, size, packed, len(packed)) != size:
        raise ValueError(wrong)
    return ctypes.string_at(room, size)


@cache
def python() -> Any:
    """Return Python's module, or pip's, which is the same; None where there is neither."""
    with suppress(ImportError):
        if sys.version_info >= (3, 14):
            from compression import zstd
        else:
            from backports import zstd
        return zstd
    return None


@cache
def c_library() -> Any:
    try:
        library = ctypes.CDLL(_LIBRARY)
    except OSError:
        require("backports.zstd")
        raise
    size, data = ctypes.c_size_t, ctypes.c_char_p
    for name, arguments in {
        "ZSTD_compressBound": [size],
        "ZSTD_compress": [data, size, data, size, ctypes.c_int],
        "ZSTD_decompress": [data, size, data, size],
    }.items():
        function = getattr(library, name)
        function.argtypes, function.restype = arguments, size
    return library
