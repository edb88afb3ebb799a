"""Explains the usual exceptions of Python and rclpy in plain words, and says what to do about each.

The first rule that fits counts. It reads the exception's text and the line that it came from, both
of which a submission may have made up.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

from grader.diagnosis.case import excerpt
from grader.message import NOTHING, Message, msg
from grader.recording.observations import Caught, Raised, SourceLine

#: So much of an exception's text is searched [characters].
_LONGEST = 1000
#: Properties of a Node that can only be read.
_OF_A_NODE = frozenset(
    ("publishers", "subscriptions", "clients", "services", "timers", "guards", "waitables")
) | {"handle"}
_NODE_ATTRIBUTE = (
    r"'(?:_Node__\w{1,40}|_default_callback_group|_logger|_clock|_parameters|_context|_rate_group"
    r"|_parameter_overrides|_descriptors|_allow_undeclared_parameters)'"
)
_GIVEN = re.compile(
    r"(?:(\w{1,60})\.)?(\w{1,60})\(\) takes (\d{1,3}) positional arguments? but (\d{1,3}) w"
)
MISSING = re.compile(r"(\w{1,60})\(\) missing \d{1,3} required positional arguments?:")
_TAKES_CALLBACK = re.compile(r"create_(?:timer|subscription|service)\(|add_done_callback\(")
_AWAITED = re.compile(r"object (\w{1,60}) can't be used in 'await' expression")
_WITH_INIT = re.compile(r"\bwith\b.*\binit\(")
_NO_PART = re.compile(r"'(\w{1,60})' has no attribute '(?:Request|Response|Goal|Result|Feedback)'")
_WRAPPED = re.compile(r"'\w{1,60}_(FeedbackMessage|GetResult_Response)' object has no attribute")
_NO_FILE = re.compile(r"\[Errno \d+\] [^:]{1,60}: '([^'\n]{1,300})")
_UNPACKED = re.compile(r"values to unpack \(expected \d{1,3}")
_SUBSCRIPTED = re.compile(r"(\b[A-Za-z_][\w.]{0,60})\[")
_QUOTED_TYPE = re.compile(r"\((?:self, *)?['\"][\w/.]*?([A-Z]\w{0,60})['\"]")
_CREATES = re.compile(r"\b(create_(?:publisher|subscription|client|service))\(")
_IN_ORDER = {
    "create_publisher": "create_publisher(Twist, '/topic', 10)",
    "create_subscription": "create_subscription(Pose, '/topic', self.on_pose, 10)",
    "create_client": "create_client(SetPen, '/service')",
    "create_service": "create_service(SetPen, '/service', self.on_request)",
}
NOT_CALLED = msg(
    "Pass a callback by its name, without parentheses: self.NAME, not self.NAME(), which calls "
    "it at once and passes what it returns."
)
OF_A_PARAMETER = msg(
    "get_parameter() gives a Parameter; what it is set to is its value: "
    "self.get_parameter('NAME').value."
)
NO_INIT = msg("rclpy.init() has not been called")
NO_NODE = msg("the Node is not made yet when that line uses it")
#: The meaning of an exception that no rule explains.
_MEANING = {
    "KeyError": msg(
        "What that line looks into has no such entry: compare it with those that it has."
    ),
    "IndexError": msg(
        "That line asks for an element beyond the end of a list, or of an empty one."
    ),
    "ZeroDivisionError": msg(
        "What stands behind / or % in that line is 0 there: look where it gets that value."
    ),
    "StopIteration": msg(
        "next() finds nothing more there: let what it asks go on, or start it anew."
    ),
    "UnboundLocalError": msg(
        "On the way that was taken the variable was given no value before that line: give it one "
        "at the start of the function, or write self. before it where it is the node's."
    ),
    "NameError": msg("Import it, define it above, or write self. before it."),
    "ValueError": msg("That line was given a value of the right type that it cannot take."),
    "TypeError": msg("That line was given something of another type, or another number of values."),
    "RecursionError": msg("A function goes on calling itself: look for what should end that."),
}


@dataclass(frozen=True)
class Hint:
    """An exception in plain words.

    Attributes:
        help: what to do; '' where that is not known.
        text: instead of the exception's own text; '' where that is good as it is.
        place: where to fix it; None where that is where it was raised.
    """

    help: Message
    text: Message = NOTHING
    place: SourceLine | None = None


def explain(raised: Raised | Caught) -> Hint:
    """Explain an exception by the first rule that fits, or else by its name alone."""
    name, text = raised.type.rpartition(".")[2], raised.text[:_LONGEST]
    hints = (hint for rule in _RULES if (hint := rule(name, text, raised.place)))
    return next(hints, Hint(_MEANING.get(name, NOTHING)))


def _not_here(name: str, text: str, place: SourceLine | None) -> Hint | None:
    """The program wants a keyboard, or a file of somebody's own computer."""
    if name == "EOFError" and "input(" in (place.text if place else ""):
        return Hint(
            msg("Leave out input(): where your node is graded nobody types anything."),
            msg("input() waits for a keyboard, and there is none"),
        )
    found = _NO_FILE.search(text)
    if name in ("FileNotFoundError", "NotADirectoryError", "PermissionError") and found:
        return Hint(
            msg(
                "That path is of your own computer: hand in the file beside your program, and open "
                "it by Path(__file__).parent / 'NAME'; or write its content into the program."
            ),
            msg("there is no file {file} where your node is graded", file=excerpt(found[1])),
        )
    return None


