"""What was exchanged in a run, hop by hop, as plain data: lanes, and what is on them.

An item has a time [s], perhaps an end, the lane that it comes from, the lanes that it reaches, what
it is about, and its values in a line. An item may still change while a run goes on; its id stays.

One page plays it afterwards: one file, without network, and with one script. Another shows it live
as it grows.
"""

from __future__ import annotations

import json
from bisect import bisect_left
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar, Final

from grader.scenes.cast.trace import ROSOUT, CastTrace, Event
from grader.scenes.live import LivePage
from grader.scenes.playback import Playback, PlayedRun, render_page
from grader.scenes.scene import STEP_NS

#: So many items a page has, so many characters of the values of each, so many nodes of a program.
MOST_ITEMS, LONGEST, MOST_NODES = 12_000, 200, 24
#: The lane of a program whose nodes are not known.
PROGRAM: Final = "/"
#: The lane of all nodes that have none.
OTHERS: Final = "…"
_LEVELS: Final = {10: "DEBUG", 20: "INFO", 30: "WARN", 40: "ERROR", 50: "FATAL"}
_SECOND: Final = 1e9
PAGE: Final = Path(__file__).with_name("page")


def lanes(trace: CastTrace) -> list[str]:
    """Return the program's nodes, of several in the order of these, and then those of the cast."""
    own = {event["node"] for event in trace.of_kind("endpoint")} - {PROGRAM}

    def place(node: str) -> tuple[int, str]:
        number = trace.programs.get(node, "").rpartition("-")[2]  # of 'talker-1'
        return int(number) if number.isdecimal() else 0, node

    shown = sorted(own, key=place) or [PROGRAM]
    if len(shown) > MOST_NODES:
        shown[MOST_NODES - 1 :] = [OTHERS]
    return [*shown, *trace.peers]


def labels(trace: CastTrace) -> dict[str, str]:
    """Return what lanes are called otherwise: those of several programs, as a terminal has them."""
    return {node: f"[{name}] {node}" for node, name in trace.programs.items() if name}


def items(trace: CastTrace, since_ns: int = 0) -> list[dict[str, Any]]:
    """Return all items but the messages before a time, by time."""
    own = lanes(trace)[: -len(trace.peers) or None]
    readers = _readers(trace)
    first = bisect_left(trace.messages, since_ns, key=lambda sent: sent.time_ns)
    made = []
    for number, sent in enumerate(trace.messages[first:MOST_ITEMS], first):
        values, sender = trace.values(sent), sent.node or own[0]
        item: dict[str, Any] = {"id": f"m{number}", "t": sent.time_ns / _SECOND, "from": sender}
        if sent.topic == ROSOUT:
            level = _LEVELS.get(values["level"], "?")
            node = f"/{values.get('name', '')}".replace(".", "/")
            item |= {"kind": "log", "from": node if node in own else sender, "to": []}
            item |= {"what": level, "text": clipped(values["msg"])}
        else:
            to = sorted(readers.get(sent.topic, set()) - {sender})
            item |= {"kind": "message", "to": to, "what": sent.topic, "text": clipped(values)}
        made.append(item)
    made += [item for n, event in enumerate(trace.events) for item in _of(n, event, own[0])]
    return sorted(made, key=lambda item: item["t"])


def _readers(trace: CastTrace) -> dict[str, set[str]]:
    """Return the lanes of those that hear a topic, by its name."""
    found: dict[str, set[str]] = {}
    for event in trace.of_kind("endpoint", writes=False):
        found.setdefault(event["channel"].partition(" ")[2], set()).add(event["node"])
    for event in trace.of_kind("offers", what="subscription"):
        found.setdefault(event["name"], set()).add(event["node"])
    return found


