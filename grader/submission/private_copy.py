"""Copies a submission for its runs alone: they see nothing that lies beside it.

A submission's process that ran in the original place could read its neighbours, and write into them
and into its own source. So there is one read-only copy for a grading: all of its runs are of the
same files, whatever becomes of the original. Each run gets a writable copy of that
(`grader.run.processes.levels.prepare`): in the memory of its process where that has a file system
of its own, else in the run's folder. People are shown the original paths.

All files of a folder are copied but what a system or a program has left there, as out of a zip.
Links that stay inside remain links; what is no file, no folder and no such link is left out.
"""

from __future__ import annotations

import errno
import importlib.util
import os
import re
import stat
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from itertools import count
from pathlib import Path
from sys import stdlib_module_names
from typing import TYPE_CHECKING, Final

from grader.errors import SubmissionError
from grader.submission import safe_files
from grader.submission.folder import (
    MAX_BYTES,
    MAX_ENTRIES,
    UNREADABLE,
    is_generated,
    is_junk,
    too_many,
)
from grader.text.message import Message, msg
from grader.text.strings import listed, shown

if TYPE_CHECKING:
    from grader.submission.answer import SetUp

#: Where ROS looks for which packages there are: a file in their names, which colcon adds.
_MARKS: Final = "share/ament_index/resource_index/packages"
_SHARE_OF: Final = re.compile(r"^share/(?!ament_index/)(\w+)/", re.MULTILINE)
MAX_LEVELS: Final = 32  # of folders; what lies deeper is left out
_CHUNK_BYTES: Final = 1 << 20

_OUTSIDE: Final = msg("not handed in, but links to somewhere else: {names}")
_FAILED: Final = msg("left out, since they cannot be copied: {names}")
#: Folders that are not searched for what to start: they are copied last, if there is room.
_LAST: Final = {"venv", "env", "test", "tests", "build", "install", "log"}
_BINARY: Final = getattr(os, "O_BINARY", 0)
_READ: Final = os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0) | _BINARY
_WRITE: Final = os.O_WRONLY | os.O_CREAT | os.O_EXCL | _BINARY
#: Where the middle of a long output is missing; see `grader.run.processes.started_process`.
_LEFT_OUT: Final = re.compile(r"(\n\[\.\.\. \d+ bytes left out \.\.\.\]\n)")
#: So much of a path that was cut through is known as part of one: less are letters like others.
_LEAST: Final = 8


@dataclass(frozen=True)
class PrivateCopy:
    """The copy of a submission for its runs.

    Attributes:
        folder: all of it, absolute, without links in its own path.
        origin: the original: the folder that was copied, or the zip.
        prefix: how paths into the copy begin, the part of them that is another each time.
        shown: what people are shown instead of that.
        beside: the folder of a single file that was submitted; None for all else.
        remarks: for the result: what was left out.
        installed: the prefix below which packages are laid out as installed; None where none are.
    """

    folder: Path
    origin: Path
    prefix: str
    shown: str
    beside: Path | None = None
    remarks: tuple[Message, ...] = ()
    installed: Path | None = None

    def of(self, path: Path) -> Path:
        """Map a path of the original into the copy; one that is in the copy stays."""
        if path.is_relative_to(self.folder):
            return path
        return self.folder / path.relative_to(self.origin)

    def moved(self, folder: Path) -> PrivateCopy:
        """Return the same copy, moved to another folder of this name."""
        is_all = self.prefix == str(self.folder)
        installed = self.installed and folder / self.installed.name
        prefix = str(folder if is_all else folder.parent)
        return replace(self, folder=folder, prefix=prefix, installed=installed)

    def with_original_paths(self, text: str) -> str:
        """Replace the copy's paths in a run's output by the original ones."""
        text = text.replace(self.prefix, self.shown)
        first, *parts = _LEFT_OUT.split(text)
        made = [self._with_whole_end(first)]
        for note, part in zip(parts[::2], parts[1::2], strict=True):
            made += [note, self._with_whole_end(self._with_whole_start(part))]
        return "".join(made)

    def _with_whole_end(self, text: str) -> str:
        """Replace the start of the copy's path at the end of a text that was cut within it."""
        for size in range(len(self.prefix) - 1, _LEAST - 1, -1):
            if text.endswith(self.prefix[:size]):
                return text[:-size] + self.shown[:size]
        return text

    def _with_whole_start(self, text: str) -> str:
        for size in range(len(self.prefix) - 1, _LEAST - 1, -1):
            if text.startswith(self.prefix[-size:]):
                return self.shown[-size:] + text[size:]
        return text


