"""What a viewer may ask for, as JSON: a part of the rosbridge protocol, version 2.

    advertise, unadvertise, publish, subscribe, unsubscribe, call_service,
    send_action_goal, cancel_action_goal

and of rosapi's services those that say what there is. Programs that use roslibjs can therefore talk
to the simulator. What cannot be done is answered with a `status`, and ends nothing.
"""

from __future__ import annotations

import asyncio
import json
import re
from collections.abc import Awaitable, Callable, Collection, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar, Protocol

from turtlesim_py.live import messages
from turtlesim_py.live.messages import NoSuchType, NotThere, Unfit

if TYPE_CHECKING:
    from turtlesim_py.live.graph import Graph

#: Of each kind a viewer may have so many open.
MOST_OPEN = 32
#: So many frames a second are heard of a viewer, on average; so many at once.
FRAMES_PER_S, FRAMES_AT_ONCE = 200.0, 400.0
#: The topic that only viewers have: what becomes of the arena.
LIVE = "/turtlesim_live"
#: A viewer may ask for a message a day, and no less.
LONGEST_PAUSE_MS = 86_400_000
#: What may stand for half a character.
_MAYBE_HALF = re.compile(r"\\u[dD][89a-fA-F]")


class Refused(ValueError):
    """A frame that cannot be followed; the text says why."""


_REFUSALS = (Refused, NotThere, NoSuchType, Unfit)


class Host(Protocol):
    """What a session needs of the server that it belongs to."""

    is_read_only: bool

    def graph(self) -> Graph:
        """The ROS graph; made when it is needed first. NotThere: viewers have none."""


