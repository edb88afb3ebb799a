"""Rules about programs that ended with an error: an exception, a refused value, a signal."""

from __future__ import annotations

import re
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from signal import Signals

from grader.exercise import Diagnosis
from grader.recording.observations import Raised, SourceLine, last_exception
from grader.text import NOTHING, Message, clip, msg, shown
from grader_diagnosis import lint_findings, lint_hints
from grader_diagnosis.case import Case, diagnosed, line, of_kind, sentences
from grader_diagnosis.known_exceptions import Hint

#: The error of a generated message class that refuses a value.
_FIELD = re.compile(r"The '(?P<field>\w{1,60})' field must be (?P<what>[^\n]{1,200})")
_RANGE = re.compile(r"integer in \[(-?\d{1,20}), (-?\d{1,20})\]")
_ENCODING = ("Non-UTF-8 code", "(unicode error)", "codec can't decode")
#: As far as the line that begins with the exception's name.
_IN_THREAD = re.compile(
    r"^(?:Exception in thread [^\n]{0,200}:|[^\n]{0,200}: Error raised in [^\n]{0,400})\n"
    r"(Traceback [^\n]*\n(?:[ \t][^\n]*\n)+[^\n]*)",
    re.MULTILINE,
)
#: Python's suffix to some errors; the cause has the place in words of its own.
_PLACE = re.compile(r" \([^()]*, line \d+\)$")
#: So much of an exception's text is in the cause, which is to be one short sentence [characters].
_LONGEST_ERROR = 120
#: What the error or its line shows -> what to do.
_NOT_PYTHON = {
    r"invalid character '[\u2018-\u201f\u00ab\u00bb]": msg(
        "These quotes are typographic, as a word processor writes them: type \" or ' instead."
    ),
    r"\n.*\belse if\b": msg("Python's word is elif: write elif CONDITION:"),
    r"\n.*(?:&&|\|\|)": msg("In Python && is `and`, || is `or`, and ! is `not`."),
    r"leading zeros in decimal integer": msg(
        "A number has a point, not a comma: 0.01. And it does not begin with 0 otherwise."
    ),
    r"Maybe you meant '=='": msg("Compare by ==; a single = assigns a value."),
    r"expected ':'": msg(
        "A line that begins a block ends with a colon: write it at the end of that line."
    ),
    r"'[(\[{]' was never closed": msg(
        "A bracket is not closed: count those of that line, and add the one that is missing."
    ),
}
_COLOURS = ("r", "g", "b")
_NOT_READ = ("SyntaxError", "IndentationError", "TabError")
#: For people who do not know the kernel's words.
_SIGNALS = {
    "SIGABRT": msg("a library gave up on a value that it cannot take"),
    "SIGSEGV": msg("it reached into memory that is not its own"),
    "SIGXCPU": msg("it used more processor time than a run may"),
    "SIGXFSZ": msg("it wrote a larger file than a run may"),
    "SIGKILL": msg("somebody killed it, or it took too much"),
}


def unreadable(case: Case) -> Diagnosis | None:
    """Python cannot read the file: its encoding or its syntax is wrong."""
    raised = case.raised
    if raised is None:
        return None
    text = shown(raised.text)
    help_ = msg(
        "Save the file as UTF-8: editors have that under 'Save with encoding' or 'Save as'."
    )
    if "null bytes" in text and raised.type in (*_NOT_READ, "ValueError"):
        cause = msg(
            "Python cannot read your file{where}: it holds NUL bytes, as text in UTF-16 does."
        )
    elif raised.type in (*_NOT_READ, "UnicodeDecodeError") and any(e in text for e in _ENCODING):
        if raised.type == "UnicodeDecodeError" and case.observed.ends:
            return None  # it read something else while it ran
        cause = msg("Python cannot read your file{where}: it is not UTF-8 text ({text}).")
    elif raised.type in _NOT_READ:
        cause = msg("Python cannot read your file: {type}: {text}{where}.")
        cause = cause.given(text=_PLACE.sub("", text))
        help_ = msg(
            "Look at that line and the one above it: a bracket, quote or colon that"
            " is missing is noticed only where something else begins."
        )
        whole = f"{text}\n{raised.place.text if raised.place is not None else ''}"
        fitting = (advice for sign, advice in _NOT_PYTHON.items() if re.search(sign, whole))
        help_ = next(fitting, help_)
        if raised.type != "SyntaxError":
            help_ = msg(
                "Look at the spaces at the beginning of that line and the one above it: lines "
                "of one block begin in the same column, with spaces or with tabs, not both."
            )
    else:
        return None
    return diagnosed("unreadable", cause, help_, raised.place, type=raised.type, text=text)


