"""Beginners' mistakes, made in right controllers, are named in the first line, at their line."""

import random
import shutil
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path, PurePath

import pytest

from grader.errors import GraderError
from grader.exercise.loading import load_exercise
from grader.grading import grade
from tests.conftest import EXAMPLES
from tests.runs import SUBMISSIONS
from tests.searches.mistakes import OPERATORS, Mutant, Operator

pytestmark = pytest.mark.more("a search; first_lines.yaml has a mistake of each kind")
RIGHT = SUBMISSIONS / "right"
#: A sample where few examples are asked for, as in CI, and in shorter runs.
IS_SAMPLE = EXAMPLES < 100
MISTAKES, SEED = 36 if IS_SAMPLE else 200, 11
#: Of those that lose points: what is to be right of the place, its line, and of the words [%].
LINE, WORDS = 75, 85
#: The processor time of a grading [s], and a run of the sample, in which a right one is over [s].
CPU_S, SHORT_S = 200.0, 65.0


@pytest.mark.parametrize("operator", OPERATORS, ids=lambda operator: operator.name)
def test_a_mistake_fits_a_right_controller_and_says_which_lines_are_to_be_changed(operator):
    texts = [path.read_text() for path in sorted(RIGHT.glob("*.py"))]
    found = [(text, operator.mutant(text, random.Random(1))) for text in texts]
    made = [(text, mutant) for text, mutant in found if mutant is not None]
    assert made
    for text, mutant in made:
        assert mutant == operator.mutant(text, random.Random(1))
        lines = mutant.source.split("\n")
        changed = [lines[each - 1] for each in mutant.lines]
        assert changed and mutant.source != text
        is_new = any(lines.count(row) > text.split("\n").count(row) for row in changed)
        assert is_new or operator.missing


@dataclass(frozen=True)
class Drawn:
    """A mistake in a controller, whose first line is to name it at a line to be changed."""

    operator: Operator
    submission: Path
    file: Path
    mutant: Mutant

    def is_at(self, found):
        place = found.place if found is not None else None
        is_there = place is not None and PurePath(place.file).name == self.file.name
        return is_there and place.line in self.mutant.lines

    def is_named_by(self, found):
        return found is not None and self.operator.named_by(f"{found.cause!s} {found.help!s}")


def some_mistakes():
    """Draw mistakes in controllers, of each class about as many."""
    chance = random.Random(SEED)
    controllers = []
    for path in sorted(RIGHT.iterdir()):
        files = [path] if path.suffix == ".py" else sorted((path / path.name).glob("[a-z]*.py"))
        controllers += [(path, file) for file in files]
    drawn, operators = 0, list(OPERATORS)
    while drawn < MISTAKES:
        chance.shuffle(operators)
        for operator in operators[: MISTAKES - drawn]:
            own = random.Random(f"{chance.random()}")  # the same, whatever is drawn for others
            for path, file in own.sample(controllers, len(controllers)):
                mutant = operator.mutant(file.read_text(encoding="utf-8"), own)
                if mutant is not None:
                    yield Drawn(operator, path, file, mutant)
                    break
            drawn += 1


def first_line(drawn, exercise):
    """Grade it; return whether it loses points or does not run to its end, and what is told."""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / drawn.submission.name
        if drawn.submission.is_dir():
            shutil.copytree(drawn.submission, copy)
        file = copy / drawn.file.relative_to(drawn.submission)
        file.write_text(drawn.mutant.source, encoding="utf-8")
        try:
            result = grade(copy, exercise)
        except GraderError:
            return False, None
    runs = (result.run, *result.varied_runs)
    is_over = all(each.outcome in ("finished", "exited") for each in runs)
    return result.score < result.max_score or not is_over, result.diagnosis


@pytest.mark.timeout(0)
def test_the_first_line_names_the_mistake_and_its_line():
    exercise = replace(load_exercise("turtlesim_challenge"), cpu_s=CPU_S)
    if IS_SAMPLE:
        limits = replace(exercise.limits, total_s=SHORT_S)
        exercise = replace(exercise, limits=limits, varied=replace(exercise.varied, count=1))
    drawn = list(some_mistakes())
    with ThreadPoolExecutor(2) as pool:
        told = list(pool.map(lambda each: first_line(each, exercise), drawn))
    of = [(each, found) for each, (loses, found) in zip(drawn, told, strict=True) if loses]
    elsewhere = [(d.operator.name, d.file.name, str(f)) for d, f in of if not d.is_at(f)]
    unnamed = [(d.operator.name, d.file.name, str(f)) for d, f in of if not d.is_named_by(f)]
    assert len(elsewhere) <= len(of) * (100 - LINE) / 100, elsewhere
    assert len(unnamed) <= len(of) * (100 - WORDS) / 100, unnamed