def _not_awaitable(_: str, text: str, place: SourceLine | None) -> Hint | None:
    """`await` before what is no future."""
    found = _AWAITED.search(text)
    if found is None:
        return None
    if found[1].endswith("_Response"):
        return Hint(
            msg("Write await ... .call_async(request) there, in an async function."),
            msg("call() waits for the answer itself, and returns it: there is nothing to await"),
        )
    return Hint(
        msg("Leave out await: that call is over when it returns."),
        msg("await was given something that nobody can wait for"),
    )


def _no_argument(_: str, text: str, place: SourceLine | None) -> Hint | None:
    """publish() or call_async() without anything, or a callback called where it is passed."""
    found, line = MISSING.search(text), place.text if place is not None else ""
    if found is None:
        return None
    if found[1] in ("publish", "call_async", "call"):
        what = "msg" if found[1] == "publish" else "request"
        return Hint(
            msg("Give it one: {call}({what}).", call=found[1], what=what),
            msg("{call}() is called without a message", call=found[1])
            if what == "msg"
            else msg("{call}() is called without a request", call=found[1]),
        )
    is_own = not found[1].startswith("create_")
    if is_own and _TAKES_CALLBACK.search(line) and f"{found[1]}(" in line:
        return Hint(
            NOT_CALLED,
            msg("{name}() is called at once, where it is to be passed", name=excerpt(found[1])),
        )
    if found[1] == "create_service" and "callback" in text:
        return Hint(
            msg("To call a service: self.create_client({takes}).", takes="TYPE, '/name'"),
            msg("create_service() offers a service, and needs a callback for that"),
        )
    if found[1].startswith("create_") and "qos_profile" in text:
        return Hint(
            msg(
                "Compare the order: {in_order}.",
                in_order=_IN_ORDER.get(found[1], _IN_ORDER["create_publisher"]),
            ),
            msg("the last argument is missing, the QoS: write , 10"),
        )
    return None


def _without_init(name: str, text: str, place: SourceLine | None) -> Hint | None:
    """ROS or the node has not been started."""
    if name == "NotInitializedException" or "rclpy.init() has not been called" in text:
        return Hint(
            msg("Call rclpy.init() at the start of main(), before the node is made."), NO_INIT
        )
    if name == "TypeError" and _WITH_INIT.search(place.text if place is not None else ""):
        return Hint(
            msg(
                "Write rclpy.init() in a line of its own, without `with`, and rclpy.shutdown() at "
                "the end of main()."
            ),
            msg("`with rclpy.init():` needs a newer ROS 2: here rclpy.init() returns nothing"),
        )
    if name == "AttributeError" and re.search(f"has no attribute {_NODE_ATTRIBUTE}", text):
        return Hint(
            msg("super().__init__('name_of_the_node') must come first in __init__."), NO_NODE
        )
    if "__init__() missing" in text and "'node_name'" in text:
        return Hint(msg("Give the node a name: super().__init__('name_of_the_node')."))
    return None


def _read_only_name(_: str, text: str, __: SourceLine | None) -> Hint | None:
    """The program sets an attribute that can only be read."""
    found = re.search(r"property '(\w{1,60})' of .{1,80} object has no setter", text) or re.search(
        r"(?:can't set attribute '?|^(?=handle cannot be modified))(\w{1,60})", text
    )
    if found is None:
        return None
    if found[1] in _OF_A_NODE:
        return Hint(
            msg(
                "A Node has a `{name}` of its own: choose another name, as self.my_{name}.",
                name=excerpt(found[1]),
            )
        )
    return Hint(
        msg(
            "`{name}` can only be read: choose another name for what you keep.",
            name=excerpt(found[1]),
        )
    )