def wrong_value(case: Case) -> Diagnosis | None:
    """The program gives a field of a message a value of the wrong type, or out of its range."""
    raised = case.raised
    # a program may have caught the exception, and printed its text
    found = _FIELD.search(case.tail if raised is None else raised.text)
    if found is None:
        return None
    when, place = (None, None) if raised is None else (_when(case, raised), raised.place)
    given = lint_findings.given_at(case, found["field"], _fitting(found["what"]))
    place = given.place if given is not None else place
    number = given.near if given is not None else ""
    what, help_ = _wanted(found["field"], shown(found["what"]), place, number)
    for finding in of_kind(case, "comma"):
        if place is not None and re.search(rf"\b{re.escape(finding.name)}\b", place.text):
            place = finding.place
            help_ = msg("Leave out the comma at its end: it makes a tuple of the number.")
            break
    if place is not None and re.search(r"\b(?:np|numpy)\.", place.text):
        help_ = msg("A number of numpy is none of Python: write float(...) or int(...) around it.")
    cause = msg(
        "The field {field} of a message must be {what}; something else was given{at}{where}."
    )
    field = shown(found["field"])
    return diagnosed("wrong_value", cause, help_, place, when, field=field, what=what)


def _fitting(what: str) -> Callable[[str], bool]:
    """Return whether a number, as it is written, may be what a field must be."""
    if limits := _RANGE.search(what):
        low, high = float(limits[1]), float(limits[2])
        return lambda text: low <= lint_findings.number(text) <= high
    if "'float'" in what:
        return lambda text: "." in text or "e" in text
    if "'int'" in what:
        return lambda text: "." not in text
    return lambda _: True


def _wanted(
    field: str, what: str, place: SourceLine | None, number: str
) -> tuple[Message, Message]:
    """Return what a field must be, and how to write it; `number`: that it was given, or ''."""
    text = place.text if place is not None else ""
    literal = re.search(rf"\b{field}\s*=\s*([-+]?\d{{1,20}}(?:\.\d{{0,20}})?)(?![\w.])", text)
    number = literal[1] if literal else shown(number)
    if (size := re.search(r"sequence with length (?:<= )?(\d{1,9})", what)) is not None:
        is_most = "<=" in size[0]
        listed = msg("a list of at most {n} values") if is_most else msg("a list of {n} values")
        return listed.given(n=size[1]), msg("Look at how many there are, and at each of them.")
    if limits := _RANGE.search(what):
        low, high = limits.groups()
        return (
            msg("a whole number from {low} to {high}", low=low, high=high),
            sentences(
                msg("{number} is not.", number=number) if number else NOTHING,
                msg(
                    "Give it one from {low} to {high}: min() and max() keep what is calculated "
                    "within."
                ).given(low=low, high=high),
            ),
        )
    if "sequence" in what and "'float'" in what:
        return msg("a list of floats"), msg("Give it numbers in brackets, as [0.0, 1.5].")
    if "sequence" in what and "'str'" in what:
        return msg("a list of texts"), msg("Give it texts in brackets, as ['one', 'two'].")
    if "'float'" in what:
        return msg("a float"), msg(
            "Write {whole}.0 instead of {whole}, and float(...) around what may be an int.",
            whole=number if number and "." not in number else "2",
        )
    if "'int'" in what:
        number = number or "255.0"
        if field in _COLOURS and 0 < lint_findings.number(number) < 1:
            return msg("an int"), msg(
                "Colours are whole numbers from 0 to 255: write {whole} instead of {number}.",
                whole=round(255 * lint_findings.number(number)),
                number=number,
            )
        return msg("an int"), msg(
            "Write {whole} instead of {number}, and int(...) around what is calculated.",
            whole=number.partition(".")[0],
            number=number,
        )
    if "sub message" in what:
        kind = re.search(r"'(\w+)'", what)
        name = kind[1] if kind else "message"
        if name in ("Time", "Duration"):
            return msg("a {name} message", name=name), msg(
                "Write .to_msg() behind it: a clock's now().to_msg()."
            )
        return msg("a {name}", name=name), msg(
            "Set the parts of {field} one by one, as in msg.{field}.{part} = 1.0.",
            field=shown(field),
            part="z" if field == "angular" else "x",
        )
    return Message.of(what.rstrip(".")), msg(
        "`ros2 interface show TYPE` lists the fields of a message."
    )


