"""Finds in a source what beginners in ROS forget or put in the wrong place.

Like all of `lint`: nothing found here is an error by itself. It gives the line to change where the
run has shown that something is wrong.
"""

from __future__ import annotations

import ast
import re
from collections import Counter
from collections.abc import Iterator, Mapping
from itertools import chain
from typing import TypeGuard

from grader.submission import Function, last
from grader_diagnosis.lint import conditions, python_mistakes, scopes
from grader_diagnosis.lint.scopes import Found, Source, is_read, unread
from grader_diagnosis.misspelling import misspelt

#: Of larger sources, in the nodes of their syntax trees times their files, nothing is looked for.
MOST_NODES = 60_000
#: So many fields of messages are followed to their numbers, and so many names to what is meant.
MOST_FOLLOWED = 30
SPINS = ("spin", "spin_once", "spin_until_future_complete")
CREATES = ("create_publisher", "create_client", "create_timer", "create_subscription")
#: Statements that name a node or what it has.
_NAMES = ("__init__", "create_service", "ActionServer", "declare_parameter")
#: What gets a callback -> what that returns.
_ANSWERS = {"create_service": "response", "ActionServer": "result"}
#: What nothing of a program's own calls: an entry point, and what a LifecycleNode has.
CALLED = frozenset(("main",)) | {
    f"on_{step}" for step in ("configure", "activate", "deactivate", "cleanup", "shutdown", "error")
}
#: Of a topic or a service.
_NAME = re.compile(r"[\w/~]{2,80}")
#: Fields of messages that beginners set wrongly.
FIELDS = ("linear", "angular", "r", "g", "b", "width", "off")


def find(sources: Mapping[str, Source]) -> Iterator[tuple[str, Found]]:
    """Yield findings in the files of a submission, each with its file; the surest first."""
    if len(sources) * sum(len(source.parents) for source in sources.values()) > MOST_NODES:
        return
    whole = [*sources.values()]
    for rule in (
        _callbacks,
        _called_callbacks,
        _around_spin,
        _brackets,
        _entry,
        _bare_nodes,
        _unspun,
        _cancels,
        _heads,
        _exits,
        _keeps,
        _quiet,
        _unstarted,
        _grows,
    ):
        for file, source in sources.items():
            yield from ((file, found) for found in rule(source))
    for file, source in sources.items():
        of_the_class = (_forgotten(source, whole), _attributes(source, whole))
        yield from ((file, found) for found in chain(*of_the_class, scopes.misplaced(source)))
    yield from python_mistakes.own_calls(sources)
    values = conditions.Values(whole)
    by_values = (python_mistakes.find, conditions.find, conditions.held, _stays, _waits, _numbers)
    for file, source in sources.items():
        yield from ((file, found) for rule in by_values for found in rule(source, values))
    for rule in (_colours, _imports, _constants, _fields):
        for file, source in sources.items():
            yield from ((file, found) for found in rule(source))


def _callbacks(source: Source) -> Iterator[Found]:
    """Callbacks that take the wrong arguments, return nothing, or wait for an answer."""
    each = [*source.callbacks()]
    for by, function in each:
        arguments = [*function.args.posonlyargs, *function.args.args]
        is_method = isinstance(source.parents.get(function), ast.ClassDef)
        takes = len(arguments) - (is_method and bool(arguments) and arguments[0].arg == "self")
        if by == "create_subscription" and takes == 0 and not function.args.vararg:
            yield "no_message", function.name, "", function.lineno
        if by == "create_timer" and takes > 0 and not function.args.defaults:
            yield "message_for_timer", function.name, "", function.lineno
            if any(of == "create_subscription" and f is function for of, f in each):
                for of, given in source.given:  # it is right for the other
                    if of == by and last(given) == function.name:
                        yield "message_for_timer", function.name, "heard", given.lineno
        if by in _ANSWERS and scopes.returns_nothing(function):
            yield "unanswered", function.name, _ANSWERS[by], function.lineno
        if isinstance(function, ast.AsyncFunctionDef):
            node = _first_await(function)
            if node is not None:
                yield "awaits", function.name, "", _inner_await(source, node).lineno


def _called_callbacks(source: Source) -> Iterator[Found]:
    """Functions of one's own that are called where they are to be passed."""
    for name, each in source.given:
        if isinstance(each, ast.Call) and last(each.func) in source.functions:
            yield "called_callback", last(each.func), name, each.lineno