def _part(_: str, text: str, place: SourceLine | None) -> Hint | None:
    """A part of another kind of interface, or what stands around the part that was meant."""
    if found := _NO_PART.search(text):
        return Hint(
            msg(
                "A service has Request and Response; an action has Goal, Result and Feedback: "
                "which is {type}?",
                type=excerpt(found[1]),
            )
        )
    found, missing = _WRAPPED.search(text), re.search(r"attribute '(\w{1,60})'", text)
    if found is None or missing is None:
        return None
    part = "feedback" if found[1] == "FeedbackMessage" else "result"
    return Hint(
        msg("Write .{part}.{name} there.", part=part, name=excerpt(missing[1])),
        msg("what came is a message around the {part}", part=part),
    )


def _values(name: str, text: str, place: SourceLine | None) -> Hint | None:
    """Another number of values than names, super without parentheses, names with blanks."""
    counts = _UNPACKED.search(text)
    is_no_number = "invalid literal" in text or "convert string" in text
    if is_no_number and re.search(r"\barg\w*\[\d", place.text if place is not None else ""):
        return Hint(
            msg("sys.argv[0] is the name of the program: its first argument is sys.argv[1].")
        )
    if name == "InvalidTopicNameException" and "rclpy.pa" in text:
        return Hint(OF_A_PARAMETER, msg("a Parameter stands there for its value"))
    if name == "ValueError" and counts is not None and place is not None:
        left, _, right = place.text.partition("=")
        return Hint(
            msg(
                "{names} stand on the left: what {values} is has to have as many values.",
                names=excerpt(left.strip()),
                values=excerpt(right.strip()),
            )
        )
    if "requires a 'super' object" in text:
        return Hint(
            msg("Write super().__init__(...)."), msg("super stands there without parentheses")
        )
    if name == "InvalidNodeNameException":
        return Hint(msg("Write letters, digits and _ only, as in 'my_node'."))
    return None


def _class_for_instance(name: str, text: str, place: SourceLine | None) -> Hint | None:
    """A class was given instead of an instance of it."""
    line = place.text if place is not None else ""
    got = re.search(r"got <class '[\w.]{0,100}\.Metaclass_(\w{1,60})'>", text)
    if got is not None:
        return Hint(
            msg("The parentheses are missing: {type}() makes a message.", type=excerpt(got[1])),
            msg("publish() was given the class {type} itself, not a message", type=excerpt(got[1])),
        )
    wrong = re.search(r"Expected <class '[\w.]+\.(\w{1,60})'>, got <class '([\w.]{1,100})'>", text)
    if wrong is not None:
        wanted, was = excerpt(wrong[1]), excerpt(wrong[2].rpartition(".")[2])
        return Hint(
            msg("Give it a {wanted}.", wanted=wanted),
            msg("{wanted} is what can be sent there, it was given: {was}", wanted=wanted, was=was),
        )
    if name == "TypeError" and not text and "spin" in line:
        return Hint(
            msg("End each callback of a service with `return response`, which it was given."),
            msg("the callback of a service returned something else than a response"),
        )
    if name == "TypeError" and not text and "call" in line:
        return Hint(
            msg(
                "Are parentheses missing where the request is made? SetPen.Request() makes one, "
                "SetPen.Request is only its class."
            ),
            msg("the call was given something that is no request of this service"),
        )
    if "'property' object" in text or "'getset_descriptor' object" in text:
        if "spin" in line:
            return Hint(
                msg("The parentheses are missing where the node is made: node = MyNode()."),
                msg("spin was given a class, not a node that was made of it"),
            )
        return Hint(msg("The parentheses are missing where the message is made, as in Twist()."))
    return None


def _no_node(_: str, text: str, place: SourceLine | None) -> Hint | None:
    """The program spins something that is no node."""
    found = re.search(r"'([\w.]{1,60})' object has no attribute '(subscriptions|executor)'", text)
    if found is None or place is None or "spin" not in place.text:
        return None
    return Hint(
        msg("Make a node and spin that: node = MyNode(), then rclpy.spin(node)."),
        msg("spin has to be given the node, it was given: {was}", was=excerpt(found[1])),
    )


