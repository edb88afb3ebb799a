"""The scene `package`: nothing runs beside the submission, which is looked at and not started."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Final, NoReturn

import numpy as np

from grader.language.phrase import say
from grader.language.telling import tell
from grader.scenes.channel import Channel
from grader.scenes.package import described, messages, view
from grader.scenes.package.trace import PackageTrace
from grader.scenes.scene import (
    Behaviour,
    Endpoint,
    Hooks,
    Introduction,
    Limits,
    Message,
    Scene,
    Simulation,
    Start,
    Trace,
)
from grader.scenes.view import Pictures, View

_NOTHING = "nothing runs in the scene 'package'"


class Package:
    """See `grader.scenes.scene.Scene`; it has no nodes, no clock and no place to start."""

    name: Final = "package"
    examiner: Final = "grader/scenes/package/examining/main.py"
    tick_ns: Final = 1
    introduction: Final = Introduction((), (), ())
    thing: Final = "package"
    plane: Final = view.PLANE
    the_thing: Final = say("the package")
    window_is_plane: Final = False
    finished: Final = say("the package was looked at")
    farthest_start_m: Final = 0.0

    def wrong_setting(self, setting: str) -> str:
        """Nothing is set up."""
        return say("package takes none") if setting else ""

    def starts(self, count: int, seed: int, nearest_m: float, farthest_m: float) -> list[Start]:
        """None: a package is looked at once, and its variations are in that."""
        return []

    def interfaces_for(self, surely: Mapping[str, str], perhaps: Mapping[str, str]) -> str:
        """It has no choice."""
        return ""

    def adapted(self, text: str, ros_distro: str) -> str:
        """The same for every release."""
        return text

    def how_to_try(self, program: str, package: str) -> str:
        """With ROS: build it, launch it, look."""
        named = package or "my_robot_description"
        return tell(
            "With ROS 2, in a workspace that holds the package in `src`:\n\n"
            "    colcon build --packages-select {package}\n"
            "    source install/setup.bash\n"
            "    ros2 launch {package} display.launch.py\n\n"
            "A link that RViz shows white, or at the origin, has no transform: nobody publishes "
            "its joint, the Fixed Frame is wrong, or the workspace was built or sourced before the "
            "last change.",
            package=named,
        )

    def preload(self) -> None:
        """Nothing is needed: there is no simulator."""

    def simulate(
        self, limits: Limits, start: Start | None, hooks: Hooks, interfaces: str, setting: str
    ) -> Simulation:
        """There is none."""
        _refuse()

    def untouched(self, start: Start | None) -> Trace:
        """What is left where nobody could look."""
        return PackageTrace()

    def message_definitions(self) -> Mapping[str, str]:
        """That of the one message that holds the trace."""
        return messages.DEFINITIONS

    def bag_topics(self, made: Trace) -> Iterable[tuple[str, str]]:
        """The one."""
        return [(messages.TOPIC, messages.TYPE)]

    def to_messages(self, made: Trace) -> list[Message]:
        """The trace as a text, in JSON."""
        return messages.to_messages(PackageTrace.of(made))

    def from_channels(self, channels: Sequence[Channel], ticks: int) -> Trace:
        """The trace of the one message."""
        return messages.from_channels(channels)

    def scenario(self, made: Trace) -> dict[str, Any]:
        """Nothing that could be replayed."""
        return {}

    def behaviour(self, made: Trace) -> Behaviour:
        """None: a package that is looked at does nothing; its files are compared."""
        return Behaviour((), np.empty((0, 2)))

    def endpoints(self, made: Trace, interfaces: str) -> Sequence[Endpoint]:
        """None."""
        return ()

    def pictures(self, made: Trace) -> Pictures:
        """The robot."""
        return Pictures(described.window(PackageTrace.of(made)))

    def view(self, made: Trace) -> View:
        """The robot and the launch files; nothing over time."""
        return view.view(PackageTrace.of(made))

    def remarks(self, made: Trace, published: Sequence[str], interfaces: str) -> list[str]:
        """Which package was looked at, and what of it could not be."""
        return view.remarks(PackageTrace.of(made))


def _refuse() -> NoReturn:
    raise NotImplementedError(_NOTHING)


SCENE: Scene = Package()
