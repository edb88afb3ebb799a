"""The peers of a cast at work: rclpy's own nodes, which act by the clock of a run."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, Final

from action_msgs.msg import GoalStatus
from rcl_interfaces.srv import GetParameters, SetParameters
from rclpy.action import ActionClient, ActionServer, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter, parameter_value_to_python
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.task import Future

from grader.ros.messages import make, plain, plain_value
from grader.scenes.cast import script
from grader.scenes.cast.recorder import CastRecorder, NoType, Types
from grader.scenes.cast.script import absolute
from grader.scenes.cast.trace import TF
from grader.system.expressions import ExpressionError, filled

#: So often a peer is served in a tick at most; and after its last message: a callback of a future
#: is a task of the executor's, which may set another.
MOST_SPINS, LAST_SPINS = 200, 4
_STATUS: Final = {
    GoalStatus.STATUS_SUCCEEDED: "succeeded",
    GoalStatus.STATUS_CANCELED: "canceled",
    GoalStatus.STATUS_ABORTED: "aborted",
}
#: Something to do: when [ns], in which order, what, and whether it can be done yet.
Deed = tuple[int, int, Callable[[], None], Callable[[], bool]]


class PeerNode:
    """A node of the cast.

    Args:
        end_s: how long the run may last [s].
        type_of: returns the type of a name that the program uses, '' for none: called with the kind
            of its channel, as 'topic', and the name.
    """

    def __init__(
        self,
        name: str,
        peer: script.Peer,
        types: Types,
        recorder: CastRecorder,
        end_s: float,
        now_ns: Callable[[], int],
        type_of: Callable[[str, str], str],
    ) -> None:
        self.node = Node(name, start_parameter_services=False, enable_rosout=False)
        self.name = self.node.get_fully_qualified_name()
        self._types, self._recorder = types, recorder
        self._end_s, self._now_ns, self._type_of = end_s, now_ns, type_of
        self._executor = SingleThreadedExecutor()
        self._executor.add_node(self.node)
        self._group = ReentrantCallbackGroup()
        self._due: list[Deed] = []
        #: what became of goals, by their ids
        self._goals: dict[str, dict[str, Any]] = {}
        kinds: dict[str, Callable[[str, Any], None]] = {
            "publishers": self._publish,
            "subscriptions": self._hear,
            "services": self._serve,
            "calls": self._call,
            "goals": self._send_goal,
            "actions": self._serve_action,
            "parameters": self._ask_parameters,
            "frames": self._broadcast,
        }
        for kind, begin in kinds.items():
            for key, entry in getattr(peer, kind).items():
                self._try(partial(begin, key, entry))
        self._due.sort(key=lambda deed: deed[:2])

    @property
    def next_ns(self) -> int:
        """When it acts next by itself [ns]."""
        return self._due[0][0] if self._due else 1 << 62

    def act(self) -> bool:
        """Do what is due; what cannot be done yet is tried again in the next tick.

        Returns:
            Whether anything was done.
        """
        now_ns, waiting, done = self._now_ns(), list[Deed](), 0
        while self._due and self._due[0][0] <= now_ns:
            deed = self._due.pop(0)
            can = self._try(deed[3])
            if can:
                self._try(deed[2])
                done += 1
            elif can is not None:
                waiting.append(deed)
        if waiting:
            self._due = sorted([*waiting, *self._due], key=lambda deed: deed[:2])
        return done > 0

    def _try(self, do: Callable[[], Any]) -> Any:
        """Do something that needs a type, which a hand-in may bring; None where there is none."""
        try:
            return do()
        except NoType as error:
            self._refuse("", str(error))
            return None

    def _refuse(self, what: str, why: Any, kind: str = "refused") -> None:
        """Record what a peer cannot do with what the program has sent, or not do at all."""
        self._recorder.event(kind, peer=self.name, what=what[:200], why=why)

    def serve(self, has_unread: Callable[[str], bool]) -> None:
        """Call back for what has arrived, and for what is due then.

        Args:
            has_unread: whether something waits for a node.
        """
        quiet = 0
        for _ in range(MOST_SPINS):
            self._executor.spin_once(timeout_sec=0)
            quiet = 0 if has_unread(self.name) else quiet + 1
            if quiet > LAST_SPINS:
                break

    def _later(
        self, at_s: float, do: Callable[[], None], can: Callable[[], bool] = lambda: True
    ) -> None:
        self._due.append((round(at_s * 1e9), len(self._due), do, can))

    def _soon(self, delay_s: float, do: Callable[[], None]) -> None:
        self._later(self._now_ns() / 1e9 + delay_s, do)
        self._due.sort(key=lambda deed: deed[:2])

    def _type(self, entry: Any, kind: str, name: str) -> tuple[str, Any]:
        """Return the type that the program uses, where several are allowed, and its class."""
        used = self._type_of(kind, absolute(name))
        chosen = used if used in entry.types else entry.types[0]
        return chosen, self._types.find(chosen)

    def _filled(self, template: Any, names: Mapping[str, Any], kind: str = "refused") -> Any:
        """Fill in a template; what a program's values make impossible is recorded."""
        try:
            return filled(template, names)
        except ExpressionError as error:
            self._refuse(str(template), error.message.serialise(), kind)
            return None

    def _made(self, kind: Any, values: Any, fault: str = "refused") -> Any:
        """Make a message of what a program's values have led to; None where that fails."""
        try:
            return make(kind, {} if values is None else values)
        except ValueError as error:
            self._refuse(kind.__name__, str(error)[:300], fault)
            return None

    def _own(self, kind: Any, template: Any, n: int = 0) -> Any:
        """Make a message in which no value of a program's has a part."""
        values = self._filled(template, {"n": n, "t": self._now_ns() / 1e9}, "unsaid")
        return self._made(kind, values, "unsaid")

    # Topics -----------------------------------------------------------------------------------

    def _publish(self, _: str, entry: script.PeerPublisher) -> None:
        chosen, kind = self._type(entry, "topic", entry.topic)
        publisher = self.node.create_publisher(kind, entry.topic, _qos(entry.qos))

        def say(n: int) -> None:
            template = entry.messages[min(n, len(entry.messages) - 1)] if entry.messages else None
            message = self._own(kind, template or entry.message, n)
            if message is not None:
                publisher.publish(message)
                self._recorder.said(publisher.topic_name, chosen, self.name, message)

        for n, time_s in enumerate(entry.times(self._end_s)):
            self._later(time_s, lambda n=n: say(n))  # type: ignore[misc]

    def _hear(self, _: str, entry: script.PeerSubscription) -> None:
        topic = absolute(entry.topic)

        def got(message: Any) -> None:
            values = self._recorder.plain(message)
            self._recorder.event("got", peer=self.name, topic=topic, values=values)

        def begin() -> None:
            _, kind = self._type(entry, "topic", entry.topic)
            self.node.create_subscription(kind, entry.topic, got, _qos(entry.qos))

        self._begin(entry, begin, "topic", topic)

    def _broadcast(self, _: str, entry: script.PeerFrame) -> None:
        durability = "volatile" if entry.rate else "transient_local"
        kind = self._types.find(TF)
        quality = script.PeerQuality(100, durability=durability)  # type: ignore[arg-type]
        publisher = self.node.create_publisher(kind, entry.topic, _qos(quality))

        def say() -> None:
            stamp = plain(self.node.get_clock().now().to_msg())
            moved = zip("xyz", entry.translation, strict=True)
            turned = zip("xyzw", entry.rotation, strict=True)
            frame = {
                "header": {"stamp": stamp, "frame_id": entry.parent},
                "child_frame_id": entry.child,
                "transform": {"translation": dict(moved), "rotation": dict(turned)},
            }
            message = self._own(kind, {"transforms": [frame]})
            if message is None:
                return
            publisher.publish(message)
            self._recorder.said(entry.topic, TF, self.name, message)

        times = [entry.begin]
        if entry.rate:
            count = max(0, math.floor((self._end_s - entry.begin) * entry.rate))
            times = [entry.begin + n / entry.rate for n in range(count)]
        for time_s in times:
            self._later(time_s, say)

    # Services ---------------------------------------------------------------------------------

    def _serve(self, _: str, entry: script.PeerService) -> None:
        count = 0

        async def answer(request: Any, response: Any) -> Any:
            nonlocal count
            asked, recorded = plain(request), self._recorder.plain(request)
            event = self._recorder.event(
                "served", peer=self.name, service=absolute(entry.service), request=recorded
            )
            values = self._filled(entry.response, {**asked, "request": asked, "n": count})
            count += 1
            made = self._made(type(response), values) or response
            if entry.delay and not self._recorder.is_full:  # what waits is kept
                await self._pause(entry.delay)
            event.update(response=self._recorder.plain(made), answered_ns=self._now_ns())
            return made

        def begin() -> None:
            _, kind = self._type(entry, "request", entry.service)
            self.node.create_service(kind, entry.service, answer, callback_group=self._group)

        self._begin(entry, begin, "request", absolute(entry.service))

    def _begin(self, entry: Any, begin: Callable[[], None], kind: str, name: str) -> None:
        """Begin to serve: at once, later, or once the program shows which type it uses."""
        if entry.begin or len(entry.types) > 1:
            can = lambda: len(entry.types) == 1 or self._type_of(kind, name) != ""  # noqa: E731
            self._later(entry.begin, begin, can)
        else:
            begin()

    def _call(self, key: str, entry: script.PeerCall) -> None:
        clients: list[Any] = []

        def is_ready() -> bool:
            name = absolute(entry.service)
            # one that the program does not serve may be the scene's
            used = self._type_of("request", name)
            if used not in (entry.types if used or len(entry.types) > 1 else ("",)):
                return False
            if not clients:
                _, kind = self._type(entry, "request", entry.service)
                clients.append(
                    self.node.create_client(kind, entry.service, callback_group=self._group)
                )
            return bool(clients[0].service_is_ready())

        def ask() -> None:
            kind = clients[0].srv_type
            request = self._own(kind.Request, entry.request)
            if request is None:  # the program has the type with other fields
                return
            event.update(request=plain(request), sent_ns=self._now_ns())

            def answered(future: Any) -> None:
                response = self._recorder.plain(future.result())
                event.update(response=response, answered_ns=self._now_ns())

            clients[0].call_async(request).add_done_callback(answered)

        event = self._recorder.event(
            "call", peer=self.name, id=key, service=absolute(entry.service), type=entry.types[0]
        )
        self._later(entry.at, ask, is_ready)

    # Actions ----------------------------------------------------------------------------------

    def _send_goal(self, key: str, entry: script.PeerGoal) -> None:
        clients: list[Any] = []
        name = absolute(entry.action)

        goal_ids: list[Any] = []

        def back(message: Any) -> None:
            if goal_ids and bytes(message.goal_id.uuid) == bytes(goal_ids[0].uuid):
                values = self._recorder.plain(message.feedback)
                event["feedback"].append([self._now_ns(), values])

        def is_ready() -> bool:
            if entry.after and "ended_ns" not in self._goals.get(entry.after, {}):
                return False
            used = self._type_of("request", f"{name}/_action/send_goal")
            known = {f"{each}_SendGoal": each for each in entry.types}
            if used not in known:
                return False
            if not clients:
                event["type"] = known[used]
                kind = self._types.find(known[used])
                # by itself: rclpy's client drops what comes together with the result
                self.node.create_subscription(
                    kind.Impl.FeedbackMessage, f"{name}/_action/feedback", back, 1000
                )
                clients.append(
                    ActionClient(self.node, kind, entry.action, callback_group=self._group)
                )
            return bool(clients[0].server_is_ready())

        def send() -> None:
            client = clients[0]
            goal = self._own(client._action_type.Goal, entry.goal)
            if goal is None:  # the program has the type with other fields
                return
            event.update(goal=plain(goal), sent_ns=self._now_ns(), feedback=[])

            def accepted(future: Any) -> None:
                handle = future.result()
                event["accepted"] = bool(handle.accepted)
                if not handle.accepted:
                    event["ended_ns"] = self._now_ns()
                    return
                handle.get_result_async().add_done_callback(ended)
                if entry.cancel_after is not None:
                    self._soon(entry.cancel_after, handle.cancel_goal_async)

            def ended(future: Any) -> None:
                found = future.result()
                status = _STATUS.get(found.status, "unknown")
                result = self._recorder.plain(found.result)
                event.update(status=status, result=result, ended_ns=self._now_ns())

            goal_ids.append(client._generate_random_uuid())
            client.send_goal_async(goal, goal_uuid=goal_ids[0]).add_done_callback(accepted)

        event = self._recorder.event(
            "goal", peer=self.name, id=key, action=name, type=entry.types[0]
        )
        self._goals[key] = event
        self._later(entry.at, send, is_ready)

    def _serve_action(self, _: str, entry: script.PeerAction) -> None:
        name = absolute(entry.action)

        def judged(goal: Any) -> Any:
            asked = plain(goal)
            accepts = bool(self._filled(entry.accepts, {**asked, "goal": asked}))
            recorded = {"goal": self._recorder.plain(goal), "accepted": accepts, "feedback": []}
            event = self._recorder.event("action", peer=self.name, action=name, **recorded)
            if not accepts or self._recorder.is_full:
                return GoalResponse.REJECT
            events.append((goal, event))
            return GoalResponse.ACCEPT

        async def execute(handle: Any) -> Any:
            asked = plain(handle.request)
            place = next(n for n, (goal, _) in enumerate(events) if goal is handle.request)
            _, event = events.pop(place)
            kind = servers[0]._action_type
            for n, template in enumerate(entry.feedback):
                await self._pause(entry.period)
                values = self._filled(template, {**asked, "goal": asked, "n": n})
                made = self._made(kind.Feedback, values)
                if made is not None:
                    handle.publish_feedback(made)
                    event["feedback"].append([self._now_ns(), self._recorder.plain(made)])
            await self._pause(entry.period)
            result = self._made(kind.Result, self._filled(entry.result, {**asked, "goal": asked}))
            handle.succeed()
            event.update(status="succeeded", ended_ns=self._now_ns())
            return result or kind.Result()

        def begin() -> None:
            used = self._type_of("request", f"{name}/_action/send_goal")
            chosen = next((e for e in entry.types if used == f"{e}_SendGoal"), entry.types[0])
            kind = self._types.find(chosen)
            servers.append(
                ActionServer(
                    *(self.node, kind, entry.action, execute),
                    goal_callback=judged,
                    callback_group=self._group,
                )
            )

        servers: list[Any] = []
        events: list[tuple[Any, dict[str, Any]]] = []  # of goals that are not yet executed
        self._begin(entry, begin, "request", f"{name}/_action/send_goal")

    async def _pause(self, seconds: float) -> None:
        waited: Future[None] = Future()
        self._soon(seconds, lambda: waited.set_result(None))
        await waited

    # Parameters -------------------------------------------------------------------------------

    def _ask_parameters(self, key: str, entry: script.PeerParameters) -> None:
        node = absolute(entry.node)
        sets = bool(entry.set)
        kind, name = (SetParameters, "set") if sets else (GetParameters, "get")
        client = self.node.create_client(
            kind, f"{node}/{name}_parameters", callback_group=self._group
        )

        def ask() -> None:
            event["sent_ns"] = self._now_ns()
            if sets:
                listed = [Parameter(n, value=v).to_parameter_msg() for n, v in entry.set.items()]
                request: Any = SetParameters.Request(parameters=listed)
            else:
                request = GetParameters.Request(names=list(entry.get))

            def answered(future: Any) -> None:
                found = future.result()
                event["answered_ns"] = self._now_ns()
                if sets:
                    results = zip(entry.set, found.results, strict=False)
                    event["set"] = {n: "" if r.successful else r.reason or "-" for n, r in results}
                else:
                    values = zip(entry.get, found.values, strict=False)
                    event["values"] = {n: _parameter(v) for n, v in values}

            client.call_async(request).add_done_callback(answered)

        event = self._recorder.event("parameter", peer=self.name, id=key, node=node)
        self._later(entry.at, ask, lambda: bool(client.service_is_ready()))


def _parameter(value: Any) -> Any:
    try:
        return plain_value(parameter_value_to_python(value))
    except RuntimeError:  # of no type that there is
        return None


def _qos(quality: script.PeerQuality) -> QoSProfile:
    return QoSProfile(
        depth=quality.depth,
        reliability=ReliabilityPolicy[quality.reliability.upper()],
        durability=DurabilityPolicy[quality.durability.upper()],
    )
