"""Finds why a check lost points: in the source, and in the lines that the run did not reach."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

from grader.exercise import Diagnosis
from grader.recording.observations import End, LintFinding
from grader.text import NOTHING, Message, msg, shown
from grader_diagnosis.case import (
    Case,
    diagnosed,
    diagnosed_by,
    filled,
    line,
    of_kind,
    sentences,
    words_of,
)
from grader_diagnosis.lint_findings import in_other_order, is_about_stopping
from grader_diagnosis.unnoticed import NOT_CAUGHT

#: Kinds that say more of a condition than whether it was ever true.
_SAY_MORE = ("at_wall", "uncalled", "always", "local", "unread")

_COLOURS = "look at its conditions"
#: Kind of a finding that explains some checks only -> words of theirs.
_ABOUT: dict[str, str] = {
    **dict.fromkeys(("late", "degrees", "overrules", "twice", "shared"), _COLOURS),
    **{"always": "driving", "heads": "into a quadrant gave", "quiet": "was not logged"},
    "grows": "grew by",
}
#: Kind of a finding -> cause and help.
_MEANT: dict[str, tuple[Message, Message]] = {
    "compared": (msg("`{name}` compares, and sets nothing{where}."), msg("Write = for ==.")),
    "always": (msg("`{name}`{where} is always true."), NOTHING),
    "adds_nothing": (msg("`{name}`{where} lets nothing grow."), NOTHING),
    "no_effect": (
        msg("Nothing uses what `{name}`{where} is."),
        msg("Write return before it, if that is what you mean."),
    ),
    "plus": (msg("`{code}`{where} sets it anew each time, and adds nothing."), msg("Write +=.")),
    "resets": (
        msg("`{code}`{where} sets {name} anew each time, so what is added to it is lost."),
        msg("Set it once, before: in __init__ or before the loop, and keep it as self.{name}."),
    ),
    "sides": (
        msg("`{code}`{where} sets the argument, not {near}."),
        msg("Exchange the sides: {near} = {name}."),
    ),
    "unpublished": (
        msg("`{name}`{where} is filled, and never sent."),
        msg("Write publish({name}), or call_async({name}) for a request, behind it."),
    ),
    "default": (
        msg(
            "`{name}`{where} is worked out once, when Python reads the function, and stays"
            " the same."
        ),
        msg("Ask for the time in the function, not in its arguments."),
    ),
    "other_text": (
        msg("`{code}`{where} compares with {name}; what is set is {near}."),
        msg("Write the same text in both places, letter by letter."),
    ),
    "late": (
        msg(
            "`{name}` in the lambda{where} is looked up when that is called: then the loop"
            " is over, and it is the last one."
        ),
        msg("Write lambda {name}={name}: there, which keeps each."),
    ),
    "degrees": (
        msg("`{name}`{where}: the angle is in radians, not in degrees."),
        msg("A full turn is 2 * math.pi; or use math.degrees(...)."),
    ),
    "overrules": (
        msg(
            "This `if`{where} begins anew, and its else sets {name} again, whatever the if "
            "above has set."
        ),
        msg("Write elif for if."),
    ),
    "twice": (
        msg("`{code}`{where} sets again what the line before it has set."),
        msg("One of the two is meant for another name."),
    ),
    "shared": (
        msg("`{name}`{where} is one and the same object, several times."),
        msg("Make each for itself: [... for _ in range(4)]."),
    ),
    "heads": (
        msg("`{name}`{where} is where the turtle looks, not where it is."),
        msg("Take the quadrant from x and y of the pose."),
    ),
    "quiet": (
        msg("`{code}`{where} logs at the level debug, which is not shown."),
        msg("Log it with self.get_logger().info(...)."),
    ),
    "grows": (
        msg("`{code}`{where} is done with each message, in {near}(): many times a second."),
        msg("Move it to where you publish."),
    ),
}
#: How a step that was not taken should have been; see `grader_diagnosis.lint.paths.Step`.
_NOT_TAKEN: dict[str, tuple[Message, Message]] = {
    "true": (
        msg("`{code}`{where} is never true{seen}."),
        msg("Look at that condition, and at what sets its names before."),
    ),
    "false": (
        msg("`{code}`{where} is always true{seen}."),
        msg("Look at that condition, and at what sets its names before."),
    ),
    "called": (
        msg("Nothing calls {code}(){where}."),
        msg("Call it where it is needed, or let a timer or a subscription do so."),
    ),
    "tried": (
        msg(
            "What is in `{code}`{where} ends in an exception, and what stands after is not reached."
        ),
        msg("Print the exception, or leave out the try/except: it says why."),
    ),
    "past": (
        msg("`{code}`{where} never comes to its end, and what stands after it is not reached."),
        msg("What is to happen meanwhile belongs in a callback."),
    ),
}
#: What tf2 says of a transform that is not found -> what to do.
_LOOKED_UP = {
    "does not exist": msg(
        "Only TransformListener(self.buffer, self) fills a tf2 buffer: is there one?"
    ),
    "extrapolation into the future": msg(
        "Ask for the newest transform: rclpy.time.Time() for the time, and not now()."
    ),
}


def beside(found: Diagnosis, case: Case) -> Diagnosis:
    """Add to a check's finding the lint finding that may be its cause."""
    if (without := _lacks(case) or _unspun(case)) is not None:
        return replace(without, run=found.run)
    if (hidden := _hidden(found, case)) is not None:
        return hidden
    for finding in of_kind(case, "swapped"):
        what, help_ = in_other_order(finding)
        return _explained(found, finding, msg("{what}{where}.", what=what), help_)
    for finding in of_kind(case, "uncalled", "unread", "local"):
        return _explained(found, finding, *_cause_and_help(finding))
    if (meant := _misunderstood(found, case)) is not None:
        return meant
    if (missed := _missed(found, case)) is not None:
        return missed
    for finding in of_kind(case, "swallows"):
        hides = filled(msg("`{code}`{where} hides every error in {name}()."), words_of(finding))
        cause, help_ = sentences(found.cause, hides), sentences(found.help, NOT_CAUGHT)
        return replace(found, cause=cause, help=help_, place=finding.place)
    return _beside_condition(found, case)


