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
from functools import cached_property, lru_cache

Function = ast.FunctionDef | ast.AsyncFunctionDef
#: Statements with more lines are no single place.
_MOST_LINES = 8
#: Names of what students keep: whether the turtle has stopped, its quadrant, its speed.
_DONE = r"_?(?:finished|stopped?|at_wall|is_done|done|at_edge)"
_QUADRANT = r"_?(?:(?:current_|old_)?quadrant|corner|last|pen_of|area|region|sector|color|quarter)"
_SPEED = r"_?(?:linear_speed|speed|linear|velocity|radius|v)"
_POSE = r"(?:pose|msg|data|p|self\.pose|self)"


@dataclass(frozen=True)
class Edit:
    """One passage replaced; `blamed` if a student would have to change it."""

    start: int
    end: int
    new: str
    blamed: bool = True


Change = tuple[Edit, ...]
Places = Callable[["Program"], Iterable[Change]]


@dataclass(frozen=True)
class Mutant:
    """A source with a mistake.

    Attributes:
        lines: those that a student would have to change, from 1; a statement of several counts as
            a whole.
        function: first and last line of the function around them, where something is missing.
    """

    source: str
    lines: tuple[int, ...]
    function: tuple[int, int] | None


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
        """Whether a text names this class of mistakes."""
        return re.search(self.words, text, re.IGNORECASE) is not None

    def mutant(self, source: str, chance: random.Random) -> Mutant | None:
        """Make the mistake in one of its places; None where there is none."""
        program = _program(source)
        changes = list(self.places(program))
        if not changes:
            return None
        return _mutant(program, chance.choice(changes), self.missing)