def _callback(_: str, text: str, place: SourceLine | None) -> Hint | None:
    """A callback that cannot be called as rclpy calls it."""
    if "object is not callable" in text and ("'NoneType'" in text or "'coroutine'" in text):
        return Hint(NOT_CALLED)
    if "callback should be" in text:
        return Hint(
            msg(
                "A method takes self before all else, and a callback of a subscription "
                "the message: def on_pose(self, pose)."
            ),
            msg("this callback of a subscription takes no message"),
        )
    if found := _GIVEN.search(text):
        owner, name, expected, given = found.groups()
        if owner and expected == "0":
            arguments = "self, msg" if int(given) > 1 else "self"
            return Hint(msg("Write def {name}({takes}).", name=excerpt(name), takes=arguments))
        if owner and (expected, given) == ("1", "2"):
            return Hint(
                msg(
                    "Write def {name}(self, msg): the callback of a subscription is given "
                    "the message, one that add_done_callback() was given the future.",
                    name=excerpt(name),
                )
            )
        return Hint(msg("Compare that call with what stands at `def {name}`.", name=excerpt(name)))
    if found := MISSING.search(text):
        is_called_by_rclpy = place is None or "spin" in place.text or "def " in place.text
        if not is_called_by_rclpy:
            return Hint(msg("Compare with what stands at `def {name}`.", name=excerpt(found[1])))
        return Hint(
            msg(
                "Compare with what stands at `def {name}`; the callback of a timer is given "
                "nothing but self.",
                name=excerpt(found[1]),
            )
        )
    return None


def _arguments(_: str, text: str, place: SourceLine | None) -> Hint | None:
    """A function in C++ was given values of other types, or in another order."""
    line = place.text if place is not None else ""
    is_of_rclpy = "incompatible function arguments" in text
    is_text_for_type = "'str' has no attribute '_TYPE_SUPPORT'" in text
    if is_text_for_type and (quoted := _QUOTED_TYPE.search(line)):
        return Hint(
            msg("Import {type}, and write it there without quotes.", type=excerpt(quoted[1])),
            msg("a type is given as a text"),
        )
    if (is_of_rclpy or is_text_for_type) and (found := _CREATES.search(line)):
        return Hint(
            msg("Compare the order: {in_order}.", in_order=_IN_ORDER[found[1]]),
            msg(
                "{function}() was given values of other types, or in another order",
                function=found[1],
            ),
        )
    if is_of_rclpy:
        return Hint(
            msg("Compare the order and the types with ROS's documentation."),
            msg("a function of rclpy's was given values of other types, or in another order"),
        )
    if "create_timer(" in line and "float() argument" in text:
        return Hint(msg("The time comes first: create_timer(0.1, self.on_timer)."))
    return None


def _no_entry(name: str, text: str, place: SourceLine | None) -> Hint | None:
    """A dict that has no such key."""
    if name != "KeyError" or not text:
        return None
    found = _SUBSCRIPTED.search(place.text if place is not None else "")
    if found is None:
        return None
    return Hint(
        msg(
            "{name} has no entry {entry}: compare with those that it has, and with what can come.",
            name=excerpt(found[1]),
            entry=excerpt(text),
        )
    )


def _parameter(name: str, text: str, _: SourceLine | None) -> Hint | None:
    """A Parameter was used instead of its value, or one that was not declared."""
    if name == "ParameterNotDeclaredException":
        asked = re.search(r"parameter\(s\): ([\w.]{1,60})", text)
        of = excerpt(asked[1]) if asked else "NAME"
        return Hint(
            msg("Declare it first, in __init__: self.declare_parameter('{name}', 1.0).", name=of)
        )
    if name == "TypeError" and "'Parameter'" in text:
        return Hint(OF_A_PARAMETER)
    return None


def _none_or_unknown(_: str, text: str, place: SourceLine | None) -> Hint | None:
    """None, a name that is not there, a spin within a spin."""
    if "NoneType" in text and place is not None and ".result()" in place.text:
        return Hint(
            msg(
                "The answer has not come yet when that line runs: go on without it, or "
                "use it in a callback that is given to add_done_callback()."
            )
        )
    if "NoneType" in text:
        return Hint(
            msg(
                "Something there is still None: a message that has not come yet, or a "
                "function that returns nothing. Return early as long as it is None."
            )
        )
    missing = re.search(r"has no attribute '(\w{1,60})'", text)
    if missing is not None and place is not None and f"self.{missing[1]}" in place.text:
        return Hint(
            msg(
                "self.{name} has no value when that line runs: write self.{name} = ... in"
                " __init__, before the first callback; or compare the name.",
                name=excerpt(missing[1]),
            )
        )
    if "has no attribute" in text:
        return Hint(
            msg(
                "Compare the name; `ros2 interface show TYPE` lists the fields of a "
                "message. An attribute of your own (self. ...) has to be set in "
                "__init__, before the first callback."
            )
        )
    if "Executor is already spinning" in text:
        return Hint(msg("Do not spin in a callback: use call_async() and add_done_callback()."))
    return None


_RULES: tuple[Callable[[str, str, SourceLine | None], Hint | None], ...] = (
    *(
        _not_here,
        _not_awaitable,
        _no_argument,
        _without_init,
        _read_only_name,
        _part,
        _values,
        _class_for_instance,
        _no_node,
        _callback,
        _arguments,
        _no_entry,
    ),
    *(_parameter, _none_or_unknown),
)
