"""The requests of viewers, as JSON: a part of the rosbridge protocol, version 2.

    advertise, unadvertise, publish, subscribe, unsubscribe, call_service,
    send_action_goal, cancel_action_goal

and of rosapi's services those that list what there is. Programs that use roslibjs can therefore
talk to the simulator. What cannot be done is answered with a `status`, and ends nothing; beside
the English text of such an answer stands its `sentence`, for pages in other languages.
"""

from __future__ import annotations

import asyncio
import json
import re
from collections.abc import Callable, Collection, Coroutine, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

from turtlesim_py.live import messages
from turtlesim_py.live.messages import Rejected

if TYPE_CHECKING:
    from turtlesim_py.live.graph import Graph

#: The most open topics, and tasks, of a viewer.
MOST_OPEN = 32
#: The most frames of a viewer: a second on average, and at once.
FRAMES_PER_S, FRAMES_AT_ONCE = 200.0, 400.0
#: The topic that only viewers have: the changes of the arena.
LIVE = "/turtlesim_live"
#: The longest pause between two messages of a topic that a viewer may ask for: a day.
LONGEST_PAUSE_MS = 86_400_000
#: An escape that may be half of a surrogate pair.
_MAYBE_HALF = re.compile(r"\\u[dD][89a-fA-F]")


@dataclass
class Goal:
    """A goal that has not ended: the viewer's name for it, and whether to cancel it."""

    name: str
    is_cancelled: bool = False


