"""The tutorials' own packages, all their scripts in them, are graded without an option."""

from pathlib import Path

import pytest
import yaml

from grader.exercise.loading import load_exercise
from grader.grading import grade
from grader.run.opening import open_submission
from tests import runs
from tests.files import lay

PACKAGES = yaml.safe_load(Path(__file__).with_name("official.yaml").read_text())
GRADED = [(name, exercise) for name, each in PACKAGES.items() for exercise in each["graded"]]
SETUP = """from glob import glob
from setuptools import find_packages, setup

setup(
    name={name!r},
    version='0.0.0',
    packages=find_packages(exclude=['test']),
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/{name}']),
        ('share/{name}', ['package.xml']),
        ('share/{name}/launch', glob('launch/*')),
    ],
    entry_points={{'console_scripts': {scripts!r}}},
)
"""
MANIFEST = """<package format="3">
  <name>{name}</name><version>0.0.0</version><description>TODO</description>
  <maintainer email="user@todo.todo">user</maintainer><license>TODO</license>
  {depends}
  <export><build_type>ament_python</build_type></export>
</package>
"""
DEPENDS = ("rclpy", "std_msgs", "example_interfaces", "geometry_msgs", "tf2_ros", "turtlesim")


def laid_out(folder, name):
    scripts, launch = PACKAGES[name]["scripts"], PACKAGES[name].get("launch", {})
    programs = {
        f"{name}/{script}.py": runs.path_of(f"tutorials/{of}/right/official").read_text()
        for script, of in scripts.items()
    }
    listed = [f"{script} = {name}.{script}:main" for script in scripts]
    depends = "".join(f"<depend>{each}</depend>" for each in DEPENDS)
    files = {
        "package.xml": MANIFEST.format(name=name, depends=depends),
        "setup.py": SETUP.format(name=name, scripts=listed),
        "setup.cfg": f"[install]\ninstall_scripts=$base/lib/{name}\n",
        f"resource/{name}": "",
        f"{name}/__init__.py": "",
        **programs,
        **{f"launch/{file}": text for file, text in launch.items()},
    }
    return lay(folder / name, files)


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