def copy_privately(path: Path, root: Path, scratch: Path) -> PrivateCopy:
    """Copy a submission, unless it was unpacked or completed in the scratch folder already.

    Args:
        path: the submission.
        root: the folder to start it from; below `scratch` if it is a copy already.
        scratch: a folder for the copy, without links in its path.
    """
    origin = path.resolve() if path.is_dir() else path.parent.resolve() / path.name
    if root.is_relative_to(scratch):
        unpacked = scratch / root.relative_to(scratch).parts[0]
        _close(unpacked)
        return PrivateCopy(unpacked, origin, str(unpacked), str(origin))
    base = origin if path.is_dir() else origin.parent
    copies = scratch / "copy"
    folder = copies / (base.name or "submission")
    remarks: tuple[Message, ...] = ()
    if path.is_dir():
        remarks = copy_folder(base, folder)
    else:
        folder.mkdir(parents=True)
        _Copying(base).copy_alone(origin, folder)
    _close(copies)
    return PrivateCopy(
        folder,
        base,
        prefix=str(copies),
        shown=str(base.parent).rstrip(os.sep),
        beside=None if path.is_dir() else base,
        remarks=remarks,
    )


def install(copy: PrivateCopy, set_ups: Iterable[SetUp]) -> PrivateCopy:
    """Lay out below a prefix in a copy what packages install, as `--symlink-install` does.

    Packages in Python are not laid out: their folders are on the path of each program.
    """
    free = (copy.folder / f".installed{number or ''}" for number in count())
    prefix = next(path for path in free if not os.path.lexists(path))
    copy.folder.chmod(0o755)
    prefix.mkdir()
    for each in set_ups:
        for path, file in each.installed.items():
            link, to = prefix / path, copy.folder / each.folder / file
            # they are a stranger's: within the copy, and a file, through which nothing is made
            if _within(link, prefix) and _within(to, copy.folder) and safe_files.is_file(to):
                _link(link, to)
        for name in {*re.findall(_SHARE_OF, "\n".join(each.installed))}:
            safe_files.touch(prefix / _MARKS / name)
    _close(prefix, within=copy.folder)
    copy.folder.chmod(0o555)
    return replace(copy, installed=prefix)


def _within(path: Path, folder: Path) -> bool:
    return Path(os.path.normpath(path)).is_relative_to(folder)


def _link(link: Path, to: Path) -> None:
    """Make a link that stays right where the copy is moved."""
    with suppress(OSError, ValueError):  # its name is none that a file can have, or there is one
        link.parent.mkdir(parents=True, exist_ok=True)
        link.symlink_to(os.path.relpath(to, link.parent))


def copy_folder(top: Path, into: Path) -> tuple[Message, ...]:
    """Copy a folder into a new one; return remarks on what was left out."""
    into.mkdir(parents=True)
    copying = _Copying(top)
    copying.copy_all(into)
    return copying.remarks()


def missing_neighbours(
    name: str, copy: PrivateCopy | None, modules: Iterable[str]
) -> tuple[Message, ...]:
    """Return notes on modules that lie beside a single file that imports them, and are missing.

    Args:
        name: what the file is called.
        copy: of the file.
        modules: the first parts of the names of what it imports and does not bring along.
    """
    if copy is None or (beside := copy.beside) is None:
        return ()
    found = [lying for module in modules if (lying := _lying(beside, module))]
    return tuple(
        msg(
            "{module} lies beside {name}, but was not handed in: grade the folder",
            module=shown(each),
            name=shown(name),
        )
        for each in found
    )


def _lying(folder: Path, module: str) -> str:
    """Name the file of a folder that an import would have found, if it finds none now; else ''."""
    with suppress(ImportError, ValueError, OSError):  # no such name can be imported at all
        for file, called in ((f"{module}.py", f"{module}.py"), (f"{module}/__init__.py", module)):
            if (folder / file).is_file() and module not in stdlib_module_names:
                spec = importlib.util.find_spec(module)
                origin = "" if spec is None else spec.origin or ""
                return called if not spec or Path(origin).is_relative_to(folder) else ""
    return ""