def unanswered(case: Case) -> Diagnosis | None:
    """The callback of a service or an action returns nothing, where its answer is to be."""
    raised = case.raised
    if raised is None or raised.type not in ("TypeError", "AssertionError"):
        return None
    for finding in of_kind(case, "unanswered"):
        sign = "'result' field must be" if finding.near == "result" else ""
        if sign in raised.text and bool(sign) == bool(raised.text):
            return diagnosed(
                "unanswered",
                msg("{name}(){where} returns no {answer}, and so your node crashed{at}."),
                msg("Write `return {answer}` at the end of {name}()."),
                finding.place,
                _when(case, raised),
                name=shown(finding.name),
                answer=shown(finding.near),
            )
    return None


def ended_itself(case: Case) -> Diagnosis | None:
    """The program ended by sys.exit() with a text or a number."""
    if case.run.outcome != "crashed":
        return None
    raised = case.raised
    help_ = msg(
        "Look for sys.exit(), exit() or a return code of main(): a node that is"
        " to go on stays in rclpy.spin(node)."
    )
    if raised is not None and raised.type == "SystemExit":
        for finding in of_kind(case, "exits"):
            if finding.place.line == getattr(raised.place, "line", 0):
                help_ = msg(
                    "That line is reached where `{test}` is true: is that the right way round?",
                    test=shown(finding.name),
                )
        text = shown(raised.text)
        value = text if text.isdecimal() else repr(text)
        cause = msg("Your program ended itself{at} by sys.exit({value}){where}.", value=value)
        return diagnosed("ended_itself", cause, help_, raised.place, _when(case, raised))
    if raised is not None:
        return None
    cause = msg("Your program ended with exit code {exit_code}, by no exception.")
    if last := shown(case.last_line):
        cause = msg(
            "Your program ended with exit code {exit_code}, by no exception; the last that it "
            "printed is: {last!r}."
        )
    return diagnosed("ended_itself", cause, help_, exit_code=case.run.exit_code, last=last)


def crashed(case: Case) -> Diagnosis | None:
    raised = case.raised
    if case.run.outcome != "crashed" or raised is None or case.is_shut_down:
        return None
    hint = lint_hints.explain(case, raised)
    place = hint.place or raised.place
    cause = msg("Your node crashed{at}{error}{where}.", error=_error(raised, hint))
    if not hint.text:
        cause = cause.given(where=line(raised.place))
    found = diagnosed("crashed", cause, _help(raised, hint), place, _when(case, raised))
    return replace(found, cause=sentences(found.cause, _limit(case)))


def thread_exception(text: str) -> Raised | None:
    """Parse the first exception that ended a thread, as Python prints it."""
    found = _IN_THREAD.search(text)
    return last_exception(found[0]) if found else None


