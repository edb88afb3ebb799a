"""Explains exceptions where the source shows more than their text.

A lint finding by itself is not reported: it may be meant. `docs/lint-findings.md` describes each
kind. Rules yield what they find; the first of all counts.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import chain
from typing import Any

from grader.recording import readable
from grader.recording.observations import LintFinding, Raised
from grader.text import NOTHING, Message, msg, shown
from grader_diagnosis import known_exceptions
from grader_diagnosis.case import Case, filled, function, of_kind, words_of
from grader_diagnosis.known_exceptions import Hint
from grader_diagnosis.lint_findings import in_other_order
from grader_diagnosis.misspelling import misspelt

#: So much of an exception's text is searched [characters].
_LONGEST = 1000
_GIVEN = re.compile(r"(\w{1,60})\(\) takes (\d{1,3}) positional arguments? but (\d{1,3}) w")
_VARIABLE = re.compile(r"variable '(\w{1,60})'")
_NO_FIELD = re.compile(r"(?:has no attribute '|passed to constructor: )(\w{1,60})")
_NO_ATTRIBUTE = re.compile(r"has no attribute '(\w{1,60})'")
_OF_A_SERVICE = re.compile(r"(\w{1,60})(?:\.__init__)?\(\) (?:got an unexpected k|takes no arg)")
#: What an exception shows not to have been begun -> what the source lacks.
_BEGINNINGS: dict[Message, tuple[str, ...]] = {
    known_exceptions.NO_INIT: ("no_init",),
    known_exceptions.NO_NODE: ("no_super",),
}
#: What is asked for an entry, and for which.
_ASKED = re.compile(r"\b([A-Za-z_][\w.]{0,60})\[([^\[\]]{1,60})\]")
_PRINTED = re.compile(r"print\(([\w.]{1,60})\)$")
_NO_INSTANCE = "Service classes can not be instantiated"


def explain(case: Case, raised: Raised) -> Hint:
    """Explain an exception by what the source or the scene shows, or else by its text."""
    found = next(chain.from_iterable(rule(case, raised) for rule in _RULES), None)
    return found or known_exceptions.explain(raised)


def _hint(finding: LintFinding, help_: Message, text: Message = NOTHING, **words: Any) -> Hint:
    """Return a hint to the place of a finding; its sentences may have the words of that."""
    words = words_of(finding) | words
    return Hint(filled(help_, words), filled(text, words), finding.place)


def _not_global(case: Case, raised: Raised) -> Iterator[Hint]:
    found = _VARIABLE.search(raised.text[:_LONGEST])
    if raised.type != "UnboundLocalError" or found is None:
        return
    for finding in of_kind(case, "global"):
        if finding.name == found[1]:
            is_of_module = finding.near.startswith("global")
            hint = _hint(
                finding,
                msg(
                    "Write `{word}` as the first line of {here}: without it that is another"
                    " variable, which has no value yet."
                ),
                msg("`{name}` is assigned {outside} (line {line}) and in {here}: add `{word}`"),
                outside=msg("at the top of the file") if is_of_module else msg("outside"),
                line=finding.place.line,
                here=Message.of(function(raised.place)) or msg("this function"),
                word=shown(finding.near),
            )
            yield replace(hint, place=None)


def _without_self(case: Case, raised: Raised) -> Iterator[Hint]:
    found = _GIVEN.search(raised.text[:_LONGEST])
    if raised.type != "TypeError" or found is None or int(found[3]) != int(found[2]) + 1:
        return
    for finding in of_kind(case, "without_self"):
        if finding.name == found[1]:
            before, _, rest = shown(finding.place.text).partition("(")
            rest = rest.lstrip()
            comma = "" if rest.startswith(")") else ", "
            help_ = msg("A method takes self before all else: write `{written}`.")
            yield _hint(finding, help_, written=f"{before}(self{comma}{rest}")


def _in_other_order(case: Case, raised: Raised) -> Iterator[Hint]:
    """An exception in a function that is given two arguments each in the other's place."""
    for finding in of_kind(case, "swapped"):
        if function(raised.place) == f"{finding.name}()":
            what, help_ = in_other_order(finding)
            yield Hint(help_, what, finding.place)