@dataclass
class Session:
    """One viewer's frames.

    Args:
        host: the server.
        send: sends an answer; may be called in the loop's thread only.
        watch: begins, or ends, to tell this viewer of the arena.
        now: a clock [s].
    """

    host: Host
    send: Callable[[Mapping[str, Any]], object]
    watch: Callable[[bool], None]
    now: Callable[[], float]
    _publishers: dict[str, Any] = field(default_factory=dict)
    _subscriptions: dict[str, Any] = field(default_factory=dict)
    _tasks: dict[str, set[asyncio.Task[None]]] = field(default_factory=dict)
    _number: int = 0
    _allowed: float = FRAMES_AT_ONCE
    _heard_at: float = 0.0

    async def hear(self, frame: str | bytes) -> None:
        """Do what a frame says, or answer why not."""
        said: Any = None
        try:
            self._count()
            said = _object(frame)
            await self._follow(said)
        except (
            Exception
        ) as error:  # rclpy refuses in many ways, and a stranger's frame ends nothing
            self._complain(_why(error), said)

    async def close(self) -> None:
        """Give back everything that the viewer had."""
        self.watch(False)
        for task in [each for tasks in self._tasks.values() for each in tasks]:
            task.cancel()
        publishers, self._publishers = self._publishers, {}
        subscriptions, self._subscriptions = self._subscriptions, {}
        if publishers or subscriptions:
            given = list(subscriptions.values()), list(publishers.values())
            await self.host.graph().forget(*given)

    # Frames -----------------------------------------------------------------------------------

    def _count(self) -> None:
        now = self.now()
        passed, self._heard_at = now - self._heard_at, now
        self._allowed = min(FRAMES_AT_ONCE, self._allowed + passed * FRAMES_PER_S) - 1.0
        if self._allowed < 0.0:
            self._allowed = 0.0
            raise Refused(f"more than {FRAMES_PER_S:g} frames a second: this one is not heard")

    async def _follow(self, said: Mapping[str, Any]) -> None:
        op = said.get("op")
        follow = self._FOLLOW.get(op) if isinstance(op, str) else None
        if follow is None:
            raise Refused(f"unknown op {op!r:.60}; there are {', '.join(self._FOLLOW)}")
        asks = op == "call_service" and _is_rosapi(str(said.get("service")))
        if self.host.is_read_only and op not in self._READING and not asks:
            raise Refused(f"{op} is refused: this page is for looking only")
        await follow(self, said)

    def _complain(self, text: str, said: Any) -> None:
        answer = {"op": "status", "level": "error", "msg": text}
        if isinstance(said, dict) and isinstance(said.get("id"), str | int):
            answer["id"] = said["id"]
        self.send(answer)

    async def _advertise(self, said: Mapping[str, Any]) -> None:
        topic = _text(said, "topic")
        if topic not in self._publishers:
            self._check_room(self._publishers)
            graph = self.host.graph()
            self._publishers[topic] = await graph.advertise(topic, _text(said, "type", ""))

    async def _unadvertise(self, said: Mapping[str, Any]) -> None:
        publisher = self._publishers.pop(_text(said, "topic"), None)
        if publisher is not None:
            await self.host.graph().forget([], [publisher])

    async def _publish(self, said: Mapping[str, Any]) -> None:
        await self._advertise(said)
        publisher = self._publishers[_text(said, "topic")]
        publisher.publish(messages.from_json(publisher.msg_type, said.get("msg", {})))

    async def _subscribe(self, said: Mapping[str, Any]) -> None:
        topic = _text(said, "topic")
        if topic == LIVE:
            self.watch(True)
            return
        if topic in self._subscriptions:
            return
        self._check_room(self._subscriptions)
        pause_s = _pause_s(said)
        loop, last = asyncio.get_running_loop(), [-pause_s]

        def tell(content: Mapping[str, Any]) -> None:
            if self.now() - last[0] >= pause_s and topic in self._subscriptions:
                last[0] = self.now()
                self.send({"op": "publish", "topic": topic, "msg": content})

        def hear(content: Mapping[str, Any]) -> None:
            _soon(loop, tell, content)

        self._subscriptions[topic] = await self.host.graph().subscribe(
            topic, _text(said, "type", ""), hear
        )

    async def _unsubscribe(self, said: Mapping[str, Any]) -> None:
        topic = _text(said, "topic")
        if topic == LIVE:
            self.watch(False)
        subscription = self._subscriptions.pop(topic, None)
        if subscription is not None:
            await self.host.graph().forget([subscription], [])

    async def _call_service(self, said: Mapping[str, Any]) -> None:
        service, args = _text(said, "service"), said.get("args", {})
        self._begin(said, self._answer_call(service, _text(said, "type", ""), args, said.get("id")))

    async def _answer_call(self, service: str, kind: str, args: object, number: object) -> None:
        answer: dict[str, Any] = {"op": "service_response", "service": service}
        if number is not None:
            answer["id"] = number
        try:
            if _is_rosapi(service):
                values = _rosapi(self.host.graph(), service, args)
            else:
                values = await self.host.graph().call(service, kind, args)
            self.send(answer | {"values": values, "result": True})
        except Exception as error:
            self.send(answer | {"values": _why(error), "result": False})

    async def _send_goal(self, said: Mapping[str, Any]) -> None:
        goal = (_text(said, "action"), _text(said, "action_type"), said.get("args", {}))
        self._begin(said, self._answer_goal(*goal, said.get("id")))

    async def _answer_goal(self, action: str, kind: str, args: object, number: object) -> None:
        about = {"action": action} | ({} if number is None else {"id": number})
        loop = asyncio.get_running_loop()

        def feedback(content: Mapping[str, Any]) -> None:
            told = {"op": "action_feedback", "values": content} | about
            _soon(loop, self.send, told)

        answer = {"op": "action_result"} | about
        try:
            values, status = await self.host.graph().send_goal(action, kind, args, feedback)
            self.send(answer | {"values": values, "status": status, "result": status == 4})
        except Exception as error:
            self.send(answer | {"values": _why(error), "status": 6, "result": False})

    async def _cancel_goal(self, said: Mapping[str, Any]) -> None:
        for task in self._tasks.get(f"send_action_goal {said.get('id')}", ()):
            task.cancel()

    def _begin(self, said: Mapping[str, Any], work: Any) -> None:
        """Let something that takes time go on beside the next frames."""
        self._number += 1
        name = f"{said['op']} {said.get('id', self._number)}"
        try:
            self._check_room([task for tasks in self._tasks.values() for task in tasks])
        except Refused:
            work.close()
            raise
        task = asyncio.get_running_loop().create_task(work)
        of_name = self._tasks.setdefault(name, set())  # several may have one id
        of_name.add(task)

        def forget(_: object) -> None:
            of_name.discard(task)
            if not of_name:
                self._tasks.pop(name, None)

        task.add_done_callback(forget)

    def _check_room(self, there: Collection[Any]) -> None:
        if len(there) >= MOST_OPEN:
            raise Refused(f"a viewer may have {MOST_OPEN} at once")

    _FOLLOW: ClassVar[Mapping[str, Callable[[Session, Mapping[str, Any]], Awaitable[None]]]] = {
        "advertise": _advertise,
        "unadvertise": _unadvertise,
        "publish": _publish,
        "subscribe": _subscribe,
        "unsubscribe": _unsubscribe,
        "call_service": _call_service,
        "send_action_goal": _send_goal,
        "cancel_action_goal": _cancel_goal,
    }
    _READING: ClassVar = frozenset(("subscribe", "unsubscribe"))


