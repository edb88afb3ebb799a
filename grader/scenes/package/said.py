"""What the process that looks at a package says of it, as phrases: it hands on plain texts."""

from __future__ import annotations

import re
import string
from collections.abc import Mapping
from typing import Final

from grader.language.phrase import Phrase, say
from grader.scenes.package.trace import Problem
from grader.text import clip_inside, without_controls

#: Stands for a value, where only the sentence counts.
_ANY: Final = ""
#: Values that have no blank in them: what looks alike and is somebody else's stays as it is.
_WORDS: Final = ("file", "module", "package", "program", "tag")

#: A text of the submission's in a sentence is no longer.
_LONGEST: Final = 200

#: What goes on from "it", or from the name of a file.
_CLAUSES: Final = (
    say("did not come to an end in {cpu} s of processor time, or {wall} s", cpu=_ANY, wall=_ANY),
    say("did not come to an end in {time} s of processor time", time=_ANY),
    say("did not come to an end in {time} s", time=_ANY),
    say("answered with more than {size}", size=_ANY),
    say("ended the process that it ran in"),
    say("ended the process that it ran in (exit code {code})", code=_ANY),
    say("ended the process that it ran in (signal {signal})", signal=_ANY),
    say("needed more memory than it may have"),
    say("called itself too deeply"),
    say("could not be started: {error}", error=_ANY),
    say("waited for what did not come"),
    say(
        "was not tried: the package had taken {cpu} s of processor time, or {idle} s of waiting",
        cpu=_ANY,
        idle=_ANY,
    ),
    say("spoils what is taken down of it"),
    say("takes away {file}", file=_ANY),
    say("cannot be read ({error})", error=_ANY),
    say("cannot be evaluated: {why}", why=_ANY),
    say("hands on a text of {length} characters; {most} at most are taken", length=_ANY, most=_ANY),
    say("hands on more than {most} descriptions and long texts", most=_ANY),
    say("is a text of {length} characters; {most} at most are taken", length=_ANY, most=_ANY),
    say("is more than {most} descriptions and long texts", most=_ANY),
    say("needs the environment variable {name}", name=_ANY),
    say("needs {name}, a file of another package", name=_ANY),
    say("uses {name}, which the grader does not have", name=_ANY),
    say("uses {name}, which the grader does not know", name=_ANY),
    say("imports {name}, which the grader does not have", name=_ANY),
    say("runs {name}, which is not here", name=_ANY),
    say("installs {name}", name=_ANY),
    say("does not parse: {error}", error=_ANY),
    say("has no <{tag}>", tag=_ANY),
    say("is not of the form 'name = module:function'"),
)
_SENTENCES: Final = (
    say("there is none"),
    say("there is no module {module}", module=_ANY),
    say("there is no {file}", file=_ANY),
    say("setup.py does not list the package {package}, so nothing installs it", package=_ANY),
    say("{file} cannot be read", file=_ANY),
    say("{file} does not parse", file=_ANY),
    say("{file} has no {name}", file=_ANY, name=_ANY),
    say("{file} has taken away {other}", file=_ANY, other=_ANY),
    say("nobody can look at it: {why}", why=_ANY),
    say("xacro is not installed where this was graded"),
    say("`{command}` asks a running system, which nobody has here", command=_ANY),
    say(
        "robot_state_publisher gets the description as a file, which it still reads, with a "
        "warning: give it the parameter robot_description"
    ),
    say(
        "robot_description is put through YAML, which takes most descriptions and not all: {code} "
        "keeps it as it is",
        code=_ANY,
    ),
    say(
        "its argument {name} has no default: looked at with {value}, the first of its choices",
        name=_ANY,
        value=_ANY,
    ),
)


def phrase_of(text: str) -> str:
    """The phrase that a text is in English; the text itself where it is none of these."""
    if text.startswith("it ") and isinstance(clause := _found(text[3:], _CLAUSES_BY), Phrase):
        return say("it {what}", what=clause)
    return _found(text, {**_CLAUSES_BY, **_SENTENCES_BY})


def how_it_ends(file: str, problem: Problem) -> str:
    """'setup.py ends with NameError: ... (setup.py, line 3)', '... did not come to an end ...'."""
    if problem.kind == "limit":
        what = shown(phrase_of(problem.text.removeprefix("it ")))
        return say("{file} {what}", file=file, what=what)
    return say(
        "{file} ends with {error}{place}", file=file, error=said(problem), place=placed(problem)
    )


def shown(text: str) -> str:
    """A text of the submission's in a sentence; a phrase that fits there stays one."""
    made = clip_inside(without_controls(" ".join(text.split()), "?"), _LONGEST).rstrip(".")
    return text if made == text else made


def said(problem: Problem) -> str:
    """What a problem says, in a sentence."""
    return shown(phrase_of(problem.text))


def placed(problem: Problem) -> str:
    """' (launch/display.launch.py, line 9)', with a blank before it; '' for no place."""
    if not problem.file:
        return ""
    if not problem.line:
        return f" ({problem.file})"
    return say(" ({file}, line {line})", file=problem.file, line=problem.line)


def _found(text: str, known: Mapping[str, re.Pattern[str]]) -> str:
    for key, pattern in known.items():
        if match := pattern.fullmatch(text):
            values = match.groupdict()
            return say(key, **{**values, **{n: phrase_of(values[n]) for n in values if n == "why"}})
    return text


def _patterns(phrases: tuple[Phrase, ...]) -> dict[str, re.Pattern[str]]:
    return {phrase.key: re.compile(_pattern(phrase.key)) for phrase in phrases}


def _pattern(key: str) -> str:
    parts = []
    for before, name, _, _ in string.Formatter().parse(key):
        parts.append(re.escape(before))
        if name is not None:
            parts.append(rf"(?P<{name}>(?!it )\S+)" if name in _WORDS else f"(?P<{name}>.+)")
    return "".join(parts)


_CLAUSES_BY: Final = _patterns(_CLAUSES)
_SENTENCES_BY: Final = _patterns(_SENTENCES)