def _misplaced(case: Case, raised: Raised) -> Iterator[Hint]:
    """A method whose def is indented too far, or not far enough."""
    found = _NO_ATTRIBUTE.search(raised.text[:_LONGEST])
    for finding in of_kind(case, "misplaced"):
        if found is not None and finding.name == found[1]:
            how = msg("too little: it is outside of the class")
            if finding.near:
                how = msg("too far: it is inside {outer}()", outer=shown(finding.near))
            yield _hint(
                finding,
                msg(
                    "Begin it in the column of the other defs of the class, and move all its lines."
                ),
                msg("`def {name}` is indented {how}"),
                how=how,
            )


def _lacks_entry(case: Case, raised: Raised) -> Iterator[Hint]:
    """A dict or a list that lacks what it is asked for, where the source shows what it has."""
    found = _ASKED.findall(raised.place.text) if raised.place is not None else []
    asked = {of.rpartition(".")[2]: index for of, index in found}
    is_index = raised.type == "IndexError" and "index out of range" in raised.text
    for finding in of_kind(case, "holds") if is_index or raised.type == "KeyError" else ():
        if (index := asked.get(finding.name.rpartition(".")[2])) is None:
            continue
        is_text = f"'{raised.text}'" in finding.near.split(", ")
        help_ = msg("Ask for one of these, with quotes or without as there, or add {key}{where}.")
        text = msg("{name} has no entry {key}; it has: {has}")
        if is_index:
            help_ = msg("Indexes begin at 0: if you count from 1, write {name}[{index} - 1].")
            text = msg("{name} has the indexes {has}, and `{index}` is another")
        elif is_text:
            help_ = msg("Write {key}: instead of '{key}': there, and so on.")
            text = msg("{name} has the text '{key}', and is asked for the number {key}")
        words = {"has": shown(finding.near), "index": shown(index), "key": shown(raised.text)}
        hint = _hint(finding, help_, text, **words)
        yield hint if is_text and not is_index else replace(hint, place=None)


def _is_zero(case: Case, raised: Raised) -> Iterator[Hint]:
    """A division by what begins with 0."""
    place = raised.place
    for finding in of_kind(case, "zero") if raised.type == "ZeroDivisionError" else ():
        if place is not None and re.search(rf"[/%] *{re.escape(finding.name)}\b", place.text):
            yield _hint(
                finding,
                msg("Let it begin with another number: {name} = {other}."),
                msg("line {line} divides by {name}, which begins with {number}"),
                line=place.line,
                number=shown(finding.near),
                other="0.1" if "." in finding.near else "1",
            )


def _ends(case: Case, raised: Raised) -> Iterator[Hint]:
    """A next() of a generator that has given all."""
    found = [*of_kind(case, "ends")] if raised.type == "StopIteration" else []
    if len(found) == 1 and raised.place is not None:
        yield _hint(
            found[0],
            msg("Let {name}() go on: while True:, a longer range(), itertools.count()."),
            msg("next() in line {line} finds nothing more: {name}() has come to its end"),
            line=raised.place.line,
        )


def _misnamed(case: Case, raised: Raised) -> Iterator[Hint]:
    """A method that has nearly the name of the one that Python looks for."""
    is_init = "__init__() missing" in raised.text and "'node_name'" in raised.text
    for finding in of_kind(case, "misnamed"):
        if raised.type == "NotImplementedError" or (is_init and finding.near == "__init__"):
            yield _hint(
                finding,
                msg("Write def {near}(...) there."),
                msg("{name}() is not called: Python looks for {near}()"),
            )


def _hidden_method(case: Case, raised: Raised) -> Iterator[Hint]:
    if "object is not callable" not in raised.text[:_LONGEST] or raised.place is None:
        return
    for finding in of_kind(case, "method"):
        if f"self.{shown(finding.name)}(" in raised.place.text:
            help_ = msg(
                "self.{name} is set to something else{where}, and that hides the method "
                "{name}(): give one of them another name."
            )
            yield replace(_hint(finding, help_), place=None)


