"""What an exercise can expect: a class for each kind of entry."""

from __future__ import annotations

from collections.abc import Mapping, Set
from dataclasses import dataclass, field
from typing import Annotated, Any, ClassVar, Final, Literal

from grader.exercise.asking import OF_FILES
from grader.exercise.comparing import is_number, is_range
from grader.scenes.cast import script
from grader.system.strict_json import above_zero, not_negative
from grader.system.yaml_file import decoded, expect

#: The names that a template may use; None for any: fields that are only known in the run.
Names = Mapping[str, Set[str] | None]


def _message_type(name: str) -> str:
    if name and not (script.TYPE.fullmatch(name) and "/msg/" in name):
        raise ValueError(f"expected a type such as std_msgs/msg/String, found {name!r:.80}")
    return name


Name = Annotated[str, script.a_name]
Seconds = Annotated[float, not_negative]
Number = Annotated[int, not_negative]
Tolerance = Annotated[float, not_negative] | None


@dataclass(frozen=True)
class ExpectedCount:
    """How many there are."""

    at_least: Number = 1
    at_most: Number = 1 << 30

    def __post_init__(self) -> None:
        if self.at_least > self.at_most:
            raise ValueError(f"at_least is {self.at_least}, more than at_most, {self.at_most}")


@dataclass(frozen=True)
class ExpectedRate:
    """How often something comes.

    Attributes:
        hz: so often a second.
        tolerance: which share of a period the mean of all may be off. None may be twice as long,
            and there are messages to the end.
    """

    hz: Annotated[float, above_zero]
    tolerance: Annotated[float, not_negative] = 0.1


@dataclass(frozen=True)
class ExpectedQuality:
    """The quality of service that a topic has; '' or 0 for any."""

    reliability: Literal["", "reliable", "best_effort"] = ""
    durability: Literal["", "volatile", "transient_local"] = ""
    depth: Number = 0


@dataclass(frozen=True, kw_only=True)
class Expectation:
    """What all have.

    Attributes:
        title, rubric: of the check; what is measured.
        after: the checks that have to pass before.
        cases: those of the exercise in which it is expected; empty for all.
        help: a hint for who does not have it.
        parrot: see `grader.exercise.check.Check`; for what names nothing drawn or heard.
    """

    title: str = ""
    rubric: str = ""
    after: tuple[str, ...] = ()
    cases: tuple[str, ...] = ()
    help: str = ""
    parrot: str = ""

    #: Its templates.
    names: ClassVar[Names] = {}

    @property
    def topics(self) -> tuple[str, ...]:
        """The program's topics that it judges."""
        return ()


@dataclass(frozen=True, kw_only=True)
class ExpectedNode(Expectation):
    """There is a node of this name."""

    node: Name


@dataclass(frozen=True, kw_only=True)
class ExpectedTopic(Expectation):
    """What the program sends on a topic.

    Attributes:
        values: of each message; expressions may use `n`, `t`, and `heard`, a topic -> the messages
            before, of a topic on which peers publish theirs alone: `=heard["/data"][-1].data`.
        holds: an expression over all `messages` together, which is to be true.
        tolerance: how far numbers may be off.
        begin, end: messages before and after are left alone [s].
        heard: a topic without which the program cannot know what to send: what it sends before it
            has a subscription of that does not count.
    """

    topic: Name
    heard: str = ""
    type: Annotated[str, _message_type] = ""
    count: ExpectedCount = ExpectedCount()
    rate: ExpectedRate | None = None
    values: Any = None
    holds: str = ""
    tolerance: Tolerance = None
    qos: ExpectedQuality = ExpectedQuality()
    begin: Seconds = 0.0
    end: Seconds = 1e9

    names: ClassVar[Names] = {"values": {"n", "t", "heard", "message"}, "holds": {"messages"}}

    @property
    def topics(self) -> tuple[str, ...]:
        """The program's topics that it judges."""
        return (self.topic,)


@dataclass(frozen=True, kw_only=True)
class ExpectedReceipt(Expectation):
    """What a peer gets of a topic, which may join late."""

    got: Name
    by: Name
    count: ExpectedCount = ExpectedCount()


@dataclass(frozen=True, kw_only=True)
class ExpectedLog(Expectation):
    """What the program logs.

    Attributes:
        log: the text; a pattern; or with `each` a text with the fields of a message.
        also: without these two, further lines that have to be there.
        each: a topic, for each of whose messages there is such a line: the program's,
        heard: or those that the program has heard: the peers', else its own. Lines count of nodes
            that hear them, messages from when one does.
        level: such as `info`; '' for any.
    """

    log: str
    also: tuple[str, ...] = ()
    each: str = ""
    heard: str = ""
    level: Literal["", "debug", "info", "warn", "error", "fatal"] = ""
    count: ExpectedCount = ExpectedCount()
    within: Seconds = 0.2

    names: ClassVar[Names] = {"log": None, "also": None}

    @property
    def topics(self) -> tuple[str, ...]:
        """The program's topics that it judges."""
        return (self.each,) if self.each else ()


