"""Make one beginner's mistake in a right controller: what students do, not random noise.

Each `Operator` knows the places of a source where it fits, the lines that a student would have to
change, and the words by which a first line names its class of mistake. What a source of another
style lacks, an operator does not fit.
"""

from __future__ import annotations

import ast
import io
import random
import re
import tokenize
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from difflib import SequenceMatcher
from functools import cached_property, lru_cache

Function = ast.FunctionDef | ast.AsyncFunctionDef
#: Statements with more lines are no single place.
_MOST_LINES = 8
#: Names of what students keep: whether the turtle has stopped, its quadrant, its speed.
_DONE = r"_?(?:finished|stopped?|at_wall|is_done|done|at_edge)"
_QUADRANT = r"_?(?:(?:current_|old_)?quadrant|corner|last|pen_of|area|region|sector|color|quarter)"
_SPEED = r"_?(?:linear_speed|speed|linear|velocity|radius|v)"
_POSE = r"(?:pose|msg|data|p|self\.pose|self)"

#: Passages, where they begin and end, and what stands there instead.
Change = tuple[tuple[int, int, str], ...]
Places = Callable[["Program"], Iterable[Change]]


@dataclass(frozen=True)
class Mutant:
    """A source with a mistake.

    Attributes:
        lines: those that a student would have to change, from 1; a statement of several counts as
            a whole.
    """

    source: str
    lines: tuple[int, ...]


@dataclass(frozen=True)
class Operator:
    """A class of mistakes.

    Attributes:
        words: a regular expression of what a first line says that names it, in English.
        places: yields the changes that make it, one a place.
        missing: whether a whole line is missing afterwards.
    """

    name: str
    words: str
    places: Places = field(repr=False)
    missing: bool = False

    def named_by(self, text: str) -> bool:
        return re.search(self.words, text, re.IGNORECASE) is not None

    def mutant(self, source: str, chance: random.Random) -> Mutant | None:
        program = _program(source)
        changes = list(self.places(program))
        if not changes:
            return None
        return _mutant(program, chance.choice(changes), self.missing)


class Program:
    def __init__(self, text: str) -> None:
        self.text = text
        self.tree = ast.parse(text)
        self.starts = [0]
        for line in text.splitlines(keepends=True):
            self.starts.append(self.starts[-1] + len(line))

    def span(self, node: ast.AST) -> tuple[int, int]:
        """Where a node begins and ends; sources are ASCII."""
        begin = self.starts[node.lineno - 1] + node.col_offset
        return begin, self.starts[node.end_lineno - 1] + node.end_col_offset

    def code(self, node: ast.AST) -> str:
        return self.text[slice(*self.span(node))]

    @cached_property
    def prose(self) -> list[tuple[int, int]]:
        """Comments and docstrings, where nothing is a mistake."""
        found = []
        for token in tokenize.generate_tokens(io.StringIO(self.text).readline):
            is_docstring = token.type == tokenize.STRING and token.string.startswith('"""')
            if token.type == tokenize.COMMENT or is_docstring:
                (row, col), (last, end) = token.start, token.end
                found.append((self.starts[row - 1] + col, self.starts[last - 1] + end))
        return found

    def matches(self, pattern: str) -> Iterator[re.Match[str]]:
        """Find a pattern in the code; ^ and $ are those of a line."""
        for found in re.finditer(pattern, self.text, re.MULTILINE):
            if not any(begin <= found.start() < end for begin, end in self.prose):
                yield found

    @cached_property
    def functions(self) -> list[Function]:
        return [each for each in ast.walk(self.tree) if isinstance(each, Function)]

    def around(self, offset: int) -> Function | None:
        spans = [(self.span(each), each) for each in self.functions]
        inside = [each for (begin, end), each in spans if begin <= offset <= end]
        return max(inside, key=lambda each: each.lineno, default=None)

    def calls(self, *names: str) -> Iterator[ast.Call]:
        for node in ast.walk(self.tree):
            if isinstance(node, ast.Call) and last_name(node.func) in names:
                yield node

    def callbacks(self, of: str) -> list[Function]:
        """The functions that calls of `create_timer` or `create_subscription` are given."""
        given = {last_name(arg) for call in self.calls(of) for arg in call.args}
        return [each for each in self.functions if each.name in given]

    def own(self, ctx: type[ast.expr_context]) -> Iterator[ast.Attribute]:
        for node in ast.walk(self.tree):
            match node:
                case ast.Attribute(value=ast.Name(id="self")) if isinstance(node.ctx, ctx):
                    yield node

    @cached_property
    def kept(self) -> set[str]:
        set_, read = ({n.attr for n in self.own(ctx)} for ctx in (ast.Store, ast.Load))
        return set_ & read

    def importing(self, line: str) -> Change:
        """An import that is added beside a mistake; '' for none."""
        at = self.text.index("import rclpy\n")
        return ((at, at, f"{line}\n"),) if line and f"{line}\n" not in self.text else ()


