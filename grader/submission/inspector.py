"""What an exercise has packages inspected for besides: an entry point of `grader.inspections`.

The core evaluates set-ups and launch files, and knows what they install and start. What that means
(a robot, say) an inspector finds out, in the process of the inspection, and shows in reports.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from grader.submission.package_trace import PackageTrace
from grader.text.message import Message

if TYPE_CHECKING:  # a confined process has none of the recording
    from grader.recording.subject import Trace
    from grader.scenes.view import Part
    from grader.submission.examining.examination import Examination


class Inspector(ABC):
    """Finds facts about a package, and shows them. What `examine` imports is small."""

    @abstractmethod
    def examine(self, examination: Examination, trace: PackageTrace) -> PackageTrace:
        """Return the trace of a package with the facts of this inspector.

        It is called in the process of the inspection, where launch files have been evaluated. What
        runs a stranger's code, or reads a stranger's file, is a `grader.submission.examining.
        steps.step`.
        """

    def words(self, trace: PackageTrace) -> Sequence[Message]:
        """Return what there is to see, in words."""
        return ()

    def parts(self, trace: PackageTrace) -> Sequence[Part]:
        """Return what a page shows besides."""
        return ()

    def odd_traces(self) -> Mapping[str, Trace]:
        """Return traces that a package may leave and nobody expects, by their descriptions."""
        return {}


def installed() -> Iterator[Inspector]:
    """Yield all inspectors that are installed."""
    from grader.system import extensions

    for name in extensions.points(extensions.INSPECTIONS):
        yield extensions.load(extensions.INSPECTIONS, name)


def places(names: Sequence[str]) -> list[str]:
    """Return where the inspectors of these names are, such as 'package.module:INSPECTOR'.

    Raises:
        KeyError: one is not installed.
    """
    from grader.system import extensions

    return [extensions.find(extensions.INSPECTIONS, name).value for name in names]
