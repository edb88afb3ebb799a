"""Finds what has to happen before a line runs, and which of it has not.

The source gives the steps that lead to a call: the function is called, the lines before it are left
behind, a condition is true. A run gives the lines that have run. The first step that was not taken
is why a call was never reached.
"""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

from grader.recording.observations import LintFinding, RanFile
from grader.submission import Function, last
from grader_diagnosis.lint.scopes import LEAVES, Found, Parents, Source

#: The calls that a diagnosis asks about.
SENDS = ("publish", "call_async", "call")
#: So many steps of a submission are kept; a function is looked for so often.
MOST, DEEPEST = 300, 5
#: Statements that run no line.
_IDLE = (ast.Global, ast.Nonlocal, ast.Pass)


class Step(NamedTuple):
    """A step on the way to a call.

    Attributes:
        goal: the name of what is called; 'branch' for the first line after a condition;
            'set:self.x' for what sets that.
        goal_line: its line.
        how: `called` - the function is; `true`, `false` - the condition is, else the goal is not
            reached; `past` - that statement is left behind.
        first, last: the lines of which one runs when the step is taken.
    """

    goal: str
    goal_line: int
    how: str
    first: int
    last: int

    def __str__(self) -> str:
        return " ".join(map(str, self))

    @classmethod
    def parse(cls, text: str) -> Step:
        """Raise ValueError or TypeError where it is none."""
        goal, line, how, first, last_ = text.split(" ")
        return cls(goal, int(line), how, int(first), int(last_))


def find(source: Source) -> Iterator[Found]:
    """Yield the steps to each call that sends something or calls a function of the file.

    Yields: the kind of `LintFinding`, its name and near, and a line.
    """
    parents, functions = source.parents, source.functions
    given = {last(each) for _, each in source.given}
    for node in source.nodes:
        if isinstance(node, ast.If):
            step = Step("branch", node.body[0].lineno, "true", *_lines(node.body[0]))
            yield "step", ast.unparse(node.test), str(step), node.lineno
        if isinstance(node, ast.Call) and (last(node.func) in (*SENDS, *functions)):
            yield from _steps(last(node.func), node, parents, given)
        for target in node.targets if isinstance(node, ast.Assign) else ():
            if isinstance(target, ast.Attribute):
                yield from _steps(f"set:{ast.unparse(target)}", target, parents, given)


def _steps(goal: str, inner: ast.expr, parents: Parents, given: Collection[str]) -> Iterator[Found]:
    found: list[tuple[str, str, int, ast.stmt]] = []
    node: ast.AST = inner
    while (outer := parents.get(node)) is not None:
        if isinstance(outer, ast.Lambda | ast.ExceptHandler):
            return
        block = next((b for b in _blocks(outer) if node in b), None)
        if block is not None:
            assert isinstance(node, ast.stmt)
            before = block[: block.index(node)]
            lines = [each for each in before if not _is_idle(each)]
            past = [
                (*_left_behind(each), each.lineno, later)
                for each, later in pairwise([*lines, node])
                if _may_stay(each)
            ]
            found[:0] = past
            entered = lines[0] if lines else node
            match outer:
                case ast.If(test=test) | ast.While(test=test):
                    how = "true" if block is outer.body else "false"
                    found.insert(0, (how, ast.unparse(test), outer.lineno, entered))
                case ast.FunctionDef(name=name) | ast.AsyncFunctionDef(name=name):
                    if name == "__init__":
                        return
                    if name not in given:  # what ROS calls others explain
                        found.insert(0, ("called", name, outer.lineno, entered))
                    break
        node = outer
    for how, code, line, later in found:
        step = Step(goal, inner.lineno, how, *_lines(later))
        yield "step", code, str(step), line


def _blocks(node: ast.AST) -> Iterator[Sequence[ast.stmt]]:
    for name in ("body", "orelse", "finalbody"):
        block = getattr(node, name, None)
        if isinstance(block, list):
            yield block


def _left_behind(statement: ast.stmt) -> tuple[str, str]:
    """Return what has to be so for what comes after a statement: how, and the code."""
    if isinstance(statement, ast.If) and isinstance(statement.body[-1], LEAVES):
        return "false", ast.unparse(statement.test)
    if isinstance(statement, ast.While):
        return "past", f"while {ast.unparse(statement.test)}:"
    return "past", ast.unparse(statement).partition("\n")[0]


@lru_cache  # it is asked for each call behind it
def _may_stay(statement: ast.stmt) -> bool:
    """Whether what comes after a statement may not be reached."""
    if isinstance(statement, ast.ClassDef | Function):
        return False
    return any(isinstance(node, (ast.Call, ast.While, *LEAVES)) for node in ast.walk(statement))


def _is_idle(statement: ast.stmt) -> bool:
    is_text = isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)
    return is_text or isinstance(statement, _IDLE)


def _lines(statement: ast.stmt) -> tuple[int, int]:
    """Return the first and last line of a statement; of a compound one to its block's first."""
    block = next(_blocks(statement), None)
    end = block[0].lineno if block else statement.end_lineno or statement.lineno
    return statement.lineno, end


def unreached(steps: Iterable[LintFinding], ran: Iterable[RanFile]) -> Iterator[LintFinding]:
    """Yield the step that was not taken, of each call that a run has not reached.

    Yields: findings of the kind `unreached`.
    """
    lines = {each.file: set(each.lines) for each in ran}
    values = {(each.file, at.line): at.text for each in ran for at in each.asked}
    ways: dict[tuple[str, str, int], list[tuple[LintFinding, Step]]] = {}
    for finding in steps:
        step = Step.parse(finding.near)
        way = ways.setdefault((finding.place.file, step.goal, step.goal_line), [])
        way.append((finding, step))
    stops = {goal: stop for goal, way in ways.items() if (stop := _stop(way, lines)) is not None}
    for (_, goal, _), stop in stops.items():
        if goal not in (*SENDS, "branch"):
            continue
        found = [stop]
        for _ in range(DEEPEST):  # to what should have called the function, or set the condition
            finding, step = found[-1]
            if step.how == "called":
                deeper = [at for at in ways if at[1] == finding.name]
            else:
                deeper = [at for at in ways if at[1][:4] == "set:" and at[1][4:] in finding.name]
            if not deeper or any(at not in stops for at in deeper) or stops[deeper[0]] in found:
                break
            found.append(stops[deeper[0]])
        for finding, step in reversed(found):
            seen = values.get((finding.place.file, finding.place.line), "")
            near = f"{goal} {step.how} {seen}".rstrip()
            yield replace(finding, kind="unreached", near=near)


def _stop(
    way: Sequence[tuple[LintFinding, Step]], lines: Mapping[str, set[int]]
) -> tuple[LintFinding, Step] | None:
    """Return the first step of a way that was not taken; None where its goal was reached."""
    for finding, step in way:
        ran = lines.get(finding.place.file)
        if not ran:
            return None  # nothing of the file was followed
        if not any(line in ran for line in range(step.first, step.last + 1)):
            began = finding.place.line in ran or step.how == "called"
            return (finding, step) if began else None
    return None
