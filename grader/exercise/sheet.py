"""The exercise sheet: all that a student needs to know, made from the exercise that will judge.

It is Markdown. What an author has written of the exercise in exercise.yaml (`title`, `task`, the
comments beside its tolerances) and checks.py (the docstrings of the checks) is shown, with the
numbers that are in force.
"""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from datetime import datetime

import yaml

from grader.exercise import rubric
from grader.exercise.check import Check
from grader.exercise.late import LatePolicy
from grader.exercise.loading import Exercise
from grader.exercise.places import DESCRIPTION
from grader.scenes.scene import Scene
from grader.text import points

#: How a check is told that students do not see at once, or not all of.
_SEEN = {
    "after_due": "Shown when the exercise is over, and until then in no report and no total",
    "points_only": "A report shows the points of these, and not what was found",
}
#: A line of exercise.yaml in a part: blanks, key, value, perhaps a comment.
_VALUE = re.compile(r"^(\s+)([\w-]+)(:\s*)([^#\n]*?)(\s+#.*)?$")


@dataclass(frozen=True)
class Start:
    """What a student begins with.

    Attributes:
        program: the Python file that is their node, relative to where they begin.
        package: the ROS package that it is in; '' for none.
        grade: the command that grades it, from the folder above.
    """

    program: str
    package: str
    grade: str


def sheet(exercise: Exercise, scene: Scene, start: Start) -> str:
    """The sheet."""
    parts = (
        [f"# {exercise.title}", rubric.in_force(exercise.task, exercise.tolerances)],
        _judged(exercise, scene),
        _tolerances(exercise),
        ["## How to try it", scene.how_to_try(start.program, start.package)],
        _handed_in(start, exercise),
    )
    texts = (text.strip("\n") for part in parts for text in part)
    return "\n\n".join(text for text in texts if text) + "\n"


def _judged(exercise: Exercise, scene: Scene) -> Iterator[str]:
    checks = {check.name: check for check in exercise.checks}
    worthy = {name: worth for name, worth in exercise.points.items() if worth}
    hidden = [worth for name, worth in worthy.items() if exercise.visible.get(name) == "never"]
    listed = [
        (checks[name], worth)
        for name, worth in worthy.items()
        if exercise.visible.get(name) != "never"
    ]
    yield f"## What it is worth: {points(exercise.max_score)} points"
    yield "\n".join(
        ["| points | what is looked at | check |", "|---:|---|---|"]
        + [f"| {points(worth)} | {check.title} | `{check.name}` |" for check, worth in listed]
        + ([f"| {points(sum(hidden))} | {_not_shown(len(hidden))} | |"] if hidden else [])
    )
    yield "\n".join(_seen_of(exercise, [check for check, _ in listed]))
    yield "\n".join(_waits([check for check, _ in listed]))
    for check, worth in listed:
        if text := rubric.told(check, exercise.tolerances):
            yield f"### {check.title}: {points(worth)} points"
            yield text
    yield "## How it is judged"
    yield _runs(exercise, scene)
    if exercise.late is not None:
        yield from _late(exercise.late)


def _not_shown(checks: int) -> str:
    return (
        "a check that no report shows" if checks == 1 else f"{checks} checks that no report shows"
    )


def _seen_of(exercise: Exercise, checks: Iterable[Check]) -> Iterator[str]:
    """Which checks a report shows later, or not all of, a line each."""
    named: dict[str, list[str]] = {"after_due": [], "points_only": []}
    for check in checks:
        named.get(exercise.visible.get(check.name, ""), []).append(f"`{check.name}`")
    for visible, names in named.items():
        if names:
            yield _wrapped(f"- {_SEEN[visible]}: {', '.join(names)}.", indent="  ")


def _late(policy: LatePolicy) -> Iterator[str]:
    yield "## When it is due"
    grace = f" Another {policy.grace_min:g} minutes cost nothing." if policy.grace_min else ""
    told = f"It is due on {policy.due:%Y-%m-%d at %H:%M:%S} (UTC{_zone(policy.due)}).{grace}"
    if not (policy.per_day and policy.most):
        yield _wrapped(f"{told} To hand it in later costs no points.")
        return
    yield _wrapped(
        f"{told} From then on each started day costs {points(policy.per_day)} points, "
        f"{points(policy.most)} at most; nobody has fewer than 0 points."
    )


def _zone(due: datetime) -> str:
    """'+01:00'."""
    return due.isoformat()[-6:]


def _waits(checks: Iterable[Check]) -> Iterator[str]:
    """What has to pass before something else is judged, a line each."""
    waiting: dict[tuple[str, ...], list[str]] = {}
    for check in checks:
        if check.depends_on:
            waiting.setdefault(check.depends_on, []).append(f"`{check.name}`")
    for first, names in waiting.items():
        passed = " and ".join(f"`{name}`" for name in first)
        yield _wrapped(f"- Judged only where {passed} passed: {', '.join(names)}.", indent="  ")


def _runs(exercise: Exercise, scene: Scene) -> str:
    if not exercise.is_started:
        return _wrapped(
            f"Nothing of your {scene.thing} is started, and no time passes: what it installs and "
            "what it would start is found out by evaluating its set-up and its launch files, in a "
            f"process that reaches nothing else. The same {scene.thing} gets the same verdict "
            "every time, on any machine, with ROS and without."
        )
    limits, varied = exercise.limits, exercise.varied
    rest = f"when the {scene.thing} has moved and then rested for {limits.rest_s:g} s, "
    rested = rest if limits.rest_s else ""
    told = [
        "Your node is run beside a simulator that shows no window, for "
        f"{limits.total_s:g} simulated seconds at most. The run ends before that "
        f"{rested}when nothing has moved "
        f"in the first {limits.first_motion_s:g} s, or when your node ends. Time is simulated: the "
        "same program gets the same verdict every time, on any machine.",
    ]
    if varied.count:
        runs = "One more run starts" if varied.count == 1 else f"{varied.count} more runs start"
        told.append(
            f"{runs} elsewhere, {varied.nearest_m:g} to {varied.farthest_m:g} m from the usual "
            "place: a program that reads the pose works there too, one that counts its steps does "
            "not."
        )
    return "\n\n".join(map(_wrapped, told))


def _tolerances(exercise: Exercise) -> Iterator[str]:
    if exercise.tolerances:
        yield "The numbers that the checks go by (`_m` metres, `_s` seconds, `_deg` degrees):"
        yield f"```yaml\n{_in_force(exercise)}\n```"


def _in_force(exercise: Exercise) -> str:
    """The tolerances as the exercise's own file explains them, with the values in force."""
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


def _handed_in(start: Start, exercise: Exercise) -> Iterator[str]:
    yield "## How to hand it in"
    yield "Grade it yourself first, as often as you like, from the folder above this one:"
    yield f"    {start.grade}"
    yield _wrapped(
        "The first line says what to mend first: the cause. `Where` below it is the place in your "
        "file, as far as it is known, `What to do` the way out. `report.html`, whose place stands "
        "in the last line, shows it in a picture. With `--watch` it is graded again whenever "
        "you save."
    )
    what = "the .py file, the folder" if exercise.is_started else "the folder"
    yield _wrapped(
        f"Hand in {what} of the package, or a .zip of it, as your course asks. "
        "Leave out what is made: `graded`, `build`, `install`, `log`, `__pycache__`."
    )


def _wrapped(text: str, indent: str = "") -> str:
    return textwrap.fill(
        text, 100, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False
    )