def thread_crashed(case: Case) -> Diagnosis | None:
    """An exception ended a thread, or the callback of an action, and the rest went on."""
    raised = case.raised or thread_exception(case.tail)
    if raised is None or case.raised is not None or raised.place is None:
        return None  # without a place: libraries' threads when the program ends
    of = msg("A thread of your program")
    if "Error raised in" in case.tail:
        of = msg("The callback of your action")
    hint = lint_hints.explain(case, raised)
    cause = msg("{of} crashed{error}{where}.", of=of, error=_error(raised, hint))
    return diagnosed("crashed", cause, _help(raised, hint), hint.place or raised.place)


def misses_message(case: Case) -> bool:
    """Whether the program crashed because it had no value yet, as one that a message brings."""
    raised = case.raised
    if raised is None:
        return False
    if "NoneType" in raised.text:
        return True
    # what is misspelt in __init__ needs no message
    in_init = raised.place is not None and raised.place.function.endswith("__init__")
    return raised.type == "AttributeError" and "has no attribute" in raised.text and not in_init


def _error(raised: Raised, hint: Hint) -> Message:
    """Return ': TypeError: its text', or ' (TypeError): ' and the hint's text."""
    name, text = shown(raised.type).rpartition(".")[2], shown(raised.text).rstrip(".")
    if hint.text:
        return msg(" ({name}): {error}", name=name, error=hint.text)
    text = clip(text, _LONGEST_ERROR)
    return msg(": {error}", error=f"{name}: {text}" if text else name)


def _help(raised: Raised, hint: Hint) -> Message:
    help_ = hint.help
    if not help_ and raised.place is None:
        help_ = msg("None of its lines is in your own files.")
    return sentences(help_, msg("The whole traceback is in output.txt."))


def killed(case: Case) -> Diagnosis | None:
    """A signal ended the program: its own, a library's or the kernel's."""
    run = case.run
    if run.outcome != "killed":
        return None
    raised = case.raised
    name = shown(raised.type) if raised is not None else _signal(run.exit_code)
    when, place = (None, None) if raised is None else (_when(case, raised), raised.place)
    signal = msg(" by the signal {name}", name=name) if name else ""
    cause = msg("Your program was killed{at}{signal}{where}.", signal=signal)
    if name in _SIGNALS:
        cause = msg("Your program was killed{at}{signal}{where}: {why}.", why=_SIGNALS[name])
    found = diagnosed("killed", cause, _signal_help(name), place, when, signal=signal)
    return replace(found, cause=sentences(found.cause, _limit(case)))


def _signal(exit_code: int | None) -> str:
    """Name the signal of an exit code; '' where the grader itself ended the program."""
    if exit_code is None:
        return ""
    with suppress(ValueError):
        return Signals(-exit_code).name
    return str(-exit_code)


def _signal_help(signal: str) -> Message:
    if signal == "SIGABRT":
        return msg(
            "Look at the values that this line gives to a message: 2.0 for a float,"
            " 255 for an int, and nothing beyond the range of its type."
        )
    if signal in ("SIGKILL", "SIGTERM"):
        return msg(
            "Look for os.kill() and for lists that grow without end; output.txt may tell more."
        )
    return msg("output.txt may tell more, and the remarks on the run below.")


def _limit(case: Case) -> Message:
    """Return the run's remark on a limit that was exceeded; nothing where there is none."""
    for flag in case.run.flags:
        if limit := flag.values.get("limit"):
            return msg("{remark!u}.", remark=limit)
        is_why = str(flag).startswith(("the node ", "the whole grading "))
        if is_why and case.run.outcome == "killed":
            return msg("{remark!u}.", remark=flag)
    return NOTHING


def _when(case: Case, raised: Raised) -> float | None:
    return raised.time_s if case.observed.is_known and raised is case.observed.raised else None
