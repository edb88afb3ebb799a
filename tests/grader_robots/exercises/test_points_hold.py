"""Less never earns more, and one more file never costs points: for each exercise about robots."""

import shutil
import tempfile
from functools import cache
from itertools import combinations
from pathlib import Path

import pytest
import yaml

from grader.exercise.loading import load_exercise
from grader.judging import judge
from grader.recording.recording import Recording, Recordings
from grader_robots.scene.driving import drive
from tests.grader_robots.exercises.test_state_publisher import walker
from tests.grader_robots.packages import looked_at, recorded
from tests.tiers import others_are_more

CASES = yaml.safe_load(Path(__file__).with_name("points_hold.yaml").read_text(encoding="utf-8"))
TAKEN, EXTRA = CASES["taken"], CASES["extra"]
MENDS = {frozenset(pair) for pair in CASES["mends"]}


@cache
def points(name: str, taken: frozenset[str], extra: str = "") -> float:
    """What the reference earns without these things."""
    exercise = load_exercise(name)
    with tempfile.TemporaryDirectory() as folder:
        package = Path(folder) / "package"
        shutil.copytree(exercise.folder / "reference", package)
        if extra:
            (package / extra).parent.mkdir(exist_ok=True)
            (package / extra).write_text(EXTRA[extra])
        for what in taken:
            for file, old, new in TAKEN[name][what]:
                path = package / file
                if not old:
                    path.unlink()
                elif path.exists():
                    text = path.read_text()
                    assert old in text, (what, file)
                    path.write_text(text.replace(old, new))
        trace = looked_at(package)
    recordings = recorded(trace)
    if name == "state_publisher":
        ran = drive(walker(without=taken), 1000, exercise.setting)
        recordings = Recordings(Recording(ran, scene="robot", package=trace))
    return judge(recordings, exercise).score


@pytest.mark.parametrize(
    "case",
    others_are_more(
        "half a second each",
        [((name, what),) for name, taken in TAKEN.items() for what in taken],
        ("description_package", "the end of the URDF"),
        ("thymio_package", "a wheel"),
        ("state_publisher", "the program's name"),
    ),
)
def test_what_is_taken_away_earns_no_points(case):
    name, what = case
    assert points(name, frozenset((what,))) <= points(name, frozenset()) == 100


@pytest.mark.more("a minute for each exercise")
@pytest.mark.timeout(1200)
@pytest.mark.parametrize("name", TAKEN)
def test_taking_away_one_thing_more_earns_no_points(name):
    gains = []
    for pair in map(frozenset, combinations(TAKEN[name], 2)):
        less = points(name, pair)
        for what in pair:
            if pair not in MENDS and less > points(name, frozenset((what,))):
                gains.append((what, *(pair - {what}), points(name, frozenset((what,))), less))
    assert gains == []


@pytest.mark.parametrize(
    "case",
    others_are_more(
        "half a second each",
        [((name, extra),) for name in TAKEN for extra in EXTRA],
        ("description_package", "launch/another.launch.py"),
    ),
)
def test_one_more_file_costs_nothing(case):
    name, extra = case
    assert points(name, frozenset(), extra) == 100
