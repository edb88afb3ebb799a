import ctypes
import random
import sys

import pytest

from grader.errors import GraderFailure
from grader.recording import zstd

DATA = random.Random(1).randbytes(5_000) * 40


@pytest.mark.parametrize("data", [b"", b"x", DATA], ids=["nothing", "a byte", "much"])
def test_each_reads_what_the_other_writes(data, monkeypatch):
    assert zstd.python() is not None
    assert isinstance(zstd.c_library(), ctypes.CDLL)
    by_python = zstd.compress(data)
    with monkeypatch.context() as patch:
        patch.setattr(zstd, "python", lambda: None)
        by_c = zstd.compress(data)
        assert zstd.decompress(by_python, len(data)) == data
    assert zstd.decompress(by_c, len(data)) == data
    assert len(by_c) < 10_000


@pytest.mark.parametrize("without", ["c_library", "python"])
def test_what_is_of_another_size_or_damaged_is_refused(monkeypatch, without):
    monkeypatch.setattr(zstd, without, lambda: None)
    packed = zstd.compress(DATA)
    assert zstd.decompress(packed, len(DATA)) == DATA
    wrong = [
        *((packed, size) for size in (0, 1, len(DATA) - 1, len(DATA) + 1)),
        *((packed[:end], len(DATA)) for end in (0, 1, 9, len(packed) // 2, len(packed) - 1)),
        (b"\xff" * 99, 99),
        (packed + b"more", len(DATA)),
    ]
    for data, size in wrong:
        with pytest.raises(ValueError, match=f"expected {size} bytes compressed by zstd"):
            zstd.decompress(data, size)


def test_without_any_one_line_says_how_to_get_it(monkeypatch):
    monkeypatch.setattr(zstd, "python", lambda: None)
    monkeypatch.setattr(zstd, "_LIBRARY", "libnone.so.1")
    monkeypatch.setitem(sys.modules, "backports.zstd", None)
    zstd.c_library.cache_clear()
    with pytest.raises(GraderFailure, match=r"backports.zstd is missing .*'backports.zstd>=1'"):
        zstd.compress(b"x")
