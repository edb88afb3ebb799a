"""Rules about programs that ended with an error: what Python, a message or a signal says of it."""

from __future__ import annotations

import re
from contextlib import suppress
from signal import Signals

from grader.diagnosis import printed, slips, usual
from grader.diagnosis.case import Case, at, line, told
from grader.diagnosis.diagnosis import Diagnosis
from grader.recording.conduct import Place, Raised
from grader.text import clip

#: What generated messages say of a value that they refuse.
_FIELD = re.compile(r"The '(?P<field>\w{1,60})' field must be (?P<what>[^\n]{1,200})")
_RANGE = re.compile(r"integer in \[(-?\d{1,20}), (-?\d{1,20})\]")
_ENCODING = ("Non-UTF-8 code", "(unicode error)", "codec can't decode")
#: What Python adds to some texts, and what is said in other words here.
_PLACE = re.compile(r" \([^()]*, line \d+\)$")
#: So much of an exception's text is in the cause, which is to be one short sentence [characters].
_LONGEST_ERROR = 120
_NOT_READ = ("SyntaxError", "IndentationError", "TabError")
_NONE = "'NoneType'"
#: For people who do not know the kernel's words.
_SIGNALS = {
    "SIGABRT": "a library gave up on a value that it cannot take",
    "SIGSEGV": "it reached into memory that is not its own",
    "SIGXCPU": "it used more processor time than a run may",
    "SIGXFSZ": "it wrote a larger file than a run may",
    "SIGKILL": "somebody killed it, or it took too much",
}


def unreadable(case: Case) -> Diagnosis | None:
    """Python cannot read the file: its encoding, or its syntax."""
    raised = case.raised
    if raised is None:
        return None
    text = told(raised.text)
    if "null bytes" in text and raised.type in (*_NOT_READ, "ValueError"):
        cause = f"Python cannot read your file{line(raised.place)}: it holds NUL bytes, as text "
        return _saved_wrongly(f"{cause}in UTF-16 does.", raised)
    if raised.type in (*_NOT_READ, "UnicodeDecodeError") and any(e in text for e in _ENCODING):
        if raised.type == "UnicodeDecodeError" and case.conduct.ends:
            return None  # it read something else while it ran
        cause = f"Python cannot read your file{line(raised.place)}: it is not UTF-8 text"
        return _saved_wrongly(f"{cause} ({text}).", raised)
    if raised.type in _NOT_READ:
        text = _PLACE.sub("", text)
        cause = f"Python cannot read your file: {raised.type}: {text}{line(raised.place)}."
        help_ = (
            "Look at that line and the one above it: a bracket, quote or colon that is missing is "
            "noticed only where something else begins."
        )
        if raised.type != "SyntaxError":
            help_ = (
                "Look at the blanks at the beginning of that line and the one above it: what "
                "belongs together begins in the same column, with blanks or with tabs, not both."
            )
        return Diagnosis("unreadable", cause, help_, place=raised.place)
    return None


def _saved_wrongly(cause: str, raised: Raised) -> Diagnosis:
    return Diagnosis(
        "unreadable",
        cause,
        "Save the file as UTF-8: editors have that under 'Save with encoding' or 'Save as'.",
        place=raised.place,
    )


def wrong_value(case: Case) -> Diagnosis | None:
    """It gives a field of a message a value of the wrong type, or out of its range."""
    raised = case.raised
    # a program may have caught the exception, and printed what it says
    found = _FIELD.search(printed.end(case.recording.output) if raised is None else raised.text)
    if found is None:
        return None
    when, place = (None, None) if raised is None else (_when(case, raised), raised.place)
    what, help_ = _wanted(found["field"], told(found["what"]), place)
    cause = f"The field {found['field']} of a message must be {what}; something else was given"
    cause = f"{cause}{at(when)}{line(place)}."
    return Diagnosis("wrong_value", cause, help_, time_s=when, place=place)


def _wanted(field: str, what: str, place: Place | None) -> tuple[str, str]:
    """What a field must be, and how to make it so."""
    text = place.text if place is not None else ""
    literal = re.search(rf"\b{field}\s*=\s*([-+]?\d{{1,20}}(?:\.\d{{0,20}})?)(?![\w.])", text)
    number = literal[1] if literal else ""
    if limits := _RANGE.search(what):
        low, high = limits.groups()
        wrong = f"{number} is not. " if number else ""
        return (
            f"a whole number from {low} to {high}",
            f"{wrong}Give it one from {low} to {high}: min() and max() keep what is calculated "
            "within.",
        )
    if "sequence" in what and "'float'" in what:
        return "a list of floats", "Give it numbers in brackets, as [0.0, 1.5]."
    if "sequence" in what and "'str'" in what:
        return "a list of texts", "Give it texts in brackets, as ['one', 'two']."
    if "'float'" in what:
        instead = f"Write {number}.0 instead of {number}" if number else "Write 2.0 instead of 2"
        return "a float", f"{instead}, and float(...) around what may be an int."
    if "'int'" in what:
        whole = number.partition(".")[0]
        instead = f"Write {whole} instead of {number}" if number else "Write 255 instead of 255.0"
        return "an int", f"{instead}, and int(...) around what is calculated."
    if "sub message" in what:
        kind = re.search(r"'(\w+)'", what)
        name = kind[1] if kind else "message"
        if name in ("Time", "Duration"):
            return f"a {name} message", "Write .to_msg() behind it: a clock's now().to_msg()."
        return f"a {name}", f"Set the parts of {field} one by one, as in msg.{field}.x = 2.0."
    return what.rstrip("."), "`ros2 interface show TYPE` lists the fields of a message."