class Program:
    """A source, and what of it has which part."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.tree = ast.parse(text)
        self.starts = [0]
        for line in text.splitlines(keepends=True):
            self.starts.append(self.starts[-1] + len(line))

    def span(self, node: ast.AST) -> tuple[int, int]:
        """Where a node begins and ends; sources are ASCII."""
        assert isinstance(node, ast.expr | ast.stmt | ast.arg | ast.keyword)
        assert node.end_lineno is not None and node.end_col_offset is not None
        begin = self.starts[node.lineno - 1] + node.col_offset
        return begin, self.starts[node.end_lineno - 1] + node.end_col_offset

    def code(self, node: ast.AST) -> str:
        """The text of a node."""
        begin, end = self.span(node)
        return self.text[begin:end]

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
        """All functions and methods, outer ones first."""
        return [each for each in ast.walk(self.tree) if isinstance(each, Function)]

    def around(self, offset: int) -> Function | None:
        """The innermost function around a place."""
        spans = [(self.span(each), each) for each in self.functions]
        inside = [each for (begin, end), each in spans if begin <= offset <= end]
        return max(inside, key=lambda each: each.lineno, default=None)

    def calls(self, *names: str) -> Iterator[ast.Call]:
        """The calls of functions by their last name."""
        for node in ast.walk(self.tree):
            if isinstance(node, ast.Call) and last_name(node.func) in names:
                yield node

    def callbacks(self, of: str) -> list[Function]:
        """The functions that calls of `create_timer` or `create_subscription` are given."""
        given = {last_name(arg) for call in self.calls(of) for arg in call.args}
        return [each for each in self.functions if each.name in given]

    def own(self, name: str, ctx: type[ast.expr_context]) -> Iterator[ast.Attribute]:
        """`self.NAME`, read or set; all names for ''."""
        for node in ast.walk(self.tree):
            match node:
                case ast.Attribute(value=ast.Name(id="self"), attr=attr):
                    if isinstance(node.ctx, ctx) and name in ("", attr):
                        yield node

    @cached_property
    def kept(self) -> set[str]:
        """Attributes of self that are both set and read."""
        set_, read = ({n.attr for n in self.own("", ctx)} for ctx in (ast.Store, ast.Load))
        return set_ & read

    def importing(self, line: str) -> Edit:
        """An import that is added beside a mistake."""
        at = self.text.index("import rclpy\n")
        return Edit(at, at, "" if f"{line}\n" in self.text else f"{line}\n", blamed=False)


_program = lru_cache(32)(Program)  # each for many operators


def last_name(node: ast.expr) -> str:
    """'drive' of self.drive."""
    match node:
        case ast.Attribute(attr=name) | ast.Name(id=name):
            return name
    return ""


# From an edit to a mutant -------------------------------------------------------------------------


def _mutant(program: Program, change: Change, missing: bool) -> Mutant | None:
    text, lines = _edited(program, change)
    if missing and not _parses(text):  # it was the only statement of its block
        change = tuple(
            Edit(e.start, e.end, re.sub(r"\S[^\n]*", "pass", program.text[e.start : e.end]), True)
            if e.blamed and not e.new
            else e
            for e in change
        )
        text, lines = _edited(program, change)
    if text == program.text:
        return None
    first = next(each for each in change if each.blamed)
    function = program.around(first.start) if missing else None
    if missing and function is None:
        function = next((f for f in program.functions if f.name in ("main", "run")), None)
    # what Python cannot read has its statements where they were
    readable = text if _parses(text) else program.text
    lines = lines if missing else _statements(readable, lines)
    if function is None:
        return Mutant(text, tuple(sorted(lines)), None)
    begin, end = program.span(function)
    span = (_line(text, _moved(change, begin)), _line(text, _moved(change, end)))
    return Mutant(text, tuple(sorted(lines)), span)


def _edited(program: Program, change: Change) -> tuple[str, set[int]]:
    text = program.text
    for each in sorted(change, key=lambda e: e.start, reverse=True):
        text = text[: each.start] + each.new + text[each.end :]
    lines: set[int] = set()
    for each in change:
        if not each.blamed:
            continue
        at = _moved(change, each.start)
        passage = each.new.strip("\n")
        first = _line(text, at) + (len(each.new) - len(each.new.lstrip("\n")))
        if passage.strip():
            lines |= set(range(first, first + passage.count("\n") + 1))
        elif "\n" in program.text[each.start : each.end]:
            lines |= {max(first - 1, 1), first}  # the neighbours of a line that is missing
        else:
            lines.add(first)
    return text, lines


def _moved(change: Change, offset: int) -> int:
    return offset + sum(len(e.new) - (e.end - e.start) for e in change if e.start < offset)


def _line(text: str, offset: int) -> int:
    return text.count("\n", 0, offset) + 1


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


def swap(pattern: str, *news: str, within: str = "", needs: str = "") -> Places:
    """Replace what matches, by one of some templates.

    Args:
        within: a pattern of the names of functions in which alone.
        needs: an import that comes with it.
    """

    def places(program: Program) -> Iterator[Change]:
        for found in program.matches(pattern):
            around = program.around(found.start())
            if within and (around is None or not re.fullmatch(within, around.name)):
                continue
            for new in news:
                edits = [Edit(found.start(), found.end(), found.expand(new))]
                yield (*edits, *([program.importing(needs)] if needs else []))

    return places


def drop(pattern: str, within: str = "", of: str = "") -> Places:
    """Leave out the whole lines that match; in callbacks `of` a kind alone."""
    swapping = swap(pattern, "", within=within)

    def places(program: Program) -> Iterator[Change]:
        for change in swapping(program):
            if not of or program.around(change[0].start) in program.callbacks(of):
                yield change

    return places


def argument(call: str, index: int, new: str, needs: str = "") -> Places:
    """Replace an argument, by its place or else its end; `new` has the old one as {0}."""

    def places(program: Program) -> Iterator[Change]:
        for node in program.calls(call):
            if len(node.args) > index:
                begin, end = program.span(node.args[index])
                edit = Edit(begin, end, new.format(program.text[begin:end]))
                yield (edit, *([program.importing(needs)] if needs else []))

    return places


def no_qos(call: str) -> Places:
    """Leave the depth of the queue out."""

    def places(program: Program) -> Iterator[Change]:
        for node in program.calls(call):
            depth = next(
                (a for a in node.args if isinstance(a, ast.Constant) and a.value in (1, 10)), None
            )
            if depth is not None:
                begin = program.span(node.args[node.args.index(depth) - 1])[1]
                yield (Edit(begin, program.span(depth)[1], ""),)

    return places


def called(*calls: str) -> Places:
    """Call a callback where it is to be passed."""

    def places(program: Program) -> Iterator[Change]:
        names = {each.name for each in program.functions}
        for node in program.calls(*calls):
            for arg in (*node.args, *(word.value for word in node.keywords)):
                if last_name(arg) in names:
                    yield (Edit(*program.span(arg), f"{program.code(arg)}()"),)

    return places


def misspelt(ctx: type[ast.expr_context], inside_init: bool = True) -> Places:
    """Misspell an attribute of self in one place."""

    def places(program: Program) -> Iterator[Change]:
        for node in program.own("", ctx):
            around = program.around(program.span(node)[0])
            is_init = around is not None and around.name == "__init__"
            if node.attr in program.kept and len(node.attr) > 4 and is_init == inside_init:
                middle = len(node.attr) // 2 + 1
                wrong = node.attr[: middle - 1] + node.attr[middle:]
                yield (Edit(*program.span(node), f"self.{wrong}"),)

    return places


def without_self_dot(ctx: type[ast.expr_context], methods: bool = False) -> Places:
    """Forget `self.` before an attribute, or before a method that is called."""

    def places(program: Program) -> Iterator[Change]:
        names = {each.name for each in program.functions} if methods else program.kept
        for node in program.own("", ctx):
            around = program.around(program.span(node)[0])
            if node.attr not in names or around is None:
                continue
            if node.attr not in {arg.arg for arg in around.args.args}:
                yield (Edit(*program.span(node), node.attr),)

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
                yield (Edit(begin, end, new),)

    return places


def insert(of: str, *news: str, needs: str = "", last: bool = False) -> Places:
    """Add statements to callbacks `of` a kind, or to a function of that name.

    Args:
        news: with {self}, what makes timers; {name}, the function's own call; {speed}, an attribute
            that begins at 0.
        last: whether at the end.
    """

    def places(program: Program) -> Iterator[Change]:
        functions = program.callbacks(of) or [f for f in program.functions if f.name == of]
        zero = re.search(r"(?:self\.)?\w+(?=(?:: float)? = 0\.0$)", program.text, re.MULTILINE)
        for each in functions:
            is_method = [a.arg for a in each.args.args[:1]] == ["self"]
            words = {"self": "self" if is_method else "node", "speed": zero[0] if zero else ""}
            words["name"] = f"self.{each.name}" if is_method else each.name
            body = [s for s in each.body if not isinstance(s, ast.Global | ast.Nonlocal)]
            if isinstance(body[0], ast.Expr) and isinstance(body[0].value, ast.Constant):
                body = body[1:]
            after = next((s for s in body if "super()" in program.code(s)), None)
            at = program.starts[body[0].lineno - 1]
            if last or after is not None:
                at = program.starts[((body[-1] if last else after) or body[0]).end_lineno or 0]
            indent = " " * body[0].col_offset
            for new in news:
                if "{speed}" in new and not zero:
                    continue
                text = "".join(f"{indent}{line}\n" for line in new.format(**words).split("\n"))
                yield (Edit(at, at, text), *([program.importing(needs)] if needs else []))

    return places


def before_spin(*news: str) -> Places:
    """Add a statement before `rclpy.spin(node)`."""
    return swap(r"^(?=( +)rclpy\.spin\((\w+)\)\n)", *(rf"\1{new}\n" for new in news))


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
    """`>` for `<` in the condition to stop."""
    for node in ast.walk(program.tree):
        if isinstance(node, ast.Compare) and is_limit(node):
            begin, end = program.span(node.left)[1], program.span(node.comparators[0])[0]
            sign = program.text[begin:end]
            yield (Edit(begin, end, sign.translate(str.maketrans("<>", "><"))),)


def fewer_walls(axis: str) -> Places:
    """Forget one wall, or all of the axis y."""

    def places(program: Program) -> Iterator[Change]:
        for node in ast.walk(program.tree):
            if isinstance(node, ast.BoolOp) and all(is_limit(each) for each in node.values):
                sign = " or " if isinstance(node.op, ast.Or) else " and "
                parts = [program.code(each) for each in node.values]
                without = [[p for p in parts if p != each] for each in parts]
                if axis:
                    without = [[p for p in parts if not re.search(rf"\b{axis}\b", p)]]
                for kept in without:
                    if kept and len(kept) < len(parts):
                        yield (Edit(*program.span(node), sign.join(kept)),)

    return places


def and_for_or(program: Program) -> Iterator[Change]:
    """All walls at once."""
    for node in ast.walk(program.tree):
        match node:
            case ast.BoolOp(op=ast.Or(), values=values) if all(map(is_limit, values)):
                parts = [program.code(each) for each in values]
                yield (Edit(*program.span(node), " and ".join(parts)),)


def same_colours(program: Program) -> Iterator[Change]:
    """One colour for two quadrants."""
    colours = list(program.matches(r"\b\d{1,3}, \d{1,3}, \d{1,3}\b"))
    for one in colours:
        for other in colours:
            if one[0] != other[0]:  # a student may change either
                yield (Edit(*one.span(), other[0]), Edit(*other.span(), other[0]))


def awaiting(program: Program) -> Iterator[Change]:
    """Wait for the pen by `await`, from a callback on."""
    for sends in program.matches(r"(?<!await )(?<!= )[\w.]+\.call_async\("):
        around = program.around(sends.start())
        if around is None or isinstance(around, ast.AsyncFunctionDef):
            continue
        names = {each.name for each in program.callbacks("create_subscription")}
        begin = program.span(around)[0]
        edits = [Edit(begin, begin, "async "), Edit(sends.start(), sends.start(), "await ")]
        if around.name in names:
            yield tuple(edits)
            continue
        outer = set()
        for call in program.calls(around.name):
            caller = program.around(program.span(call)[0])
            if caller is not None and caller.name in names:
                edits.append(Edit(program.span(call)[0], program.span(call)[0], "await "))
                outer.add(program.span(caller)[0])
        if outer:
            yield (*edits, *(Edit(begin, begin, "async ") for begin in outer))


def in_loop(program: Program) -> Iterator[Change]:
    """A loop that publishes, in a timer's callback."""
    for each in program.callbacks("create_timer"):
        begin, end = program.span(each)
        for found in re.finditer(r"^( +)([\w.]+\.publish\(\w+\))$", program.text[begin:end], re.M):
            for loop in ("while True:", "while rclpy.ok():"):
                start = begin + found.start()
                yield (
                    Edit(start, begin + found.end(), f"{found[1]}{loop}\n{found[1]}    {found[2]}"),
                )


