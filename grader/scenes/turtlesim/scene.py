"""turtlesim as a scene: one node, turtles, and what their pens draw."""

from __future__ import annotations

import math
import random
import textwrap
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import PurePath
from typing import Any, ClassVar, Final

from grader.recording.mcap import Channel
from grader.recording.recording import Recording
from grader.recording.subject import BagMessage, Endpoint, Pictures, Start, Trace
from grader.scenes.cast.trace import CastTrace
from grader.scenes.live import LivePage
from grader.scenes.playback import Playback
from grader.scenes.scene import Hooks, Introduction, Limits, Scene, Simulation, command_by_hand
from grader.scenes.subject import Oversteps, Rules
from grader.scenes.turtlesim import interfaces, messages, view, words
from grader.scenes.turtlesim.interfaces import endpoints_of
from grader.scenes.turtlesim.rules import INPUTS, own_inputs, within
from grader.scenes.turtlesim.trace import FIRST_TURTLE, SPRITE, USUAL_START, TurtleTrace
from grader.scenes.view import View
from grader.text.message import NOTHING, Message, msg
from grader.text.translations import tr
from turtlesim_py.world import picture
from turtlesim_py.world.arena import TICK_NS
from turtlesim_py.world.events import Spawn, to_json
from turtlesim_py.world.turtle import SIZE_M

_TURTLE = f"/{FIRST_TURTLE}"
#: The longest scenario [ticks]: an hour. It is replayed when an exercise is loaded.
MOST_TICKS: Final = 225_000