def _first_await(function: Function) -> ast.Await | None:
    return next((node for node in ast.walk(function) if isinstance(node, ast.Await)), None)


def _inner_await(source: Source, node: ast.Await) -> ast.Await:
    """Return the await of an answer that an awaited function of one's own leads to."""
    for _ in range(5):
        called = node.value.func if isinstance(node.value, ast.Call) else node.value
        function = source.functions.get(last(called))
        if not isinstance(function, ast.AsyncFunctionDef):
            break
        inner = _first_await(function)
        if inner is None:
            break
        node = inner
    return node


def _around_spin(source: Source) -> Iterator[Found]:
    """What stands before a spin and ends it, and spins in the wrong place."""
    for call in source.calls("shutdown", "try_shutdown", "destroy_node"):
        statement = source.parents.get(call)
        block = source.parents.get(statement) if statement is not None else None
        body = getattr(block, "body", [])
        if isinstance(statement, ast.Expr) and statement in body:
            later = body[body.index(statement) + 1 :]
            inside = (node for each in later for node in ast.walk(each))
            if any(isinstance(n, ast.Call) and last(n.func) in SPINS for n in inside):
                yield "ends_before_spin", last(call.func), "", call.lineno
    for call in source.calls("spin_once"):
        if source.around(call, ast.While, ast.For) is None:
            yield "spins_once", "spin_once", "", call.lineno
    for call in source.calls("spin"):
        function = source.function_around(call)
        if function is not None and function.name == "__init__":
            yield "spins_in_init", "spin", "", call.lineno


def _brackets(source: Source) -> Iterator[Found]:
    """Message classes that are kept instead of a message, or hidden by one; a stray comma."""
    imported = source.messages
    for node in source.nodes:
        match node:
            case ast.Assign(targets=[ast.Name(id=name)]) if name in imported:
                yield "hides_class", name, "", node.lineno
            case ast.Assign(targets=[target], value=ast.Tuple(elts=[only])) if (
                last(target) and only.col_offset == node.value.col_offset
            ):
                yield "comma", last(target), "", node.lineno
            case ast.Assign(targets=[target], value=ast.Tuple(elts=[ast.Constant() as a, b])) if (
                last(target) and a.col_offset == node.value.col_offset and _is_decimal(a, b)
            ):
                yield "comma", last(target), ast.unparse(b), node.lineno
            case ast.Assign(value=ast.Name(id=name)) if name in imported:
                yield "class_kept", name, "", node.lineno
            case ast.Assign(value=ast.Attribute(value=ast.Name(id=name), attr="Request")) if (
                name in imported
            ):
                yield "class_kept", f"{name}.Request", "", node.lineno


def _is_decimal(whole: ast.Constant, part: ast.expr) -> bool:
    """Whether two numbers look like one that was written with a comma: 0,5."""
    is_whole = isinstance(whole.value, int) and 0 <= whole.value < 10
    return is_whole and isinstance(part, ast.Constant) and isinstance(part.value, int)


def _entry(source: Source) -> Iterator[Found]:
    """A main() that cannot be called with nothing, as an entry point calls it."""
    for node in source.tree.body:
        if isinstance(node, Function) and node.name == "main":
            takes = [each.arg for each in node.args.args]
            if takes := takes[: len(takes) - len(node.args.defaults)]:
                yield "entry", node.name, ", ".join(takes), node.lineno


def _bare_nodes(source: Source) -> Iterator[Found]:
    """Classes of nodes whose `__init__` does not call that of Node."""
    for of in source.nodes:
        if _is_node(of):
            for each in of.body:
                if isinstance(each, Function) and each.name == "__init__":
                    calls = (n for n in ast.walk(each) if isinstance(n, ast.Call))
                    if not any(last(call.func) == "__init__" for call in calls):
                        yield "no_super", of.name, "", each.lineno


def _is_node(of: ast.AST) -> TypeGuard[ast.ClassDef]:
    return isinstance(of, ast.ClassDef) and any("Node" in last(base) for base in of.bases)


def _unspun(source: Source) -> Iterator[Found]:
    """Nodes that are made, and that nothing is given."""
    nodes = {of.name for of in source.nodes if _is_node(of)}
    names = Counter(node.id for node in source.nodes if isinstance(node, ast.Name))
    ends = source.calls("destroy_node", "shutdown")
    names.subtract(ast.unparse(getattr(call.func, "value", call.func)) for call in ends)
    for node in source.nodes:
        match node:
            case ast.Assign(targets=[ast.Name(id=name)], value=ast.Call(func=ast.Name(id=of))):
                if of in nodes and names[name] == 1:
                    yield "unspun", name, of, node.lineno


