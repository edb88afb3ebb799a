"""A file's syntax tree, its names and scopes; what is another's by mistake."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from functools import cached_property, lru_cache

from grader.submission import Function, last, scope_nodes

#: Kind, name, near, line; see `LintFinding`.
Found = tuple[str, str, str, int]
#: Statements after which the next line does not run.
LEAVES = (ast.Return, ast.Raise, ast.Break, ast.Continue)
#: A node -> the one that it is part of.
Parents = Mapping[ast.AST, ast.AST]


def is_read(node: ast.AST) -> bool:
    """Whether a name or an attribute is read there, not set."""
    return isinstance(getattr(node, "ctx", None), ast.Load)


#: Calls that take a callback -> its position, and that of a keyword of this name.
CALLBACKS = {
    "create_subscription": (2, "callback"),
    "create_timer": (1, "callback"),
    "add_done_callback": (0, "fn"),
    "create_service": (2, "callback"),
    "ActionServer": (3, "execute_callback"),
}


class Source:
    """One file, with what is asked of it again and again.

    Attributes:
        nodes: all of its syntax tree, in the order of `ast.walk`.
        functions: by name.
        parents: a node -> the one that it is part of.
    """

    def __init__(self, tree: ast.Module) -> None:
        self.tree, self.nodes = tree, [*ast.walk(tree)]
        self.functions = {node.name: node for node in self.nodes if isinstance(node, Function)}
        self.parents: Parents = {
            child: node for node in self.nodes for child in ast.iter_child_nodes(node)
        }

    @cached_property
    def all_calls(self) -> list[ast.Call]:
        return [node for node in self.nodes if isinstance(node, ast.Call)]

    def calls(self, *names: str) -> Iterator[ast.Call]:
        """Yield the calls of functions of these names, of whatever object."""
        return (call for call in self.all_calls if last(call.func) in names)

    def around(self, node: ast.AST, *kinds: type[ast.AST]) -> ast.AST | None:
        """Return the nearest of these kinds that a node is in."""
        found = self.parents.get(node)
        while found is not None and not isinstance(found, kinds):
            found = self.parents.get(found)
        return found

    def function_around(self, node: ast.AST) -> Function | None:
        """Return the innermost function that a node is in."""
        found = self.around(node, ast.FunctionDef, ast.AsyncFunctionDef)
        return found if isinstance(found, Function) else None

    @cached_property
    def imported(self) -> list[tuple[ast.ImportFrom, ast.alias]]:
        """The imports of messages and services."""
        found = (node for node in self.nodes if isinstance(node, ast.ImportFrom))
        of_ros = (node for node in found if (node.module or "").endswith((".msg", ".srv")))
        return [(node, alias) for node in of_ros for alias in node.names]

    @cached_property
    def messages(self) -> set[str]:
        """The names of messages and services, as the file calls them."""
        return {alias.asname or alias.name for _, alias in self.imported}

    @cached_property
    def given(self) -> list[tuple[str, ast.expr]]:
        """What stands where ROS is to get a callback, and by which call."""
        found: list[tuple[str, ast.expr]] = []
        for name, (position, keyword) in CALLBACKS.items():
            for call in self.calls(name):
                found += ((name, each) for each in call.args[position : position + 1])
                found += ((name, word.value) for word in call.keywords if word.arg == keyword)
        return found

    def callbacks(self) -> Iterator[tuple[str, Function]]:
        """Yield the functions that ROS is to call, and by which call it gets them."""
        for name, each in self.given:
            if (function := self.functions.get(last(each))) is not None:
                yield name, function

    def called_back(self) -> Iterator[Function]:
        """Yield the callbacks, and what these call."""
        waiting = [function for _, function in self.callbacks()]
        seen: set[str] = set()
        while waiting:
            function = waiting.pop()
            if function.name in seen:
                continue
            seen.add(function.name)
            yield function
            calls = (last(node.func) for node in ast.walk(function) if isinstance(node, ast.Call))
            waiting += [self.functions[name] for name in calls if name in self.functions]


def not_declared(node: ast.AST, outer: tuple[ast.AST, ...] = ()) -> Iterator[Found]:
    """Yield names that a function sets, and a scope around it sets, too.

    Yields: the kind of `LintFinding`, the name, the declaration that lacks, and a line.
    """
    for inner in (each for each in scope_nodes(node) if isinstance(each, Function)):
        scopes = [*outer, node]
        never_read = unread(inner)
        for name, line in _assigned(inner).items():
            home = next((scope for scope in reversed(scopes) if name in _assigned(scope)), None)
            if home is None or isinstance(home, ast.ClassDef):
                continue
            word = "global" if isinstance(home, ast.Module) else "nonlocal"
            if name in never_read and _is_read_beside(home, inner, name):
                yield "local", name, f"{word} {name}", line
            elif name not in never_read and _is_read_first(inner, name):
                yield "global", name, f"{word} {name}", _assigned(home)[name]
        yield from not_declared(inner, (*outer, node))
    if isinstance(node, ast.Module):
        for each in ast.walk(node):
            if isinstance(each, ast.ClassDef):
                yield from not_declared(each, (node,))


@lru_cache  # of a module it is asked for each name in each of its functions
def _assigned(scope: ast.AST) -> dict[str, int]:
    """Map the local names of a scope, by plain assignments, to the line where first."""
    lines: dict[str, int] = {}
    others: set[str] = set()
    arguments = scope.args if isinstance(scope, Function) else None
    if arguments is not None:
        others |= {each.arg for each in ast.walk(arguments) if isinstance(each, ast.arg)}
    for node in scope_nodes(scope):
        match node:
            case ast.Global(names=names) | ast.Nonlocal(names=names):
                others |= set(names)
            case ast.Assign(targets=targets):
                for name in (each.id for t in targets for each in _plain(t)):
                    lines[name] = min(node.lineno, lines.get(name, node.lineno))
            case ast.AugAssign(target=ast.Name(id=name)) | ast.AnnAssign(target=ast.Name(id=name)):
                lines[name] = min(node.lineno, lines.get(name, node.lineno))
    return {name: line for name, line in lines.items() if name not in others}


def _plain(target: ast.expr) -> list[ast.Name]:
    parts = target.elts if isinstance(target, ast.Tuple) else [target]
    return [each for each in parts if isinstance(each, ast.Name)]


def unread(function: Function) -> dict[str, int]:
    """Map the local names that a function never reads to the line where first."""
    loads = {node.id for node in ast.walk(function) if isinstance(node, ast.Name) and is_read(node)}
    added = {
        node.target.id
        for node in ast.walk(function)
        if isinstance(node, ast.AugAssign) and isinstance(node.target, ast.Name)
    }
    return {n: line for n, line in _assigned(function).items() if n not in loads | added}


def _is_read_beside(home: ast.AST, function: Function, name: str) -> bool:
    """Whether anything but a function itself reads a name."""
    inside = set(map(id, ast.walk(function)))
    return any(
        isinstance(node, ast.Name) and node.id == name and is_read(node) and id(node) not in inside
        for node in ast.walk(home)
    )


def _is_read_first(function: Function, name: str) -> bool:
    """Whether a function reads a name no later than it sets it."""
    uses = [n for n in scope_nodes(function) if isinstance(n, ast.Name) and n.id == name]
    reads = [node.lineno for node in uses if is_read(node)]
    sets = [node.lineno for node in uses if isinstance(node.ctx, ast.Store)]
    adds = any(
        isinstance(n, ast.AugAssign) and isinstance(n.target, ast.Name) and n.target.id == name
        for n in scope_nodes(function)
    )
    return adds or bool(reads and sets and min(reads) <= min(sets))


# Functions ----------------------------------------------------------------------------------------


def misplaced(source: Source) -> Iterator[Found]:
    """Yield what looks like a method, and is defined in a function or outside of all classes."""
    for node in source.nodes:
        outer = source.parents.get(node)
        if not isinstance(node, Function) or not isinstance(outer, Function | ast.Module):
            continue
        if [each.arg for each in node.args.args[:1]] == ["self"]:
            yield "misplaced", node.name, getattr(outer, "name", ""), node.lineno


def returns_nothing(function: Function) -> bool:
    """Whether a function gives None whatever happens."""
    gives = (ast.Return, ast.Yield, ast.YieldFrom, ast.Raise)
    return isinstance(function, ast.FunctionDef) and not any(
        isinstance(node, gives) and getattr(node, "value", node) is not None
        for node in scope_nodes(function)
    )


def last_print(function: Function) -> int:
    """Return the line of a function's last print(), or that of its def."""
    calls = (node for node in scope_nodes(function) if isinstance(node, ast.Call))
    prints = (each.lineno for each in calls if last(each.func) == "print")
    return max(prints, default=function.lineno)


def in_other_order(call: ast.Call, functions: Mapping[str, Function]) -> Found | None:
    """Return a call that gives two arguments each in the other's place; None for any other."""
    called, given = call.func, [*call.args]
    if last(called) == "partial" and given:
        called, given = given[0], given[1:]
    function = functions.get(last(called))
    takes = [each.arg for each in function.args.args] if function and len(given) > 1 else []
    if function is None or any(isinstance(each, ast.Starred) for each in given):
        return None
    takes = takes[1:] if takes[:1] == ["self"] else takes
    places = {name: at for at, name in enumerate(map(last, given)) if name}
    is_wrong = any(
        name in places and places[name] != at and last(given[at]) in takes[places[name] :][:1]
        for at, name in enumerate(takes[: len(given)])
    )
    values = {n: getattr(each, "value", None) for n, each in zip(takes, given, strict=False)}
    if values.get("width") in (0, 1) and isinstance(off := values.get("off"), int) and off > 1:
        is_wrong = True  # the pen's two, which nobody tells apart in a row of numbers
    return ("swapped", function.name, ", ".join(takes), call.lineno) if is_wrong else None