def renamed(*names: str) -> Places:
    """Keep the publisher under a name that a Node has itself."""

    def places(program: Program) -> Iterator[Change]:
        for call in program.calls("create_publisher"):
            for node in program.own("", ast.Store):
                if node.lineno == call.lineno and node.attr not in names:
                    for name in names:
                        others = program.own(node.attr, ast.Load)
                        spans = [program.span(other) for other in others]
                        rest = (Edit(*span, f"self.{name}", blamed=False) for span in spans)
                        yield (Edit(*program.span(node), f"self.{name}"), *rest)

    return places


def swallowing(program: Program) -> Iterator[Change]:
    """A callback that fails, within a bare except."""
    for each in program.callbacks("create_subscription"):
        first = next(s for s in each.body if not isinstance(s, ast.Global | ast.Nonlocal))
        begin, end = program.starts[first.lineno - 1], program.span(each)[1]
        lines = program.text[begin:end].split("\n")
        name = each.args.args[-1].arg
        body = "\n".join(f"    {line}" if line else "" for line in lines)
        wrong = re.sub(rf"\b{name}\.x\b", f"{name}.X", body, count=1)
        if wrong == body:
            continue
        indent = " " * first.col_offset
        rows = wrong.split("\n")
        at = next(n for n, row in enumerate(rows) if row.strip() != lines[n].strip())
        here = begin + sum(len(line) + 1 for line in lines[:at])
        after = here + len(lines[at])
        head = "".join(f"\n{row}" for row in [f"{indent}try:", *rows[:at]])
        tail = "".join(f"\n{row}" for row in rows[at + 1 :])
        yield (
            Edit(begin - 1, here - 1, head, blamed=False),
            Edit(here, after, rows[at]),
            *([Edit(after, end, tail, blamed=False)] if tail else []),
            Edit(end, end, f"\n{indent}except:\n{indent}    pass"),
        )


