"""Finds the packages of a submission that is not started: all of a folder or an archive."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from grader.errors import SubmissionError
from grader.submission.folder import CMAKE, SETUP_FILES
from grader.submission.manifest import FILE, read_manifest
from grader.submission.refusals import PACKAGE
from grader.submission.request import Request
from grader.submission.start import Submission
from grader.submission.unpacking import opened
from grader.text.message import msg, msg_many
from grader.text.strings import listed, nearest, shown

_MARKS: Final = (FILE, CMAKE, *SETUP_FILES)


def find(path: Path, package: str | None, scratch: Path) -> Submission:
    """Find the packages in a submission.

    Args:
        package: chooses among them, by name.
        scratch: an empty folder, for what has to be unpacked.
    """
    submitted, files, _ = opened(path, Request(package, is_started=False), scratch)
    name = submitted.name
    folders = sorted({file.parent for file in files if file.name in _MARKS})
    if not folders:
        names = [submitted.called(file) for file in files]
        raise SubmissionError(
            "{name} holds no ROS 2 package: no package.xml, setup.py or "
            "CMakeLists.txt (it holds: {names}). {hand_in}",
            name=name,
            names=listed(names) or msg("only folders that are not searched"),
            hand_in=PACKAGE,
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
