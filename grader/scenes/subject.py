"""The subject of a recording as it is shown: its words, pictures and pages.

It is a scene that ran beside a submission, or an inspected package. Nothing here needs ROS.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar, NamedTuple

from grader.recording.recording import Recording
from grader.recording.subject import Endpoint, Keeper, Start, Trace, load_keeper
from grader.scenes.view import Plane, View
from grader.text.message import NOTHING, Message, msg

#: Inputs of a submission's against the rules: when [ns from the start], '/turtle2/set_pen'.
Oversteps = Sequence[tuple[int, str]]


class Rules(NamedTuple):
    """What an exercise lets a submission use of a scene.

    Attributes:
        may: services and actions, 'spawn', or of one thing alone, 'turtle1/set_pen'.
        drives: the things that it may drive.
        setting: what the scene is set up with.
    """

    may: tuple[str, ...] = ()
    drives: tuple[str, ...] = ()
    setting: str = ""


class Subject(Keeper):
    """The subject of recordings, which an exercise names as its `scene:`."""

    #: What a submission drives, or what is inspected, with its article: 'the turtle'.
    the_thing: ClassVar[Message]
    #: The same without an article.
    thing: ClassVar[Message]
    #: How a run ended -> that as a clause, 'the turtle came to rest', where it is not as for any
    #: node. The keys are those of `grader.reports.wording.OUTCOMES`.
    outcomes: ClassVar[Mapping[str, Message]] = {}
    #: How places become pixels.
    plane: ClassVar[Plane] = Plane(500, 1.0, 500.0)
    #: The services and actions that an exercise may allow, each by the last part of its name; none
    #: where inputs of a submission are not told from those of others.
    inputs: ClassVar[tuple[str, ...]] = ()

    # How it is shown ------------------------------------------------------------------------------

    def view(self, trace: Trace) -> View:
        """Return the trace as a page shows it."""
        return View()

    def remarks(self, recording: Recording) -> list[Message]:
        """Return what a reader of any exercise's result should know about the run."""
        return []

    def endpoints(self, trace: Trace, interfaces: str) -> Sequence[Endpoint]:
        """Return the endpoints that a submission could have met in a run; the usual ones first.

        Args:
            interfaces: with which the scene was run.
        """
        return ()

    @property
    def player(self) -> Callable[[Any], str] | None:
        """Renders a page that plays runs, HTML that needs no other file; None: there is none.

        It is called with a `grader.scenes.playback.Playback`, and raises RecordingError where a
        run cannot be played.
        """
        return None

    # What an exercise sets about it ---------------------------------------------------------------

    def wrong_setting(self, setting: str) -> Message:
        """Say why a scene cannot be set up with an exercise's setting; NOTHING where it can.

        Args:
            setting: the text of a file of the exercise's, as a robot's description; '' for none.
        """
        return msg("{scene} takes none", scene=self.name) if setting else NOTHING

    def within(self, trace: Trace, cast: Trace | None, rules: Rules) -> tuple[Trace, Oversteps]:
        """Return the trace without what was moved against rules, and the inputs that did so.

        Args:
            cast: what scripted peers have sent, which is not the submission's.
        """
        return trace, ()

    def adapted(self, text: str, ros_distro: str) -> str:
        """Adapt a Python file or a package.xml to a ROS 2 release, named as in ROS_DISTRO."""
        return text

    def how_to_try(self, program: str, package: str) -> str:
        """Describe how a student tries a solution by hand, in Markdown; '' for nothing.

        Args:
            program: the node's Python file, as the folder above that of the submission finds it.
            package: the ROS package that it is in; '' for none.
        """
        return ""

    def odd_traces(self, setting: str, start: Start | None) -> Mapping[str, Trace]:
        """Return traces that checks have to survive, by their descriptions: 'a node that jumps'.

        Args:
            setting: of the exercise whose checks are tried.
            start: where the runs begin.
        """
        return {}


def load_subject(name: str) -> Subject:
    """Load the subject that an exercise names as its `scene:`; see `load_keeper`."""
    subject = load_keeper(name)
    assert isinstance(subject, Subject), f"{name} is no Subject"
    return subject
