"""Cluster students who failed alike: by check or first cause, and by the kind of sentence."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

from grader import text
from grader.batch.page.students import GAP, STATES, Student
from grader.message import NOTHING, Message, Value, joined, msg
from grader.reports.wording import title_of
from grader.translations import translate

#: More kinds than this, of first causes and of a check, are merged into one cluster.
MOST_CAUSES, MOST_KINDS = 24, 8
#: More students than this are only counted.
MOST_LINKS = 400
_TEXT_LIMIT = 400
RARER = msg("rarer kinds")
#: Diagnoses in words, by their keys.
_CALLED: Final = {
    str(each).replace(" ", "_"): each
    for each in (
        msg("called at once"),
        msg("crashed"),
        msg("does nothing"),
        msg("ended by caught"),
        msg("ended itself"),
        msg("endless loop"),
        msg("ends early"),
        msg("has unfit qos"),
        msg("hears once"),
        msg("hides errors"),
        msg("killed"),
        msg("makes timers"),
        msg("never awaits"),
        msg("never spins"),
        msg("not importable"),
        msg("publishes without waiting"),
        msg("slow callback"),
        msg("spins in loop"),
        msg("stays in init"),
        msg("stuck in call"),
        msg("stuck in callback"),
        msg("unreadable"),
        msg("waits for timer"),
        msg("waits in vain"),
        msg("wrong value"),
    )
}
#: The name of an exception is the kind of a mistake.
_ERROR = re.compile(r"\w*(?:Error|Exception|Warning|Interrupt)\b")
_WORD = re.compile(r"\w+")
#: Fewer words are a name: a colour, a side.
_CLAUSE = 3
#: How much of a student's text is searched [characters].
_LIMIT = 600


@dataclass(frozen=True)
class Remark:
    """A sentence about one student, with its heading."""

    student: Student
    heading: str
    sentence: Message
    key: str = ""


@dataclass(frozen=True)
class Cluster:
    """Students with the same kind of sentence.

    Attributes:
        heading: the title of a check, or a diagnosis in words.
        example: the most frequent sentence; '' for the rarer kinds together.
        nameless: the kind of sentence without anything that identifies a student.
        students: sorted by number; at most `MOST_LINKS`.
        count: the number of all of them.
        causes: their diagnoses where these are more specific than the check, with their counts.
    """

    heading: str
    example: str
    nameless: str
    students: tuple[Student, ...]
    count: int
    causes: tuple[tuple[str, int], ...] = ()


def to_mend_first(students: Iterable[Student]) -> list[Cluster]:
    """Cluster what each should fix first, or why there is no result; nobody is in two clusters."""
    remarks = [each for student in students if (each := _first_of(student)) is not None]
    return _clusters(remarks, MOST_CAUSES)


def of_check(students: Iterable[Student], check: str) -> list[Cluster]:
    """Cluster why points of a check were lost, but for those whom an earlier check cost them."""
    remarks = [
        Remark(student, title_of(verdict), verdict.rationale, _diagnosed(student))
        for student in students
        if (verdict := student.entry.verdicts.get(check)) is not None
        and not (verdict.passed or verdict.waited_for(student.entry.verdicts))
    ]
    return _clusters(remarks, MOST_KINDS)


def _called(key: str) -> str:
    """Return a diagnosis in a word or two."""
    return translate(_CALLED.get(key) or key.replace("_", " "))


def _first_of(student: Student) -> Remark | None:
    result = student.entry.result
    if result is None:
        state = student.entry.state
        return Remark(student, translate(STATES.get(state, NOTHING)), student.entry.message)
    found = result.diagnosis
    if found is not None and not found.check:
        return Remark(student, _called(found.key), found.cause)
    lost = [verdict for verdict in result.verdicts if not verdict.passed]
    if not lost:
        return None
    costliest = max(lost, key=lambda verdict: verdict.max_score - verdict.score)
    verdict = costliest if found is None else student.entry.verdicts.get(found.check, costliest)
    return Remark(student, title_of(verdict), verdict.rationale)


def _diagnosed(student: Student) -> str:
    result = student.entry.result
    found = None if result is None else result.diagnosis
    return "" if found is None or found.check else _called(found.key)


def _clusters(remarks: Sequence[Remark], most: int) -> list[Cluster]:
    """Return at most so many clusters, the largest first, and one of all others."""
    groups: defaultdict[tuple[str, Message], list[Remark]] = defaultdict(list)
    for each in remarks:
        groups[each.heading, kind_of(each.sentence)].append(each)
    ordered = sorted(groups.items(), key=_order)
    shown = [_cluster(heading, kind, alike) for (heading, kind), alike in ordered[:most]]
    rest = [each for _, alike in ordered[most:] for each in alike]
    return [*shown, _cluster(translate(RARER), NOTHING, rest)] if rest else shown


def _order(group: tuple[tuple[str, Message], list[Remark]]) -> tuple[int, str, str]:
    (heading, kind), alike = group
    return -len(alike), heading, str(kind)


def _cluster(heading: str, kind: Message, alike: Sequence[Remark]) -> Cluster:
    members = sorted((each.student for each in alike), key=lambda student: student.number)
    nameless = translate(kind)
    for student in members:
        nameless = student.without_names(nameless)
    causes = Counter(each.key for each in alike if each.key)
    return Cluster(
        _shown(heading),
        _example(alike) if kind else "",
        _shown(nameless),
        tuple(members[:MOST_LINKS]),
        len(members),
        tuple(sorted(causes.items(), key=lambda cause: (-cause[1], cause[0]))[:3]),
    )


def _example(alike: Sequence[Remark]) -> str:
    """Return the most frequent sentence; of equals the shortest, then the first in the alphabet."""
    counted = Counter(_shown(translate(each.sentence)) for each in alike)
    return min(counted, key=lambda sentence: (-counted[sentence], len(sentence), sentence))


def _shown(sentence: str) -> str:
    return text.clip(text.one_line(text.plain(sentence)), _TEXT_LIMIT)


def kind_of(message: Message) -> Message:
    """Return a message without what differs between students."""
    if message.is_row:  # the number of its parts makes no other kind
        parts = (part for part in message.values.values() if _WORD.search(str(part)))
        return joined(dict.fromkeys(map(_kind, parts)), " ")
    values = {name: _kind(value) for name, value in message.values.items()}
    return Message(message.key, values, message.many, message.words)


def _kind(value: Value) -> str | Message:
    if isinstance(value, Message):
        kind = kind_of(value)
        return kind if len(_WORD.findall(str(kind))) >= _CLAUSE else _kind(str(value))
    if isinstance(value, str) and (error := _ERROR.search(value[:_LIMIT])):
        return error[0]
    return GAP