_program = lru_cache(32)(Program)  # each for many operators


def last_name(node: ast.expr) -> str:
    """'drive' of self.drive."""
    match node:
        case ast.Attribute(attr=name) | ast.Name(id=name):
            return name
    return ""


# From a change to a mutant ------------------------------------------------------------------------


def _mutant(program: Program, change: Change, missing: bool) -> Mutant | None:
    text = _edited(program, change)
    if missing and not _parses(text):  # it was the only statement of its block
        passing = [(b, e, re.sub(r"\S[^\n]*", "pass", program.text[b:e])) for b, e, _ in change]
        text = _edited(program, passing)
    if text == program.text:
        return None
    lines = _changed_lines(program.text, text)
    # what Python cannot read has its statements where they were
    readable = text if _parses(text) else program.text
    return Mutant(text, tuple(sorted(lines if missing else _statements(readable, lines))))


def _edited(program: Program, change: Iterable[tuple[int, int, str]]) -> str:
    text = program.text
    for begin, end, new in sorted(change, reverse=True):
        text = text[:begin] + new + text[end:]
    return text


def _changed_lines(old: str, new: str) -> set[int]:
    """The lines that differ, without imports; of one that is missing the neighbours."""
    before, after = old.split("\n"), new.split("\n")
    lines: set[int] = set()
    for kind, _, _, first, last in SequenceMatcher(None, before, after, False).get_opcodes():
        if kind == "delete":
            lines |= {max(first, 1), first + 1}
        elif kind != "equal":
            lines |= set(range(first + 1, last + 1))
    imports = {n for n in lines if re.match(r"import time|from \w+(\.\w+)* import", after[n - 1])}
    return lines - imports or lines


def _parses(text: str) -> bool:
    try:
        ast.parse(text)
    except SyntaxError:
        return False
    return True


def _statements(text: str, lines: set[int]) -> set[int]:
    """Add the other lines of the same short statements, or of their heads."""
    found = set(lines)
    for node in ast.walk(ast.parse(text)):
        if not isinstance(node, ast.stmt):
            continue
        if isinstance(getattr(node, "value", None), ast.Dict | ast.List):
            continue  # a table: its rows are places
        body = getattr(node, "body", None)
        last = body[0].lineno - 1 if body else node.end_lineno or node.lineno
        span = set(range(node.lineno, max(last, node.lineno) + 1))
        if lines & span and len(span) <= _MOST_LINES:
            found |= span if not body or last > node.lineno else {node.lineno}
    return found


# Kinds of places ----------------------------------------------------------------------------------


def swap(pattern: str, *news: str, within: str = "", of: str = "", needs: str = "") -> Places:
    """Replace what matches, by one of some templates.

    Args:
        within: a pattern of the names of functions in which alone.
        of: a kind of callbacks in which alone.
        needs: an import that comes with it.
    """

    def places(program: Program) -> Iterator[Change]:
        for found in program.matches(pattern):
            around = program.around(found.start())
            if within and (around is None or not re.fullmatch(within, around.name)):
                continue
            if of and around not in program.callbacks(of):
                continue
            for new in news:
                yield ((*found.span(), found.expand(new)), *program.importing(needs))

    return places


def drop(pattern: str, within: str = "", of: str = "") -> Places:
    """Leave out the whole lines that match."""
    return swap(pattern, "", within=within, of=of)


def called(*calls: str) -> Places:
    def places(program: Program) -> Iterator[Change]:
        names = {each.name for each in program.functions}
        for node in program.calls(*calls):
            for arg in (*node.args, *(word.value for word in node.keywords)):
                if last_name(arg) in names:
                    yield ((*program.span(arg), f"{program.code(arg)}()"),)

    return places


def misspelt(ctx: type[ast.expr_context], inside_init: bool = True) -> Places:
    def places(program: Program) -> Iterator[Change]:
        for node in program.own(ctx):
            around = program.around(program.span(node)[0])
            is_init = around is not None and around.name == "__init__"
            if node.attr in program.kept and len(node.attr) > 4 and is_init == inside_init:
                middle = len(node.attr) // 2 + 1
                wrong = node.attr[: middle - 1] + node.attr[middle:]
                yield ((*program.span(node), f"self.{wrong}"),)

    return places


