"""What a look at the source has shown, where it explains what went wrong.

A lint finding is nothing wrong by itself (`LintFinding` says what each is): an exception explains
it, or a check that lost points stands beside it.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import replace

from grader.diagnosis.case import Case, function, line, sentences, told
from grader.diagnosis.diagnosis import Diagnosis
from grader.diagnosis.standstill import never_spins
from grader.diagnosis.unnoticed import NOT_CAUGHT
from grader.diagnosis.usual import Said
from grader.message import Message, as_message, msg
from grader.recording.observations import LintFinding, LintKind, Raised, SourceLine

#: So much of an exception's text is looked at [characters].
_LONGEST = 1000
_GIVEN = re.compile(r"(\w{1,60})\(\) takes (\d{1,3}) positional arguments? but (\d{1,3}) w")
_VARIABLE = re.compile(r"variable '(\w{1,60})'")
_OF_A_SERVICE = re.compile(r"(\w{1,60})(?:\.__init__)?\(\) (?:got an unexpected k|takes no arg)")
_NO_INSTANCE = "Service classes can not be instantiated"


def explains(case: Case, raised: Raised) -> Said | None:
    """What an exception comes from, where the source or the scene tells more than its text."""
    return next((said for rule in _RULES if (said := rule(case, raised)) is not None), None)


def _of_kind(case: Case, *kinds: LintKind) -> Iterator[LintFinding]:
    return (slip for slip in case.observed.lint_findings if slip.kind in kinds)


def _not_global(case: Case, raised: Raised) -> Said | None:
    found = _VARIABLE.search(raised.text[:_LONGEST])
    if raised.type != "UnboundLocalError" or found is None:
        return None
    for slip in _of_kind(case, "global"):
        if slip.name == found[1]:
            word = told(slip.near)
            outside = msg("outside")
            if word.startswith("global"):
                outside = msg("at the top of the file")
            here = as_message(function(raised.place)) or msg("this function")
            return Said(
                msg(
                    "Write `{word}` as the first line of {here}: without it that is another"
                    " variable, which has no value yet.",
                    word=word,
                    here=here,
                ),
                msg(
                    "`{name}` is assigned {outside} (line {line}) and in {here}: add `{word}`",
                    name=told(slip.name),
                    outside=outside,
                    line=slip.place.line,
                    here=here,
                    word=word,
                ),
            )
    return None


def _without_self(case: Case, raised: Raised) -> Said | None:
    found = _GIVEN.search(raised.text[:_LONGEST])
    if raised.type != "TypeError" or found is None or int(found[3]) != int(found[2]) + 1:
        return None
    for slip in _of_kind(case, "without_self"):
        if slip.name == found[1]:
            written = told(slip.place.text)
            rest = written.partition("(")[2].lstrip()
            comma = "" if rest.startswith(")") else ", "
            return Said(
                msg(
                    "A method takes self before all else: write `{written}`.",
                    written=f"{written.partition('(')[0]}(self{comma}{rest}",
                ),
                place=slip.place,
            )
    return None


def _hidden_method(case: Case, raised: Raised) -> Said | None:
    if "object is not callable" not in raised.text[:_LONGEST] or raised.place is None:
        return None
    for slip in _of_kind(case, "method"):
        name = told(slip.name)
        if f"self.{name}(" in raised.place.text:
            return Said(
                msg(
                    "self.{name} is set to something else{where}, and that hides the method "
                    "{name}(): give one of them another name.",
                    name=name,
                    where=line(slip.place),
                )
            )
    return None


def _class_given(case: Case, raised: Raised) -> Said | None:
    place = raised.place
    for slip in _of_kind(case, "class"):
        if place is not None and ("spin" in place.text or place.line == slip.place.line):
            call, name = told(slip.near), told(slip.name)
            return Said(
                msg(
                    "The parentheses are missing: node = {name}(), then {call}(node).",
                    name=name,
                    call=call,
                ),
                msg(
                    "{call} was given a class, not a node that was made of it",
                    call=call.rpartition(".")[2],
                ),
                slip.place,
            )
    return None


def _service_for_request(case: Case, raised: Raised) -> Said | None:
    services = {each.type.rpartition("/")[2] for each in case.scene_has if each.kind == "service"}
    services |= {end.type.rpartition("/")[2] for end in case.ends if end.kind == "client"}
    text = raised.text[:_LONGEST]
    found = _OF_A_SERVICE.search(text)
    name = found[1] if found else ""
    if _NO_INSTANCE in text and raised.place is not None:
        calls = re.findall(r"(\w{1,60})\(", raised.place.text)
        name = next((each for each in calls if each in services), "")
    if name not in services:
        return None
    return Said(
        msg("Write {name}.Request(...) there: that is what a request is made of.", name=told(name)),
        msg("{name} is the service, not a request to it", name=told(name)),
    )


_RULES: tuple[Callable[[Case, Raised], Said | None], ...] = (
    *(_not_global, _without_self, _hidden_method, _class_given, _service_for_request),
)


def called_at_once(case: Case) -> Diagnosis | None:
    """What was to run in a thread runs in the main program, which gets no further."""
    for slip in _of_kind(case, "called"):
        if never_spins(case) is None and case.observed.spun_s is not None:
            continue
        name = told(slip.name)
        return Diagnosis(
            "called_at_once",
            msg(
                "{called}{where} calls {name}() at once, in the main program, and what comes "
                "after waits until it returns.",
                called=f"{told(slip.near)}{name}())",
                where=line(slip.place),
                name=name,
            ),
            msg(
                "Pass it by its name, without parentheses: {handed}.",
                handed=f"{told(slip.near)}{name})",
            ),
            place=slip.place,
        )
    return None


def beside(found: Diagnosis, case: Case) -> Diagnosis:
    """The finding of a check, with a slip that may be its cause."""
    for slip in _of_kind(case, "uncalled", "unread", "local"):
        text, help_ = _told(slip)
        cause = sentences(text, found.cause)
        return replace(found, cause=cause, help=help_, place=slip.place)
    for slip in _of_kind(case, "swallows"):
        hides = msg(
            "`{code}`{where} hides every error in {name}().",
            code=told(slip.place.text),
            where=line(slip.place),
            name=told(slip.name),
        )
        cause, help_ = sentences(found.cause, hides), sentences(found.help, NOT_CAUGHT)
        return replace(found, cause=cause, help=help_, place=slip.place)
    return found


def _told(slip: LintFinding) -> tuple[Message, Message]:
    name, near, where = told(slip.name), told(slip.near), line(slip.place)
    if slip.kind == "unread":
        return (
            msg(
                "`self.{name}` is set and never read; what is read is `self.{near}`{where}.",
                name=name,
                near=near,
                where=where,
            ),
            msg("Write self.{near} there, if that is what you mean.", near=near),
        )
    if slip.kind == "local" and near.startswith("self."):
        return (
            msg(
                "`{name}` is a variable of this function and never read; what is read "
                "elsewhere is `{near}`{where}.",
                name=name,
                near=near,
                where=where,
            ),
            msg("Write {near} = ... there.", near=near),
        )
    if slip.kind == "local":
        return (
            msg(
                "`{name}` is set in this function only, and never read; outside there "
                "is another `{name}`{where}.",
                name=name,
                where=where,
            ),
            msg("Write `{near}` as the first line of the function.", near=near),
        )
    text = slip.place.text.lstrip()
    if text.partition(";")[0].rstrip() == slip.name:
        return msg(
            "`{name}` stands there without parentheses, and does nothing{where}.",
            name=name,
            where=where,
        ), msg("Write {name}().", name=name)
    return (
        msg(
            "`{name}` stands there without parentheses: a function itself is always true{where}.",
            name=name,
            where=where,
        ),
        msg("Write {name}().", name=name),
    )


def unsent(case: Case) -> SourceLine | None:
    """Where a request is made that nobody ever sends."""
    return next((slip.place for slip in _of_kind(case, "unsent")), None)
