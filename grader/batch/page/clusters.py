"""Who failed alike: the same check, or the same first cause, said in the same kind of words."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

from grader import text
from grader.batch.page.kinds import kind_of
from grader.batch.page.students import STATES, Student
from grader.language.phrase import marked, say
from grader.language.telling import told
from grader.reports.wording import title_of

#: More kinds than this, of first causes and of a check, are told together.
MOST_CAUSES, MOST_KINDS = 24, 8
#: More students than this are only counted.
MOST_LINKS = 400
_TEXT_LIMIT = 400
RARER = say("rarer kinds")
#: What diagnoses are called, for the catalogues.
_KEYS: Final = (
    marked("called at once"),
    marked("crashed"),
    marked("does nothing"),
    marked("ended by caught"),
    marked("ended itself"),
    marked("endless loop"),
    marked("ends early"),
    marked("has unfit qos"),
    marked("hears once"),
    marked("hides errors"),
    marked("killed"),
    marked("makes timers"),
    marked("never awaits"),
    marked("never spins"),
    marked("not importable"),
    marked("publishes without waiting"),
    marked("slow callback"),
    marked("spins in loop"),
    marked("stays in init"),
    marked("stuck in call"),
    marked("stuck in callback"),
    marked("unreadable"),
    marked("waits for timer"),
    marked("waits in vain"),
    marked("wrong value"),
)


@dataclass(frozen=True)
class Said:
    """What is said of one student: under which heading, and the sentence."""

    student: Student
    heading: str
    sentence: str
    key: str = ""


@dataclass(frozen=True)
class Cluster:
    """Students of whom the same kind of thing is said.

    Attributes:
        heading: the title of a check, or the key of a diagnosis.
        example: the sentence that is said most often; '' of the rarer kinds together.
        nameless: the same without what could tell whose it is.
        students: by number, the first of them only, where there are very many.
        count: how many there are.
        causes: the keys of their diagnoses where these say more than the check, with their counts.
    """

    heading: str
    example: str
    nameless: str
    students: tuple[Student, ...]
    count: int
    causes: tuple[tuple[str, int], ...] = ()


def to_mend_first(students: Iterable[Student]) -> list[Cluster]:
    """What each should mend first, or why there is no result; nobody is in two of them."""
    said = [each for student in students if (each := _first_of(student)) is not None]
    return _clusters(said, MOST_CAUSES)


def of_check(students: Iterable[Student], check: str) -> list[Cluster]:
    """Why points of a check were lost."""
    said = [
        Said(student, told(title_of(verdict)), told(verdict.rationale), _diagnosed(student))
        for student in students
        if (verdict := student.verdicts.get(check)) is not None and not verdict.passed
    ]
    return _clusters(said, MOST_KINDS)


def _called(key: str) -> str:
    """A diagnosis in a word or two."""
    return told(key.replace("_", " "))


def _first_of(student: Student) -> Said | None:
    result = student.entry.result
    if result is None:
        state = student.entry.state
        return Said(student, told(STATES.get(state, state)), told(student.entry.message))
    found = result.diagnosis
    if found is not None and not found.check:
        return Said(student, _called(found.key), told(found.cause))
    lost = [verdict for verdict in result.verdicts if not verdict.passed]
    if not lost:
        return None
    costliest = max(lost, key=lambda verdict: verdict.max_score - verdict.score)
    verdict = costliest if found is None else student.verdicts.get(found.check, costliest)
    return Said(student, told(title_of(verdict)), told(verdict.rationale))


def _diagnosed(student: Student) -> str:
    result = student.entry.result
    found = None if result is None else result.diagnosis
    return "" if found is None or found.check else _called(found.key)


def _clusters(said: Sequence[Said], most: int) -> list[Cluster]:
    """So many, the largest first, and the others together."""
    groups: defaultdict[tuple[str, str], list[Said]] = defaultdict(list)
    for each in said:
        groups[each.heading, kind_of(each.sentence)].append(each)
    ordered = sorted(groups.items(), key=lambda group: (-len(group[1]), group[0]))
    shown = [_cluster(heading, kind, alike) for (heading, kind), alike in ordered[:most]]
    rest = [each for _, alike in ordered[most:] for each in alike]
    return [*shown, _cluster(told(RARER), "", rest)] if rest else shown


def _cluster(heading: str, kind: str, alike: Sequence[Said]) -> Cluster:
    members = sorted((each.student for each in alike), key=lambda student: student.number)
    nameless = kind
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


def _example(alike: Sequence[Said]) -> str:
    """What is said most often; of equals the shortest, then the first in the alphabet."""
    counted = Counter(_shown(each.sentence) for each in alike)
    return min(counted, key=lambda sentence: (-counted[sentence], len(sentence), sentence))


def _shown(sentence: str) -> str:
    return text.clip(text.one_line(text.plain(sentence)), _TEXT_LIMIT)
