"""turtlesim as a scene: one node, turtles, and what their pens draw."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Final

from grader.language.phrase import say
from grader.scenes.channel import Channel
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
from grader.scenes.turtlesim import (
    behaviour,
    endpoints,
    interfaces,
    remarks,
    starts,
    trying,
    view,
)
from grader.scenes.turtlesim.trace import FIRST_TURTLE, SPRITE, TurtleTrace
from grader.scenes.view import Pictures, View
from turtlesim_py.world import sprites
from turtlesim_py.world.arena import TICK_NS
from turtlesim_py.world.events import to_json

_TURTLE = f"/{FIRST_TURTLE}"


class Turtlesim:
    """See `grader.scenes.scene.Scene`; here each of its parts finds its module.

    The modules that need ROS or rosbags are imported where they are used: judging a recording needs
    no ROS, and running a submission no bags.
    """

    name: Final = "turtlesim"
    examiner: Final = ""
    tick_ns: Final = TICK_NS
    introduction: Final = Introduction(
        nodes=(("turtlesim", "/"),),
        topics=(f"{_TURTLE}/cmd_vel",),
        services=(
            *("/clear", "/kill", "/reset", "/spawn", f"{_TURTLE}/set_pen"),
            *(f"{_TURTLE}/teleport_absolute", f"{_TURTLE}/teleport_relative"),
        ),
    )
    thing: Final = say("turtle")
    finished: Final = say("the turtle came to rest")
    plane: Final = view.PLANE
    window_is_plane: Final = True
    the_thing: Final = say("the turtle")
    farthest_start_m: Final = starts.FARTHEST_M

    def wrong_setting(self, setting: str) -> str:
        """An arena is always the same."""
        return say("turtlesim takes none") if setting else ""

    def starts(self, count: int, seed: int, nearest_m: float, farthest_m: float) -> list[Start]:
        """Places round the centre of the window."""
        return starts.starts(count, seed, nearest_m, farthest_m)

    def interfaces_for(self, surely: Mapping[str, str], perhaps: Mapping[str, str]) -> str:
        """One of the two packages that turtlesim's messages come from."""
        return interfaces.choose(surely, perhaps)

    def adapted(self, text: str, ros_distro: str) -> str:
        """With the package that the release has."""
        return interfaces.adapted(text, ros_distro)

    def how_to_try(self, program: str, package: str) -> str:
        """With ros2 and without."""
        return trying.how_to_try(program, package)

    def preload(self) -> None:
        """Import the node, decode the picture of the turtle."""
        from grader.scenes.turtlesim import graded_node, simulation  # noqa: F401

        sprites.sprite(SPRITE)

    def simulate(
        self, limits: Limits, start: Start | None, hooks: Hooks, interfaces: str, setting: str
    ) -> Simulation:
        """Make the node and the recorder; ROS is up."""
        from grader.scenes.turtlesim.simulation import TurtlesimSimulation

        return TurtlesimSimulation(limits, start, hooks, interfaces)

    def untouched(self, start: Start | None) -> Trace:
        """No tick, an empty canvas, and the turtle where it began."""
        from grader.scenes.turtlesim.driving import drive

        return drive(lambda *_: None, 0, start)[0]

    def message_definitions(self) -> Mapping[str, str]:
        """Turtlesim's messages, and ROS's own in its bags."""
        from grader.scenes.turtlesim import messages

        return messages.DEFINITIONS

    def bag_topics(self, made: Trace) -> Iterable[tuple[str, str]]:
        """Those of every turtle, also of one that published nothing."""
        from grader.scenes.turtlesim import messages

        for turtle in TurtleTrace.of(made).trajectories:
            yield from messages.topics(turtle).items()

    def to_messages(self, made: Trace) -> list[Message]:
        """A trace as messages, by tick."""
        from grader.scenes.turtlesim import messages

        return messages.to_messages(TurtleTrace.of(made))

    def from_channels(self, channels: Sequence[Channel], ticks: int) -> Trace:
        """The trace of a bag's channels; see `grader.scenes.turtlesim.messages`."""
        from grader.scenes.turtlesim import messages

        return messages.from_channels(channels, ticks)

    def scenario(self, made: Trace) -> dict[str, Any]:
        """The inputs, for `python -m turtlesim_py.scenario`."""
        events = TurtleTrace.of(made).events
        within = [to_json(event) for event in events if 1 <= event.tick <= made.ticks]
        return {"ticks": made.ticks, "events": within}

    def behaviour(self, made: Trace) -> Behaviour:
        """Commands, pens, jumps, and the way of the first turtle."""
        return behaviour.behaviour(TurtleTrace.of(made))

    def endpoints(self, made: Trace, interfaces: str) -> Sequence[Endpoint]:
        """Those of the node and of each turtle."""
        return endpoints.endpoints(TurtleTrace.of(made), interfaces)

    def pictures(self, made: Trace) -> Pictures:
        """The original's window, and the path alone."""
        taken = TurtleTrace.of(made)
        return Pictures(taken.window, {"path": taken.canvas})

    def view(self, made: Trace) -> View:
        """Ways, pens and curves."""
        return view.view(TurtleTrace.of(made))

    def remarks(self, made: Trace, published: Sequence[str], interfaces: str) -> list[str]:
        """What was done to the arena other than by driving, and for which ROS that was."""
        return remarks.remarks(TurtleTrace.of(made), published, interfaces)


SCENE: Scene = Turtlesim()