class Turtlesim(Scene):
    """The scene, whose parts are in the modules of this folder.

    The modules that need ROS are imported where they are used: judging a recording needs none.
    """

    name = "turtlesim"
    introduction = Introduction(
        nodes=(("turtlesim", "/"),),
        topics=(f"{_TURTLE}/cmd_vel",),
        services=(
            *("/clear", "/kill", "/reset", "/spawn", f"{_TURTLE}/set_pen"),
            *(f"{_TURTLE}/teleport_absolute", f"{_TURTLE}/teleport_relative"),
        ),
    )
    thing = msg("turtle")
    outcomes: ClassVar = {"finished": msg("the turtle came to rest")}
    plane = view.PLANE
    the_thing = msg("the turtle")
    #: from the centre to half a metre before a wall; rounded, for authors of exercises
    farthest_start_m = round(SIZE_M / 2 - 0.5, 2)
    usual_start = USUAL_START
    inputs = INPUTS

    def wrong_setting(self, setting: str) -> Message:
        """Return why a setting is no scenario to play beside a submission; NOTHING where it is.

        It may have any turtles. Its events of a tick happen before those that the submission has
        sent for that tick.
        """
        from turtlesim_py.scenario import ScenarioError, events_by_tick, parse, replay

        if not setting:
            return NOTHING
        try:
            scenario = parse(setting)
            ticks = scenario.get("ticks")
            if isinstance(ticks, int) and ticks > MOST_TICKS:
                return msg(
                    "expected {most} ticks at most, found {ticks}", most=MOST_TICKS, ticks=ticks
                )
            replay(scenario)
            for tick, each in events_by_tick(scenario).items():
                if tick > 1 and any(isinstance(event, Spawn) for _, event in each):
                    return msg(
                        "expected turtles to be spawned in tick 1, found tick {tick}", tick=tick
                    )
        except ScenarioError as error:
            return msg("expected a scenario in JSON: {why}", why=str(error))
        return NOTHING

    def within(self, trace: Trace, cast: Trace | None, rules: Rules) -> tuple[Trace, Oversteps]:
        peers = None if cast is None else CastTrace.of(cast)
        return within(TurtleTrace.of(trace), peers, rules)

    def starts(self, count: int, seed: int, nearest_m: float, farthest_m: float) -> list[Start]:
        """Return places at a distance from the centre of the window; the same for the same seed."""
        chance = random.Random(seed)
        found = []
        for _ in range(count):
            distance = chance.uniform(nearest_m, farthest_m)
            angle = chance.uniform(-math.pi, math.pi)
            x, y = (SIZE_M / 2 + distance * f(angle) for f in (math.cos, math.sin))
            theta = chance.uniform(-math.pi, math.pi)
            found.append(Start(round(x, 3), round(y, 3), round(theta, 3)))
        return found

    def interfaces_for(self, surely: Mapping[str, str], perhaps: Mapping[str, str]) -> str:
        return interfaces.choose(surely, perhaps)

    def adapted(self, text: str, ros_distro: str) -> str:
        return interfaces.adapted(text, ros_distro)

    def how_to_try(self, program: str, package: str) -> str:
        parts = [
            tr(
                "From the folder above this one, in one terminal the simulator, in another your "
                "node:"
            ),
            f"    turtlesim\n    {command_by_hand(program, package)}",
        ]
        if package:
            parts += [
                tr("The same with `ros2`, in a workspace that has this folder in its `src`:"),
                "    colcon build && . install/setup.bash\n    ros2 run turtlesim_py turtlesim\n"
                f"    ros2 run {package} {PurePath(program).stem}",
            ]
        parts += [tr("To see the turtle:"), "\n".join(_ways_to_see())]
        return "\n\n".join(parts) + "\n"

    def preload(self) -> None:
        from grader.scenes.turtlesim import graded_node, simulation  # noqa: F401

        picture.sprite(SPRITE)

    def simulate(
        self, limits: Limits, start: Start | None, hooks: Hooks, interfaces: str, setting: str
    ) -> Simulation:
        from grader.scenes.turtlesim.simulation import TurtlesimSimulation

        return TurtlesimSimulation(limits, start, hooks, interfaces, setting)

    def untouched(self, start: Start | None) -> Trace:
        """Return a trace of no tick, with an empty canvas and the turtle at its start."""
        from grader.scenes.turtlesim.driving import drive

        return drive(lambda *_: None, 0, start)[0]

    def bag_topics(self, made: Trace) -> Iterable[tuple[str, str]]:
        for turtle in TurtleTrace.of(made).trajectories:
            yield from messages.topics(turtle).items()

    def to_messages(self, made: Trace) -> list[BagMessage]:
        return messages.to_messages(TurtleTrace.of(made))

    def from_channels(self, channels: Sequence[Channel], duration_ns: int) -> Trace:
        return messages.from_channels(channels, duration_ns // TICK_NS)

    def scenario(self, made: Trace) -> dict[str, Any]:
        events = TurtleTrace.of(made).events
        within = [to_json(event) for event in events if 1 <= event.tick <= made.ticks]
        return {"ticks": made.ticks, "events": within}

    def endpoints(self, made: Trace, interfaces: str) -> Sequence[Endpoint]:
        return endpoints_of(TurtleTrace.of(made), interfaces)

    def pictures(self, made: Trace) -> Pictures:
        trace = TurtleTrace.of(made)
        return Pictures(trace.window, {"path": trace.canvas})

    def view(self, made: Trace) -> View:
        return view.view(TurtleTrace.of(made))

    @property
    def player(self) -> Callable[[Playback], str]:
        from grader.scenes.turtlesim.pages import render

        return render

    def live_page(self, port: int) -> LivePage:
        from grader.scenes.turtlesim.pages import TurtlesimPage

        return TurtlesimPage.serve(port)

    def odd_traces(self, setting: str, start: Start | None) -> Mapping[str, Trace]:
        from grader.scenes.turtlesim.driving import odd_traces

        return odd_traces(start)

    def remarks(self, recording: Recording) -> list[Message]:
        trace = TurtleTrace.of(recording.trace)
        if recording.cast is not None:  # what peers call is none of the submission's
            inputs = own_inputs(trace, CastTrace.of(recording.cast), "")
            trace = replace(trace, events=tuple(event for _, _, event in inputs))
        published = [each.topic for each in recording.topics]
        return list(words.remarks(trace, published, recording.run.interfaces))


def _ways_to_see() -> Iterator[str]:
    """Return the ways to see the turtle, each as an item of a list."""
    points = (
        tr(
            "Every grading leaves `report.html`: the picture, the way, an animation, the speeds "
            "over time. It needs nothing but a browser."
        ),
        tr(
            "`turtlesim` prints the address of a page, on which the turtle draws while your node "
            "drives it. `grader run` with `--live` shows a grading there, and `grader view` plays "
            "it again, tick by tick, with the line of your code behind each command."
        ),
        tr(
            "`turtlesim_node` is the same without a page. With `ros2`, `ros2 run rqt_image_view "
            "rqt_image_view /turtlesim/image` shows the picture, and `ros2 service call "
            "/turtlesim/save_canvas std_srvs/srv/Trigger` writes it as a PNG file."
        ),
        tr(
            "On a desktop with ROS 2, `ros2 run turtlesim turtlesim_node` opens the original's "
            "window; your node drives that turtle as well."
        ),
    )
    item = textwrap.TextWrapper(
        100, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False
    )
    return (item.fill(f"- {point}") for point in points)


SCENE: Final = Turtlesim()
