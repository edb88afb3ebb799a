"""Which line of a submission has sent what came in.

The submission's process counts what it sends, the simulator what arrives. Where both are as many by
a name, the first is the first and the last the last; else only the first is known, if anything.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import Any

from grader.scenes.playback import Line, Sent

#: Services that are the node's own, and no turtle's.
_OF_THE_NODE = frozenset(("clear", "reset", "spawn", "kill"))


def of(calls: Sequence[Mapping[str, Any]], sent: Sequence[Sent]) -> dict[str, Any]:
    """`{"calls", "lines"}`: the calls, with `line` where it is known, a number in the lines."""
    by_name = defaultdict(list)
    for index, call in enumerate(calls):
        by_name[_name(call)].append(index)
    known: dict[int, int] = {}
    lines: dict[Line, int] = {}
    for each in sent:
        where = [line for line, times in each.order for _ in range(min(times, len(calls) + 1))]
        came = by_name[each.name]
        # the simulator has missed something, or hears of somebody else, too
        surely = where if each.times == len(came) else where[:1]
        for index, line in zip(came, surely, strict=False):
            known[index] = lines.setdefault(each.lines[line], len(lines))
    return {
        "calls": [
            {**call, "line": known[index]} if index in known else call
            for index, call in enumerate(calls)
        ],
        "lines": [{"file": line.file, "line": line.line, "text": line.text} for line in lines],
    }


def _name(call: Mapping[str, Any]) -> str:
    """The topic or service that a call came by; '' for what is none."""
    if call["op"] in _OF_THE_NODE:
        return f"/{call['op']}"
    return f"/{call['turtle']}/{call['op']}" if "turtle" in call else ""
