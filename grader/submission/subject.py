"""A package that is examined: nothing of it is started, no clock runs.

Its trace is the one message of a bag: a std_msgs/String with its JSON, at tick 0.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import ClassVar, Final

from grader.recording.mcap import Channel
from grader.recording.recording import Recording
from grader.recording.subject import PACKAGE_SCENE, BagMessage, Start, Trace
from grader.ros.cdr import string, string_of
from grader.scenes.subject import Subject
from grader.scenes.view import Part, View
from grader.submission import inspector, launched
from grader.submission.package_trace import PackageTrace, decode, encode
from grader.text.message import Message, msg
from grader.text.translations import tr

_TOPIC: Final = "/package"
_TYPE: Final = "std_msgs/msg/String"


class PackageSubject(Subject):
    """What an exercise names as `scene: package`."""

    name = PACKAGE_SCENE
    thing = msg("package")
    the_thing = msg("the package")
    outcomes: ClassVar = {
        "finished": msg("the package was looked at"),
        "time limit": msg("looking at the package did not come to an end"),
        "crashed": msg("the package ended the process that looked at it"),
        "killed": msg("the package ended the process that looked at it"),
    }

    def how_to_try(self, program: str, package: str) -> str:
        """With ROS: build it, launch it, look."""
        named = package or "my_robot_description"
        return tr(
            "With ROS 2, in a workspace that holds the package in `src`:\n\n"
            "    colcon build --packages-select {package}\n"
            "    source install/setup.bash\n"
            "    ros2 launch {package} display.launch.py\n\n"
            "A link that RViz shows white, or at the origin, has no transform: nobody publishes "
            "its joint, the Fixed Frame is wrong, or the workspace was built or sourced before the "
            "last change.",
            package=named,
        )

    def untouched(self, start: Start | None) -> Trace:
        """What is left where nobody could look."""
        return PackageTrace()

    def bag_topics(self, made: Trace) -> Iterable[tuple[str, str]]:
        return [(_TOPIC, _TYPE)]

    def to_messages(self, made: Trace) -> list[BagMessage]:
        """The trace as a text, in JSON."""
        data = string(self.encode(made).decode("ascii"))
        return [BagMessage(0, _TOPIC, _TYPE, data)]

    def from_channels(self, channels: Sequence[Channel], duration_ns: int) -> Trace:
        """The trace of the one message."""
        found = [(each.topic, each.msgtype, each.times_ns.tolist()) for each in channels]
        if found != [(_TOPIC, _TYPE, [0])]:
            raise ValueError(f"expected one message on {_TOPIC}, found {found!r:.80}")
        return self.decode(string_of(next(channels[0].messages())).encode("ascii"))

    def encode(self, made: Trace) -> bytes:
        """Serialise a trace as JSON, for a file beside the bag of a run."""
        return encode(PackageTrace.of(made))

    def decode(self, data: bytes) -> Trace:
        return decode(data)

    def view(self, made: Trace) -> View:
        """Return what inspectors show, and the launch files; nothing over time."""
        trace = PackageTrace.of(made)
        drawn: list[Message] = []
        parts: list[Part] = []
        for each in inspector.installed():
            drawn += each.words(trace)
            parts += each.parts(trace)
        return View(drawn=tuple(drawn), parts=(*parts, *launched.tables(trace)))

    def remarks(self, recording: Recording) -> list[Message]:
        """Which package was looked at, and what of it could not be."""
        trace = PackageTrace.of(recording.trace)
        if trace.setup is None:
            return []
        found = [
            msg("{file} could not be evaluated: {why}", file=launch.file, why=launch.problem.text)
            for launch in trace.launches
            if launch.problem is not None and launch.problem.kind == "unknown"
        ]
        found += [
            msg("{file}: {remark}", file=launch.file, remark=remark)
            for launch in trace.launches
            for remark in launch.remarks
        ]
        if trace.others:
            beside = ", ".join(trace.others[:10])
            found.append(
                msg(
                    "judged was the package {name}; beside it lie {others}",
                    name=trace.setup.name,
                    others=beside,
                )
            )
        return found

    def odd_traces(self, setting: str, start: Start | None) -> Mapping[str, Trace]:
        """Return what inspectors have, and a package of which nothing is known."""
        odd: dict[str, Trace] = {"a package that nobody could look at": PackageTrace()}
        for each in inspector.installed():
            odd |= each.odd_traces()
        return odd


PACKAGE: Final = PackageSubject()