def ended_itself(case: Case) -> Diagnosis | None:
    """It left by sys.exit() with a text or a number."""
    if case.run.outcome != "crashed":
        return None
    raised = case.raised
    help_ = (
        "Look for sys.exit(), exit() or a return code of main(): a node that is to go on stays in "
        "rclpy.spin(node)."
    )
    if raised is not None and raised.type == "SystemExit":
        when = _when(case, raised)
        said = told(raised.text)
        value = said if said.isdecimal() else repr(said)
        cause = f"Your program ended itself{at(when)} by sys.exit({value}){line(raised.place)}."
        return Diagnosis("ended_itself", cause, help_, time_s=when, place=raised.place)
    if raised is not None:
        return None
    last = printed.last_line(case.recording.output)
    said = f"; the last that it printed is: {told(last)!r}" if last else ""
    cause = f"Your program ended with exit code {case.run.exit_code}, by no exception{said}."
    return Diagnosis("ended_itself", cause, help_)


def crashed(case: Case) -> Diagnosis | None:
    """An exception that nobody caught."""
    raised = case.raised
    if case.run.outcome != "crashed" or raised is None:
        return None
    when = _when(case, raised)
    said = slips.explains(case, raised) or usual.known(raised)
    place = said.place if said is not None and said.place is not None else raised.place
    at_line = place if said is not None and said.text else raised.place
    cause = f"Your node crashed{at(when)}{_error(raised, said)}{line(at_line)}.{_limit(case)}"
    return Diagnosis("crashed", cause, _mending(raised, said), time_s=when, place=place)


def thread_crashed(case: Case) -> Diagnosis | None:
    """An exception ended one of its threads, and the rest went on."""
    raised = case.raised or printed.in_thread(case.recording.output)
    if raised is None or case.raised is not None or raised.place is None:
        return None  # without a place: libraries' threads when the program ends
    said = usual.known(raised)
    cause = f"A thread of your program crashed{_error(raised, said)}{line(raised.place)}."
    return Diagnosis("crashed", cause, _mending(raised, said), place=raised.place)


def misses_message(case: Case) -> bool:
    """Whether it crashed because something was not there yet, as what a message brings."""
    raised = case.raised
    return raised is not None and (
        _NONE in raised.text
        or "NoneType" in raised.text
        or (raised.type == "AttributeError" and "has no attribute" in raised.text)
    )


def _error(raised: Raised, said: usual.Said | None) -> str:
    """': TypeError: what it says', or ' (TypeError): ' and what we say instead."""
    name, text = told(raised.type).rpartition(".")[2], told(raised.text).rstrip(".")
    if said is not None and said.text:
        return f" ({name}): {clip(said.text, _LONGEST_ERROR)}"
    text = clip(text, _LONGEST_ERROR)
    return f": {name}: {text}" if text else f": {name}"


def _mending(raised: Raised, said: usual.Said | None) -> str:
    whole = "The whole traceback is in output.txt."
    help_ = said.help if said is not None else usual.meaning(raised)
    if not help_ and raised.place is None:
        help_ = "None of its lines is in your own files."
    return f"{help_} {whole}".strip()


def killed(case: Case) -> Diagnosis | None:
    """A signal ended it: from itself, from a library, from the kernel."""
    run = case.run
    if run.outcome != "killed":
        return None
    raised = case.raised
    name = told(raised.type) if raised is not None else _signal(run.exit_code)
    when = None if raised is None else _when(case, raised)
    place = None if raised is None else raised.place
    why = _SIGNALS.get(name, "")
    cause = (
        f"Your program was killed{at(when)}{f' by the signal {name}' if name else ''}{line(place)}"
    )
    cause += f": {why}." if why else "."
    return Diagnosis("killed", f"{cause}{_limit(case)}", _after(name), time_s=when, place=place)


def _signal(exit_code: int | None) -> str:
    """By its name; '' where the grader itself ended the program."""
    if exit_code is None:
        return ""
    with suppress(ValueError):
        return Signals(-exit_code).name
    return str(-exit_code)


def _after(signal: str) -> str:
    if signal == "SIGABRT":
        return (
            "Look at the values that this line gives to a message: 2.0 for a float, 255 for an "
            "int, and nothing beyond the range of its type."
        )
    if signal in ("SIGKILL", "SIGTERM"):
        return "Look for os.kill() and for lists that grow without end; output.txt may tell more."
    return "output.txt may tell more, and the remarks on the run below."


def _limit(case: Case) -> str:
    """A sentence of the run's remarks on what it was refused; '' for none."""
    for flag in case.run.flags:
        if flag.startswith("the node ended with "):
            return f" {told(flag.partition(': ')[2]).capitalize()}."
        if case.run.outcome == "killed" and flag.startswith("the node "):
            return f" {told(flag).capitalize()}."
    return ""


def _when(case: Case, raised: Raised) -> float | None:
    return raised.time_s if case.knows_when and raised is case.conduct.raised else None