def without_self_dot(ctx: type[ast.expr_context], methods: bool = False) -> Places:
    """Forget `self.` before an attribute, or before a method that is called."""

    def places(program: Program) -> Iterator[Change]:
        names = {each.name for each in program.functions} if methods else program.kept
        for node in program.own(ctx):
            around = program.around(program.span(node)[0])
            if node.attr not in names or around is None:
                continue
            if node.attr not in {arg.arg for arg in around.args.args}:
                yield ((*program.span(node), node.attr),)

    return places


def arguments(of: str, change: Callable[[list[str]], list[str]]) -> Places:
    """Change the arguments of a callback where it is defined; '' for all methods."""

    def places(program: Program) -> Iterator[Change]:
        for each in program.callbacks(of) if of else program.functions:
            old = [program.code(arg) for arg in each.args.args]
            if each.name == "__init__" or (not of and old[:1] != ["self"]):
                continue
            begin = program.text.index("(", program.span(each)[0]) + 1
            end = program.text.index(")", begin)
            new = ", ".join(change(old))
            if new != ", ".join(old):
                yield ((begin, end, new),)

    return places


def is_limit(node: ast.AST) -> bool:
    """Whether a comparison tells that a wall is near."""
    if isinstance(node, ast.UnaryOp):
        return is_limit(node.operand)
    if not isinstance(node, ast.Compare):
        return False
    for each in (node.left, *node.comparators):
        match each:
            case ast.Constant(value=float() as value):
                if 0.5 < value < 3 or 4.4 < value < 5.2 or value > 8.5:
                    return True
            case ast.Name() | ast.Attribute():
                if last_name(each).lower() in ("low", "high", "margin"):
                    return True
    return False


def flipped(program: Program) -> Iterator[Change]:
    for node in ast.walk(program.tree):
        if isinstance(node, ast.Compare) and is_limit(node):
            begin, end = program.span(node.left)[1], program.span(node.comparators[0])[0]
            sign = program.text[begin:end]
            yield ((begin, end, sign.translate(str.maketrans("<>", "><"))),)


def walls(program: Program) -> Iterator[tuple[tuple[int, int], str, list[str]]]:
    """Where walls are watched, by `or` or `and`, and how each is."""
    for node in ast.walk(program.tree):
        if isinstance(node, ast.BoolOp) and all(map(is_limit, node.values)):
            sign = " or " if isinstance(node.op, ast.Or) else " and "
            yield program.span(node), sign, [program.code(each) for each in node.values]


def fewer_walls(program: Program) -> Iterator[Change]:
    for span, sign, parts in walls(program):
        for each in parts:
            yield ((*span, sign.join(part for part in parts if part != each)),)


def and_for_or(program: Program) -> Iterator[Change]:
    for span, sign, parts in walls(program):
        if sign == " or ":
            yield ((*span, " and ".join(parts)),)


def same_colours(program: Program) -> Iterator[Change]:
    colours = list(program.matches(r"\b\d{1,3}, \d{1,3}, \d{1,3}\b"))
    for one in colours:
        for other in colours:
            if one[0] != other[0]:  # a student may change either
                yield ((*one.span(), other[0]), (*other.span(), other[0]))


# The operators ------------------------------------------------------------------------------------

_FIELD = r"compare the (?:name|field)|did you mean|is spelt|interface show"
_NAME = r"compare the name|did you mean|is spelt|never read|mean `?self\."
_SELF = r"write self\.|self\. before|is a variable of this function"
_NEVER_TRUE = (
    r"(?:never|ever|always) (?:be )?true|true in (?:the middle|a corner)|\band\b.{0,25}\bor\b"
)
_NOT_WATCHED = r"not at the \w+ one|not (?:be )?watch(?:ed)?|\w+ wall watched"
_FLOW = r"drive[sn]? on|driving command|drive no more|overrul|another command"
_ZERO_STOP = r"(?:\w+\.)?publish\(Twist\(\)\)|[\w.]+\(0\.0, 0\.0\)|self\.(?:halt|stop)\(\)"
_TURN = (
    r"(angular\.z = |\b(?:ANGULAR|OMEGA) = |_turn = |turn: float = |"
    r"(?:move|drive|send)\([^()\n]*, )"
)

