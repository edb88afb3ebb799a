"""Explains the usual exceptions of Python and rclpy in plain words, and says what to do about each.

The first rule that fits counts. It reads the exception's text and the line that it came from, both
of which a submission may have made up.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import NamedTuple

from grader.recording.observations import Caught, Raised, SourceLine
from grader.text import NOTHING, Message, msg, shown
from grader_diagnosis.case import filled

#: So much of an exception's text is searched [characters].
_LONGEST = 1000
#: Properties of a Node that can only be read.
_OF_A_NODE = "publishers|subscriptions|clients|services|timers|guards|waitables|handle"
_NODE_ATTRIBUTE = (
    r"'(?:_Node__\w{1,40}|_default_callback_group|_logger|_clock|_parameters|_context|_rate_group"
    r"|_parameter_overrides|_descriptors|_allow_undeclared_parameters)'"
)
#: Before the name of what can only be read.
_READ_ONLY = (
    r"(?:property '(?=\w{1,60}' of .{1,80} object has no setter)|can't set attribute '?"
    r"|: (?=handle cannot be modified))"
)
#: Behind the name of a function.
_LACKS = r"\(\) missing \d{1,3} required positional arguments?:"
MISSING = re.compile(rf"(\w{{1,60}}){_LACKS}")
_TEXT_FOR_TYPE = "'str' has no attribute '_TYPE_SUPPORT'"
_UNFIT = "incompatible function arguments"
_CLASS = "'property' object|'getset_descriptor' object"
_NO_ATTRIBUTE = r"has no attribute '(?P<name>\w{1,60})'"
_OF_A_PUBLISHER = "create_publisher(Twist, '/topic', 10)"
_IN_ORDER = {
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
_DECLARE = msg("Declare it first, in __init__: self.declare_parameter('{name}', 1.0).")
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
    name = raised.type.rpartition(".")[2]
    error = f"{name}: {raised.text[:_LONGEST]}"
    code = None if raised.place is None else raised.place.text
    for rule in _RULES:
        if (words := rule.fitting(error, code)) is not None:
            words["in_order"] = _IN_ORDER.get(words.get("function", ""), _OF_A_PUBLISHER)
            return Hint(filled(rule.help, words), filled(rule.text, words))
    return Hint(_MEANING.get(name, NOTHING))


class _Rule(NamedTuple):
    """What an exception means that some patterns fit.

    Attributes:
        error: searched in 'TypeError: its text'; its groups are words of the sentences.
        help, text: as in `Hint`; they may also have `{in_order}`, how `{function}` is called.
        code: searched in the line that it came from, where there is one; '' for any line and none.
            It may repeat a group of `error`.
    """

    error: str
    help: Message
    text: Message = NOTHING
    code: str = ""

    def fitting(self, error: str, code: str | None) -> dict[str, str] | None:
        """Return the words of its patterns where they fit."""
        found = re.search(self.error, error, re.DOTALL)
        if found is None or (self.code and code is None):
            return None
        words = found.groupdict()
        pattern = self.code
        for name, word in words.items():
            pattern = pattern.replace(f"(?P={name})", re.escape(word))
        in_code = re.search(pattern, code or "")
        if in_code is None:
            return None
        return {name: shown(word) for name, word in (words | in_code.groupdict()).items()}


_RULES = (
    # a keyboard, or a file of somebody's own computer
    _Rule(
        r"^EOFError: ",
        msg("Leave out input(): where your node is graded nobody types anything."),
        msg("input() waits for a keyboard, and there is none"),
        code=r"input\(",
    ),
    _Rule(
        r"^(?:FileNotFound|NotADirectory|Permission)Error: .*\[Errno \d+\] [^:]{1,60}: "
        r"'(?P<file>[^'\n]{1,300})",
        msg(
            "That path is of your own computer: hand in the file beside your program, and open "
            "it by Path(__file__).parent / 'NAME'; or write its content into the program."
        ),
        msg("there is no file {file} where your node is graded"),
    ),
    # `await` before what is no future
    _Rule(
        r"object \w{0,51}_Response can't be used in 'await' expression",
        msg("Write await ... .call_async(request) there, in an async function."),
        msg("call() waits for the answer itself, and returns it: there is nothing to await"),
    ),
    _Rule(
        r"object \w{1,60} can't be used in 'await' expression",
        msg("Leave out await: that call is over when it returns."),
        msg("await was given something that nobody can wait for"),
    ),
    # a call without anything, or a callback called where it is passed
    _Rule(
        rf"\b(?P<call>publish){_LACKS}",
        msg("Give it one: {call}({what}).", what="msg"),
        msg("{call}() is called without a message"),
    ),
    _Rule(
        rf"\b(?P<call>call_async|call){_LACKS}",
        msg("Give it one: {call}({what}).", what="request"),
        msg("{call}() is called without a request"),
    ),
    _Rule(
        rf"\b(?!create_)(?P<name>\w{{1,60}}){_LACKS}",
        NOT_CALLED,
        msg("{name}() is called at once, where it is to be passed"),
        code=r"^(?=.*(?:create_(?:timer|subscription|service)\(|add_done_callback\()).*(?P=name)\(",
    ),
    _Rule(
        rf"\bcreate_service{_LACKS}.*callback",
        msg("To call a service: self.create_client({takes}).", takes="TYPE, '/name'"),
        msg("create_service() offers a service, and needs a callback for that"),
    ),
    _Rule(
        rf"\b(?P<function>create_\w{{0,53}}){_LACKS}.*qos_profile",
        msg("Compare the order: {in_order}."),
        msg("the last argument is missing, the QoS: write , 10"),
    ),
    # ROS or the node has not been started
    _Rule(
        r"^NotInitializedException: |rclpy\.init\(\) has not been called",
        msg("Call rclpy.init() at the start of main(), before the node is made."),
        NO_INIT,
    ),
    _Rule(
        r"^TypeError: ",
        msg(
            "Write rclpy.init() in a line of its own, without `with`, and rclpy.shutdown() at "
            "the end of main()."
        ),
        msg("`with rclpy.init():` needs a newer ROS 2: here rclpy.init() returns nothing"),
        code=r"\bwith\b.*\binit\(",
    ),
    _Rule(
        rf"^AttributeError: .*has no attribute {_NODE_ATTRIBUTE}",
        msg("super().__init__('name_of_the_node') must come first in __init__."),
        NO_NODE,
    ),
    _Rule(
        r"__init__\(\) missing.*'node_name'",
        msg("Give the node a name: super().__init__('name_of_the_node')."),
    ),
    # an attribute that can only be read
    _Rule(
        rf"{_READ_ONLY}(?P<name>{_OF_A_NODE})\b",
        msg("A Node has a `{name}` of its own: choose another name, as self.my_{name}."),
    ),
    _Rule(
        rf"{_READ_ONLY}(?P<name>\w{{1,60}})",
        msg("`{name}` can only be read: choose another name for what you keep."),
    ),
    # a part of another kind of interface, or what stands around the part that was meant
    _Rule(
        r"'(?P<type>\w{1,60})' has no attribute '(?:Request|Response|Goal|Result|Feedback)'",
        msg(
            "A service has Request and Response; an action has Goal, Result and Feedback: "
            "which is {type}?"
        ),
    ),
    *(
        _Rule(
            rf"'\w{{1,60}}_{kind}' object {_NO_ATTRIBUTE}",
            msg("Write .{part}.{name} there.", part=part),
            msg("what came is a message around the {part}", part=part),
        )
        for kind, part in (("FeedbackMessage", "feedback"), ("GetResult_Response", "result"))
    ),
    # values: another number of them than names, super without parentheses, names with blanks
    _Rule(
        r"invalid literal|convert string",
        msg("sys.argv[0] is the name of the program: its first argument is sys.argv[1]."),
        code=r"\barg\w*\[\d",
    ),
    _Rule(
        r"^InvalidTopicNameException: .*rclpy\.pa",
        OF_A_PARAMETER,
        msg("a Parameter stands there for its value"),
    ),
    _Rule(
        r"^ValueError: .*values to unpack \(expected \d{1,3}",
        msg("{names} stand on the left: what {values} is has to have as many values."),
        code=r"^(?P<names>[^=]*)=?(?P<values>.*)",
    ),
    _Rule(
        r"requires a 'super' object",
        msg("Write super().__init__(...)."),
        msg("super stands there without parentheses"),
    ),
    _Rule(
        r"^InvalidNodeNameException: ", msg("Write letters, digits and _ only, as in 'my_node'.")
    ),
    # a class instead of an instance of it
    _Rule(
        r"got <class '[\w.]{0,100}\.Metaclass_(?P<type>\w{1,60})'>",
        msg("The parentheses are missing: {type}() makes a message."),
        msg("publish() was given the class {type} itself, not a message"),
    ),
    _Rule(
        r"Expected <class '[\w.]+\.(?P<wanted>\w{1,60})'>, "
        r"got <class '(?=[\w.]{1,100}')(?:[\w.]*\.)?(?P<was>\w*)'>",
        msg("Give it a {wanted}."),
        msg("{wanted} is what can be sent there, it was given: {was}"),
    ),
    _Rule(
        r"^TypeError: \Z",
        msg("End each callback of a service with `return response`, which it was given."),
        msg("the callback of a service returned something else than a response"),
        code="spin",
    ),
    _Rule(
        r"^TypeError: \Z",
        msg(
            "Are parentheses missing where the request is made? SetPen.Request() makes one, "
            "SetPen.Request is only its class."
        ),
        msg("the call was given something that is no request of this service"),
        code="call",
    ),
    _Rule(
        _CLASS,
        msg("The parentheses are missing where the node is made: node = MyNode()."),
        msg("spin was given a class, not a node that was made of it"),
        code="spin",
    ),
    _Rule(_CLASS, msg("The parentheses are missing where the message is made, as in Twist().")),
    # something that is no node
    _Rule(
        r"'(?P<was>[\w.]{1,60})' object has no attribute '(?:subscriptions|executor)'",
        msg("Make a node and spin that: node = MyNode(), then rclpy.spin(node)."),
        msg("spin has to be given the node, it was given: {was}"),
        code="spin",
    ),
    # a callback that cannot be called as rclpy calls it
    _Rule(r"'(?:NoneType|coroutine)' object is not callable", NOT_CALLED),
    _Rule(
        r"callback should be",
        msg(
            "A method takes self before all else, and a callback of a subscription "
            "the message: def on_pose(self, pose)."
        ),
        msg("this callback of a subscription takes no message"),
    ),
    *(
        _Rule(
            rf"\w\.(?P<name>\w{{1,60}})\(\) takes 0 positional arguments? but {given} w",
            msg("Write def {name}({takes}).", takes=takes),
        )
        for given, takes in (("[01]", "self"), (r"\d{1,3}", "self, msg"))
    ),
    _Rule(
        r"\w\.(?P<name>\w{1,60})\(\) takes 1 positional arguments? but 2 w",
        msg(
            "Write def {name}(self, msg): the callback of a subscription is given "
            "the message, one that add_done_callback() was given the future."
        ),
    ),
    _Rule(
        r"(?P<name>\w{1,60})\(\) takes \d{1,3} positional arguments? but \d{1,3} w",
        msg("Compare that call with what stands at `def {name}`."),
    ),
    _Rule(
        rf"(?P<name>\w{{1,60}}){_LACKS}",
        msg("Compare with what stands at `def {name}`."),
        code=r"^(?!.*(?:spin|def ))",
    ),
    _Rule(
        rf"(?P<name>\w{{1,60}}){_LACKS}",
        msg(
            "Compare with what stands at `def {name}`; the callback of a timer is given "
            "nothing but self."
        ),
    ),
    # values of other types for a function in C++, or in another order
    _Rule(
        _TEXT_FOR_TYPE,
        msg("Import {type}, and write it there without quotes."),
        msg("a type is given as a text"),
        code=r"\((?:self, *)?['\"][\w/.]*?(?P<type>[A-Z]\w{0,60})['\"]",
    ),
    _Rule(
        f"{_UNFIT}|{_TEXT_FOR_TYPE}",
        msg("Compare the order: {in_order}."),
        msg("{function}() was given values of other types, or in another order"),
        code=r"\b(?P<function>create_(?:publisher|subscription|client|service))\(",
    ),
    _Rule(
        _UNFIT,
        msg("Compare the order and the types with ROS's documentation."),
        msg("a function of rclpy's was given values of other types, or in another order"),
    ),
    _Rule(
        r"float\(\) argument",
        msg("The time comes first: create_timer(0.1, self.on_timer)."),
        code=r"create_timer\(",
    ),
    # a dict that has no such key
    _Rule(
        r"^KeyError: (?P<entry>.+)",
        msg("{name} has no entry {entry}: compare with those that it has, and with what can come."),
        code=r"(?P<name>\b[A-Za-z_][\w.]{0,60})\[",
    ),
    # a Parameter instead of its value, or one that was not declared
    _Rule(r"^ParameterNotDeclaredException: .*parameter\(s\): (?P<name>[\w.]{1,60})", _DECLARE),
    _Rule(r"^ParameterNotDeclaredException: ", _DECLARE.given(name="NAME")),
    _Rule(r"^TypeError: .*'Parameter'", OF_A_PARAMETER),
    # None, a name that is not there, a spin within a spin
    _Rule(
        "NoneType",
        msg(
            "The answer has not come yet when that line runs: go on without it, or "
            "use it in a callback that is given to add_done_callback()."
        ),
        code=r"\.result\(\)",
    ),
    _Rule(
        "NoneType",
        msg(
            "Something there is still None: a message that has not come yet, or a "
            "function that returns nothing. Return early as long as it is None."
        ),
    ),
    _Rule(
        _NO_ATTRIBUTE,
        msg(
            "self.{name} has no value when that line runs: write self.{name} = ... in"
            " __init__, before the first callback; or compare the name."
        ),
        code=r"self\.(?P=name)",
    ),
    _Rule(
        "has no attribute",
        msg(
            "Compare the name; `ros2 interface show TYPE` lists the fields of a "
            "message. An attribute of your own (self. ...) has to be set in "
            "__init__, before the first callback."
        ),
    ),
    _Rule(
        "Executor is already spinning",
        msg("Do not spin in a callback: use call_async() and add_done_callback()."),
    ),
)
