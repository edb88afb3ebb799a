"""What a CMakeLists.txt installs, as far as it can be read."""

from pathlib import Path

import pytest
import yaml

from grader.submission.examining import cmake

FILES = ("launch/a.py", "urdf/a.urdf", "urdf/more/b.urdf", "rviz/a.rviz", "rviz/b.txt")


def read(folder, text):
    for name in FILES:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).touch()
    (folder / "CMakeLists.txt").write_text(f"project(a)\n{text}")
    return cmake.read(folder)


INSTALLS = yaml.safe_load(Path(__file__).with_name("cmake.yaml").read_text(encoding="utf-8"))


@pytest.mark.parametrize("case", INSTALLS, ids=range(len(INSTALLS)))
def test_what_is_installed_is_found(case, tmp_path):
    made = read(tmp_path, case["text"])
    assert (made.project, made.absent, made.problems) == ("a", [], [])
    assert [f"{path}: {name}" for path, name in made.files] == case["installs"]


@pytest.mark.parametrize(
    "name", ["${nobody}", "${nobody}/", "/", "/etc", "../..", "${CMAKE_BINARY_DIR}/a", "out"]
)
def test_what_nobody_knows_here_or_lies_elsewhere_is_not_followed(name, tmp_path):
    folder = tmp_path / "a"
    folder.mkdir()
    (folder / "out").symlink_to("/etc")
    made = read(folder, f"install(DIRECTORY {name} DESTINATION share/a)")
    assert (made.files, made.absent) == ([], [])
    (problem,) = made.problems
    assert (problem.kind, problem.file, problem.line) == ("unknown", "CMakeLists.txt", 2)


def test_what_is_not_there_is_told(tmp_path):
    made = read(tmp_path, "install(DIRECTORY launch meshes DESTINATION share/a)")
    assert made.absent == ["meshes"]