def _soon(loop: asyncio.AbstractEventLoop, tell: Callable[[Any], object], content: Any) -> None:
    with suppress(RuntimeError):  # the loop has just ended
        loop.call_soon_threadsafe(tell, content)


def _object(frame: str | bytes) -> dict[str, Any]:
    if not isinstance(frame, str):
        raise Refused("expected JSON as text, found bytes")
    try:
        said = json.loads(frame, parse_constant=_refuse)
        if _MAYBE_HALF.search(frame):
            json.dumps(said, ensure_ascii=False).encode()  # half a character is no text
    except (ValueError, RecursionError):
        raise Refused(f"expected JSON, found {frame!r:.60}") from None
    if not isinstance(said, dict):
        raise Refused(f"expected a JSON object, found {frame!r:.60}")
    return said


def _refuse(constant: str) -> Any:
    raise ValueError(f"{constant} is no JSON")


def _why(error: Exception) -> str:
    """What is answered to who has asked for what cannot be done."""
    return str(error) if isinstance(error, _REFUSALS) else f"{type(error).__name__}: {error!s:.200}"


def _text(said: Mapping[str, Any], key: str, default: str | None = None) -> str:
    value = said.get(key, default)
    if value is None and default is not None:
        value = default
    if not isinstance(value, str):
        raise Refused(f"{key}: expected a text, found {value!r:.60}")
    return value


def _pause_s(said: Mapping[str, Any]) -> float:
    pause_ms = said.get("throttle_rate", 0)
    is_number = isinstance(pause_ms, int | float) and not isinstance(pause_ms, bool)
    if not is_number or not 0 <= pause_ms <= LONGEST_PAUSE_MS:
        raise Refused(f"throttle_rate: expected milliseconds, found {pause_ms!r:.60}")
    return float(pause_ms) / 1000.0


def _is_rosapi(service: str) -> bool:
    return service.lstrip("/").startswith("rosapi/")  # roslibjs leaves the slash out


def _rosapi(graph: Graph, service: str, args: object) -> dict[str, Any]:
    """What there is in the graph, as rosapi's services of these names tell it."""
    said = args if isinstance(args, dict) else {}
    match service.rpartition("/")[2]:
        case "topics":
            topics = graph.topics()
            return {"topics": list(topics), "types": list(topics.values())}
        case "services":
            return {"services": list(graph.services())}
        case "topic_type":
            return {"type": graph.topic_type(_text(said, "topic"))}
        case "service_type":
            return {"type": graph.service_type(_text(said, "service"))}
        case "publishers":
            return {"publishers": graph.nodes_of(_text(said, "topic"))[0]}
        case "subscribers":
            return {"subscribers": graph.nodes_of(_text(said, "topic"))[1]}
        case "message_details":
            name = _text(said, "type")
            return {"typedefs": messages.typedefs(messages.find(name, "msg"), name)}
        case "service_request_details":
            name = _text(said, "type")
            return {"typedefs": messages.typedefs(messages.find(name, "srv").Request, name)}
        case "service_response_details":
            name = _text(said, "type")
            return {"typedefs": messages.typedefs(messages.find(name, "srv").Response, name)}
    raise NotThere(f"there is no service {service!r:.80} here")
