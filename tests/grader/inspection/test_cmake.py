"""What a CMakeLists.txt installs, as far as it can be read."""

from __future__ import annotations

import pytest

from grader.inspection.examining import cmake

FILES = ("launch/a.py", "urdf/a.urdf", "urdf/more/b.urdf", "rviz/a.rviz", "rviz/b.txt")


def read(folder, text: str) -> cmake.Read:
    for name in FILES:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).touch()
    (folder / "CMakeLists.txt").write_text(f"project(a)\n{text}")
    return cmake.read(folder)


@pytest.mark.parametrize(
    ("text", "files"),
    [
        (
            "install(DIRECTORY rviz DESTINATION share/a)",
            ["share/a/rviz: rviz/a.rviz", "share/a/rviz: rviz/b.txt"],
        ),
        ("install(FILES rviz/a.rviz DESTINATION share/${PROJECT_NAME})", ["share/a: rviz/a.rviz"]),
        (
            "foreach(d launch urdf)\ninstall(DIRECTORY ${d}/ DESTINATION share/${d})\nendforeach()",
            [
                "share/launch: launch/a.py",
                "share/urdf: urdf/a.urdf",
                "share/urdf/more: urdf/more/b.urdf",
            ],
        ),
        (
            "set(all launch rviz)\nforeach(d IN LISTS all)\n"
            "install(DIRECTORY ${d} DESTINATION share)\nendforeach(d)",
            ["share/launch: launch/a.py", "share/rviz: rviz/a.rviz", "share/rviz: rviz/b.txt"],
        ),
        (
            "file(GLOB found rviz/*.rviz)\ninstall(FILES ${found} DESTINATION share/a)",
            ["share/a: rviz/a.rviz"],
        ),
        (
            "file(GLOB_RECURSE found *.urdf)\n"
            "install(FILES ${found} DESTINATION ${CMAKE_INSTALL_PREFIX}/share/a)",
            ["share/a: urdf/a.urdf", "share/a: urdf/more/b.urdf"],
        ),
        (
            "install(DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/launch DESTINATION share/a)",
            ["share/a/launch: launch/a.py"],
        ),
        ("# install(DIRECTORY rviz DESTINATION share/a)", []),
        (
            "file(GLOB found RELATIVE ${CMAKE_CURRENT_LIST_DIR} rviz/*.rviz)\n"
            "install(FILES ${found} DESTINATION share/a)",
            ["share/a: rviz/a.rviz"],
        ),
        (
            "file(GLOB_RECURSE found ./urdf/**.urdf)\ninstall(FILES ${found} DESTINATION share/a)",
            ["share/a: urdf/a.urdf", "share/a: urdf/more/b.urdf"],
        ),
        ("file(GLOB found ./)\ninstall(FILES ${found} DESTINATION share/a)", []),
        (
            "if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/meshes)\n"
            "  install(DIRECTORY meshes DESTINATION share/a)\nendif()\n"
            "install(FILES rviz/a.rviz DESTINATION share/a)",
            ["share/a: rviz/a.rviz"],
        ),
    ],
)
def test_what_is_installed_is_found(text, files, tmp_path):
    made = read(tmp_path, text)
    assert (made.project, made.absent, made.problems) == ("a", [], [])
    assert [f"{where}: {name}" for where, name in made.files] == files


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
