"""Makes a check of each entry of `expect:`."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence, Set
from typing import Any, Final

from grader.exercise.cases import USUAL, RunCase
from grader.exercise.check import Checks
from grader.exercise.draws import DRAWN, Draw, examples, put_in
from grader.exercise.expect import judging
from grader.exercise.expect.expectations import Expectation, ExpectedTopic, parse
from grader.exercise.known_types import KnownTypes, check_time
from grader.exercise.verdict import Finding
from grader.recording.recording import Drawn, Recordings
from grader.scenes.cast import script
from grader.system import expressions
from grader.system.yaml_file import Mistake, expect
from grader.text.message import msg
from grader.text.strings import listed

#: What an expectation is about: its key -> the part of the peers, and whether that is known by an
#: id; what is expected of it -> the part of the definition that it is, and the one whose fields its
#: expressions may use.
_OF_PEERS: Final[Mapping[str, tuple[str, bool, Mapping[str, tuple[str, str | None]]]]] = {
    "call": ("calls", True, {"response": ("response", "request")}),
    "served": ("services", False, {"request": ("request", None)}),
    "goal": ("goals", True, {"feedback": ("feedback", "goal"), "result": ("result", "goal")}),
    "sends": ("actions", False, {"values": ("goal", None)}),
    "parameter": ("parameters", True, {}),
    "got": ("subscriptions", False, {}),
}

#: What of an entry names a drawn value, or something heard.
_WORD: Final = re.compile(rf"{DRAWN}\.|\bheard\b")


def add_checks(
    checks: Checks,
    data: Any,
    cases: Sequence[RunCase],
    known: KnownTypes,
    end_s: float,
    draws: Mapping[str, Draw],
    unheard: Set[str] = frozenset(),
) -> set[str]:
    """Add a check for each entry; return the topics that they judge.

    Args:
        cases: those of the exercise, with their peers.
        end_s: how long a run lasts [s].
        unheard: topics of the scene itself, of which nothing is recorded.

    Raises:
        Mistake: something in it is wrong; its keys name the place.
    """
    keys = ("expect",)
    what = "expected names of checks, each with what is expected; found {found}"
    expect(isinstance(data, dict) and bool(data), keys, what, data)
    named = [each.name or USUAL for each in cases]
    casts = [script.parse(each.cast or {}) for each in cases]
    made: dict[str, Expectation] = {}
    for name, values in data.items():
        at = (*keys, str(name))
        is_name = isinstance(name, str) and name.isidentifier()
        expect(is_name, at, "expected a name such as talks, found {found}", name)
        expectation = made[name] = parse(put_in(values, examples(draws), at), at)
        is_told = _WORD.search(repr({k: v for k, v in values.items() if k != "rubric"}))
        what = "no parrot passes what names something drawn or heard: leave it out"
        expect(not (expectation.parrot and is_told), (*at, "parrot"), what, "")
        unknown = sorted({*expectation.cases} - {*named})
        what = "expected some of {known}, found {found}"
        expect(not unknown, (*at, "cases"), what, unknown, known=", ".join(named))
        _check_fit(expectation, casts, known, at)
        for topic in unheard & {*map(script.absolute, expectation.topics)}:
            raise Mistake(
                at, "{topic} is the scene's: a cast hears programs and peers alone", topic=topic
            )
        begin_s, until_s = (getattr(expectation, key, 0.0) for key in ("begin", "end"))
        check_time(begin_s, end_s, (*at, "begin"))
        if begin_s > until_s > 0:
            raise Mistake((*at, "end"), "{end:g} s is before `begin`, {begin:g} s",
                          end=until_s, begin=begin_s)  # fmt: skip
        check = _check(str(name), expectation, values if draws else None)
        try:
            checks(after=expectation.after, parrot=expectation.parrot)(check)
        except ValueError as error:
            raise Mistake(at, msg("{what}", what=str(error))) from None
    topics = {topic for each in made.values() for topic in each.topics}
    hears = {topic for each in cases for topic in each.hears} | topics
    sent = {each.name for peers in casts for each in script.endpoints(peers)}
    there = sorted(sent.union(*(script.heard(peers, hears) for peers in casts)) - unheard)
    for name, expectation in made.items():
        asked = {each: getattr(expectation, each) for each in expectation.names}
        asked = {key: expressions.looked_up(said, "heard") for key, said in asked.items()}
        if heard := getattr(expectation, "heard", ""):
            asked["heard"] = {script.absolute(heard)}
        for key, wanted in asked.items():
            for topic in wanted - {*there}:
                what = "nobody hears {topic} here, only {known}"
                words = {"topic": repr(topic), "known": listed(there) or msg("none")}
                raise Mistake((*keys, name, key), what, **words)
    return topics


def _check_fit(
    wanted: Expectation,
    casts: Sequence[Mapping[str, script.Peer]],
    known: KnownTypes,
    at: tuple[str, ...],
) -> None:
    """Check that there is what something is expected of, and that values fit its type."""
    by, nodes = getattr(wanted, "by", ""), {name for peers in casts for name in peers}
    what = "expected a node of the cast, {nodes}; found {found}"
    expect(
        by.lstrip("/") in {"", *nodes},
        (*at, "by"),
        what,
        by,
        nodes=listed(sorted(nodes)) or msg("none"),
    )
    if isinstance(wanted, ExpectedTopic):
        hearing = [e for peers in casts for n, e in _entries(peers, "subscriptions")
                   if n == script.absolute(wanted.topic)]  # fmt: skip
        types = [wanted.type] if wanted.type else [t for each in hearing for t in each.types]
        for each in types:
            known.expect(each, (*at, "type"))
        known.check_each([wanted.values], types, "", (*at, "values"), is_expected=True)
    for key, (part, has_id, said) in _OF_PEERS.items():
        if not (name := getattr(wanted, key, "")):
            continue
        there = [[*_entries(peers, part, has_id=has_id)] for peers in casts]
        full = name if has_id else script.absolute(name)
        most = max(sum(each == full for each, _ in entries) for entries in there)
        if most < 1 or (has_id and most > 1):
            what = "expected one that a peer has among its {part}, {ids}; found {found}"
            ids = listed(dict.fromkeys(each for entries in there for each, _ in entries))
            raise Mistake((*at, key), what, part=part, ids=ids or msg("none"), found=repr(name))
        types = [t for entries in there for each, entry in entries if each == full
                 for t in getattr(entry, "types", ())]  # fmt: skip
        for field, (inner, asked) in said.items():
            value = getattr(wanted, field)
            values = [value] if field != "feedback" else value if isinstance(value, list) else []
            known.check_each(values, types, inner, (*at, field), asked, is_expected=True)
            if asked is not None:
                known.check_names(value, types, asked, {asked}, (*at, field))


def _entries(
    peers: Mapping[str, script.Peer], part: str, *, has_id: bool = False
) -> Iterator[tuple[str, Any]]:
    """Yield what peers have of a kind, by its id or else by its name."""
    for peer in peers.values():
        for key, entry in getattr(peer, part).items():
            yield (
                key if has_id else script.absolute(getattr(entry, script.KINDS[part].named_by)),
                entry,
            )


def _check(name: str, expectation: Expectation, written: Any) -> Any:
    """Return the function of a check.

    Args:
        written: the entry, where values are drawn; `expectation` is that of the examples.
    """

    def of_run(drawn: Drawn) -> Expectation:
        return parse(put_in(written, drawn), (name,)) if drawn and written else expectation

    def check(recordings: Recordings, tolerances: Mapping[str, Any]) -> Finding:
        return judging.judge(of_run, recordings)

    check.__name__ = name
    title = expectation.title or name.replace("_", " ").capitalize()
    check.__doc__ = f"{title}\n\n{expectation.rubric}"
    return check