#: All of them; some belong to one class, and then share its words.
# fmt: off
OPERATORS: tuple[Operator, ...] = (
    # Python does not read it
    Operator("colon_missing", r"expected ':'|colon is missing|write a colon|ends with a colon",
             swap(r"(?<=\)):$|(?<=else):$", "")),
    Operator("bracket_missing", r"never closed|(?:bracket|parenthesis) is (?:missing|not closed)",
             swap(r"\)$", "")),
    Operator("typographic_quotes", r"typographic|curly|straight quote",
             swap(r'"([/\w]+)"', "\u201c\\1\u201d")),
    Operator("mixed_tabs", r"\btabs?\b", swap(r"^        (?=\w)", "\t")),
    Operator("indentation", r"indent|same column|spaces at the beginning",
             swap(r"^(    +)(?=[a-z][\w.]+(?: =|\())", r"\1  ", r"\1 ")),
    Operator("else_if", r"elif", swap(r"\belif\b", "else if")),
    Operator("assigns_in_condition", r"==", swap(r"(?<=if )(\w+) == ", r"\1 = ")),
    # imports
    Operator("imports_rospy", r"ROS 1", swap(r"^import rclpy$", "import rospy")),
    Operator("twist_of_turtlesim", r"geometry_msgs",
             swap(r"from geometry_msgs\.msg import Twist", "from turtlesim.msg import Twist")),
    # names
    Operator("attribute_misspelt_where_set", _NAME, misspelt(ast.Store)),
    Operator("attribute_misspelt_where_read", _NAME, misspelt(ast.Load, inside_init=False)),
    Operator("method_of_node_misspelt", _NAME, swap(r"create_(tim|cli|pub|sub)(\w)", r"create_\1")),
    Operator("self_dot_missing_read", _SELF, without_self_dot(ast.Load)),
    Operator("self_dot_missing_call", _SELF, without_self_dot(ast.Load, methods=True)),
    Operator("local_for_attribute", _SELF, without_self_dot(ast.Store)),
    Operator("global_missing", r"\bglobal\b|nonlocal",
             drop(r"^ +(?:global|nonlocal) .*\n"), missing=True),
    Operator("field_of_twist", rf"{_FIELD}|linear\.x",
             swap(r"\.linear\.x = ", ".x = ", ".linear_x = ")),
    # calls
    Operator("callback_called", r"without (?:parentheses|brackets)|at once",
             called("create_timer", "create_subscription", "add_done_callback")),
    Operator("method_without_self", r"takes self|self before|def \w+\(self",
             arguments("", lambda old: old[1:])),
    Operator("callback_without_message", r"takes no message|given the message",
             arguments("create_subscription", lambda old: old[:-1])),
    Operator("super_init_missing", r"super\(\)\.__init__",
             drop(r"^ +super\(\)\.__init__\(.*\n"), missing=True),
    Operator("publish_without_brackets", r"without (?:parentheses|brackets)",
             swap(r"\.publish\([\w]+(?:\(\))?\)$", ".publish")),
    Operator("twist_is_the_class", r"(?:parentheses|brackets) are missing|Twist\(\) makes",
             swap(r"= Twist\(\)$", "= Twist")),
    Operator("main_not_called", r"main\(\) ever called|main\(\) is never called|__main__",
             drop(r"^if __name__ == [^\n]*\n[^\n]*\n"), missing=True),
    Operator("init_missing", r"rclpy\.init", drop(r"^ +rclpy\.init\(.*\n"), missing=True),
    Operator("spin_missing", r"rclpy\.spin\(", drop(r"^ +rclpy\.spin\(\w+\)\n"), missing=True),
    Operator("shutdown_too_early", r"shut ?down",
             swap(r"^(?=( +)rclpy\.spin\()", r"\1rclpy.shutdown()\n")),
    # what meets nobody
    Operator("velocity_topic_misspelt", r"listens to|nobody listens",
             swap(r"turtle1/cmd_vel", "turtle1/cmd_val", "turtle1/cmdvel", "turtle1/cmd_Vel")),
    Operator("service_misspelt", r"nobody offers",
             swap(r"turtle1/set_pen", "turtle1/setpen", "turtle1/pen", "turtle1/set_pen_color")),
    Operator("turtle1_missing", r"nobody (?:listens|publishes|offers)",
             swap(r"/?turtle1/(?=cmd_vel|pose|set_pen)", "/")),
    Operator("publisher_of_another_type", r"listens to geometry_msgs|publisher (?:is|was made) for",
             swap(r"(?<=create_publisher\()\w+", "Pose")),
    Operator("transient_local", r"TRANSIENT_LOCAL|QoS",
             swap(r"(create_subscription\((?:\s*[^\s,]+,){3}\s*)10",
                  r"\1QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)",
                  needs="from rclpy.qos import DurabilityPolicy, QoSProfile")),
    # what waits or never waits
    Operator("spin_until_in_callback", r"spin_until_future_complete|spin in a callback",
             swap(r"^( +)([\w.]+\.call_async\(.*\))$",
                  r"\1future = \2\n\1rclpy.spin_until_future_complete(self, future)",
                  within=r"(?!main|step|watch|set_pen)\w+")),
    Operator("call_in_callback", r"call_async\(request\)",
             swap(r"(?<!await )(\b[\w.]+)\.call_async\((?=.*\)$)", r"\1.call(",
                  within=r"(?!main)\w+")),
    Operator("sleep_in_pose_callback", r"sleep",
             swap(r"def \w+\(.*:\n( +)", r"\g<0>time.sleep(0.5)\n\1", of="create_subscription",
                  needs="import time")),
    Operator("timer_of_zero", r"period", swap(r"(create_timer\()0\.\d+", r"\g<1>0.0", r"\g<1>0")),
    Operator("timer_in_milliseconds", r"milliseconds",
             swap(r"(create_timer\()0\.(\d)", r"\g<1>\g<2>00")),
    Operator("timer_missing", r"(?:no|without a) timer|timer is (?:missing|never made)",
             drop(r"^ +(?:self\.\w+ = )?(?:self|node)\.create_timer\(.*\)\n"), missing=True),
    Operator("subscription_missing", r"(?:no|without a) subscription|never subscribe",
             drop(r"^ +(?:self\.\w+ = )?(?:self|node)\.create_subscription\(.*\)\n"), missing=True),
    # values
    Operator("int_for_float", r"must be a float", swap(rf"{_TURN}([1-9])\.\d+(?=\)?$)", r"\1\2")),
    Operator("float_for_int", r"must be an int",
             swap(r"(\.[rgb] = |\.width = |\b[rgb]=)(\d+)\b", r"\1\2.0")),
    Operator("colour_256", r"0 to 255", swap(r"\b255\b", "256")),
    Operator("guard_of_none_missing", r"(?-i:\bNone\b)",
             drop(r"^ +if \w+\.(?:pose|x) is None:\n(?: +rate\.sleep\(\)\n)? +continue\n"),
             missing=True),
    # the stop
    Operator("stop_flipped", rf"{_NEVER_TRUE}|[<>] ", flipped),
    Operator("one_wall_forgotten", _NOT_WATCHED, fewer_walls),
    Operator("and_for_or", _NEVER_TRUE, and_for_or),
    Operator("stop_not_sent", r"Twist of zeros|zero Twist|told to stop",
             drop(rf"^ +(?:{_ZERO_STOP})\n"), missing=True),
    Operator("stop_overruled", _FLOW,
             drop(rf"^ +if (?:self\.)?{_DONE}:\n +return\n", of="create_timer"), missing=True),
    Operator("flag_not_set", _FLOW,
             drop(rf"^ +(?:self\.)?(?:{_DONE} = True|(?:running|active) = False)\n",
                  within=r"(?!__init__)\w+"), missing=True),
    # shape and pen
    Operator("degrees", r"radians",
             swap(rf"{_TURN}[1-9]\.\d+(?=\)?$)", r"\g<1>90.0", r"\g<1>45.0")),
    Operator("turns_about_x", r"angular\.[xz]",
             swap(r"angular\.z = (?!0\.0)", "angular.x = ", "angular.y = ")),
    Operator("never_grows", r"grow", swap(rf"((?:self\.)?{_SPEED} \+= )[\w.]+$", r"\g<1>0.0")),
    Operator("pen_at_every_pose", r"set_pen.{0,80}(?:times|calls)|calls of set_pen|each pose",
             drop(rf"^ +(?:self\.)?{_QUADRANT} = [a-z][\w.()]*\n",
                  within=r"(?!__init__|main)\w+"), missing=True),
    Operator("pen_off", r"\boff\b", swap(r"(\.off = |\boff=)0", r"\g<1>1")),
    Operator("same_colours", r"are both|no eye|colou?r of its own", same_colours),
    Operator("y_for_x", r"conditions?\b|compare x and y",
             swap(rf"(\b{_POSE}\.)y(?= [<>]=? (?:5\.5|MIDDLE|HALF|half))", r"\1x")),
)
# fmt: on