def _grows(source: Source) -> Iterator[Found]:
    """Attributes that a subscription's callback lets grow: with each message."""
    for by, function in source.callbacks():
        for node in ast.walk(function) if by == "create_subscription" else ():
            match node:
                case ast.AugAssign(target=ast.Attribute() as target, op=ast.Add()):
                    yield "grows", ast.unparse(target), function.name, node.lineno


def _unstarted(source: Source) -> Iterator[Found]:
    begun = {ast.unparse(call.func) for call in source.calls("start")}
    for node in source.nodes:
        match node:
            case ast.Assign(targets=[target], value=ast.Call(func=of)) if last(of) == "Thread":
                if last(target) and f"{ast.unparse(target)}.start" not in begun:
                    yield "unstarted", ast.unparse(target), "", node.lineno


def _exits(source: Source) -> Iterator[Found]:
    """Lines that end the program where a condition is true."""
    for call in source.calls("SystemExit", "exit"):
        outer = source.around(call, ast.If)
        if isinstance(outer, ast.If) and call.lineno <= (outer.body[-1].end_lineno or 0):
            yield "exits", ast.unparse(outer.test), "", call.lineno


def _quiet(source: Source) -> Iterator[Found]:
    """Log lines of a level that is not shown."""
    for call in source.calls("debug"):
        yield "quiet", ast.unparse(call.func), "", call.lineno


def _keeps(source: Source) -> Iterator[Found]:
    """Where is kept what the next value is compared with."""
    compared = {
        ast.unparse(each)
        for node in source.nodes
        if isinstance(node, ast.Compare) and isinstance(node.ops[0], ast.NotEq)
        for each in (node.left, *node.comparators)
    }
    for node in source.nodes:
        match node:
            case ast.Assign(targets=[ast.Attribute() as kept], value=value):
                if not isinstance(value, ast.Constant) and ast.unparse(kept) in compared:
                    yield "keeps", ast.unparse(kept), "", node.lineno


def _heads(source: Source) -> Iterator[Found]:
    """Where the pose's angle is read."""
    for node in source.nodes:
        if isinstance(node, ast.Attribute) and node.attr == "theta" and is_read(node):
            yield "heads", ast.unparse(node), "", node.lineno


def _cancels(source: Source) -> Iterator[Found]:
    for call in source.calls("cancel"):
        yield "cancels", ast.unparse(call), "", call.lineno


def _number(node: ast.expr) -> float | None:
    """Return the number that is written there."""
    match node:
        case ast.Constant(value=int() | float() as value) if not isinstance(value, bool):
            return value
        case ast.UnaryOp(op=ast.USub(), operand=ast.Constant(value=int() | float() as value)):
            return -value
    return None


def _stays(source: Source, values: conditions.Values) -> Iterator[Found]:
    """Tests of what keeps the value that it began with: nothing ever sets it."""
    seen: set[str] = set()
    for node in source.nodes:
        match node:
            case ast.Compare(ops=[ast.Eq() | ast.NotEq() | ast.Is() | ast.IsNot()]):
                tested = [node.left, *node.comparators]
            case ast.If(test=test) | ast.While(test=test):
                tested = [test, *getattr(test, "values", [])]
            case _:
                continue
        for each in tested:
            while isinstance(each, ast.UnaryOp):
                each = each.operand
            name = ast.unparse(each) if last(each) else ""
            if not name or name.isupper() or name in seen:
                continue
            plain = [v for v in values.assigned(name) if isinstance(v, ast.Constant | ast.UnaryOp)]
            begins = {ast.unparse(value) for value in plain}
            if len(begins) == 1 and len(plain) == len(values.assigned(name)):
                seen.add(name)
                yield "stays", name, begins.pop(), each.lineno


def _plain(given: ast.expr | None, values: conditions.Values) -> Iterator[ast.expr]:
    """Yield the number that an argument is, or that its name begins with."""
    if given is not None and _number(given) is not None:
        yield given
    elif given is not None and last(given):
        kept = values.assigned(ast.unparse(given))
        yield from (each for each in kept[:1] if each is not None and _number(each) is not None)


