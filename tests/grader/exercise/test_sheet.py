"""The exercise sheet says all that is judged, with the numbers that are in force."""

import pytest

from grader.exercise.loading import load_exercise
from grader.exercise.sheet import Start, in_force, sheet
from grader.scenes.subject import load_subject
from tests.grader.testing import exercises
from tests.grader.testing.exercises import edited, refusal

START = Start("mine/pkg/node.py", "pkg", "grader run mine")


def sheet_of(where, start=START):
    exercise = load_exercise(where)
    return sheet(exercise, load_subject(exercise.scene), start)


#: Exercise -> what its sheet tells of how to try.
TRIED = {
    "turtlesim_challenge": ("    turtlesim\n    (cd mine && python3 -m pkg.node)\n", "save_canvas"),
    "talker_listener": ("    (cd mine && python3 -m pkg.node)\n", "ros2 node info"),
}


def expect_all_told(name, tried):
    exercise, text = load_exercise(name), sheet_of(name)
    assert text.startswith(
        f"# {exercise.title!s}\n\n{in_force(str(exercise.task), exercise.tolerances).strip()}\n\n"
        "## What it is worth: 100"
    )
    for check in exercise.checks:
        assert f"| {exercise.points[check.name]:g} | {check.title!s} | `{check.name}` |" in text
    assert f"{exercise.limits.total_s:g} simulated seconds" in " ".join(text.split())
    for key, value in exercise.tolerances.items():
        assert f"\n{key}: {value}" in text
    for words in (
        *tried,
        "    ros2 run pkg node\n",
        "report.html",
        "    grader run mine\n",
        "Hand in",
    ):
        assert words in text


@pytest.mark.parametrize("name", TRIED)
def test_the_sheet_of_an_exercise_of_ours_tells_task_points_limits_and_how_to_begin(name):
    expect_all_told(name, TRIED[name])


def test_numbers_are_those_in_force_and_keep_their_explanations(tmp_path):
    tolerances = {"edge_m": 1.25, "centres_m": [5.5]}
    text = sheet_of(edited(tmp_path, tolerances=tolerances, limits={"total_s": 240}))
    assert "\nedge_m: 1.25            # a stop this near a wall is near the edge" in text
    assert "\ncentres_m: [5.5]  # where students take the centre to be\n" in text
    assert "whichever of the four it is, between 0 and 1.25 m from it" in " ".join(text.split())
    assert "240 simulated seconds" in " ".join(text.split())


def test_an_exercise_needs_no_words_of_its_own_but_a_task_is_a_text(tmp_path):
    folder = exercises.write(tmp_path / "ahead", tolerances={"far_m": 0.5})
    text = sheet_of(folder, Start("mine/my_node.py", "", "grader run mine"))
    assert text.startswith("# Drive ahead\n\n## What it is worth: 10 points\n")
    assert "- Judged only where `commands` passed: `far`." in text
    assert "far_m: 0.5" in text
    assert "ros2 run " not in text.partition("To see")[0]
    assert "more run" not in text
    assert "task: expected a text, found 3" in refusal(exercises.write(tmp_path / "ahead", task=3))
