r"""Hashes of files and folders by what is in them, whatever order they are found in.

The hash of a folder is that of the lines which `sha256sum` prints of its files, sorted by name, so
that anybody can find it out without us:

    cd FOLDER
    find . -type f -printf '%P\n' | LC_ALL=C sort | xargs -d '\n' sha256sum | sha256sum

A link counts as a file that holds where it leads to.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping
from pathlib import Path


def of_folder(folder: Path) -> str:
    """The hash of all files in a folder and below, hexadecimal.

    Raises:
        OSError: one of them cannot be read.
    """
    found: dict[str, str] = {}
    for at, folders, files in os.walk(folder):
        links = (name for name in folders if Path(at, name).is_symlink())
        for path in (Path(at, name) for name in (*files, *links)):
            found[path.relative_to(folder).as_posix()] = _of_link_or_file(path)
    return of_files(found)


def of_files(hashes: Mapping[str, str]) -> str:
    """The hash of files, from their relative names and their own hashes."""
    named = {os.fsencode(name): digest.encode() for name, digest in hashes.items()}
    lines = (_line(name, digest) for name, digest in sorted(named.items()))
    return of_bytes(b"".join(lines))


def of_file(path: Path) -> str:
    """The hash of a file, hexadecimal.

    Raises:
        OSError: it cannot be read.
    """
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def of_bytes(data: bytes) -> str:
    """The hash of what a file holds, hexadecimal."""
    return hashlib.sha256(data).hexdigest()


def _of_link_or_file(path: Path) -> str:
    return of_bytes(os.fsencode(path.readlink())) if path.is_symlink() else of_file(path)


def _line(name: bytes, digest: bytes) -> bytes:
    """As sha256sum writes it: a name with a line end in it cannot stand for two names."""
    escaped = name.replace(b"\\", b"\\\\").replace(b"\n", b"\\n").replace(b"\r", b"\\r")
    mark = b"" if escaped == name else b"\\"
    return mark + digest + b"  " + escaped + b"\n"