def _waits(source: Source, _: conditions.Values) -> Iterator[Found]:
    """Calls in callbacks, and in what these call, that wait for another callback."""
    for function in source.called_back():
        for node in ast.walk(function):
            if isinstance(node, ast.Call):
                name = last(node.func)
                if name in SPINS or (name == "call" and isinstance(node.func, ast.Attribute)):
                    yield "waits", function.name, ast.unparse(node.func), node.lineno


def _colours(source: Source) -> Iterator[Found]:
    """Colours that are written twice: the second place of each."""
    first: dict[tuple[float, ...], int] = {}
    for node in source.nodes:
        match node:
            case ast.Tuple(elts=parts) | ast.List(elts=parts):
                pass
            case ast.Call(args=parts, keywords=words):
                given = {word.arg: word.value for word in words}
                parts = parts or [given[each] for each in "rgb" if each in given]
            case _:
                continue
        numbers = [number for part in parts if (number := _number(part)) is not None]
        color = tuple(numbers[-3:])  # what comes before may be a quadrant's number
        is_one = len(numbers) in (3, 4) and all(0 <= each <= 255 for each in color)
        if is_one and first.setdefault(color, id(node)) != id(node):
            yield "same_colour", str(tuple(map(int, color))), "", node.lineno


def _numbers(source: Source, values: conditions.Values) -> Iterator[Found]:
    """Literals that a message's field gets, also by way of an argument or a name."""
    followed: set[tuple[str, str]] = set()
    for node in source.nodes:
        match node:
            case ast.Assign(targets=[ast.Attribute(attr=name, value=outer)], value=value):
                part = last(outer)
                known = name if name in FIELDS else f"{part}.{name}" if part in FIELDS else ""
            case ast.keyword(arg=str() as name, value=value) if name in FIELDS:
                known = name
            case _:
                continue
        if known and _number(value) is not None:
            yield "argument", known, ast.unparse(value), value.lineno
        given = last(value)
        if not known or not given or len(followed) >= MOST_FOLLOWED or (known, given) in followed:
            continue
        followed.add((known, given))
        function = source.function_around(node)
        names = [a.arg for a in function.args.args if a.arg != "self"] if function else []
        if function is not None and given in names:
            at = names.index(given)
            for call in source.calls(function.name):
                literal = next((w.value for w in call.keywords if w.arg == given), None)
                literal = literal or (call.args[at] if at < len(call.args) else None)
                for begin in _plain(literal, values):
                    yield "argument", known, ast.unparse(begin), begin.lineno
                    yield "argument", known, ast.unparse(begin), call.lineno
        for each in source.nodes:
            match each:
                case (
                    ast.Assign(targets=[target], value=ast.expr() as literal)
                    | ast.AnnAssign(target=target, value=ast.expr() as literal)
                ) if last(target) == given and _number(literal) is not None:
                    yield "argument", known, ast.unparse(literal), each.lineno
    for node in source.nodes:
        if isinstance(node, ast.Tuple | ast.Call):
            parts = getattr(node, "elts", None) or getattr(node, "args", [])
            numbers = [number for each in parts if (number := _number(each)) is not None]
            for each in parts:
                number = _number(each)
                is_part = len(numbers) > 2 and isinstance(number, float)
                if number is not None and (is_part or not 0 <= number <= 255):
                    yield "argument", "colour", ast.unparse(each), each.lineno


def _imports(source: Source) -> Iterator[Found]:
    for node, alias in source.imported:
        yield "imports", alias.name, node.module or "", node.lineno


def _forgotten(source: Source, whole: list[Source]) -> Iterator[Found]:
    """What a program of ROS needs, and nowhere has: init, spin, a timer, a subscription."""
    makes = list(source.calls("create_node"))
    nodes = {node.name for each in whole for node in each.nodes if _is_node(node)}
    makes += source.calls(*nodes)
    if makes and not any(_has(each, "init") for each in whole):
        yield "no_init", "", "", (source.function_around(makes[0]) or makes[0]).lineno
    if makes and not any(_has(each, *SPINS, "add_node") for each in whole):
        statement = source.around(makes[0], ast.stmt)
        yield "no_spin", "", "", getattr(statement, "end_lineno", makes[0].lineno)
    used = {
        last(node)
        for each in whole
        for node in each.nodes
        if isinstance(node, ast.Attribute | ast.Name) and isinstance(node.ctx, ast.Load)
    }
    creates = [*source.calls(*CREATES)]
    for name, function in source.functions.items():
        if name in used or name.startswith("__") or function.decorator_list or name in CALLED:
            continue
        takes = [arg.arg for arg in function.args.args if arg.arg != "self"]
        near = [c for c in creates if source.around(c, *_FUNCTIONS) is not function]
        if near and len(takes) < 2:
            lacks = "create_subscription" if takes else "create_timer"
            yield "unused", name, lacks, max(call.end_lineno or call.lineno for call in near)


