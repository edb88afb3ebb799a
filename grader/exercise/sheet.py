"""Makes the exercise sheet: all that a student needs to know, from the exercise that will judge.

It is Markdown, in the language of this process's user. What an author has written about the
exercise in exercise.yaml (`title`, `task`, the comments beside its tolerances), in its translations
and in checks.py (the docstrings of the checks) is shown, with the numbers that are in force.
"""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import yaml

from grader.exercise.asking import Check
from grader.exercise.exercise import Exercise
from grader.exercise.places import DESCRIPTION
from grader.exercise.policies import LatePolicy
from grader.scenes.scene import Scene
from grader.scenes.subject import Subject
from grader.text.message import chained, joined, msg
from grader.text.strings import points
from grader.text.translations import current, tr, translate

_TOLERANCE = re.compile(r"\{(?P<name>\w+)(?P<percent>%?)\}")
#: A line of exercise.yaml in a part: blanks, key, value, perhaps a comment.
_VALUE = re.compile(r"^(\s+)([\w-]+)(:\s*)([^#\n]*?)(\s+#.*)?$")


@dataclass(frozen=True)
class Start:
    """The files that a student begins with.

    Attributes:
        program: the Python file that is their node, from the folder above where they begin.
        package: the ROS package that it is in; '' for none.
        grade: the command that grades it, from the folder above.
    """

    program: str
    package: str
    grade: str


def sheet(exercise: Exercise, subject: Subject, start: Start) -> str:
    trial = subject.how_to_try(start.program, start.package)
    parts = (
        [f"# {translate(exercise.title)}", in_force(translate(exercise.task), exercise.tolerances)],
        _judged(exercise, subject),
        _tolerances(exercise),
        [_heading(tr("How to try it")), trial] if trial else [],
        _how_to_submit(start, exercise),
    )
    texts = (text.strip("\n") for part in parts for text in part)
    return "\n\n".join(text for text in texts if text) + "\n"


def _judged(exercise: Exercise, subject: Subject) -> Iterator[str]:
    checks = {check.name: check for check in exercise.checks}
    worthy = {name: worth for name, worth in exercise.points.items() if worth}
    hidden = [worth for name, worth in worthy.items() if exercise.visible.get(name) == "never"]
    listed = [
        (checks[name], worth)
        for name, worth in worthy.items()
        if exercise.visible.get(name) != "never"
    ]
    yield _heading(tr("What it is worth: {points} points", points=points(exercise.max_score)))
    rows = [_row(tr("points"), tr("what is looked at"), tr("check")), "|---:|---|---|"]
    for check, worth in listed:
        rows.append(_row(points(worth), translate(check.title), f"`{check.name}`"))
    if number := len(hidden):
        what = tr("a check that no report shows", "{n} checks that no report shows", n=number)
        rows.append(f"| {points(sum(hidden))} | {what} | |")
    yield "\n".join(rows)
    shown = [check for check, _ in listed]
    yield "\n".join(_seen_of(exercise, shown))
    yield "\n".join(_waits(shown))
    for check, worth in listed:
        # empty where the author has written no more than a title
        if text := in_force(translate(check.rubric), exercise.tolerances):
            heading = tr("{title}: {points} points", title=check.title, points=points(worth))
            yield f"### {heading}"
            yield text
    yield _heading(tr("How it is judged"))
    yield _runs(exercise, subject)
    if exercise.allowed is not None:
        yield _wrapped(translate(exercise.allowed.text))
    if exercise.late is not None:
        yield from _late(exercise.late)


def _seen_of(exercise: Exercise, checks: Sequence[Check]) -> Iterator[str]:
    """Yield which checks a report shows later, or not all of, a line each."""
    sentences = {
        "after_due": msg(
            "Shown when the exercise is over, and until then in no report and no total: {checks}."
        ),
        "points_only": msg("A report shows the points of these, and not what was found: {checks}."),
    }
    for visible, sentence in sentences.items():
        names = [f"`{c.name}`" for c in checks if exercise.visible.get(c.name) == visible]
        if names:
            told = translate(sentence.given(checks=", ".join(names)))
            yield _wrapped(f"- {told}", indent="  ")