def _close(folder: Path, within: Path | None = None) -> None:
    """Make all of a folder read-only, and remove links that lead out of it, or of another."""
    base = os.path.realpath(within or folder)
    for at, folders, files in os.walk(folder, topdown=False):
        for name in (*folders, *files):
            path = Path(at, name)
            mode = path.lstat().st_mode
            if stat.S_ISLNK(mode):
                if not Path(os.path.realpath(path)).is_relative_to(base):
                    path.unlink()
            elif stat.S_ISREG(mode):
                path.chmod(0o555 if mode & stat.S_IXUSR else 0o444)
        Path(at).chmod(0o555)


@dataclass
class _Copying:
    """A copying in progress.

    Attributes:
        top: the folder that is copied, without links in its path.
        entries: how many files, folders and links have been seen.
        size: how many bytes have been copied.
        outside, failed: what was left out, and why.
        pending, last: folders to be copied, into which, and how many levels down.
    """

    top: Path
    entries: int = 0
    size: int = 0
    outside: list[str] = field(default_factory=list)
    failed: list[str] = field(default_factory=list)
    pending: list[tuple[Path, Path, int]] = field(default_factory=list)
    last: list[tuple[Path, Path, int]] = field(default_factory=list)

    def remarks(self) -> tuple[Message, ...]:
        """Return the remarks on what was left out."""
        left_out = {_OUTSIDE: self.outside, _FAILED: self.failed}
        return tuple(why.given(names=listed(names)) for why, names in left_out.items() if names)

    def copy_alone(self, file: Path, into: Path) -> None:
        real = file.resolve()
        if not real.is_relative_to(self.top):
            raise SubmissionError(
                "{name} is a link to a place outside of its folder. Hand in the file itself.",
                name=shown(file.name),
            )
        self._copy_file(real, into / file.name)

    def copy_all(self, into: Path) -> None:
        """Copy the folder into an empty one."""
        self.pending.append((self.top, into, 0))
        self._go_on()
        last = sorted(self._called(source) for source, _, _ in self.last)
        self.pending = self.last
        try:
            self._go_on()
        except SubmissionError:
            self.failed += last

    def _go_on(self) -> None:
        while self.pending:
            source, target, level = self.pending.pop()
            with self._reading(source), os.scandir(source) as entries:
                for entry in entries:
                    self.entries += 1
                    if self.entries > MAX_ENTRIES:
                        raise too_many(self.top)
                    with self._reading(Path(entry.path)):
                        self._copy(entry, target / entry.name, level + 1)

    def _copy(self, entry: os.DirEntry[str], target: Path, level: int) -> None:
        source = Path(entry.path)
        if entry.is_symlink():
            real = Path(os.path.realpath(source))
            if real.is_relative_to(self.top):
                target.symlink_to(os.path.relpath(real, source.parent))
            else:
                self.outside.append(self._called(source))
        elif entry.is_dir():
            if is_junk(entry.name) or is_generated(source):
                return
            if level > MAX_LEVELS:
                raise OSError(errno.ENAMETOOLONG, "it lies too deep")
            target.mkdir()
            (self.last if entry.name in _LAST else self.pending).append((source, target, level))
        elif entry.is_file():
            self._copy_file(source, target)

    def _copy_file(self, source: Path, target: Path) -> None:
        """Copy what is an ordinary file also when it is opened, and not more than allowed."""
        with os.fdopen(os.open(source, _READ), "rb") as reading:
            mode = os.fstat(reading.fileno()).st_mode
            if not stat.S_ISREG(mode):
                raise OSError(errno.ENXIO, "it is no file any more")
            permission = stat.S_IRWXU if mode & stat.S_IXUSR else stat.S_IRUSR | stat.S_IWUSR
            with os.fdopen(os.open(target, _WRITE, permission), "wb") as writing:
                while chunk := reading.read(_CHUNK_BYTES):
                    self.size += len(chunk)
                    if self.size > MAX_BYTES:
                        raise SubmissionError(
                            "{name} has more than {max_bytes:g} MB, the limit for a "
                            "submission. Leave out recordings and videos, and hand it in "
                            "again.",
                            name=shown(self.top.name),
                            max_bytes=MAX_BYTES / 1e6,
                        )
                    writing.write(chunk)

    @contextmanager
    def _reading(self, source: Path) -> Iterator[None]:
        """Note the file of an OSError as left out, unless the machine is at fault."""
        try:
            yield
        except OSError as error:
            if error.errno not in UNREADABLE:
                raise
            self.failed.append(self._called(source))

    def _called(self, path: Path) -> str:
        return str(path.relative_to(self.top))
