"""The tutorials' own packages, all their scripts in them, are graded without an option."""

from pathlib import Path

import pytest
import yaml

from grader.exercise.loading import load_exercise
from grader.grading import grade
from grader.run.opening import open_submission
from tests import hand_ins, runs

PACKAGES = yaml.safe_load(Path(__file__).with_name("official.yaml").read_text())
GRADED = [(name, exercise) for name, each in PACKAGES.items() for exercise in each["graded"]]
DEPENDS = ("rclpy", "std_msgs", "example_interfaces", "geometry_msgs", "tf2_ros", "turtlesim")


def laid_out(folder, name):
    scripts, launch = PACKAGES[name]["scripts"], PACKAGES[name].get("launch", {})
    programs = {
        f"{name}/{script}.py": runs.path_of(f"tutorials/{of}/right/official").read_text()
        for script, of in scripts.items()
    }
    listed = [f"{script} = {name}.{script}:main" for script in scripts]
    files = {
        "package.xml": {"name": name, "depend": DEPENDS},
        "setup.py": {"console_scripts": listed, "data_files": ["launch/*"] if launch else []},
        **programs,
        **{f"launch/{file}": text for file, text in launch.items()},
    }
    return hand_ins.write(folder / name, files)


@pytest.mark.parametrize(("name", "exercise"), GRADED)
def test_each_exercise_finds_its_programs(tmp_path, name, exercise):
    asked = load_exercise(exercise).opening
    with open_submission(laid_out(tmp_path, name), **asked) as submission:
        found = [program.executable for program in submission.programs]
    assert found == PACKAGES[name]["graded"][exercise]


@pytest.mark.more("a grading of each official package")
@pytest.mark.parametrize(("name", "exercise"), GRADED)
def test_each_exercise_gives_all_points(tmp_path, name, exercise):
    result = grade(laid_out(tmp_path, name), exercise)
    assert result.score == result.max_score, [str(each.rationale) for each in result.verdicts]