def _explained(
    found: Diagnosis, finding: LintFinding, cause: Message, help_: Message, **words: Any
) -> Diagnosis:
    """Put what the source shows before a check's finding; without a help, that one's stays."""
    words = words_of(finding) | words
    cause, help_ = sentences(filled(cause, words), found.cause), filled(help_, words)
    return replace(found, cause=cause, help=help_ or found.help, place=finding.place)


def _hidden(found: Diagnosis, case: Case) -> Diagnosis | None:
    """Add the error that an `except` hides which catches all of them."""
    for catches in of_kind(case, "swallows"):
        for finding in of_kind(case, "raises"):
            if finding.place.file == catches.place.file:
                return _explained(
                    found,
                    finding,
                    msg(
                        "`{code}`{where} ends in an error, {error}, which `{catches}`{there} hides."
                    ),
                    sentences(msg("Correct that line."), NOT_CAUGHT),
                    error=shown(finding.name),
                    catches=shown(catches.place.text),
                    there=line(catches.place),
                )
    return None


def unused(found: Diagnosis, case: Case) -> End | None:
    """Return the publisher or client that a finding is about, where it was never used."""
    there = {(each.name, each.type) for each in case.scene_has}
    for end in case.observed.ends if case.observed.spun_s is not None else ():
        is_meant = (end.name, end.type) in there and end.name in found.spoken
        if is_meant and not end.used and end.kind in ("publisher", "client"):
            return end
    return None


def _missed(found: Diagnosis, case: Case) -> Diagnosis | None:
    """Add why a run has not reached what would have earned the points."""
    end = unused(found, case)
    if end is not None:
        goals = ["publish"] if end.kind == "publisher" else ["call", "call_async"]
    elif _COLOURS in found.spoken:
        goals = ["branch"]
    elif "ran into" in found.spoken:  # it has come to a wall, and should have stopped there
        goals = ["publish", "branch"]
    else:
        return None
    stays = {each.place: each for each in of_kind(case, "stays")}
    known = {each.place for each in case.observed.lint_findings if each.kind in _SAY_MORE}
    for finding in of_kind(case, "unreached"):
        goal, how, values = (*finding.near.split(" ", 2), "", "")[:3]
        is_flag = goal == "branch" and not re.search("[<>=]", finding.name)
        if goal not in goals or finding.place in known or is_flag or "__name__" in finding.name:
            continue
        is_tried = how == "past" and finding.name.startswith("try")
        cause, help_ = _NOT_TAKEN["tried" if is_tried else how if how in _NOT_TAKEN else "past"]
        if is_tried:
            fitting = (advice for text, advice in _LOOKED_UP.items() if text in case.tail)
            help_ = next(fitting, help_)
        if (kept := stays.get(finding.place)) is not None:
            help_ = msg(
                "Nothing sets {name} after the start: which line should?", name=shown(kept.name)
            )
        if goal == "branch" and end is None:
            help_ = NOTHING  # the check's own stays
        seen = msg(" ({values})", values=shown(values)) if values else NOTHING
        return _explained(found, finding, cause, help_, code=shown(finding.name), seen=seen)
    return None


def _misunderstood(found: Diagnosis, case: Case) -> Diagnosis | None:
    """Add what the source says otherwise than it was meant, where that may cost the points."""
    for kind in _MEANT:
        for finding in of_kind(case, kind) if _ABOUT.get(kind, "") in found.spoken else ():
            return _explained(found, finding, *_MEANT[kind])
    return None


