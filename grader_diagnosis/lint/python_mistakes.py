"""Finds in a source what beginners in Python write and do not mean.

Like all of `lint`: nothing found here is an error by itself.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from itertools import pairwise

from grader.submission import Function, last
from grader_diagnosis.lint import scopes
from grader_diagnosis.lint.conditions import Values
from grader_diagnosis.lint.scopes import LEAVES, Found, Source, is_read
from grader_diagnosis.misspelling import misspelt

#: Of a class so many methods are compared with those of another.
MOST_METHODS = 100
#: Numbers of degrees.
_DEGREES = (45, 90, 180, 270, 360)


def find(source: Source, values: Values) -> Iterator[Found]:
    for rule in (_recursion, _idle, _late, _overrules, _defaults, _names_of_methods, _blocks):
        yield from rule(source)
    for rule_of_values in (_degrees, _texts, _factors):
        yield from rule_of_values(source, values)


def _recursion(source: Source) -> Iterator[Found]:
    callers = {*source.called_back()}
    called = {function.name for function in callers}
    stops = [
        ast.unparse(call.func).removesuffix("cancel")
        for call in source.calls("cancel")
        if source.parents.get(source.parents[call]) in callers
    ]
    again = f"{stops[0]}reset()" if stops else "ros"
    for name, function in source.functions.items():
        for node in ast.walk(function):
            if isinstance(node, ast.Call) and last(node.func) == name:
                owner = node.func.value if isinstance(node.func, ast.Attribute) else None
                if owner is None or (isinstance(owner, ast.Name) and owner.id == "self"):
                    yield "calls_itself", name, again if name in called else "", node.lineno


def _idle(source: Source) -> Iterator[Found]:
    """Statements and conditions that have no effect."""
    for node in source.nodes:
        match node:
            case ast.Expr(value=ast.Compare(ops=[ast.Eq()]) as test):
                yield "compared", ast.unparse(test), "", node.lineno
            case ast.Expr(value=ast.Compare() as value):
                yield "no_effect", ast.unparse(value), "", node.lineno
            case ast.Expr(value=ast.IfExp() | ast.BinOp() | ast.BoolOp() | ast.UnaryOp() as value):
                yield "no_effect", ast.unparse(value), "", node.lineno
            case ast.Expr(value=ast.Constant(value=int() | float() as value)):
                yield "no_effect", str(value), "", node.lineno
            case ast.Expr(value=ast.Subscript() as value):
                yield "uncalled", ast.unparse(value), "", node.lineno
            case ast.Assign(targets=[target], value=ast.UnaryOp(op=ast.UAdd())):
                yield "plus", ast.unparse(target), "", node.lineno
            case ast.BinOp(left=ast.List(elts=[ast.Call()]), op=ast.Mult()):
                yield "shared", ast.unparse(node), "", node.lineno
            case ast.If(test=ast.Constant(value=True)):
                yield "always", "if True", "", node.lineno
            case ast.AugAssign(op=ast.Add(), value=ast.Constant(value=0)):
                yield "adds_nothing", ast.unparse(node), "", node.lineno


def _late(source: Source) -> Iterator[Found]:
    """Lambdas in a loop that use its variable: it has another value when they are called."""
    for loop in source.nodes:
        targets = ast.walk(loop.target) if isinstance(loop, ast.For) else ()
        names = {each.id for each in targets if isinstance(each, ast.Name)}
        for inner in ast.walk(loop) if names else ():
            if isinstance(inner, ast.Lambda):
                own = {each.arg for each in ast.walk(inner.args) if isinstance(each, ast.arg)}
                for each in ast.walk(inner.body):
                    if isinstance(each, ast.Name) and each.id in names - own:
                        yield "late", each.id, "", inner.lineno


def own_calls(sources: Mapping[str, Source]) -> Iterator[tuple[str, Found]]:
    """Calls of functions of one's own: for a result that they lack, in another order."""
    homes = {name: file for file, source in sources.items() for name in source.functions}
    functions = {name: sources[file].functions[name] for name, file in homes.items()}
    ends = {
        name: scopes.last_print(function)
        for name, function in functions.items()
        if scopes.returns_nothing(function)
    }
    for file, source in sources.items():
        for call in source.all_calls:
            if found := scopes.in_other_order(call, functions):
                yield file, found
            name, user, owner = last(call.func), source.parents[call], call.func
            if isinstance(owner, ast.Attribute):
                owner = owner.value
            unused = (ast.Expr, ast.Lambda, ast.Return, ast.Await)
            if name in ends and isinstance(owner, ast.Name) and not isinstance(user, unused):
                kept = last(user.targets[0]) if isinstance(user, ast.Assign) else ""
                yield homes[name], ("no_return", kept or name, name, ends[name])


def _overrules(source: Source) -> Iterator[Found]:
    """An `if` whose `else` sets again what the `if` before it has set."""
    for node in source.nodes:
        for block in (getattr(node, "body", None), getattr(node, "orelse", None)):
            for first, second in pairwise(block if isinstance(block, list) else []):
                match first, second:
                    case ast.If(orelse=[]), ast.If(orelse=[_, *_]):
                        leaves = isinstance(first.body[-1], LEAVES)
                        both = _set(first.body) & _set(_else(second))
                        if both and not leaves:
                            yield "overrules", min(both), "", second.lineno


def _else(node: ast.If) -> list[ast.stmt]:
    """Return the block of an `if` that comes when no condition of its is true."""
    while len(node.orelse) == 1 and isinstance(node.orelse[0], ast.If):
        node = node.orelse[0]
    return node.orelse


def _set(block: list[ast.stmt]) -> set[str]:
    """Return what a block assigns to in any case."""
    targets = (target for each in block if isinstance(each, ast.Assign) for target in each.targets)
    return {ast.unparse(target) for target in targets}


