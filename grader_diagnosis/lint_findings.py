"""Finds cause and line to change in the source, where the run shows their effect only.

A lint finding by itself is not reported: it may be meant. `docs/lint-findings.md` describes
each kind.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable

from grader.exercise import Diagnosis
from grader.recording.observations import LintFinding, SourceLine
from grader.text import Message, msg, shown
from grader_diagnosis.case import Case, diagnosed, diagnosed_by, first_of, line, of_kind
from grader_diagnosis.standstill import hears_once, never_spins

#: Words of checks about a stop that did not come, or came at once.
_ABOUT_STOPPING = ("wall", "zeros")


def named_at(case: Case, name: str, place: SourceLine | None) -> SourceLine | None:
    """Return the line of a name, where that is a constant apart from its use."""
    if place is None or name.lstrip("/") in place.text:
        return place
    for finding in of_kind(case, "constant"):
        if finding.name.lstrip("/") == name.lstrip("/"):
            return finding.place
    return place


def called_at(case: Case, text: str) -> SourceLine | None:
    """Return the line of the name that a finding says there is instead of the right one."""
    names = re.findall(r"(?:yours is|there is|only(?: on)?) /?([\w/]{1,100})", text)
    found = (each for each in of_kind(case, "constant") if each.name.lstrip("/") in names)
    return next((each.place for each in found), None)


def number(text: str) -> float:
    """Parse a number of a source; not a number where it is none."""
    try:
        return float(text)
    except ValueError:
        return math.nan


def imported_at(case: Case, end_type: str, wanted: str) -> SourceLine | None:
    """Return the import of a class that has the right name and is another package's."""
    package, _, rest = end_type.partition("/")
    name = rest.rpartition("/")[2]
    for finding in of_kind(case, "imports"):
        if finding.name == name == wanted.rpartition("/")[2] and finding.near.startswith(package):
            return finding.place
    return None


def given_at(case: Case, field: str, fits: Callable[[str], bool]) -> LintFinding | None:
    """Return what gives a field of a message a number that does not fit."""
    wrong = (each for each in of_kind(case, "argument") if not fits(each.near))
    names = (field, f"linear.{field}", f"angular.{field}", "colour")
    return next((each for each in wrong if each.name in names), None)


def in_other_order(finding: LintFinding) -> tuple[Message, Message]:
    """Say that a function is given its arguments in another order, and what to do."""
    name, takes = shown(finding.name), shown(finding.near)
    return (
        msg("{name}() takes ({takes}), and is given them in another order", name=name, takes=takes),
        msg("Give them in the order of `def {name}`: ({takes}).", name=name, takes=takes),
    )


def is_about_stopping(text: str) -> bool:
    """Whether a check's words are about a stop that did not come, or came at once."""
    return any(word in text for word in _ABOUT_STOPPING)


def set_at(case: Case, text: str) -> SourceLine | None:
    """Return where the field of a message is set that a finding names first."""
    if was_set := re.search(r"\b((?:linear|angular)\.[xyz]) was set", text):
        for finding in of_kind(case, "sets"):
            if finding.name == was_set[1]:
                return finding.place
    if value := re.search(r"\b(linear\.x|angular\.z) (is|was) (-?[\d.]+)", text):
        given = [each for each in of_kind(case, "argument") if each.name == value[1]]
        meant = [e.place for e in given if number(e.near) == number(value[3].rstrip("."))]
        if meant:  # what was the same all the time is to grow where it is passed on
            return meant[-1 if value[2] == "was" else 0]
    if "limits does your node compare" in text or "look at its conditions" in text:
        for colour in of_kind(case, "same_colour"):
            if colour.name in text:
                return colour.place
        middles = [*of_kind(case, "at_middle")]
        one_axis = [each for each in middles if each.name == "one axis"]
        off = [each for each in middles if not 5.4 < number(each.near) < 5.65]
        for finding in (*off, *one_axis, *middles):
            return finding.place
    if "needless call" in text and (kept := first_of(case, "keeps")) is not None:
        return kept
    if re.search(r"turn(?:ed)? on the spot", text):
        halts = {each.place.line for each in of_kind(case, "argument") if number(each.near) == 0}
        for finding in of_kind(case, "argument"):
            is_turning = finding.name == "angular.z" and number(finding.near) != 0
            if is_turning and finding.place.line in halts:
                return finding.place
    zeros = [e for e in of_kind(case, "argument") if e.name == "linear.x" and number(e.near) == 0]
    if "never moved" in text:  # where what stays zero is passed on by its name
        for finding in zeros:
            if finding.near not in finding.place.text:
                return finding.place
    if "told to stop" in text:
        for finding in zeros:
            if "linear.x" in finding.place.text:
                return finding.place
        if not zeros and (cancels := first_of(case, "cancels")) is not None:
            return cancels
    found = [
        (at, finding.place)
        for finding in of_kind(case, "sets")
        if (at := text.find(finding.name)) >= 0
        and ("." in finding.name or f"`{finding.name}`" in text)
    ]
    if is_about_stopping(text) and "drive on" not in text:
        at = min(text.find(word) for word in _ABOUT_STOPPING if word in text)
        found += [(at, finding.place) for finding in of_kind(case, "at_wall")]
    return min(found, key=lambda each: each[0])[1] if found else None


