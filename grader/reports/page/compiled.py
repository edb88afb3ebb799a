"""Compiled templates kept beside them, as Python keeps compiled modules: in __pycache__."""

from __future__ import annotations

import hashlib
import os
import sys
from contextlib import suppress
from importlib.metadata import version
from importlib.util import cache_from_source
from pathlib import Path

from jinja2.bccache import Bucket, BytecodeCache


class BesideTheTemplates(BytecodeCache):
    """Where nothing can be written, templates are compiled each time.

    jinja2 itself sees whether what it finds is of this source and of Python's version; its own
    version and the settings that compiling depends on are in the file's name.

    Args:
        folder: the templates'.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def load_bytecode(self, bucket: Bucket) -> None:
        """Called by jinja2: fill the bucket, if there is something for it."""
        # a file that is damaged raises anything
        with suppress(Exception), self._file(bucket).open("rb") as file:
            bucket.load_bytecode(file)

    def dump_bytecode(self, bucket: Bucket) -> None:
        """Called by jinja2: keep what is in the bucket."""
        if sys.dont_write_bytecode:
            return
        path = self._file(bucket)
        unfinished = path.with_name(f"{path.name}.{os.getpid()}")
        with suppress(OSError):
            path.parent.mkdir(exist_ok=True)
            unfinished.write_bytes(bucket.bytecode_to_string())
            unfinished.replace(path)

    def _file(self, bucket: Bucket) -> Path:
        of = bucket.environment
        made_by = (version("jinja2"), of.trim_blocks, of.lstrip_blocks, of.autoescape, of.undefined)
        digest = hashlib.sha256(repr((bucket.key, *made_by)).encode()).hexdigest()[:16]
        return Path(cache_from_source(str(self._folder / f"template_{digest}.py")))