def spin_of_the_class(program: Program) -> Iterator[Change]:
    """`rclpy.spin(Controller)`."""
    for found in program.matches(r"rclpy\.spin\((\w+)(\(\))?\)"):
        made = re.search(rf"^ +{found[1]} = ([A-Z]\w+)\(", program.text, re.MULTILINE)
        name = found[1] if found[2] else made[1] if made else ""
        if name:
            yield (Edit(*found.span(), f"rclpy.spin({name})"),)


def timer_each_time(program: Program) -> Iterator[Change]:
    """A timer that is made in the callback of the subscription."""
    for each in program.callbacks("create_timer"):
        is_method = [arg.arg for arg in each.args.args[:1]] == ["self"]
        callback = f"self.{each.name}" if is_method else each.name
        yield from insert("create_subscription", f"{{self}}.create_timer(0.1, {callback})")(program)


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
    Operator("other_languages_signs", r"&&|\|\||`(?:and|or)`", swap(r" or (?=\w+\.)", " || ")),
    Operator("lower_case_true", r"\bTrue\b", swap(r"= True$", "= true")),
    # imports
    Operator("imports_rospy", r"ROS 1", swap(r"^import rclpy$", "import rospy")),
    Operator("not_installed", r"not installed",
             swap(r"^(?=import rclpy$)", "import pygame\n", "import matplotlib.pyplot as plt\n")),
    Operator("twist_of_turtlesim", r"geometry_msgs",
             swap(r"from geometry_msgs\.msg import Twist", "from turtlesim.msg import Twist")),
    Operator("pose_of_geometry", r"turtlesim/msg/Pose|from turtlesim\.msg import",
             swap(r"from turtlesim\.msg import Pose", "from geometry_msgs.msg import Pose")),
    Operator("service_from_msg", r"turtlesim\.srv",
             swap(r"from turtlesim\.srv import", "from turtlesim.msg import")),
    # names
    Operator("attribute_misspelt_where_set", _NAME, misspelt(ast.Store)),
    Operator("flag_misspelt_where_set", _NAME, misspelt(ast.Store, inside_init=False)),
    Operator("attribute_misspelt_where_read", _NAME, misspelt(ast.Load, inside_init=False)),
    Operator("callback_misspelt", _NAME, misspelt(ast.Load)),
    Operator("method_of_node_misspelt", _NAME, swap(r"create_(tim|cli|pub|sub)(\w)", r"create_\1")),
    Operator("logger_misspelt", _NAME, swap(r"get_logger\(", "get_loger(", "getLogger(")),
    Operator("publish_misspelt", _NAME, swap(r"\.publish\(", ".publich(", ".pub(")),
    Operator("call_async_misspelt", _NAME, swap(r"call_async\(", "callasync(", "call_asynch(")),
    Operator("rclpy_misspelt", _NAME, swap(r"rclpy\.(sp|in)i[nt](?=\()", r"rclpy.\1i")),
    Operator("attribute_never_set", r"no value when|in __init__",
             drop(rf"^ +self\.{_SPEED}(?:: \w+)? = 0\.\d+\n", "__init__"), missing=True),
    Operator("self_dot_missing_read", _SELF, without_self_dot(ast.Load)),
    Operator("self_dot_missing_call", _SELF, without_self_dot(ast.Load, methods=True)),
    Operator("local_for_attribute", _SELF, without_self_dot(ast.Store)),
    Operator("global_missing", r"\bglobal\b|nonlocal",
             drop(r"^ +(?:global|nonlocal) .*\n"), missing=True),
    Operator("read_only_name", r"of its own|choose another name|can only be read",
             renamed("publishers", "handle", "clients", "context")),
    Operator("field_of_twist", rf"{_FIELD}|linear\.x",
             swap(r"\.linear\.x = ", ".x = ", ".linear_x = ")),
    Operator("field_of_pose", _FIELD, swap(rf"\b({_POSE})\.([xy])(?= [<>])", r"\1.position.\2")),
    Operator("flag_compared", r"==", swap(rf"({_DONE}) = True$", r"\1 == True")),
    # calls
    Operator("callback_called", r"without (?:parentheses|brackets)|at once",
             called("create_timer", "create_subscription", "add_done_callback")),
    Operator("method_without_self", r"takes self|self before|def \w+\(self",
             arguments("", lambda old: old[1:])),
    Operator("callback_without_message", r"takes no message|given the message",
             arguments("create_subscription", lambda old: old[:-1])),
    Operator("timer_with_message", r"timer is (?:given|called with) nothing|nothing but self",
             arguments("create_timer", lambda old: [*old, "msg"])),
    Operator("super_init_missing", r"super\(\)\.__init__",
             drop(r"^ +super\(\)\.__init__\(.*\n"), missing=True),
    Operator("node_without_name", r"node a name",
             swap(r"super\(\)\.__init__\(.*\)", "super().__init__()")),
    Operator("node_name_blank", r"name (?:of|for) (?:the|a|your) node|node'?s? name|\bblank",
             swap(r"super\(\)\.__init__\(([\"'])(\w+)", r"super().__init__(\1my \2")),
    Operator("qos_missing", r"\bqos|, 10\b|`10`",
             lambda p: [*no_qos("create_publisher")(p), *no_qos("create_subscription")(p)]),
    Operator("create_in_wrong_order", r"order",
             swap(r"create_(publisher|client)\((\w+), ([\"'\w/]+)", r"create_\1(\3, \2")),
    Operator("publish_without_brackets", r"without (?:parentheses|brackets)",
             swap(r"\.publish\([\w]+(?:\(\))?\)$", ".publish")),
    Operator("publish_of_the_class", r"(?:parentheses|brackets) are missing|Twist\(\) makes",
             swap(r"\.publish\(Twist\(\)\)", ".publish(Twist)")),
    Operator("twist_is_the_class", r"(?:parentheses|brackets) are missing|Twist\(\) makes",
             swap(r"= Twist\(\)$", "= Twist")),
    Operator("publish_of_nothing", r"publish\(\w+\)|without a message|message is missing",
             swap(r"\.publish\(\w+\)$", ".publish()")),
    Operator("request_is_the_class", r"Request\(",
             swap(r"SetPen\.Request\(\)", "SetPen.Request", "SetPen()")),
    Operator("call_without_request", r"(?:no|without a) request|call_async\(request",
             swap(r"call_async\(\w+\)", "call_async()")),
    Operator("wrong_keyword", r"keyword|Invalid arguments|no field|has no argument",
             swap(r"\b(?:callback_group|timeout_sec)=", "group=", "timeout=")),
    Operator("wrong_field_keyword", r"keyword|Invalid arguments|no field|interface show",
             swap(r"\br=(?=\w)", "red=")),
    Operator("main_not_called", r"main\(\) ever called|main\(\) is never called|__main__",
             drop(r"^if __name__ == [^\n]*\n[^\n]*\n"), missing=True),
    Operator("main_without_brackets", r"without (?:parentheses|brackets)|main\(\) ever called",
             swap(r"^    (main|run)\(\)$", r"    \1")),
    Operator("init_missing", r"rclpy\.init", drop(r"^ +rclpy\.init\(.*\n"), missing=True),
    Operator("spin_missing", r"rclpy\.spin\(", drop(r"^ +rclpy\.spin\(\w+\)\n"), missing=True),
    Operator("spin_once", r"spin_once\(node\) handles one",
             swap(r"^( +)rclpy\.spin\(", r"\1rclpy.spin_once(")),
    Operator("spin_of_the_class", r"given a class|parentheses are missing|brackets are missing",
             spin_of_the_class),
    Operator("spin_in_init", r"leaves __init__|only when the program ends",
             insert("__init__", "rclpy.spin({self})")),
    Operator("destroyed_too_early", r"destroy", before_spin(r"\2.destroy_node()")),
    Operator("shutdown_too_early", r"shut ?down", before_spin("rclpy.shutdown()")),
    # what meets nobody
    Operator("velocity_topic_misspelt", r"listens to|nobody listens",
             swap(r"turtle1/cmd_vel", "turtle1/cmd_val", "turtle1/cmdvel", "turtle1/cmd_Vel")),
    Operator("pose_topic_misspelt", r"nobody publishes",
             swap(r"turtle1/pose", "turtle1/position", "turtle1/poses", "turtle1/Pose")),
    Operator("service_misspelt", r"nobody offers",
             swap(r"turtle1/set_pen", "turtle1/setpen", "turtle1/pen", "turtle1/set_pen_color")),
    Operator("turtle1_missing", r"nobody (?:listens|publishes|offers)",
             swap(r"/?turtle1/(?=cmd_vel|pose|set_pen)", "/")),
    Operator("turtle2", r"nobody (?:listens|publishes|offers)",
             swap(r"turtle1/(?=cmd_vel|pose|set_pen)", "turtle2/")),
    Operator("publisher_of_another_type", r"listens to geometry_msgs|publisher (?:is|was made) for",
             argument("create_publisher", 0, "Pose")),
    Operator("subscription_of_another_type", r"is published there",
             argument("create_subscription", 0, "Twist")),
    Operator("client_of_another_service",
             r"it is (?:of type )?turtlesim/srv/SetPen|client (?:is|was made) for",
             argument("create_client", 0, "Spawn", "from turtlesim.srv import Spawn")),
    Operator("transient_local", r"TRANSIENT_LOCAL|QoS",
             swap(r"(create_subscription\((?:\s*[^\s,]+,){3}\s*)10",
                  r"\1QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)",
                  needs="from rclpy.qos import DurabilityPolicy, QoSProfile")),
    Operator("best_effort", r"BEST_EFFORT|QoS",
             argument("create_publisher", 2, "qos_profile_sensor_data",
                      "from rclpy.qos import qos_profile_sensor_data")),
    # what waits or never waits
    Operator("await_blocks", r"\bawait", awaiting),
    Operator("await_outside", r"\bawait",
             swap(r"^( +)([\w.]+\.(?:publish|call_async)\()", r"\1await \2")),
    Operator("spin_until_in_callback", r"spin_until_future_complete|spin in a callback",
             swap(r"^( +)([\w.]+\.call_async\(.*\))$",
                  r"\1future = \2\n\1rclpy.spin_until_future_complete(self, future)",
                  within=r"(?!main|step|watch|set_pen)\w+")),
    Operator("call_in_callback", r"call_async\(request\)",
             swap(r"(?<!await )(\b[\w.]+)\.call_async\((?=.*\)$)", r"\1.call(",
                  within=r"(?!main)\w+")),
    Operator("sleep_in_pose_callback", r"sleep",
             insert("create_subscription", "time.sleep(0.5)", needs="import time")),
    Operator("sleep_in_timer_callback", r"sleep",
             insert("create_timer", "time.sleep(1.0)", needs="import time")),
    Operator("loop_in_callback", r"\bloop", in_loop),
    Operator("loop_for_spin", r"\bloop",
             swap(r"^( +)rclpy\.spin\(\w+\)$", r"\1while rclpy.ok():\n\1    pass",
                  r"\1while True:\n\1    pass")),
    Operator("timer_of_zero", r"period", swap(r"(create_timer\()0\.\d+", r"\g<1>0.0", r"\g<1>0")),
    Operator("timer_in_milliseconds", r"milliseconds",
             swap(r"(create_timer\()0\.(\d)", r"\g<1>\g<2>00")),
    Operator("timer_too_fast", r"period|timer.{0,30}\b0\.001",
             swap(r"(create_timer\()0\.\d+", r"\g<1>0.001")),
    Operator("timer_in_callback", r"new timer", timer_each_time),
    Operator("timer_missing", r"(?:no|without a) timer|timer is (?:missing|never made)",
             drop(r"^ +(?:self\.\w+ = )?(?:self|node)\.create_timer\(.*\)\n"), missing=True),
    Operator("subscription_missing", r"(?:no|without a) subscription|never subscribe",
             drop(r"^ +(?:self\.\w+ = )?(?:self|node)\.create_subscription\(.*\)\n"), missing=True),
    Operator("asks_at_the_start", r"input\(|keyboard|types? anything",
             before_spin('input("Press Enter to start ")')),
    Operator("file_of_ones_own", r"computer|hand(?:ed)? in",
             insert("__init__", 'self.colors = open("/home/anna/ros2_ws/colors.txt").read()',
                    "config = open(r'C:\\Users\\Anna\\config.txt')")),
    # values
    Operator("int_for_float", r"must be a float", swap(rf"{_TURN}([1-9])\.\d+(?=\)?$)", r"\1\2")),
    Operator("int_zero_for_float", r"must be a float",
             swap(r"(?<=\()0\.0(?=, 0\.0\))|(?<=angular\.z = )0\.0", "0")),
    Operator("float_for_int", r"must be an int",
             swap(r"(\.[rgb] = |\.width = |\b[rgb]=)(\d+)\b", r"\1\2.0")),
    Operator("colour_256", r"0 to 255", swap(r"\b255\b", "256")),
    Operator("text_for_number", r"must be an? (?:float|int)|quotes",
             swap(r"(\.(?:r|width) = )(\d+)$|(linear\.x = )([\w.]+)$", r'\1\3"\2\4"')),
    Operator("number_for_linear", r"Vector3|linear\.x", swap(r"\.linear\.x = ", ".linear = ")),
    Operator("numpy_value", r"numpy|np\.",
             swap(r"(linear\.x = )([\w. *]+)$", r"\1np.float32(\2)", needs="import numpy as np")),
    Operator("division_by_zero", r"divi", insert("create_timer", "turns = 1.0 / {speed}")),
    Operator("recursion", r"calling itself|calls itself|recursion",
             insert("create_timer", "{name}()", last=True)),
    Operator("none_compared", r"(?-i:\bNone\b)", swap(r"^( +self\.(?:x|y) = )5\.5$", r"\1None")),
    Operator("guard_of_none_missing", r"(?-i:\bNone\b)",
             drop(r"^ +if \w+\.(?:pose|x) is None:\n(?: +rate\.sleep\(\)\n)? +continue\n"),
             missing=True),
    Operator("return_missing", r"\breturn", swap(r"\breturn (?=\d|True)", "")),
    Operator("swallowed", r"hides|catches", swallowing),
    # the stop
    Operator("stop_flipped", rf"{_NEVER_TRUE}|[<>] ", flipped),
    Operator("one_wall_forgotten", _NOT_WATCHED, fewer_walls("")),
    Operator("only_x_watched", rf"{_NOT_WATCHED}|only x", fewer_walls("y")),
    Operator("and_for_or", _NEVER_TRUE, and_for_or),
    Operator("stop_not_sent", r"Twist of zeros|zero Twist|told to stop",
             drop(rf"^ +(?:{_ZERO_STOP})\n"), missing=True),
    Operator("stop_built_and_not_sent", r"Twist of zeros|zero Twist|told to stop",
             drop(r"(?<=angular\.z = 0\.0\n) +[\w.]+publish\(\w+\)\n"), missing=True),
    Operator("break_without_stop", r"Twist of zeros|zero Twist|told to stop",
             swap(rf"^( +)(?:{_ZERO_STOP})$", r"\1return"), missing=True),
    Operator("stop_overruled", _FLOW,
             drop(rf"^ +if (?:self\.)?{_DONE}:\n +return\n", of="create_timer"), missing=True),
    Operator("stop_not_asked_for", _FLOW,
             swap(rf"if (?:not (?:self\.)?{_DONE}|self\.(?:running|active|at_edge is False)):",
                  "if True:", within=r"\w*(?:tick|timer|drive|go|velocity)\w*")),
    Operator("flag_not_set", _FLOW,
             drop(rf"^ +(?:self\.)?(?:{_DONE} = True|(?:running|active) = False)\n",
                  within=r"(?!__init__)\w+"), missing=True),
    Operator("stop_keeps_turning", r"turn(?:ed|ing)? on|stops turning|angular",
             swap(r"\(0\.0, 0\.0\)", "(0.0, 1.0)")),
    # shape and pen
    Operator("degrees", r"radians",
             swap(rf"{_TURN}[1-9]\.\d+(?=\)?$)", r"\g<1>90.0", r"\g<1>45.0")),
    Operator("turns_about_x", r"angular\.[xz]",
             swap(r"angular\.z = (?!0\.0)", "angular.x = ", "angular.y = ")),
    Operator("never_grows", r"grow", swap(rf"((?:self\.)?{_SPEED} \+= )[\w.]+$", r"\g<1>0.0")),
    Operator("growth_forgotten", r"grow",
             drop(rf"^ +(?:self\.)?{_SPEED} (?:\+= |= self\.speed \+ ).*\n"), missing=True),
    Operator("shrinks", r"smaller|negative|backward",
             swap(rf"((?:self\.)?{_SPEED} )\+= ", r"\1-= ")),
    Operator("pen_at_every_pose", r"set_pen.{0,80}(?:times|calls)|calls of set_pen|each pose",
             drop(rf"^ +(?:self\.)?{_QUADRANT} = [a-z][\w.()]*\n",
                  within=r"(?!__init__|main)\w+"), missing=True),
    Operator("pen_off", r"\boff\b", swap(r"(\.off = |\boff=)0", r"\g<1>1")),
    Operator("width_of_zero", r"width", swap(r"(\.width = |\bwidth=)\d", r"\g<1>0")),
    Operator("same_colours", r"are both|no eye|colou?r of its own", same_colours),
    Operator("middle_elsewhere", r"middle",
             swap(r"([<>]=? )5\.5\d*\b|^((?:MIDDLE|CENTER_X|CENTER_Y|CX = CY) = )5\.5\d*",
                  r"\1\g<2>0.0", r"\1\g<2>5.0", r"\1\g<2>6.5")),
    Operator("y_for_x", r"conditions?\b|compare x and y",
             swap(rf"(\b{_POSE}\.)y(?= [<>]=? (?:5\.5|MIDDLE|HALF|half))", r"\1x")),
)
# fmt: on