# Rules -------------------------------------------------------------------------------------------


def ends_before_spin(case: Case) -> Diagnosis | None:
    """ROS or the node is ended before anything spins."""
    if any(end.used for end in case.observed.ends if end.kind == "publisher"):
        return None
    for finding in of_kind(case, "ends_before_spin"):
        what = msg("ROS is shut down before anything spins{where}", where=line(finding.place))
        if finding.name == "destroy_node":
            what = msg("Your node is destroyed before it spins{where}", where=line(finding.place))
        return diagnosed_by(
            finding,
            "ends_before_spin",
            msg("{what}: no timer and no callback is ever called.", what=what),
            msg("Move {name}() behind rclpy.spin(node), to the end of main()."),
        )
    return None


def spins_in_init(case: Case) -> Diagnosis | None:
    """A spin in an `__init__`, which never gets to what comes after it."""
    if any(end.used for end in case.observed.ends if end.kind == "publisher"):
        return None
    for finding in of_kind(case, "spins_in_init"):
        return diagnosed_by(
            finding,
            "stays_in_init",
            msg(
                "Your program never leaves __init__(): it stays at `{code}`{where}, and what comes "
                "after is never reached: spin() returns only when the program ends."
            ),
            msg("Take it out there; main() makes the node and then calls rclpy.spin(node)."),
        )
    return None


def awaits(case: Case) -> Diagnosis | None:
    """A callback awaits an answer, and no further message is handled."""
    if hears_once(case) is None:
        return None
    for finding in of_kind(case, "waits"):
        cause = msg(
            "{name}() waits in {call}(){where} for what only another callback can bring, and "
            "no callback is called meanwhile."
        )
        help_ = msg(
            "Send the request by call_async(request) and go on, without "
            "spin_until_future_complete()."
        )
        cause = cause.given(call=shown(finding.near))
        return diagnosed_by(finding, "stuck_in_callback", cause, help_)
    for finding in of_kind(case, "awaits"):
        return diagnosed_by(
            finding,
            "awaits",
            msg(
                "{name}() waits by `await` for an answer{where}, and until then none of the other "
                "callbacks of its group is called: the answer never comes."
            ),
            msg(
                "Leave out await and async: call_async(request) sends the request, and you go on "
                "without waiting for the answer."
            ),
        )
    return None


def called_at_once(case: Case) -> Diagnosis | None:
    """A function that was to run in a thread runs in the main program, which gets no further."""
    sends = any(end.used for end in case.observed.ends if end.kind == "publisher")
    for finding in of_kind(case, "called"):
        name, near = shown(finding.name), shown(finding.near)
        is_spin = name.rpartition(".")[2] == "spin"
        goes_on = sends if is_spin else never_spins(case) is None
        if goes_on and case.observed.spun_s is not None:
            continue
        return diagnosed(
            "called_at_once",
            msg(
                "{called}{where} calls {name}() at once, in the main program, and what comes "
                "after waits until it returns."
            ),
            msg("Pass it by its name, without parentheses: {handed}."),
            finding.place,
            called=f"{near}{name}())",
            name=name,
            handed=f"{near}{name}{', args=(node,)' * is_spin})",
        )
    return None


def unstarted(case: Case) -> Diagnosis | None:
    """A thread that is to spin, and is never started."""
    for finding in of_kind(case, "unstarted") if case.observed.spun_s is None else ():
        return diagnosed_by(
            finding,
            "unstarted",
            msg("Nothing starts your thread {name}{where}, so nothing spins the node."),
            msg("Write {name}.start() behind it."),
        )
    return None