_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef, ast.Module)


def _has(source: Source, *names: str) -> bool:
    return any(True for _ in source.calls(*names))


def _is_stored(node: ast.AST) -> TypeGuard[ast.Attribute]:
    return isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store)


def _attributes(source: Source, whole: list[Source]) -> Iterator[Found]:
    """Attributes of self that are read and never set, with the start of the class."""
    classes = {n.name for each in whole for n in each.nodes if isinstance(n, ast.ClassDef)}
    stored: set[str] = set()
    read: set[str] = set()
    for each in whole:
        for node in each.nodes:
            if isinstance(node, ast.Attribute):
                (read if isinstance(node.ctx, ast.Load) else stored).add(node.attr)
    for of in source.nodes:
        if not isinstance(of, ast.ClassDef):
            continue
        methods = [n for n in of.body if isinstance(n, Function)]
        inits = [n for n in methods if n.name == "__init__"]
        own = {n.attr for n in ast.walk(of) if _is_stored(n)}
        begun = {n.attr for init in inits for n in ast.walk(init) if _is_stored(n)}
        counts = Counter(n.attr for n in ast.walk(of) if isinstance(n, ast.Attribute))
        seen: set[str] = set()
        is_derived = any(last(base) in classes for base in of.bases)
        known = {n.name for n in methods} | (stored if is_derived else begun)
        known |= {last(t) for n in of.body if isinstance(n, ast.Assign) for t in n.targets}
        variables = {name: line for n in methods for name, line in unread(n).items()}
        for node in ast.walk(of):
            match node:
                case ast.Attribute(value=ast.Name(id="self"), attr=name) if isinstance(
                    node.ctx, ast.Load
                ) or isinstance(source.parents[node], ast.AugAssign):
                    call = source.parents[node]
                    is_called = isinstance(call, ast.Call) and call.func is node
                    if name not in known and name in variables:
                        yield "local", name, f"self.{name}", variables[name]
                    if name in known or name in seen or is_called or not inits:
                        continue
                    seen.add(name)
                    is_few = len(seen) <= MOST_FOLLOWED
                    others = [] if name in own else sorted(own)[:200]
                    if is_few and not any(misspelt(name, other) for other in others):
                        # what stands once alone is a slip there, not a forgotten beginning
                        line = node.lineno if counts[name] == 1 else inits[0].lineno
                        yield "never_set", name, "", line
                case ast.Attribute(value=ast.Name(id="self"), attr=name, ctx=ast.Store()):
                    if name not in read:
                        yield "never_read", name, "", node.lineno


def _constants(source: Source) -> Iterator[Found]:
    """Names of topics and services that stand apart from where they are used."""
    for node in source.nodes:
        value = getattr(node, "value", None)
        is_naming = isinstance(node, ast.Expr) and last(getattr(value, "func", node)) in _NAMES
        if value is not None and (isinstance(node, ast.Assign | ast.AnnAssign) or is_naming):
            texts = (n for n in ast.walk(value) if isinstance(n, ast.Constant))
            for each in texts:
                if isinstance(each.value, str) and _NAME.fullmatch(each.value):
                    yield "constant", each.value, "", each.lineno


def _fields(source: Source) -> Iterator[Found]:
    """Where fields of messages are set: the first place of each, one of zero last."""
    places: dict[str, tuple[bool, int]] = {}
    for node in source.nodes:
        match node:
            case ast.Attribute(value=ast.Attribute(attr=part), attr=name, ctx=ast.Store()):
                known = f"{part}.{name}"
            case ast.Attribute(attr=field, ctx=ast.Store()) | ast.keyword(arg=str() as field):
                known = field
            case _:
                continue
        given = getattr(source.parents[node], "value", None)
        place = isinstance(given, ast.Constant) and not given.value, node.lineno
        if known.partition(".")[0] in FIELDS and place[0] < places.get(known, (2, 0))[0]:
            places[known] = place
    yield from (("sets", name, "", line) for name, (_, line) in places.items())