def _defaults(source: Source) -> Iterator[Found]:
    """Arguments whose default is the time when Python read the function."""
    for function in source.functions.values():
        arguments = function.args.args[len(function.args.args) - len(function.args.defaults) :]
        for argument, value in zip(arguments, function.args.defaults, strict=True):
            if isinstance(value, ast.Call) and last(value.func) in ("time", "monotonic", "now"):
                yield "default", f"{argument.arg}={ast.unparse(value)}", "", value.lineno


def _degrees(source: Source, values: Values) -> Iterator[Found]:
    """Angles in radians that are divided by or compared with degrees."""
    for node in source.nodes:
        match node:
            case ast.BinOp(left=left, op=ast.Div() | ast.FloorDiv() | ast.Mod(), right=right):
                angle, others = left, [right]
            case ast.Compare(left=left, comparators=others):
                angle = left
            case _:
                continue
        if any(isinstance(each, ast.Constant) and each.value in _DEGREES for each in others):
            kept = values.assigned(last(angle)) if last(angle) else []
            made = [angle, *(each for each in kept if each is not None)]
            is_turn = any(isinstance(e, ast.Call) and last(e.func) == "atan2" for e in made)
            if is_turn or last(angle) == "theta":
                yield "degrees", ast.unparse(node), "", node.lineno


def _texts(source: Source, _: Values) -> Iterator[Found]:
    """Comparisons with a text that stands nowhere else, but in other letters."""
    compared: dict[str, int] = {}
    others: set[str] = set()
    for node in source.nodes:
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            if isinstance(source.parents[node], ast.Compare):
                compared.setdefault(node.value, node.lineno)
            else:
                others.add(node.value)
    for text, line in compared.items():
        near = sorted(other for other in others if other.lower() == text.lower())
        if near and text not in others:
            yield "other_text", repr(text), repr(near[0]), line


def _factors(source: Source, values: Values) -> Iterator[Found]:
    """Products of what begins with 0, and stays so."""
    for node in source.nodes:
        match node:
            case ast.AugAssign(target=target, op=ast.Mult()):
                begins = values.assigned(ast.unparse(target))
                first = [each.value for each in begins if isinstance(each, ast.Constant)]
                if first and not any(first):
                    yield "adds_nothing", ast.unparse(node), "", node.lineno


def _names_of_methods(source: Source) -> Iterator[Found]:
    """Methods that are nearly called `__init__`, or as one that they are to replace."""
    classes = {of.name: of for of in source.nodes if isinstance(of, ast.ClassDef)}
    for of in classes.values():
        own = {each.name: each for each in of.body if isinstance(each, Function)}
        for name, method in own.items():
            if name.strip("_") in ("init", "int", "inti") and "__init__" not in own:
                yield "misnamed", name, "__init__", method.lineno
        for base in (classes[last(each)] for each in of.bases if last(each) in classes):
            replaced = [each.name for each in base.body if isinstance(each, Function)]
            for name in replaced[:MOST_METHODS]:
                for other, method in [*own.items()][:MOST_METHODS]:
                    if name not in own and misspelt(name, other):
                        yield "misnamed", other, name, method.lineno


def _blocks(source: Source) -> Iterator[Found]:
    """Lines that the next one, or the next time, makes needless."""
    for node in source.nodes:
        block = getattr(node, "body", None)
        if not isinstance(block, list):
            continue
        for first, second in pairwise(block):
            match first, second:
                case ast.Assign(targets=[one], value=ast.Constant()), ast.Assign(
                    targets=[other], value=ast.Constant()
                ) if ast.dump(one) == ast.dump(other):
                    yield "twice", ast.unparse(other), "", second.lineno
        if isinstance(node, ast.While | ast.For | Function):
            yield from _resets(block)
        if isinstance(node, Function):
            yield from _sides(node)
            yield from _unpublished(node, source)


def _resets(block: list[ast.stmt]) -> Iterator[Found]:
    begun = {}
    for statement in block:
        match statement:
            case ast.Assign(targets=[ast.Name(id=name)], value=ast.Constant(value=int() | float())):
                begun[name] = statement.lineno
            case ast.AugAssign(target=ast.Name(id=name)) if name in begun:
                yield "resets", name, "", begun[name]


def _sides(function: Function) -> Iterator[Found]:
    """An argument that gets the attribute of its name, and is not used after that."""
    arguments = {each.arg for each in function.args.args}
    reads = [n.id for n in ast.walk(function) if isinstance(n, ast.Name) and is_read(n)]
    for node in ast.walk(function):
        match node:
            case ast.Assign(
                targets=[ast.Name(id=name)], value=ast.Attribute(value=ast.Name(id="self")) as kept
            ) if name in arguments and name not in reads:
                yield "sides", name, ast.unparse(kept), node.lineno


def _unpublished(function: Function, source: Source) -> Iterator[Found]:
    """A message that a function makes and fills, and hands to nothing."""
    made: dict[str, int] = {}
    for node in ast.walk(function):
        match node:
            case ast.Assign(targets=[ast.Name(id=name)], value=ast.Call(func=of)):
                owner = of.value if isinstance(of, ast.Attribute) else of
                if isinstance(owner, ast.Name) and owner.id in source.messages:
                    made[name] = node.lineno
    for node in ast.walk(function):
        if isinstance(node, ast.Name) and is_read(node) and node.id in made:
            outer: ast.AST = node
            while isinstance(source.parents[outer], ast.Attribute):
                outer = source.parents[outer]
            if outer is node or is_read(outer):
                made.pop(node.id)
    yield from (("unpublished", name, "", line) for name, line in made.items())