def _late(policy: LatePolicy) -> Iterator[str]:
    yield _heading(tr("When it is due"))
    sentences = [
        msg(
            "It is due on {date} at {time} (UTC{zone}).",
            date=f"{policy.due:%Y-%m-%d}",
            time=f"{policy.due:%H:%M:%S}",
            zone=policy.due.isoformat()[-6:],  # '+01:00'
        )
    ]
    if policy.grace_min:
        sentences.append(msg("Another {grace:g} minutes cost nothing.", grace=policy.grace_min))
    cost = msg("To hand it in later costs no points.")
    if policy.per_day and policy.most:
        cost = msg(
            "From then on each started day costs {per_day} points, {most} at most; nobody has "
            "fewer than 0 points.",
            per_day=points(policy.per_day),
            most=points(policy.most),
        )
    sentences.append(cost)
    yield _wrapped(translate(joined(sentences, " ")))


def _waits(checks: Iterable[Check]) -> Iterator[str]:
    """Yield what has to pass before another check is judged, a line each."""
    waiting: dict[tuple[str, ...], list[str]] = {}
    for check in checks:
        if check.depends_on:
            waiting.setdefault(check.depends_on, []).append(f"`{check.name}`")
    for first, names in waiting.items():
        waits = tr(
            "Judged only where {passed} passed: {checks}.",
            passed=chained([f"`{name}`" for name in first]),
            checks=", ".join(names),
        )
        yield _wrapped(f"- {waits}", indent="  ")


def _runs(exercise: Exercise, subject: Subject) -> str:
    thing = translate(subject.thing)
    if not exercise.is_started:
        return _wrapped(
            tr(
                "Nothing of your {thing} is started, and no time passes: what it installs and "
                "what it would start is found out by evaluating its set-up and its launch files, "
                "in a process that reaches nothing else. The same {thing} gets the same verdict "
                "every time, on any machine, with ROS and without.",
                thing=thing,
            )
        )
    limits, varied = exercise.limits, exercise.varied
    times = {"total_s": limits.total_s, "first_s": limits.first_motion_s}
    is_driven = isinstance(subject, Scene) and subject.usual_start is not None
    if subject.has_cast and not is_driven:
        text = tr(
            "Your node is run beside others for {total_s:g} simulated seconds, or until it ends. "
            "Time is simulated: the same program gets the same verdict every time, on any machine.",
            **times,
        )
    else:
        rests = msg(
            "when the {thing} has moved and then rested for {rest_s:g} s, ",
            thing=thing,
            rest_s=limits.rest_s,
        )
        text = tr(
            "Your node is run beside a simulator that shows no window, for {total_s:g} simulated "
            "seconds at most. The run ends before that {rests}when nothing has moved in the first "
            "{first_s:g} s, or when your node ends. Time is simulated: the same program gets the "
            "same verdict every time, on any machine.",
            rests=rests if limits.rest_s else "",
            **times,
        )
    elsewhere = tr(
        "One more run starts elsewhere, {nearest_m:g} to {farthest_m:g} m from the usual place: a "
        "program that reads the pose works there too, one that counts its steps does not.",
        "{n} more runs start elsewhere, {nearest_m:g} to {farthest_m:g} m from the usual place: a "
        "program that reads the pose works there too, one that counts its steps does not.",
        n=varied.count,
        nearest_m=varied.nearest_m,
        farthest_m=varied.farthest_m,
    )
    others = tr(
        "In one more run other nodes do something else, or yours has other arguments.",
        "In {n} more runs other nodes do something else, or yours has other arguments.",
        n=len(exercise.cases) - 1,
    )
    otherwise = tr(
        "In {n} more run {the_thing} starts elsewhere, or drives and turns faster or slower than "
        "it is commanded: a program that reads the pose works there too, one that counts steps or "
        "seconds does not.",
        "In {n} more runs {the_thing} starts elsewhere, or drives and turns faster or slower than "
        "it is commanded: a program that reads the pose works there too, one that counts steps or "
        "seconds does not.",
        n=varied.count,
        the_thing=translate(subject.the_thing),
    )
    drawn = tr(
        "What others send and ask is drawn for each run, such as {values}.",
        values=", ".join(f"`{name}` {each.example}" for name, each in exercise.draws.items()),
    )
    more = {
        drawn: exercise.draws,
        elsewhere: varied.count and not varied.runs,
        others: len(exercise.cases) > 1,
        otherwise: varied.runs,
    }
    return "\n\n".join(map(_wrapped, [text, *(each for each in more if more[each])]))


