"""Rules about lint findings: where one explains an exception, or a check that lost points.

A lint finding by itself is not reported: it may be meant. `LintFinding` describes each kind.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import replace

from grader.diagnosis.case import Case, excerpt, function, line, sentences
from grader.diagnosis.diagnosis import Diagnosis
from grader.diagnosis.known_exceptions import Hint
from grader.diagnosis.standstill import never_spins
from grader.diagnosis.unnoticed import NOT_CAUGHT
from grader.message import Message, as_message, msg
from grader.recording.observations import LintFinding, LintKind, Raised, SourceLine

#: So much of an exception's text is searched [characters].
_LONGEST = 1000
_GIVEN = re.compile(r"(\w{1,60})\(\) takes (\d{1,3}) positional arguments? but (\d{1,3}) w")
_VARIABLE = re.compile(r"variable '(\w{1,60})'")
_OF_A_SERVICE = re.compile(r"(\w{1,60})(?:\.__init__)?\(\) (?:got an unexpected k|takes no arg)")
_NO_INSTANCE = "Service classes can not be instantiated"


def explain(case: Case, raised: Raised) -> Hint | None:
    """Explain an exception where the source or the scene shows more than its text."""
    return next((hint for rule in _RULES if (hint := rule(case, raised)) is not None), None)


def _of_kind(case: Case, *kinds: LintKind) -> Iterator[LintFinding]:
    return (finding for finding in case.observed.lint_findings if finding.kind in kinds)


def _not_global(case: Case, raised: Raised) -> Hint | None:
    found = _VARIABLE.search(raised.text[:_LONGEST])
    if raised.type != "UnboundLocalError" or found is None:
        return None
    for finding in _of_kind(case, "global"):
        if finding.name == found[1]:
            word = excerpt(finding.near)
            outside = msg("outside")
            if word.startswith("global"):
                outside = msg("at the top of the file")
            here = as_message(function(raised.place)) or msg("this function")
            return Hint(
                msg(
                    "Write `{word}` as the first line of {here}: without it that is another"
                    " variable, which has no value yet.",
                    word=word,
                    here=here,
                ),
                msg(
                    "`{name}` is assigned {outside} (line {line}) and in {here}: add `{word}`",
                    name=excerpt(finding.name),
                    outside=outside,
                    line=finding.place.line,
                    here=here,
                    word=word,
                ),
            )
    return None


def _without_self(case: Case, raised: Raised) -> Hint | None:
    found = _GIVEN.search(raised.text[:_LONGEST])
    if raised.type != "TypeError" or found is None or int(found[3]) != int(found[2]) + 1:
        return None
    for finding in _of_kind(case, "without_self"):
        if finding.name == found[1]:
            written = excerpt(finding.place.text)
            rest = written.partition("(")[2].lstrip()
            comma = "" if rest.startswith(")") else ", "
            return Hint(
                msg(
                    "A method takes self before all else: write `{written}`.",
                    written=f"{written.partition('(')[0]}(self{comma}{rest}",
                ),
                place=finding.place,
            )
    return None


def _hidden_method(case: Case, raised: Raised) -> Hint | None:
    if "object is not callable" not in raised.text[:_LONGEST] or raised.place is None:
        return None
    for finding in _of_kind(case, "method"):
        name = excerpt(finding.name)
        if f"self.{name}(" in raised.place.text:
            return Hint(
                msg(
                    "self.{name} is set to something else{where}, and that hides the method "
                    "{name}(): give one of them another name.",
                    name=name,
                    where=line(finding.place),
                )
            )
    return None


def _class_given(case: Case, raised: Raised) -> Hint | None:
    place = raised.place
    for finding in _of_kind(case, "class"):
        if place is not None and ("spin" in place.text or place.line == finding.place.line):
            call, name = excerpt(finding.near), excerpt(finding.name)
            return Hint(
                msg(
                    "The parentheses are missing: node = {name}(), then {call}(node).",
                    name=name,
                    call=call,
                ),
                msg(
                    "{call} was given a class, not a node that was made of it",
                    call=call.rpartition(".")[2],
                ),
                finding.place,
            )
    return None


def _service_for_request(case: Case, raised: Raised) -> Hint | None:
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
    return Hint(
        msg(
            "Write {name}.Request(...) there: that is what a request is made of.",
            name=excerpt(name),
        ),
        msg("{name} is the service, not a request to it", name=excerpt(name)),
    )


_RULES: tuple[Callable[[Case, Raised], Hint | None], ...] = (
    *(_not_global, _without_self, _hidden_method, _class_given, _service_for_request),
)


def called_at_once(case: Case) -> Diagnosis | None:
    """A function that was to run in a thread runs in the main program, which gets no further."""
    for finding in _of_kind(case, "called"):
        if never_spins(case) is None and case.observed.spun_s is not None:
            continue
        name = excerpt(finding.name)
        return Diagnosis(
            "called_at_once",
            msg(
                "{called}{where} calls {name}() at once, in the main program, and what comes "
                "after waits until it returns.",
                called=f"{excerpt(finding.near)}{name}())",
                where=line(finding.place),
                name=name,
            ),
            msg(
                "Pass it by its name, without parentheses: {handed}.",
                handed=f"{excerpt(finding.near)}{name})",
            ),
            place=finding.place,
        )
    return None


def beside(found: Diagnosis, case: Case) -> Diagnosis:
    """Add to a check's finding the lint finding that may be its cause."""
    for finding in _of_kind(case, "uncalled", "unread", "local"):
        text, help_ = _cause_and_help(finding)
        cause = sentences(text, found.cause)
        return replace(found, cause=cause, help=help_, place=finding.place)
    for finding in _of_kind(case, "swallows"):
        hides = msg(
            "`{code}`{where} hides every error in {name}().",
            code=excerpt(finding.place.text),
            where=line(finding.place),
            name=excerpt(finding.name),
        )
        cause, help_ = sentences(found.cause, hides), sentences(found.help, NOT_CAUGHT)
        return replace(found, cause=cause, help=help_, place=finding.place)
    return found


def _cause_and_help(finding: LintFinding) -> tuple[Message, Message]:
    name, near, where = excerpt(finding.name), excerpt(finding.near), line(finding.place)
    if finding.kind == "unread":
        return (
            msg(
                "`self.{name}` is set and never read; what is read is `self.{near}`{where}.",
                name=name,
                near=near,
                where=where,
            ),
            msg("Write self.{near} there, if that is what you mean.", near=near),
        )
    if finding.kind == "local" and near.startswith("self."):
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
    if finding.kind == "local":
        return (
            msg(
                "`{name}` is set in this function only, and never read; outside there "
                "is another `{name}`{where}.",
                name=name,
                where=where,
            ),
            msg("Write `{near}` as the first line of the function.", near=near),
        )
    text = finding.place.text.lstrip()
    if text.partition(";")[0].rstrip() == finding.name:
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
    """Return where a request is made that is never sent."""
    return next((finding.place for finding in _of_kind(case, "unsent")), None)
