"""The scene of a cast alone: peers beside any node, with nothing that is driven."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import PurePath
from typing import Any, ClassVar

from grader.recording.mcap import Channel
from grader.recording.subject import BagMessage, Start, Trace
from grader.ros.bag_types import BagTypes
from grader.ros.cdr import string
from grader.scenes.cast import timeline, trace
from grader.scenes.cast.trace import STRING, CastTrace, SentMessage
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
from grader.scenes.view import Cell, Table, View
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
        made = self.trace()
        # what was told last may have been joined by a message of before, which came late
        items = timeline.items(made, self._told_ns - 2 * STEP_NS)
        changed = [each for each in items if self._told.get(each["id"]) != each]
        self._told.update((each["id"], each) for each in changed)
        self._told_ns = made.duration_ns
        shown = {"lanes": timeline.lanes(made), "labels": timeline.labels(made)}
        send({"t": made.duration_ns / 1e9, **shown, "items": changed})

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
        return CastTrace.of(made).definitions

    def view(self, made: Trace) -> View:
        """Return a table of what was exchanged, as much of it as a page shows at once."""
        made = CastTrace.of(made)
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
        return timeline.TimelinePage.serve(port)

    @property
    def player(self) -> Callable[[Playback], str]:
        return timeline.render

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
        return _odd_traces()

    def bag_topics(self, made: Trace) -> Iterable[tuple[str, str]]:
        return [(trace.EVENTS, STRING)]

    def to_messages(self, made: Trace) -> list[BagMessage]:
        return trace.to_messages(CastTrace.of(made))

    def from_channels(self, channels: Sequence[Channel], duration_ns: int) -> Trace:
        return trace.from_channels(channels, duration_ns)


def _hop(item: Mapping[str, Any]) -> str:
    to = f" → {', '.join(item['to'])}" if item["to"] else ""
    return f"{item['from']}{to}: {item['what']}"


# Odd nodes, whose traces the checks of an exercise have to survive --------------------------------

_FLOAT, _LOG = "std_msgs/msg/Float64", "rcl_interfaces/msg/Log"
_TYPES = BagTypes({})
_ENDPOINT = {"type": STRING, "reliability": 1, "durability": 2, "depth": 10}


def _odd_traces() -> Mapping[str, CastTrace]:
    long = "x" * 20_000
    names = ("/topic", "/tf", "/latest", "/turtle1/cmd_vel")
    writers = [_endpoint("/node", f"topic {name}") for name in names]
    return {
        "nothing at all": CastTrace(),
        "a node that does nothing": _trace(_endpoint("/node", "topic /parameter_events")),
        "a thousand nodes": _trace(*(_endpoint(f"/n{n}", "topic /x") for n in range(1000))),
        "a node with a very long name": _trace(_endpoint(f"/{long[:600]}", f"topic /{long[:300]}")),
        "odd qualities of service": _trace(_endpoint("/node", "topic /latest", depth=2**32 - 1)),
        "texts where something else belongs": _trace(*writers, sent=[
            SentMessage(10**9, name, STRING, "/node", string("\x1b[2J \ud800")) for name in names
        ]),
        "numbers that are none": _trace(*writers, sent=[
            SentMessage(10**8 * n, name, _FLOAT, "/node", _TYPES.data(_FLOAT, {"data": value}))
            for n, value in enumerate((float("nan"), float("inf"), -1e308, 0.0))
            for name in names
        ]),
        "log lines of no level": _trace(sent=[
            SentMessage(10**9 + n, trace.ROSOUT, _LOG, "", _log(n * 17 % 256, text))
            for n, text in enumerate(("", long, "\n\r\t", "Hello World: 0"))
        ]),
        "everything at once": _trace(*writers, sent=[
            SentMessage(0, "/topic", STRING, "/node", string("Hello World: 0")) for _ in range(50)
        ]),
        "peers that could do nothing": _trace(
            {"kind": "refused", "time_ns": 0, "peer": "/peer", "what": "x", "why": "y"}
        ),
        "more than is recorded": _trace({"kind": "full", "time_ns": 10**9}),
        "a message that nobody sent": _trace(sent=[
            SentMessage(2 * 10**9, "/topic", STRING, "", string("?"))
        ]),
    }  # fmt: skip


def _trace(*events: Mapping[str, Any], sent: list[SentMessage] | None = None) -> CastTrace:
    messages = tuple(sorted(sent or [], key=lambda each: each.time_ns))
    return CastTrace(300, messages, events, ("/peer",))


def _endpoint(node: str, channel: str, **more: Any) -> dict[str, Any]:
    facts = {"kind": "endpoint", "time_ns": 0, "node": node, "channel": channel, "writes": True}
    return {**facts, **_ENDPOINT, **more}


def _log(level: int, text: str) -> bytes:
    line = {"stamp": {"sec": 1, "nanosec": 0}, "level": level, "name": "node", "msg": text}
    return _TYPES.data(_LOG, {**line, "file": "", "function": "", "line": 1})


SCENE = GraphScene()
