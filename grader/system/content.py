r"""Hashes of files and folders by their contents, independent of the order of listing.

The hash of a folder is that of the lines which `sha256sum` prints for its files, sorted by name, so
that anybody can compute it without the grader:

    cd FOLDER
    find . -type f -printf '%P\n' | LC_ALL=C sort | xargs -d '\n' sha256sum | sha256sum

A link counts as a file that holds its target.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping
from pathlib import Path


def of_folder(folder: Path, without: Path | None = None) -> str:
    """Return the hash of all files in a folder and below, hexadecimal; without one folder."""
    found: dict[str, str] = {}
    for at, folders, files in os.walk(folder):
        folders[:] = [name for name in folders if Path(at, name) != without]
        links = (name for name in folders if Path(at, name).is_symlink())
        for path in (Path(at, name) for name in (*files, *links)):
            is_link = path.is_symlink()
            digest = of_bytes(os.fsencode(path.readlink())) if is_link else of_file(path)
            found[path.relative_to(folder).as_posix()] = digest
    return of_files(found)


def of_files(hashes: Mapping[str, str]) -> str:
    """Return the hash of files, from their relative names and their hashes."""
    named = {os.fsencode(name): digest.encode() for name, digest in hashes.items()}
    lines = (_line(name, digest) for name, digest in sorted(named.items()))
    return of_bytes(b"".join(lines))


def of_file(path: Path) -> str:
    """Return the hash of a file, hexadecimal."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def of_bytes(data: bytes) -> str:
    """Return the hash of a file's contents, hexadecimal."""
    return hashlib.sha256(data).hexdigest()


def _line(name: bytes, digest: bytes) -> bytes:
    """Format a line as sha256sum does: a name with a line end in it is not two names."""
    escaped = name.replace(b"\\", b"\\\\").replace(b"\n", b"\\n").replace(b"\r", b"\\r")
    mark = b"" if escaped == name else b"\\"
    return mark + digest + b"  " + escaped + b"\n"