@dataclass(eq=False)
class Session:
    """One viewer's frames.

    Args:
        graph: returns the ROS graph; `Rejected`: viewers have none.
        is_read_only: whether the viewer can only watch.
        send: sends an answer.
        watch: begins, or ends, to send this viewer the changes of the arena.
        now: a clock [s].
    """

    graph: Callable[[], Graph]
    is_read_only: bool
    send: Callable[[Mapping[str, Any]], object]
    watch: Callable[[bool], None]
    now: Callable[[], float]
    _publishers: dict[str, Any] = field(default_factory=dict)
    _subscriptions: dict[str, Any] = field(default_factory=dict)
    #: calls and goals that have not ended
    _tasks: dict[asyncio.Task[None], Goal | None] = field(default_factory=dict)
    _allowed: float = FRAMES_AT_ONCE
    _counted_at: float = 0.0

    def handle(self, text: str | bytes) -> None:
        """Follow a frame, or answer why not."""
        frame: Any = None
        try:
            self._count()
            frame = _parse(text)
            self._follow(frame)
        except Exception as error:  # rclpy refuses in many ways, and a frame ends nothing
            answer = {"op": "status", "level": "error", **_why(error, "msg")}
            if frame is not None and isinstance(frame.get("id"), str | int):
                answer["id"] = frame["id"]
            self.send(answer)

    def close(self) -> None:
        """Give back everything that the viewer had."""
        self.watch(False)
        for task, goal in self._tasks.items():
            if goal is None:
                task.cancel()
            else:
                goal.is_cancelled = True
        for topic in list(self._publishers):
            self._unadvertise({"topic": topic})
        for topic in list(self._subscriptions):
            self._unsubscribe({"topic": topic})

    # Frames -----------------------------------------------------------------------------------

    def _count(self) -> None:
        now = self.now()
        passed, self._counted_at = now - self._counted_at, now
        self._allowed = min(FRAMES_AT_ONCE, self._allowed + passed * FRAMES_PER_S) - 1.0
        if self._allowed < 0.0:
            self._allowed = 0.0
            raise Rejected(
                "more than {n} frames a second: this one is not heard", n=f"{FRAMES_PER_S:g}"
            )

    def _follow(self, frame: Mapping[str, Any]) -> None:
        op = frame.get("op")
        follow = self._FOLLOW.get(op) if isinstance(op, str) else None
        if follow is None:
            raise Rejected(
                "unknown op {op}; there are {ops}", op=f"{op!r:.60}", ops=", ".join(self._FOLLOW)
            )
        asks = op == "call_service" and _is_rosapi(str(frame.get("service")))
        if self.is_read_only and op not in ("subscribe", "unsubscribe") and not asks:
            raise Rejected("{op} is refused: this page is for looking only", op=op)
        follow(self, frame)

    def _advertise(self, frame: Mapping[str, Any]) -> None:
        topic = _text(frame, "topic")
        if topic not in self._publishers:
            _check_room(self._publishers)
            graph = self.graph()
            self._publishers[topic] = graph.advertise(topic, _text(frame, "type", ""))

    def _unadvertise(self, frame: Mapping[str, Any]) -> None:
        publisher = self._publishers.pop(_text(frame, "topic"), None)
        if publisher is not None:
            self.graph().node.destroy_publisher(publisher)

    def _publish(self, frame: Mapping[str, Any]) -> None:
        self._advertise(frame)
        publisher = self._publishers[_text(frame, "topic")]
        publisher.publish(messages.from_json(publisher.msg_type, frame.get("msg", {})))

    def _subscribe(self, frame: Mapping[str, Any]) -> None:
        topic = _text(frame, "topic")
        if topic == LIVE:
            self.watch(True)
            return
        if topic in self._subscriptions:
            return
        _check_room(self._subscriptions)
        pause_s = _pause_s(frame)
        due = -1.0

        def on_message(content: Mapping[str, Any]) -> None:
            nonlocal due
            if self.now() >= due:
                due = self.now() + pause_s
                self.send({"op": "publish", "topic": topic, "msg": content})

        graph = self.graph()
        self._subscriptions[topic] = graph.subscribe(topic, _text(frame, "type", ""), on_message)

    def _unsubscribe(self, frame: Mapping[str, Any]) -> None:
        topic = _text(frame, "topic")
        if topic == LIVE:
            self.watch(False)
        subscription = self._subscriptions.pop(topic, None)
        if subscription is not None:
            self.graph().node.destroy_subscription(subscription)

    def _call_service(self, frame: Mapping[str, Any]) -> None:
        service, kind = _text(frame, "service"), _text(frame, "type", "")
        self._begin(self._answer_call(service, kind, frame.get("args", {}), _id_of(frame)))

    async def _answer_call(
        self, service: str, kind: str, args: object, about: Mapping[str, Any]
    ) -> None:
        answer = {"op": "service_response", "service": service, **about}
        try:
            graph = self.graph()
            values = (
                _rosapi(graph, service, args)
                if _is_rosapi(service)
                else await graph.call(service, kind, args)
            )
            self.send(answer | {"values": values, "result": True})
        except Exception as error:
            self.send(answer | {**_why(error, "values"), "result": False})

    def _send_goal(self, frame: Mapping[str, Any]) -> None:
        action, kind = _text(frame, "action"), _text(frame, "action_type")
        about = {"action": action, **_id_of(frame)}
        goal = Goal(str(frame.get("id")))
        self._begin(self._answer_goal(action, kind, frame.get("args", {}), about, goal), goal)

    async def _answer_goal(
        self, action: str, kind: str, args: object, about: Mapping[str, Any], goal: Goal
    ) -> None:
        def on_feedback(content: Mapping[str, Any]) -> None:
            self.send({"op": "action_feedback", "values": content, **about})

        answer = {"op": "action_result", **about}
        try:
            values, status = await self.graph().send_goal(
                action, kind, args, on_feedback, lambda: goal.is_cancelled
            )
            self.send(answer | {"values": values, "status": status, "result": status == 4})
        except Exception as error:
            self.send(answer | {**_why(error, "values"), "status": 6, "result": False})

    def _cancel_goal(self, frame: Mapping[str, Any]) -> None:
        for goal in self._tasks.values():  # several may have one id
            if goal is not None and goal.name == str(frame.get("id")):
                goal.is_cancelled = True

    def _begin(self, work: Coroutine[Any, Any, None], goal: Goal | None = None) -> None:
        """Start work that runs beside the next frames."""
        try:
            _check_room(self._tasks)
        except Rejected:
            work.close()
            raise
        task = asyncio.get_running_loop().create_task(work)
        self._tasks[task] = goal
        task.add_done_callback(self._tasks.pop)

    _FOLLOW: ClassVar[Mapping[str, Callable[[Session, Mapping[str, Any]], None]]] = {
        "advertise": _advertise,
        "unadvertise": _unadvertise,
        "publish": _publish,
        "subscribe": _subscribe,
        "unsubscribe": _unsubscribe,
        "call_service": _call_service,
        "send_action_goal": _send_goal,
        "cancel_action_goal": _cancel_goal,
    }


