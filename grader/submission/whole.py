"""Finds the packages of a submission that is not started: all of a folder or an archive."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Final

from grader.errors import SubmissionError
from grader.message import msg, msg_many
from grader.submission.folder import SETUP_FILES, SubmissionFolder, files_below, top_of
from grader.submission.manifest import FILE, read_manifest
from grader.submission.refusals import missing
from grader.submission.start import Submission
from grader.submission.unpacking import Unpacking, is_archive
from grader.text import listed, nearest, shown

_HAND_IN: Final = msg("Hand in the folder of your ROS 2 package, or a .zip of it.")
_MARKS: Final = (FILE, "CMakeLists.txt", *SETUP_FILES)


def find(path: Path, package: str | None, scratch: Path) -> Submission:
    """Find the packages in a submission.

    Args:
        package: chooses among them, by name.
        scratch: an empty folder, for what has to be unpacked.
    """
    submitted, files = opened(path, scratch, lambda file: file.name in _MARKS)
    name = submitted.name
    folders = sorted({file.parent for file in files if file.name in _MARKS})
    if not folders:
        names = [submitted.called(file) for file in files]
        raise SubmissionError(
            "{name} holds no ROS 2 package: no package.xml, setup.py or "
            "CMakeLists.txt (it holds: {names}). {hand_in}",
            name=name,
            names=listed(names) or msg("only folders that are not searched"),
            hand_in=_HAND_IN,
        )
    manifests = (read_manifest(each / FILE) for each in folders if (each / FILE).is_file())
    names = sorted({shown(each.name) for each in manifests if each is not None and each.name})
    if package is not None and package not in names:
        meant = nearest(package, names) or names
        raise SubmissionError(
            "{name} has no package {package}; there is: {names}.",
            name=name,
            package=shown(package),
            names=listed(meant) or msg("none"),
        )
    found = msg("a package without {file}", file=FILE)
    if names:
        found = msg_many("the package {names}", "packages {names}", len(names), names=listed(names))
    return Submission(name, submitted.base, (), found, asked=package or "")


def opened(
    path: Path, scratch: Path, is_part: Callable[[Path], bool]
) -> tuple[SubmissionFolder, list[Path]]:
    """Return the folder of a submission, unpacked, and its files.

    Args:
        scratch: an empty folder, for what has to be unpacked.
        is_part: whether a file is one of a submission; where none is, the one archive is it.
    """
    name = shown(path.name or path.resolve().name)
    if not path.exists():
        raise missing(path)
    unpacking = Unpacking(scratch)
    if path.is_dir():
        submitted = SubmissionFolder(name, path.resolve())
    elif is_archive(path):
        submitted = SubmissionFolder(name, unpacking.unpack(path))
    else:
        raise SubmissionError(
            "{name} is neither a folder nor a .zip or .tar.gz. {hand_in}",
            name=name,
            hand_in=_HAND_IN,
        )
    files = files_below(top_of(submitted.base))
    archives = [file for file in files if is_archive(file)]
    if len(archives) == 1 and not any(map(is_part, files)):
        submitted.must_hold(archives[0])
        submitted = SubmissionFolder(name, unpacking.unpack(archives[0]))
        files = files_below(top_of(submitted.base))
    return submitted, files
