"""The decorator that makes a function a check, and the loop that runs an exercise's checks.

A check is a function of a submission's recordings and the exercise's tolerances; the first line of
its docstring is the title that a student reads. Checks run in the order of their definition. One
that depends on a failed check is not judged, and names that one.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any

from grader.errors import CheckFailed
from grader.exercise import asking
from grader.exercise.asking import Answers, Check, CheckFunction, NoFinding, NotReached
from grader.exercise.verdict import Finding, Verdict
from grader.recording.recording import NominalAlone, NotOver, Recording, Recordings
from grader.text.message import NOTHING, Message, authored, chained, msg

Tolerances = Mapping[str, Any]
#: Raises a ValueError where a tolerance cannot be used.
Validator = Callable[[Any], None]
#: Returns the part of a recording that is judged.
SeenPart = Callable[[Recording], Recording]


#: Returns the finding of a check by its name; see `grader.exercise.asking.Answers`.
Ask = Callable[[str], Finding]


class Checks:
    """The checks of one exercise, in the order of their definition.

    Args:
        parts: whose checks come first.
    """

    def __init__(self, *parts: Checks) -> None:
        self._checks: list[Check] = [check for part in parts for check in part]
        self._validators: dict[str, Validator] = {}
        self._seen: SeenPart | None = None

    def __iter__(self) -> Iterator[Check]:
        return iter(self._checks)

    def copy(self) -> Checks:
        """Return a copy, to which others can be added."""
        return self.translated("", {})

    def translated(self, language: str, texts: Mapping[str, Mapping[str, str]]) -> Checks:
        """Return a copy with titles and rubrics in a language: check -> title, rubric -> text."""
        made = Checks()
        made._validators, made._seen = self._validators, self._seen
        for check in self:
            known = texts.get(check.name, {})
            title = check.title.translated(language, known.get("title"))
            rubric = check.rubric.translated(language, known.get("rubric"))
            made._checks.append(replace(check, title=title, rubric=rubric))
        return made

    def guarded(self, check: Check, seen: SeenPart) -> Checks:
        """Return a copy with one more check, whose checks see a part of each recording."""
        if check.name in {each.name for each in self}:
            raise ValueError(f"two checks are named {check.name!r}")
        made = self.copy()
        made._checks.append(check)
        made._seen = seen
        return made

    def see(self, recordings: Recordings) -> Recordings:
        """Return the part of recordings that these checks judge."""
        if self._seen is None:
            return recordings
        if isinstance(recordings, NominalAlone):
            return NominalAlone(self._seen(recordings.nominal))
        nominal, *varied = map(self._seen, recordings)
        return Recordings(nominal, tuple(varied))

    def tolerance(self, validate: Validator) -> Validator:
        """Register the decorated function as the validator of the tolerance that has its name.

        It is called when the exercise is loaded, if the yaml names the tolerance, and raises a
        ValueError that says what was expected and what was found.
        """
        self._validators[validate.__name__] = validate
        return validate

    def wrong_tolerance(self, tolerances: Tolerances) -> tuple[str, Message] | None:
        """Return the name of the first invalid tolerance, and why; None: all are valid."""
        for name, validate in self._validators.items():
            try:
                if name in tolerances:
                    validate(tolerances[name])
            except ValueError as error:
                return name, Message.of(error)
        return None

    def __call__(
        self, *wrong: object, after: tuple[str, ...] = (), parrot: str = ""
    ) -> Callable[[CheckFunction], CheckFunction]:
        """Register the decorated function; `after` names the checks it depends on.

        Args:
            parrot: see `Check`.

        Raises:
            ValueError: one of them is not defined above it, or the function's own name is taken.
            TypeError: it is no function of recordings and tolerances, or `after` is no tuple.
        """
        if wrong:
            raise TypeError("write @checks(), with brackets")
        if not isinstance(after, tuple | list) or not all(isinstance(n, str) for n in after):
            raise TypeError(f"after: expected a tuple of names, found {after!r}")
        unknown = set(after) - {check.name for check in self._checks}
        if unknown:
            raise ValueError(f"after: no check above is named {', '.join(sorted(unknown))}")

        def register(function: CheckFunction) -> CheckFunction:
            title, _, rubric = (inspect.getdoc(function) or function.__name__).partition("\n")
            name = function.__name__
            if name in {check.name for check in self._checks}:
                raise ValueError(f"two checks are named {name!r}")
            found = inspect.signature(function)
            try:
                found.bind(None, None)
            except TypeError:
                what = f"{name}: expected (recordings, tolerances), found {found}"
                raise TypeError(what) from None
            heading, rest = authored(title.strip().rstrip(".")), authored(rubric.strip())
            self._checks.append(Check(name, heading, function, tuple(after), rest, parrot))
            return function

        return register


def judge(
    recordings: Recordings, checks: Checks, points: Mapping[str, float], tolerances: Tolerances
) -> list[Verdict]:
    """Run every check that the exercise gives points for.

    Raises:
        CheckFailed: a check raised an exception, or returned no finding.
        KeyError: the exercise gives points to a check that does not exist.
    """
    lacking = next((each.run for each in recordings if each.run.outcome == "not_run"), None)
    if lacking is None:
        (answered,) = answers(recordings, checks, points, tolerances)
        return judge_by(answered, checks, points)
    (answered,) = answers(NominalAlone(recordings.nominal), checks, points, tolerances)

    def ask(name: str) -> Finding:
        try:
            if recordings.nominal.run is lacking:
                raise NotOver
            return answered(name)
        except NotOver:
            return Finding(0.0, msg("Not judged: {why}.", why=lacking.flags[0]), judged=False)

    return judge_by(ask, checks, points)


def answers(
    recordings: Recordings,
    checks: Checks,
    points: Mapping[str, float],
    tolerances: Tolerances,
    rounds: int = 1,
) -> list[Answers]:
    """Run the checks that the exercise gives points for; see `asking.ask`."""
    asked = [check for check in checks if check.name in points]
    return asking.ask(asked, checks.see(recordings), tolerances, rounds)


def judge_by(ask: Ask, checks: Checks, points: Mapping[str, float]) -> list[Verdict]:
    """Make the verdicts from findings that are known already; raises what `judge` raises."""
    known = {check.name: check for check in checks}
    verdicts: dict[str, Verdict] = {}
    for name in points:
        if name not in known:
            raise KeyError(f"no check is named {name!r}; there are {', '.join(known)}")
    for check in known.values():
        if check.name in points:
            verdicts[check.name] = judge_one(check, float(points[check.name]), ask, verdicts)
    return [verdicts[name] for name in points]


def judge_one(check: Check, max_score: float, ask: Ask, earlier: Mapping[str, Verdict]) -> Verdict:
    """Make the verdict of one check, if those that it depends on passed in the `earlier` ones.

    Raises:
        CheckFailed: it raised an exception, or returned no finding.
        NotOver: it needs a run that is not over.
    """
    blank = Verdict(
        *(check.name, check.title, "not_judged", 0.0, max_score, NOTHING),
        depends_on=check.depends_on,
    )

    def not_judged(rationale: Message, help: Message) -> Verdict:
        return replace(blank, rationale=rationale, help=help)

    missing = [n for n in check.depends_on if n in earlier and earlier[n].status != "passed"]
    if missing:
        titles = [msg("“{title}”", title=earlier[name].title) for name in missing]
        return not_judged(
            msg("Not judged, because {titles} did not pass.", titles=chained(titles)),
            msg("Look at {title} first.", title=titles[0]),
        )
    try:
        finding = ask(check.name)
    except NotReached as hit:
        return not_judged(
            msg(
                "Not judged: the check {name} {what}. That is a fault of the exercise, not of the "
                "submission.",
                name=repr(hit.by),
                what=hit.what,
            ),
            msg(
                "Tell the exercise's author: once the check is fixed, the recording can be "
                "judged again."
            ),
        )
    except NoFinding as error:
        raise CheckFailed(
            "the check {check!r} failed itself, so nothing was judged: {error}",
            check=check.name,
            error=str(error),
        ) from error
    if not finding.judged:
        return not_judged(finding.rationale, finding.help)
    share = min(max(float(finding.share), 0.0), 1.0)
    passed = share >= 1.0
    return replace(
        blank,
        status="passed" if passed else "failed",
        score=round(max_score * share, 2),
        rationale=finding.rationale,
        help=NOTHING if passed else finding.help,
        evidence=finding.evidence,
        expected=finding.expected,
    )


def judge_nominal(
    nominal: Recording, checks: Checks, points: Mapping[str, float], tolerances: Tolerances
) -> list[Verdict]:
    """Run the checks for which the nominal run is enough, and for those that they depend on.

    All others are left out. So is one that raises an exception: `judge` reports it.
    """
    (answered,) = answers(NominalAlone(nominal), checks, points, tolerances)
    verdicts: dict[str, Verdict] = {}
    waiting: set[str] = set()
    for check in checks:
        if check.name not in points:
            continue
        if not waiting.isdisjoint(check.depends_on):
            waiting.add(check.name)
            continue
        try:
            verdicts[check.name] = judge_one(check, float(points[check.name]), answered, verdicts)
        except (NotOver, CheckFailed):
            waiting.add(check.name)
    return [verdicts[name] for name in points if name in verdicts]