def _of(number: int, event: Event, program: str) -> Iterator[dict[str, Any]]:
    """Yield the item of an event; none of those that nobody sees happen."""
    kind, peer = event["kind"], event.get("peer", "")
    begin = event.get("sent_ns", event["time_ns"]) / _SECOND
    end_ns = event.get("answered_ns", event.get("ended_ns"))
    item = {"id": f"e{number}", "t": begin, "from": peer, "to": [program], "kind": kind}
    if end_ns is not None:
        item["end"] = end_ns / _SECOND
    if "feedback" in event:
        item["marks"] = [time_ns / _SECOND for time_ns, _ in event["feedback"]]
    match kind:
        case "call" if "sent_ns" in event:
            yield item | {"what": event["service"], "text": _answered(event, "request", "response")}
        case "served":
            turned = {"from": program, "to": [peer], "kind": "call"}
            text = _answered(event, "request", "response")
            yield item | turned | {"what": event["service"], "text": text}
        case "goal" if "sent_ns" in event:
            yield item | {"what": event["action"], "text": _answered(event, "goal", "result")}
        case "action":
            turned = {"from": program, "to": [peer], "kind": "goal"}
            yield item | turned | {"what": event["action"], "text": _answered(event, "goal", "")}
        case "parameter" if "sent_ns" in event:
            verb = "set" if "set" in event else "get"
            told = event.get(verb, event.get("values", {})).items()
            text = ", ".join(f"{verb} {name}{_after(value)}" for name, value in told)
            yield item | {"what": event["node"], "text": clipped(text)}


def _after(value: Any) -> str:
    """Return the value of a parameter, or why it was refused; '' for neither."""
    return "" if value == "" else f" → {clipped(value)}"


def _answered(event: Event, asked: str, answer: str) -> str:
    """Return a question with its answer, if that has come."""
    told = clipped(event.get(asked, {}))
    return f"{told} → {clipped(event[answer])}" if answer in event else told


def clipped(value: Any) -> str:
    """Return plain data in a line, not too long."""
    if isinstance(value, Mapping) and len(value) == 1:
        (value,) = value.values()
    text = value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
    text = text.encode("utf-8", "replace").decode()
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 4]} ..."


# Pages ----------------------------------------------------------------------------------------


def render(playback: Playback) -> str:
    """Return the page, with a timeline of each run in it."""
    other = playback.other
    others = () if other is None else tuple((f"{other.title}: {r.title}", r) for r in other.runs)
    runs = [_run(*each) for each in (*((r.title, r) for r in playback.runs), *others)]
    data = {"tick_s": STEP_NS / 1e9, "runs": runs}
    live = PAGE / "live"
    return render_page(playback, PAGE / "replay.html", data, [PAGE, live], [live / "timeline.css"])


def _run(title: str, run: PlayedRun) -> dict[str, Any]:
    trace = CastTrace.of(run.trace)
    return {
        **{"title": title, "outcome": run.outcome, "ticks": trace.ticks},
        **{"lanes": lanes(trace), "labels": labels(trace)},
        "items": items(trace),
    }


class TimelinePage(LivePage):
    """The items of a run in another process, by their ids."""

    PAGE: ClassVar = PAGE / "live"

    def _start(self) -> Mapping[str, Any]:
        self._shown: dict[str, Any] = {"lanes": [], "labels": {}}
        self._items: dict[str, Mapping[str, Any]] = {}
        self._time_s = 0.0
        return self._nothing_new()

    def _everything(self) -> tuple[Mapping[str, Any], None]:
        return {**self._nothing_new(), "items": [*self._items.values()], "begins": True}, None

    def _nothing_new(self) -> Mapping[str, Any]:
        return {"t": self._time_s, **self._shown, "items": []}

    def hear(self, news: Sequence[Mapping[str, Any]]) -> None:
        changed: dict[str, Mapping[str, Any]] = {}
        with self._lock:
            for each in news:
                self._time_s = each["t"]
                self._shown = {name: each[name] for name in self._shown}
                changed.update((item["id"], item) for item in each["items"])
            self._items.update(changed)
            self._tell({**self._nothing_new(), "items": [*changed.values()]})
