"""Rules about exceptions that the program caught, so that nobody has heard of them."""

from __future__ import annotations

from grader.diagnosis.case import Case, after, function, line, sentences, told
from grader.diagnosis.diagnosis import Diagnosis
from grader.diagnosis.usual import known, meaning
from grader.language.phrase import Phrase, joined, say
from grader.recording.conduct import Caught, Raised

#: A program that ends so soon after an exception has ended by it [s].
_SOON_S = 1.0
#: Exceptions that no program counts on.
_MISTAKES = frozenset(
    (
        *("NameError", "UnboundLocalError", "AttributeError", "TypeError", "AssertionError"),
        *("ZeroDivisionError", "ImportError", "ModuleNotFoundError"),
    )
)
#: How an `except` begins that catches all there is.
_ALL = ("except:", "except Exception", "except BaseException", "except (Exception")
#: What is None until the first message has come is gone after so many times.
_OFTEN = 8
_NOT_CAUGHT = say("Without the try/except Python would say so itself.")


def ended_by_caught(case: Case) -> Diagnosis | None:
    """It came to its end by an exception that it caught itself."""
    ended_s = case.ended_s
    if ended_s is None or case.conduct.raised is not None:
        return None
    for caught in case.conduct.caught:
        if caught.by is None and 0 <= ended_s - caught.time_s <= _SOON_S:
            cause = say(
                "Your program caught an exception, and so ended {after}: {error}{where}.",
                after=after(ended_s),
                error=_error(caught),
                where=line(caught.place),
            )
            return Diagnosis(
                "ended_by_caught", cause, _mending(caught), time_s=ended_s, place=caught.place
            )
    return None


def hides_errors(case: Case) -> Diagnosis | None:
    """A callback fails again and again, and an `except` keeps that to itself."""
    for caught in case.conduct.caught:
        if not _is_mistake(caught):
            continue
        who = function(caught.place) or say("A callback")
        hides = say("something in your program catches that and goes on")
        if caught.by is not None:
            hides = say(
                "`{code}` (line {line}) hides it", code=told(caught.by.text), line=caught.by.line
            )
        cause = say(
            "{who} fails, and {hides}: {error}{where}.",
            who=who,
            hides=hides,
            error=_error(caught),
            where=line(caught.place),
        )
        return Diagnosis("hides_errors", cause, _mending(caught), place=caught.place)
    return None


def _is_mistake(caught: Caught) -> bool:
    if caught.by is None and caught.times < 2:
        return False
    if "NoneType" in caught.text and caught.times < _OFTEN:
        return False
    catches_all = caught.by is not None and caught.by.text.startswith(_ALL)
    return caught.type in _MISTAKES or catches_all


def _raised(caught: Caught) -> Raised:
    return Raised(caught.type, caught.text, caught.time_s, caught.place)


def _error(caught: Caught) -> str:
    said = known(_raised(caught))
    text = said.text if said is not None and said.text else Phrase(told(caught.text).rstrip("."))
    return joined([told(caught.type), text] if text else [told(caught.type)], ": ")


def _mending(caught: Caught) -> str:
    said = known(_raised(caught))
    help_ = said.help if said is not None else meaning(_raised(caught))
    return sentences(help_, _NOT_CAUGHT)
