"""The scene of a cast alone: peers beside any node, with nothing that is driven."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import PurePath
from typing import Any, ClassVar

from grader.recording.mcap import Channel
from grader.recording.subject import BagMessage, Start, Trace
from grader.recording.view import Cell, Table, View
from grader.scenes.cast import trace
from grader.scenes.cast.trace import CastTrace
from grader.scenes.live import LivePage
from grader.scenes.playback import Playback
from grader.scenes.scene import (
    STEP_NS,
    Hooks,
    Limits,
    Reason,
    Scene,
    Simulation,
    command_by_hand,
)
from grader.text.message import Message, msg
from grader.text.translations import tr

#: So many rows of what was exchanged are in a report.
MOST_ROWS = 60
#: So often viewers are told what is new [ticks].
NEWS_TICKS = 6


class GraphSimulation(Simulation):
    """Lets time pass; the cast does the rest."""

    ticks = 0

    def __init__(self, limits: Limits, hooks: Hooks) -> None:
        super().__init__()
        cast = hooks.cast
        assert cast is not None, "an exercise of this scene has a cast, if an empty one"
        self._limits = limits
        self._cast = cast
        self._send, self._told, self._told_ns = hooks.send_news, dict[str, Any](), 0
        self.node = next(iter(cast.nodes), None)

    @property
    def is_at_rest(self) -> bool:
        """A server waits for ever, and has done its work."""
        return True

    def tick(self, now_ns: int | None = None) -> Reason:
        if not self.records:
            return ""
        self.ticks += 1
        reason = self.over(self.ticks, self._limits, self._cast.has_met)
        if self._send is not None and (reason or self.ticks % NEWS_TICKS == 0):
            self._tell(self._send)
        return reason

    def _tell(self, send: Callable[[Mapping[str, Any]], None]) -> None:
        """Send viewers the items that are new or have changed."""
        from grader.scenes.cast import timeline

        made = self.trace()
        # what was told last may have been joined by a message of before, which came late
        items = timeline.items(made, self._told_ns - 2 * STEP_NS)
        changed = [each for each in items if self._told.get(each["id"]) != each]
        self._told.update((each["id"], each) for each in changed)
        self._told_ns = made.duration_ns
        shown = {"lanes": timeline.lanes(made), "labels": timeline.labels(made)}
        send({"t": made.duration_ns / 1e9, **shown, "items": changed})

    def pass_tick(self, now_ns: int) -> tuple[Reason, tuple[bytes, ...]]:
        return self.tick(now_ns), ()

    def trace(self) -> CastTrace:
        made: CastTrace = self._cast.trace(self.ticks)
        return made


class GraphScene(Scene):
    """See `grader.scenes.scene.Scene`; everything else comes with the cast."""

    name = "graph"
    has_cast = True
    thing, the_thing = msg("other node"), msg("the other node")
    outcomes: ClassVar[Mapping[str, Message]] = {
        "finished": msg("the node was watched to the end"),
        "nothing moved": msg("no node came up"),
    }

    def simulate(
        self, limits: Limits, start: Start | None, hooks: Hooks, interfaces: str, setting: str
    ) -> Simulation:
        return GraphSimulation(limits, hooks)

    def untouched(self, start: Start | None) -> Trace:
        return CastTrace()

    def definitions_of(self, made: Trace) -> Mapping[str, str]:
        assert isinstance(made, CastTrace)
        return made.definitions

    def view(self, made: Trace) -> View:
        """Return a table of what was exchanged, as much of it as a page shows at once."""
        assert isinstance(made, CastTrace)
        from grader.scenes.cast import timeline

        listed = timeline.items(made)
        headings = (msg("time [s]"), msg("what"), msg("values"))
        rows = tuple(
            (Cell((f"{item['t']:.2f}",)), Cell((_hop(item),)), Cell((item["text"],)))
            for item in listed[:MOST_ROWS]
        )
        note = msg("`grader view` plays it.")
        if len(listed) > MOST_ROWS:
            note = msg("The first {n} of {all}; `grader view` plays them all.",
                       n=MOST_ROWS, all=len(listed))  # fmt: skip
        if not rows:
            return View()
        return View(parts=(Table(msg("What went from one to another"), headings, rows, note),))

    def live_page(self, port: int) -> LivePage:
        from grader.scenes.cast.pages import TimelinePage

        return TimelinePage.serve(port)

    @property
    def player(self) -> Callable[[Playback], str]:
        from grader.scenes.cast.pages import render

        return render

    def how_to_try(self, program: str, package: str) -> str:
        parts = [
            tr("From the folder above this one, with the arguments that the task names:"),
            f"    {command_by_hand(program, package)}",
        ]
        if package:
            name = PurePath(program).stem
            parts += [
                tr("The same with `ros2`, in a workspace that has this folder in its `src`:"),
                f"    colcon build && . install/setup.bash\n    ros2 run {package} {name}",
            ]
        parts += [
            tr("What it sends, hears and serves, in another terminal with ROS 2:"),
            "    ros2 node list\n    ros2 node info /NODE",
        ]
        return "\n\n".join(parts)

    def odd_traces(self, setting: str, start: Start | None) -> Mapping[str, Trace]:
        from grader.scenes.cast.odd import odd_traces

        return odd_traces()

    def bag_topics(self, made: Trace) -> Iterable[tuple[str, str]]:
        return [(trace.EVENTS, trace.STRING)]

    def to_messages(self, made: Trace) -> list[BagMessage]:
        assert isinstance(made, CastTrace)
        return trace.to_messages(made)

    def from_channels(self, channels: Sequence[Channel], duration_ns: int) -> Trace:
        return trace.from_channels(channels, duration_ns)


def _hop(item: Mapping[str, Any]) -> str:
    to = f" → {', '.join(item['to'])}" if item["to"] else ""
    return f"{item['from']}{to}: {item['what']}"


SCENE = GraphScene()
