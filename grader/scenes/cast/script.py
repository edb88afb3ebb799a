"""What the peers of a cast do, as an exercise describes it.

    cast:
      caller:                      # a node of this name
        calls:
          small: {service: add_two_ints, type: example_interfaces/srv/AddTwoInts, request: {a: 2}}

Everything is plain data: it travels as JSON to the simulator's process. Values of messages are
templates (`expressions`); times are simulated seconds from the start of the run.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, field, fields, replace
from typing import Annotated, Any, Final, Literal, NamedTuple

from grader.recording.subject import Endpoint, EndpointKind, Role, RoleKind
from grader.scenes.cast.trace import TF
from grader.system import expressions, strict_json
from grader.system.strict_json import OURS, not_negative
from grader.system.yaml_file import Mistake, expect
from grader.text.message import msg

#: So many peers there are at most, and of each so many things of a kind.
MOST_PEERS, MOST_EACH = 20, 100
_NAME: Final = re.compile(r"[A-Za-z]\w{0,99}", re.ASCII)
_TOPIC: Final = re.compile(r"(?!/?cast/)/?[A-Za-z_]\w*(/[A-Za-z_]\w*)*", re.ASCII)
TYPE: Final = re.compile(r"[a-z]\w*/(msg|srv|action)/[A-Z]\w*", re.ASCII)

#: The most of a publisher's messages a second: one a tick, that each can be answered by itself.
MOST_HZ: Final = 62.5


def _rate(hz: float) -> float:
    if not 0 <= hz <= MOST_HZ:
        raise ValueError(f"expected 0 to {MOST_HZ:g} times a second, found {hz!r:.80}")
    return hz


Seconds = Annotated[float, not_negative]
Rate = Annotated[float, _rate]
#: A value of a message with expressions in it.
Template = Any


def a_name(name: str) -> str:
    """For `Annotated`: the name of a node, a topic, a service or an action."""
    if not _TOPIC.fullmatch(name):
        raise ValueError(f"expected a name such as chatter, found {name!r:.80}")
    return name


@dataclass(frozen=True)
class PeerQuality:
    """The quality of service of a topic."""

    depth: Annotated[int, not_negative] = 10
    reliability: Literal["reliable", "best_effort"] = "reliable"
    durability: Literal["volatile", "transient_local"] = "volatile"


@dataclass(frozen=True, kw_only=True)
class _Typed:
    """What has a type; or several, of which a peer takes the one that the program uses."""

    type: Any

    @property
    def types(self) -> tuple[str, ...]:
        return (self.type,) if isinstance(self.type, str) else tuple(self.type)


@dataclass(frozen=True, kw_only=True)
class PeerPublisher(_Typed):
    """Publishes a message again and again.

    Attributes:
        topic: '' for the name that it is listed by.
        rate: how often a second; or
        at: when.
        begin, count: from when on, and how often; with `rate`.
        message: its values; they may use `n`, how many came before, and `t`, the time [s].
        messages: instead: those of each, in turn; the last is repeated.
    """

    topic: str = ""
    rate: Rate = 0.0
    at: tuple[Seconds, ...] = ()
    begin: Seconds = 0.0
    count: Annotated[int, not_negative] = 100_000
    message: Template = field(default_factory=dict)
    messages: tuple[Template, ...] = ()
    qos: PeerQuality = PeerQuality()

    def times(self, end_s: float) -> list[float]:
        """Return when it publishes in a run of this length [s]."""
        if not self.rate:
            return sorted(time for time in self.at if time <= end_s)
        begin = self.begin or 1 / self.rate
        most = max(0, math.floor((end_s - begin) * self.rate + 1e-9) + 1)
        return [begin + n / self.rate for n in range(min(self.count, most))]


@dataclass(frozen=True, kw_only=True)
class PeerSubscription(_Typed):
    """Hears a topic, from `begin` on."""

    topic: str = ""
    begin: Seconds = 0.0
    qos: PeerQuality = PeerQuality()


@dataclass(frozen=True, kw_only=True)
class PeerService(_Typed):
    """Serves, from `begin` on.

    Attributes:
        response: its values, which may use the request's fields, and `n`.
        delay: how long an answer takes [s].
    """

    service: str = ""
    response: Template = field(default_factory=dict)
    begin: Seconds = 0.0
    delay: Seconds = 0.0


@dataclass(frozen=True, kw_only=True)
class PeerCall(_Typed):
    """Calls a service of the program, or of the scene, once, as soon as it is there."""

    service: str
    at: Seconds = 0.0
    request: Template = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class PeerGoal(_Typed):
    """Sends an action server of the program a goal, as soon as it is there.

    Attributes:
        cancel_after: how long after it was accepted it is cancelled [s].
        after: another goal of this peer's, by its id, that has to have ended before; '' for none.
    """

    action: str
    at: Seconds = 0.0
    goal: Template = field(default_factory=dict)
    cancel_after: Seconds | None = None
    after: str = ""


@dataclass(frozen=True, kw_only=True)
class PeerAction(_Typed):
    """Serves an action, from `begin` on.

    Attributes:
        feedback: the values of each feedback, which may use the goal's fields.
        period: between feedbacks, and before the result [s].
        accepts: whether it accepts a goal.
    """

    action: str = ""
    accepts: Template = True
    feedback: tuple[Template, ...] = ()
    period: Seconds = 0.5
    result: Template = field(default_factory=dict)
    begin: Seconds = 0.0


@dataclass(frozen=True, kw_only=True)
class PeerParameters:
    """Sets or reads parameters of a node of the program.

    Attributes:
        set: a name -> the value that it is set to.
        get: names that are read.
    """

    node: str
    at: Seconds = 0.0
    set: Mapping[str, Any] = field(default_factory=dict)
    get: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class PeerFrame:
    """Broadcasts a transform.

    Attributes:
        rate: how often a second; 0 for once, on /tf_static.
        translation, rotation: [m], quaternion x, y, z, w; numbers, or expressions over `t`.
    """

    parent: str
    child: str
    rate: Rate = 0.0
    begin: Seconds = 0.0
    translation: tuple[Template, Template, Template] = (0.0, 0.0, 0.0)
    rotation: tuple[Template, Template, Template, Template] = (0.0, 0.0, 0.0, 1.0)

    @property
    def topic(self) -> str:
        return "/tf" if self.rate else "/tf_static"

    @property
    def types(self) -> tuple[str, ...]:
        return (TF,)


@dataclass(frozen=True)
class Peer:
    """A node of the cast: what it has, by its name or id."""

    publishers: Mapping[str, PeerPublisher] = field(default_factory=dict)
    subscriptions: Mapping[str, PeerSubscription] = field(default_factory=dict)
    services: Mapping[str, PeerService] = field(default_factory=dict)
    calls: Mapping[str, PeerCall] = field(default_factory=dict)
    goals: Mapping[str, PeerGoal] = field(default_factory=dict)
    actions: Mapping[str, PeerAction] = field(default_factory=dict)
    parameters: Mapping[str, PeerParameters] = field(default_factory=dict)
    frames: Mapping[str, PeerFrame] = field(default_factory=dict)


class Kind(NamedTuple):
    """A kind of thing that a peer has.

    Attributes:
        named_by: the attribute that names it; where that is '', the name that it is listed by does.
        values: the names that its templates may use; None for any: those of a message that is only
            known in the run.
        met: what of it a program may meet.
        facing: what faces it in a program.
    """

    entry: type
    named_by: str = ""
    values: Set[str] | None = frozenset()
    met: EndpointKind | None = None
    facing: RoleKind | None = None


KINDS: Final[Mapping[str, Kind]] = {
    "publishers": Kind(PeerPublisher, "topic", {"n", "t"}, "publisher", "subscription"),
    "subscriptions": Kind(PeerSubscription, "topic", set(), "subscription", "publisher"),
    "services": Kind(PeerService, "service", None, "service", "client"),
    "calls": Kind(PeerCall, "service", {"t"}, None, "service"),
    "goals": Kind(PeerGoal, "action", {"t"}, None, "action"),
    "actions": Kind(PeerAction, "action", None, "action", "action_client"),
    "parameters": Kind(PeerParameters),
    "frames": Kind(PeerFrame, "topic", {"t"}, "publisher", "subscription"),
}
#: Types of what has one, for a mistake.
_EXAMPLES: Final = {
    "topic": "std_msgs/msg/String",
    "service": "example_interfaces/srv/AddTwoInts",
    "action": "example_interfaces/action/Fibonacci",
}


def parse(data: Any, keys: Sequence[str] = ("cast",)) -> dict[str, Peer]:
    """Parse the peers of a cast, by their names.

    Raises:
        Mistake: something in it is wrong; its keys name the place.
    """
    at = tuple(keys)
    expect(isinstance(data, dict), at, "expected names of nodes, found {found}", data)
    if len(data) > MOST_PEERS:
        raise Mistake(at, msg("a cast has at most {n} nodes", n=MOST_PEERS))
    return {name: _peer(name, parts or {}, (*at, str(name))) for name, parts in data.items()}


def absolute(name: str) -> str:
    """Return a name with its namespace, as nodes without one have it."""
    return name if name.startswith("/") else f"/{name}"


def heard(peers: Mapping[str, Peer], hears: Iterable[str]) -> list[str]:
    """Return the topics of a program that are recorded, and those that peers hear from the start.

    A topic is named so many times as it has readers then.

    Args:
        hears: topics that are recorded besides.
    """
    entries = [entry for peer in peers.values() for entry in peer.subscriptions.values()]
    recorded = {absolute(name) for name in (*(each.topic for each in entries), *hears)}
    return sorted([*recorded, *(absolute(each.topic) for each in entries if not each.begin)])


def _named(peer: Peer) -> Iterator[tuple[Kind, str, Any]]:
    """Yield all of a peer that has a name on the graph, with its kind and this name."""
    for key, kind in KINDS.items():
        if kind.named_by:
            for entry in getattr(peer, key).values():
                yield kind, absolute(getattr(entry, kind.named_by)), entry


def endpoints(peers: Mapping[str, Peer]) -> Iterator[Endpoint]:
    """Yield what a program may meet, once for each type that it may have."""
    for node, peer in peers.items():
        for kind, name, entry in _named(peer):
            if kind.met is not None:
                for each in entry.types:
                    yield Endpoint(kind.met, name, each, absolute(node), entry.begin)


def roles(peers: Mapping[str, Peer]) -> Iterator[Role]:
    """Yield what a program has on the graph that faces these peers."""
    for peer in peers.values():
        yield from (Role(kind.facing, name) for kind, name, _ in _named(peer) if kind.facing)
        for each in peer.parameters.values():
            yield from (Role("parameter", name) for name in (*each.set, *each.get))


def _peer(name: Any, parts: Any, at: tuple[str, ...]) -> Peer:
    is_name = isinstance(name, str) and _NAME.fullmatch(name) is not None
    expect(is_name, at, "expected the name of a node, found {found}", name)
    what = "expected some of {kinds}, found {found}"
    fits = isinstance(parts, dict) and parts.keys() <= KINDS.keys()
    expect(fits, at, what, parts, kinds=", ".join(KINDS))
    made: dict[str, dict[str, Any]] = {}
    for kind, listed in parts.items():
        here = (*at, kind)
        is_some = isinstance(listed, dict) and 0 < len(listed) <= MOST_EACH
        what = "expected names, each with what it is, at most {n}; found {found}"
        expect(is_some, here, what, listed, n=MOST_EACH)
        made[kind] = {
            str(each): _entry(kind, values, (*here, str(each))) for each, values in listed.items()
        }
    return Peer(**made)


def _entry(kind: str, values: Any, at: tuple[str, ...]) -> Any:
    made_of, named_by, known, *_ = KINDS[kind]
    try:
        made: Any = strict_json.from_json(made_of, values, OURS)
    except ValueError as error:
        raise Mistake(at, msg("{what}", what=str(error))) from None
    if named_by and not getattr(made, named_by):
        made = replace(made, **{named_by: at[-1]})
    for each in fields(made_of):
        value = getattr(made, each.name)
        if each.name in ("topic", "service", "action", "node"):
            what = "expected a name such as chatter, found {found}"
            expect(_TOPIC.fullmatch(value) is not None, (*at, each.name), what, value)
        elif each.name == "type":
            listed = _flat(value)
            example = _EXAMPLES[named_by]
            are_types = isinstance(listed, list) and all(
                TYPE.fullmatch(str(one)) and str(one).split("/")[1] == example.split("/")[1]
                for one in listed
            )
            what = "expected a type such as {example}, or a list of some; found {found}"
            expect(bool(listed) and are_types, (*at, "type"), what, value, example=example)
        else:
            check_templates(value, known, (*at, each.name))
    if kind == "publishers" and not (made.rate or made.at):
        raise Mistake(at, msg("expected `rate`, how often a second, or `at`, when"))
    if kind == "parameters":
        expect(
            bool(made.set) != bool(made.get), at, "expected `set` or `get`, found {found}", values
        )
        for name, value in made.set.items():
            kinds = {type(one) for one in _flat(value)}
            fits = len(kinds) == 1 and kinds <= {bool, int, float, str}
            fits = fits and not (kinds == {int} and max(map(abs, _flat(value))) >= 1 << 63)
            what = "expected true, a number, a text, or a list of some of one kind; found {found}"
            expect(fits, (*at, "set", name), what, value)
    return made


def _flat(value: Any) -> list[Any]:
    return value if isinstance(value, list) else [value]


def check_templates(
    value: Any, known: Set[str] | None, at: tuple[str, ...], *, has_patterns: bool = False
) -> None:
    """Check the expressions in a template.

    Args:
        known: the names that they may use; None for any.

    Raises:
        Mistake: one cannot be used.
    """
    try:
        unknown = expressions.check(value, has_patterns=has_patterns)
    except expressions.ExpressionError as error:
        raise Mistake(at, error.message) from None
    if known is not None and (left := sorted(unknown - known)):
        raise Mistake(
            at,
            msg(
                "there is no value {name} here, only {known}",
                name=left[0],
                known=", ".join(sorted(known)) or "none",
            ),
        )