def _class_given(case: Case, raised: Raised) -> Iterator[Hint]:
    place = raised.place
    for finding in of_kind(case, "class"):
        if place is not None and ("spin" in place.text or place.line == finding.place.line):
            call, name = shown(finding.near), shown(finding.name)
            yield Hint(
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


def _service_for_request(case: Case, raised: Raised) -> Iterator[Hint]:
    services = {each.type.rpartition("/")[2] for each in case.scene_has if each.kind == "service"}
    services |= {end.type.rpartition("/")[2] for end in case.ends if end.kind == "client"}
    text = raised.text[:_LONGEST]
    found = _OF_A_SERVICE.search(text)
    name = found[1] if found else ""
    if _NO_INSTANCE in text and raised.place is not None:
        calls = re.findall(r"(\w{1,60})\(", raised.place.text)
        name = next((each for each in calls if each in services), "")
    if name in services:
        help_ = msg("Write {name}.Request(...) there: that is what a request is made of.")
        what = msg("{name} is the service, not a request to it")
        yield Hint(help_.given(name=shown(name)), what.given(name=shown(name)))


def _misspelt_field(case: Case, raised: Raised) -> Iterator[Hint]:
    """A field of an interface of the hand-in's, with the name that it has there."""
    found = _NO_FIELD.search(raised.text[:_LONGEST])
    for name, text in case.recording.interfaces.texts.items() if found is not None else ():
        for field in (each.name for each in readable(text) if each.value is None):
            if found is not None and field != found[1] and misspelt(field, found[1]):
                words = {"field": field, "name": shown(found[1]), "type": name}
                yield Hint(
                    msg("Write {field} there.", field=field),
                    msg("{type} has no field {name}; it has {field}", **words),
                )


def _misspelt(case: Case, raised: Raised) -> Iterator[Hint]:
    """An attribute that is set under another name, or nowhere."""
    found = _NO_ATTRIBUTE.search(raised.text[:_LONGEST])
    if found is None or raised.place is None or f".{found[1]}" not in raised.place.text:
        return
    name = shown(found[1])
    for finding in of_kind(case, "local"):
        if finding.name == found[1] and finding.near == f"self.{found[1]}":
            yield _hint(
                finding,
                msg("Write self.{name} = ... there."),
                msg("`{name}` is a variable of that function; self.{name} is never set"),
            )
    for finding in of_kind(case, "never_read"):
        if misspelt(finding.name, found[1]):
            yield _hint(
                finding,
                msg("Write self.{name} there, or the other name here."),
                msg(
                    "self.{name} has no value: what is set is self.{other}, which is never read; "
                    "compare the names"
                ),
                name=name,
                other=shown(finding.name),
            )
    for finding in of_kind(case, "never_set"):
        if finding.name == found[1] and "__init__" in finding.place.text:
            yield _hint(
                finding,
                msg("Write self.{name} = ... in __init__, or compare the name."),
                msg("self.{name} has no value when that line runs: nothing has set it by then"),
            )


def _wrong_callback(case: Case, raised: Raised) -> Iterator[Hint]:
    """A callback whose own line has to change."""
    text = raised.text[:_LONGEST]
    wrong = [*of_kind(case, "no_message", "without_self")]
    for finding in wrong if "callback should be" in text else ():
        if len(wrong) == 1 or raised.place is None or finding.name in raised.place.text:
            yield _hint(
                finding,
                msg(
                    "A method takes self before all else, and a callback of a subscription the "
                    "message: def {name}(self, pose)."
                ),
                msg("{name}(), the callback of a subscription, takes no message"),
            )
    missing = known_exceptions.MISSING.search(text)
    if missing is None:
        return
    for finding in of_kind(case, "entry") if missing[1] == "main" else ():
        takes = shown(finding.near)
        with_none = ", ".join(f"{each}=None" for each in takes.split(", "))
        yield Hint(
            msg("Write `def main({takes}):` there.", takes=with_none),
            msg("main() is called with nothing, and takes ({takes})", takes=takes),
            finding.place,
        )
    for finding in sorted(of_kind(case, "message_for_timer"), key=lambda each: not each.near):
        if missing[1] != finding.name:
            continue
        if finding.near:
            yield _hint(
                finding,
                msg("Give create_timer() the function that is to be called by it."),
                msg("{name}() is the callback of your subscription, not of a timer"),
            )
        yield _hint(
            finding,
            msg("Write def {name}(self): a timer is given nothing but self."),
            msg("{name}(), the callback of a timer, takes too much"),
        )


def _called_callback(case: Case, raised: Raised) -> Iterator[Hint]:
    for finding in of_kind(case, "called_callback"):
        at = raised.place
        is_in_it = function(at) == f"{finding.name}()" and case.observed.spun_s is None
        if is_in_it or (at is not None and at.line == finding.place.line):
            text = msg("{name}() is called at once, where it is to be passed")
            yield _hint(finding, known_exceptions.NOT_CALLED, text)


def _hidden_class(case: Case, raised: Raised) -> Iterator[Hint]:
    for finding in of_kind(case, "hides_class"):
        if f"'{finding.name}' object is not callable" in raised.text[:_LONGEST]:
            yield _hint(
                finding,
                msg("Give what you make there another name, as message = {name}()."),
                msg("`{name}` is the class no more: that name was given to something"),
            )


def _class_kept(case: Case, raised: Raised) -> Iterator[Hint]:
    is_sent = raised.place is not None and re.search(
        r"\.(?:call|call_async|publish)\(", raised.place.text
    )
    is_class = "'property' object" in raised.text or "'getset_descriptor' object" in raised.text
    if is_class or (is_sent and raised.type == "TypeError"):
        for finding in of_kind(case, "class_kept"):
            yield _hint(
                finding,
                msg("The parentheses are missing: write {name}() there."),
                msg("{name} without parentheses is the class, not a message"),
            )


def _not_begun(case: Case, raised: Raised) -> Iterator[Hint]:
    """ROS or a node that was not begun: the line to change is where that should have been."""
    known = known_exceptions.explain(raised)
    for finding in of_kind(case, *_BEGINNINGS.get(known.text, ())):
        yield replace(known, place=finding.place)


def _calls_itself(case: Case, raised: Raised) -> Iterator[Hint]:
    for finding in of_kind(case, "calls_itself") if raised.type == "RecursionError" else ():
        help_ = msg("Leave that call out, and let a timer call {name}().")
        if finding.near:
            help_ = msg("Write {again} instead: its timer then calls you again.")
        if finding.near == "ros":
            help_ = msg("Leave that call out: ROS calls {name}() again and again by itself.")
        text = msg("{name}() calls itself without end")
        yield _hint(finding, help_, text, again=shown(finding.near))


def _none_for_a_value(case: Case, raised: Raised) -> Iterator[Hint]:
    """None: of a shutdown before, of a variable that another hides, of a missing return."""
    if "NoneType" not in raised.text or raised.place is None:
        return
    for finding in of_kind(case, "ends_before_spin"):
        if "spin" in raised.place.text and finding.place.line < raised.place.line:
            yield _hint(
                finding,
                msg("Move {name}() to the end of main()."),
                msg("ROS is shut down before that line spins"),
            )
    for finding in of_kind(case, "local"):
        if finding.name in raised.place.text and not finding.near.startswith("self."):
            yield _hint(
                finding,
                msg("Write `{near}` as the first line of the function."),
                msg("`{name}` is still None: what is set is another one, of that function"),
            )
    for finding in of_kind(case, "no_return"):
        names = rf"\b(?:{re.escape(finding.name)}|{re.escape(finding.near)})\b"
        if re.search(names, raised.place.text):
            name = shown(finding.near)
            printed = _PRINTED.match(finding.place.text)
            text = msg("{name}() returns nothing, that is None", name=name)
            help_ = msg("End {name}() with `return` and its result.", name=name)
            if printed is not None:
                text = msg("{name}() prints its result and returns None", name=name)
                help_ = msg("Write `return {result}` there.", result=shown(printed[1]))
            yield Hint(help_, text, finding.place)
    for finding in of_kind(case, "no_effect"):
        yield _hint(
            finding,
            msg("Write return before it, if that is what you mean."),
            msg("a function returned None; nothing uses what `{code}` is"),
            code=shown(finding.name),
        )


_RULES: tuple[Callable[[Case, Raised], Iterator[Hint]], ...] = (
    *(_called_callback, _misnamed, _not_global, _without_self, _hidden_method, _class_given),
    *(_service_for_request, _hidden_class, _misplaced, _misspelt_field, _misspelt),
    *(_wrong_callback, _class_kept),
    *(_not_begun, _calls_itself, _none_for_a_value, _lacks_entry, _is_zero, _ends),
    _in_other_order,
)