@dataclass(frozen=True, kw_only=True)
class ExpectedAnswer(Expectation):
    """What the program answers to a call of a peer's, by its id; expressions use the request."""

    call: str
    response: Any = field(default_factory=dict)
    within: Seconds = 1.0
    tolerance: Tolerance = None

    names: ClassVar[Names] = {"response": None}


@dataclass(frozen=True, kw_only=True)
class ExpectedRequest(Expectation):
    """What the program asks of a service of a peer's."""

    served: Name
    request: Any = field(default_factory=dict)
    count: ExpectedCount = ExpectedCount()
    tolerance: Tolerance = None

    names: ClassVar[Names] = {"request": set()}


@dataclass(frozen=True, kw_only=True)
class ExpectedOutcome(Expectation):
    """What becomes of a peer's goal, by its id; expressions use the goal's fields.

    Attributes:
        feedback: a list of each, in order; None for any.
        within: from the goal to its result [s].
    """

    goal: str
    accepted: bool = True
    status: Literal["", "succeeded", "canceled", "aborted"] = ""
    feedback: Any = None
    result: Any = None
    within: Seconds = 1e9
    tolerance: Tolerance = None

    names: ClassVar[Names] = {"feedback": None, "result": None}


@dataclass(frozen=True, kw_only=True)
class ExpectedGoal(Expectation):
    """The goal that the program sends an action server of a peer's."""

    sends: Name
    values: Any = field(default_factory=dict)

    names: ClassVar[Names] = {"values": set()}


@dataclass(frozen=True, kw_only=True)
class ExpectedParameters(Expectation):
    """What comes of setting or reading parameters, by a peer's id.

    Attributes:
        set: a name -> whether it was taken.
        values: a name -> its value.
    """

    parameter: str
    set: Mapping[str, bool] = field(default_factory=dict)
    values: Any = field(default_factory=dict)

    names: ClassVar[Names] = {"values": frozenset()}


@dataclass(frozen=True, kw_only=True)
class ExpectedTransform(Expectation):
    """A transform that the program broadcasts; numbers as in `ExpectedTopic.values`."""

    transform: str
    parent: str
    translation: Any = None
    rotation: Any = None
    is_static: bool = False
    tolerance: Annotated[float, not_negative] = 0.01
    count: ExpectedCount = ExpectedCount()

    names: ClassVar[Names] = {"translation": {"t", "heard"}, "rotation": {"t", "heard"}}

    @property
    def topics(self) -> tuple[str, ...]:
        """The program's topics that it judges."""
        return ("/tf_static" if self.is_static else "/tf",)


@dataclass(frozen=True, kw_only=True)
class ExpectedInterface(Expectation):
    """A definition in what is handed in, with these fields in this order.

    Attributes:
        definition: as in its file; comments, values and constants do not count.
    """

    interface: str
    definition: str
    parrot: str = OF_FILES


@dataclass(frozen=True, kw_only=True)
class ExpectedExit(Expectation):
    """The program ends by itself, with an exit code."""

    exits: int


#: The key that an entry is known by -> its class.
KINDS: Final[Mapping[str, type[Expectation]]] = {
    "node": ExpectedNode,
    "topic": ExpectedTopic,
    "log": ExpectedLog,
    "call": ExpectedAnswer,
    "served": ExpectedRequest,
    "goal": ExpectedOutcome,
    "sends": ExpectedGoal,
    "got": ExpectedReceipt,
    "parameter": ExpectedParameters,
    "transform": ExpectedTransform,
    "interface": ExpectedInterface,
    "exits": ExpectedExit,
}


def parse(values: Any, at: tuple[str, ...]) -> Expectation:
    """Parse an entry.

    Raises:
        Mistake: something in it is wrong; its keys name the place.
    """
    kinds = [kind for kind in KINDS if isinstance(values, dict) and kind in values]
    what = "expected one of {kinds}, found {found}"
    expect(bool(kinds), at, what, values, kinds=", ".join(KINDS))
    made: Expectation = decoded(KINDS[kinds[0]], values, *at)
    for key, known in made.names.items():
        if key == "log" and not (getattr(made, "each", "") or getattr(made, "heard", "")):
            known = set()
        script.check_templates(getattr(made, key), known, (*at, key), has_patterns=True)
        _check_ranges(getattr(made, key), (*at, key))
    holds = getattr(made, "holds", "")
    fits = not holds or _is_expression(holds)
    what = "expected an expression such as {example}, found {found}"
    expect(fits, (*at, "holds"), what, holds, example='"=len(messages) > 3"')
    return made


def _check_ranges(value: Any, at: tuple[str, ...]) -> None:
    for each in value if isinstance(value, list) else []:
        _check_ranges(each, at)
    if not isinstance(value, Mapping):
        return
    for key, each in value.items():
        if not is_range(value):
            _check_ranges(each, (*at, str(key)))
            continue
        fits = is_number(each) or _is_expression(each)
        expect(fits, (*at, key), "expected a number or an expression, found {found}", each)


def _is_expression(value: Any) -> bool:
    return isinstance(value, str) and value.startswith("=")