def _unspun(case: Case) -> Diagnosis | None:
    """A node that is made, and that nothing spins."""
    ends = case.observed.ends
    is_deaf = any(end.kind == "subscription" and not end.used for end in ends)
    is_idle = not any(end.used for end in ends)
    for finding in of_kind(case, "unspun") if is_deaf or is_idle else ():
        return diagnosed(
            "unspun",
            msg(
                "Nothing spins `{name}`{where}: no timer and no callback of {kind} is ever called."
            ),
            msg("Give it to what spins: executor.add_node({name})."),
            finding.place,
            name=shown(finding.name),
            kind=shown(finding.near),
        )
    return None


def _beside_condition(found: Diagnosis, case: Case) -> Diagnosis:
    """Add to a check's finding the condition that may be its cause."""
    spoken = found.spoken
    walls = [*of_kind(case, "at_wall")] if is_about_stopping(spoken) else []
    for finding in walls:
        if (wrong := _wrong_condition(finding, spoken)) is not None:
            return _explained(found, finding, *wrong, code=shown(finding.name), seen=NOTHING)
    is_about_memory = "driving" in spoken or "needless call" in spoken
    for finding in of_kind(case, "stays") if is_about_memory else ():
        text = msg("`{code}`{where} is always {value}: nothing sets it after the start.")
        code, value = shown(finding.name), shown(finding.near)
        explained = _explained(found, finding, text, NOTHING, code=code, value=value)
        return replace(explained, place=walls[0].place) if walls else explained
    return found


#: What is wrong with a condition that is to tell that a wall is near, and the way out.
_WRONG_CONDITIONS: dict[str, tuple[Message, Message]] = {
    "never": (
        msg("`{code}`{where} is never true{seen}."),
        msg("Look at `and` and `or`, at < and >: x and y go from 0 to 11.09."),
    ),
    "always": (
        msg("`{code}`{where} is always true{seen}."),
        msg("Look at `and` and `or`, and at < and >."),
    ),
    "middle": (
        msg("`{code}`{where} is true in the middle of the window, too."),
        msg("Which of its signs has to be the other one, < or >?"),
    ),
    "corners": (
        msg("`{code}`{where} is true in a corner only."),
        msg("Join the walls by `or`: one of them is enough."),
    ),
}


def _wrong_condition(finding: LintFinding, spoken: str) -> tuple[Message, Message] | None:
    """Say what is wrong with a condition, also if it does not watch the wall that is spoken of."""
    if finding.near in _WRONG_CONDITIONS:
        return _WRONG_CONDITIONS[finding.near]
    help_ = NOTHING
    if finding.name.startswith("not ") and " and " in finding.name:
        help_ = msg("`not` belongs to the comparison beside it only: write not (... and ...).")
    for wall in finding.near.split(", ") if finding.near else ():
        if f"{wall} wall" in spoken:
            return msg("`{code}`{where} does not watch that wall."), help_
    return None


def _lacks(case: Case) -> Diagnosis | None:
    """A function that looks like a callback, and that nothing passes on."""
    ends = [end.kind for end in case.observed.ends]
    for finding in of_kind(case, "unused") if case.observed.is_known else ():
        if finding.near == "create_timer" and not case.observed.timers:
            return diagnosed_by(
                finding,
                "lacks_timer",
                msg("There is no timer{where}: nothing ever calls {name}()."),
                msg("Write self.create_timer(0.1, self.{name}) there, in __init__."),
            )
        if finding.near == "create_subscription" and "subscription" not in ends:
            return diagnosed_by(
                finding,
                "lacks_subscription",
                msg("There is no subscription{where}: nothing ever calls {name}()."),
                msg(
                    "Write self.create_subscription(Pose, '/turtle1/pose', self.{name}, 10) there, "
                    "in __init__."
                ),
            )
    return None


def _cause_and_help(finding: LintFinding) -> tuple[Message, Message]:
    if finding.kind == "unread":
        return (
            msg("`self.{name}` is set and never read; what is read is `self.{near}`{where}."),
            msg("Write self.{near} there, if that is what you mean."),
        )
    if finding.kind == "local" and finding.near.startswith("self."):
        return (
            msg(
                "`{name}` is a variable of this function and never read; what is read "
                "elsewhere is `{near}`{where}."
            ),
            msg("Write {near} = ... there."),
        )
    if finding.kind == "local":
        return (
            msg(
                "`{name}` is set in this function only, and never read; outside there "
                "is another `{name}`{where}."
            ),
            msg("Write `{near}` as the first line of the function."),
        )
    cause = msg(
        "`{name}` stands there without parentheses: a function itself is always true{where}."
    )
    if finding.place.text.lstrip().partition(";")[0].rstrip() == finding.name:
        cause = msg("`{name}` stands there without parentheses, and does nothing{where}.")
    return cause, msg("Write {name}().")