def _check_room(there: Collection[Any]) -> None:
    if len(there) >= MOST_OPEN:
        raise Rejected("a viewer may have {n} at once", n=MOST_OPEN)


def _parse(text: str | bytes) -> dict[str, Any]:
    if not isinstance(text, str):
        raise Rejected("expected JSON as text, found bytes")
    try:
        frame = json.loads(text, parse_constant=_refuse)
        if _MAYBE_HALF.search(text):
            json.dumps(frame, ensure_ascii=False).encode()  # half a character is no text
    except (ValueError, RecursionError):
        raise Rejected("expected JSON, found {found}", found=f"{text!r:.60}") from None
    if not isinstance(frame, dict):
        raise Rejected("expected a JSON object, found {found}", found=f"{text!r:.60}")
    return frame


def _refuse(constant: str) -> Any:
    raise ValueError(f"{constant} is no JSON")


def _why(error: Exception, name: str) -> dict[str, Any]:
    """Return the answer to a refused frame: its text, by this name, and its sentence."""
    if isinstance(error, Rejected):
        return {name: str(error), "sentence": {"key": error.key, "values": error.values}}
    return {name: f"{type(error).__name__}: {error!s:.200}"}


def _id_of(frame: Mapping[str, Any]) -> dict[str, Any]:
    """Return the id that an answer repeats, where a frame has one."""
    return {} if frame.get("id") is None else {"id": frame["id"]}


def _text(frame: Mapping[str, Any], key: str, default: str | None = None) -> str:
    value = frame.get(key, default)
    if value is None and default is not None:
        value = default
    if not isinstance(value, str):
        raise Rejected("{field}: expected a text, found {found}", field=key, found=f"{value!r:.60}")
    return value


def _pause_s(frame: Mapping[str, Any]) -> float:
    pause_ms = frame.get("throttle_rate", 0)
    is_number = isinstance(pause_ms, int | float) and not isinstance(pause_ms, bool)
    if not is_number or not 0 <= pause_ms <= LONGEST_PAUSE_MS:
        raise Rejected(
            "throttle_rate: expected milliseconds, found {found}", found=f"{pause_ms!r:.60}"
        )
    return float(pause_ms) / 1000.0


def _is_rosapi(service: str) -> bool:
    return service.lstrip("/").startswith("rosapi/")  # roslibjs leaves the slash out


def _rosapi(graph: Graph, service: str, args: object) -> dict[str, Any]:
    """Answer a query of the graph, as rosapi's service of this name does."""
    asked = args if isinstance(args, dict) else {}
    match service.rpartition("/")[2]:
        case "topics":
            topics = graph.topics()
            return {"topics": list(topics), "types": list(topics.values())}
        case "services":
            return {"services": list(graph.services())}
        case "topic_type":
            return {"type": graph.topic_type(_text(asked, "topic"))}
        case "service_type":
            return {"type": graph.service_type(_text(asked, "service"))}
        case "publishers":
            return {"publishers": graph.publishers(_text(asked, "topic"))}
        case "subscribers":
            return {"subscribers": graph.subscribers(_text(asked, "topic"))}
        case "message_details":
            name = _text(asked, "type")
            return {"typedefs": messages.typedefs(messages.find(name, "msg"), name)}
        case "service_request_details" | "service_response_details" as details:
            name = _text(asked, "type")
            part = "Request" if details == "service_request_details" else "Response"
            return {"typedefs": messages.typedefs(getattr(messages.find(name, "srv"), part), name)}
    raise Rejected("there is no service {name} here", name=f"{service!r:.80}")