def _tolerances(exercise: Exercise) -> Iterator[str]:
    if exercise.tolerances:
        yield tr("The numbers that the checks go by (`_m` metres, `_s` seconds, `_deg` degrees):")
        yield f"```yaml\n{_explained(exercise) or _in_force(exercise)}\n```"


def _explained(exercise: Exercise) -> str:
    """Return the tolerances with their translated comments; '' where there are none."""
    explained = exercise.explained.get(current())
    if not explained:
        return ""
    lines = []
    for name, value in exercise.tolerances.items():
        text = explained.get(name)
        lines.append(f"{name}: {_in_yaml(value)}" + (f"  # {text}" if text else ""))
    return "\n".join(lines)


def _in_force(exercise: Exercise) -> str:
    """Return the tolerances with the comments of the exercise.yaml and the values in force."""
    text = (exercise.folder / DESCRIPTION).read_text(encoding="utf-8-sig")
    _, found, rest = text.partition("\ntolerances:")
    part = re.split(r"^(?=[^\s#])", rest.partition("\n")[2], maxsplit=1, flags=re.MULTILINE)[0]
    original = (yaml.safe_load(text) or {}).get("tolerances") or {}
    shown: list[str] = []
    missing = dict(exercise.tolerances)
    for line in part.rstrip().splitlines() if found else ():
        value = _VALUE.match(line)
        if value and (name := value[2]) in missing:
            now = missing.pop(name)
            if now != original.get(name):
                line = f"{value[1]}{name}: {_in_yaml(now)}{value[5] or ''}"
        shown.append(line.removeprefix("  "))
    return "\n".join([*shown, *(f"{name}: {_in_yaml(value)}" for name, value in missing.items())])


def _in_yaml(value: object) -> str:
    dumped: str = yaml.safe_dump(value, default_flow_style=True)
    return dumped.removesuffix("...\n").strip()


def _how_to_submit(start: Start, exercise: Exercise) -> Iterator[str]:
    yield _heading(tr("How to hand it in"))
    yield tr("Grade it yourself first, as often as you like, from the folder above this one:")
    yield f"    {start.grade}"
    yield _wrapped(
        tr(
            "The first line says what to fix first: the cause. `Where` below it is the place in "
            "your file, as far as it is known, `What to do` the way out. `report.html`, whose "
            "place stands in the last line, shows it in a picture. With `--watch` it is graded "
            "again whenever you save."
        )
    )
    if exercise.is_started:
        what = msg(
            "Hand in the .py file, the folder of the package, or a .zip of it, as your course asks."
        )
    else:
        what = msg("Hand in the folder of the package, or a .zip of it, as your course asks.")
    made = msg(
        "Leave out what is made: {folders}.",
        folders="`graded`, `build`, `install`, `log`, `__pycache__`",
    )
    yield _wrapped(translate(joined([what, made], " ")))


def _heading(text: str) -> str:
    return f"## {text}"


def _row(*cells: str) -> str:
    return f"| {' | '.join(cells)} |"


def _wrapped(text: str, indent: str = "") -> str:
    return textwrap.fill(
        text, 100, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False
    )


def in_force(text: str, tolerances: Mapping[str, Any]) -> str:
    """Fill in the tolerances that a text names in braces, as '{edge_m}'; all else is left."""

    def put_in(found: re.Match[str]) -> str:
        value = tolerances.get(found["name"])
        if isinstance(value, list):
            return ", ".join(map(str, value))
        if isinstance(value, bool) or not isinstance(value, int | float):
            return found[0] if value is None else str(value)
        return f"{100 * value:g} %" if found["percent"] else f"{value:g}"

    return _TOLERANCE.sub(put_in, text)
