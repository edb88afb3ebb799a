"""The right console script is chosen, and its module is taken from the submission alone."""

from pathlib import Path

import pytest

from grader.run.opening import open_submission
from grader.submission.start import EntryPoint
from tests.files import lay
from tests.grader.submission.copies import GUARDED, NODE, below, found_in, refused

SETUP = """
from setuptools import find_packages, setup
package_name = '{package}'
setup(
    name=package_name,
    packages=find_packages(exclude=['test']),
    entry_points={{'console_scripts': [{entries}]}},
)
"""


def package(name: str, *entries: str, module: str = "turtle_controller") -> dict[str, str]:
    """Write down an ament_python package as `ros2 pkg create` makes it."""
    listed = ", ".join(map(repr, entries or (f"turtle_controller = {name}.{module}:main",)))
    return {
        "package.xml": f"<package format='3'><name>{name}</name></package>",
        "setup.py": SETUP.format(package=name, entries=listed),
        "setup.cfg": f"[develop]\nscript_dir=$base/lib/{name}\n",
        f"resource/{name}": "",
        f"{name}/__init__.py": "",
        f"{name}/{module}.py": GUARDED,
        "test/test_flake8.py": "def main():\n    pass\n",
    }


# packages and workspaces


def test_a_package_starts_by_its_console_script(tmp_path: Path) -> None:
    lay(tmp_path / "spiral", package("spiral"))
    found = found_in(tmp_path / "spiral")
    assert (found.name, found.root) == ("spiral", tmp_path / "spiral")
    assert found.start == EntryPoint("spiral.turtle_controller", "main")
    assert str(found.found) == "console script turtle_controller in setup.py"


def test_turtle_controller_is_preferred_to_other_scripts(tmp_path: Path) -> None:
    target = "spiral.turtle_controller:main"
    lay(tmp_path, package("spiral", f"a = {target}", f"turtle_controller = {target}"))
    assert str(found_in(tmp_path).found) == "console script turtle_controller in setup.py"
    assert str(found_in(tmp_path, "a").found) == "console script a in setup.py"


def test_the_only_console_script_needs_no_particular_name(tmp_path: Path) -> None:
    lay(tmp_path, package("spiral", "draw = spiral.turtle_controller:main"))
    assert found_in(tmp_path).start == EntryPoint("spiral.turtle_controller", "main")


def test_several_console_scripts_are_listed_with_the_option_that_chooses(tmp_path: Path) -> None:
    target = "spiral.turtle_controller:main"
    text = refused(lay(tmp_path, package("spiral", f"a = {target}", f"b = {target}")))
    assert "several console scripts: a, b" in text
    assert "--executable NAME" in text


def test_an_executable_that_is_not_there_is_named_beside_those_that_are(tmp_path: Path) -> None:
    text = refused(lay(tmp_path, package("spiral")), "spirral")
    assert "no console script spirral; it has: turtle_controller" in text


def test_the_package_is_found_in_a_workspace(tmp_path: Path) -> None:
    lay(tmp_path, below("src/spiral", package("spiral")))
    lay(tmp_path, below("install/spiral", package("spiral")))
    lay(tmp_path, {"src/msgs/package.xml": "", "src/msgs/CMakeLists.txt": ""})
    submission = found_in(tmp_path)
    assert submission.root == tmp_path / "src/spiral"
    assert str(submission.found) == "console script turtle_controller in src/spiral/setup.py"


def test_of_several_packages_the_one_with_the_script_is_taken(tmp_path: Path) -> None:
    lay(tmp_path, below("src/a", package("a", "helper = a.turtle_controller:main")))
    lay(tmp_path, below("src/b", package("b")))
    assert found_in(tmp_path).root == tmp_path / "src/b"
    assert found_in(tmp_path, "helper").root == tmp_path / "src/a"


def test_the_same_script_in_two_packages_is_refused(tmp_path: Path) -> None:
    for name in ("a", "b"):
        lay(tmp_path, below(f"src/{name}", package(name)))
    assert "turtle_controller more than once: src/a/setup.py, src/b/setup.py" in refused(tmp_path)


def test_two_packages_that_each_have_the_only_script_are_refused(tmp_path: Path) -> None:
    for name in ("a", "b"):
        lay(tmp_path, below(f"src/{name}", package(name, f"draw = {name}.turtle_controller:main")))
    assert "draw more than once: src/a/setup.py, src/b/setup.py" in refused(tmp_path)


def test_a_package_may_be_called_test(tmp_path: Path) -> None:
    lay(tmp_path, below("src/test", package("test")))
    lay(tmp_path, {"src/README.md": ""})
    assert found_in(tmp_path).start == EntryPoint("test.turtle_controller", "main")


def test_a_broken_set_up_file_does_not_matter_beside_a_good_one(tmp_path: Path) -> None:
    lay(tmp_path, {"src/bad/setup.py": "setup(\n"} | below("src/good", package("good")))
    assert found_in(tmp_path).root == tmp_path / "src/good"
    assert "no console script other; it has: turtle_controller" in refused(tmp_path, "other")


def test_a_set_up_file_may_compute_its_scripts(tmp_path: Path) -> None:
    entries = "*(f'{name} = spiral.{name}:main' for name in ['turtle_controller'])"
    files = package("spiral") | {"setup.py": SETUP.format(package="spiral", entries=entries)}
    submission = found_in(lay(tmp_path, files))
    assert submission.start == EntryPoint("spiral.turtle_controller", "main")
    assert str(submission.found) == "console script turtle_controller in setup.py"


@pytest.mark.parametrize(
    ("setup", "why"),
    [
        ("setup(\n", "SyntaxError: '(' was never closed (setup.py, line 1)"),
        ("import no_such_module\n", "No module named 'no_such_module' (setup.py, line 1)"),
        ("import sys\nsys.exit(3)\n", "SystemExit: 3 (setup.py, line 2)"),
        ("import os\nos._exit(3)\n", "ended the process that it ran in (exit code 3)"),
    ],
)
def test_where_setup_py_cannot_be_evaluated_the_program_is_found_as_without_scripts(
    tmp_path: Path, setup: str, why: str
) -> None:
    submission = found_in(lay(tmp_path, package("spiral") | {"setup.py": setup}))
    assert submission.start == EntryPoint("spiral.turtle_controller", "main")
    assert str(submission.notes[0]).startswith("colcon would not build this: setup.py ")
    assert str(submission.notes[0]).endswith(why)
    files = package("spiral", module="draw") | {"spiral/pens.py": GUARDED, "setup.py": setup}
    assert refused(lay(tmp_path / "several", files)).endswith(f"{why}.")


def test_the_one_program_of_a_setup_py_without_scripts_is_started_and_the_line_told(
    tmp_path: Path,
) -> None:
    files = package("spiral") | {"setup.py": SETUP.format(package="spiral", entries="")}
    submission = found_in(lay(tmp_path, files))
    assert submission.start == EntryPoint("spiral.turtle_controller", "main")
    assert submission.root == tmp_path
    (note,) = (note for note in map(str, submission.notes) if "names no console script" in note)
    assert note.startswith("setup.py names no console script")
    assert "'turtle_controller = spiral.turtle_controller:main'" in note


def test_several_programs_and_a_setup_py_without_scripts_are_refused(tmp_path: Path) -> None:
    files = package("spiral", module="draw") | {"spiral/pens.py": GUARDED}
    files["setup.py"] = SETUP.format(package="spiral", entries="")
    text = refused(lay(tmp_path, files))
    assert "setup.py names no console script" in text
    assert "'turtle_controller = my_package.turtle_controller:main'" in text


# the module of a console script


def test_a_missing_module_is_never_taken_from_elsewhere(tmp_path: Path) -> None:
    text = refused(lay(tmp_path, package("spiral", "turtle_controller = json.tool:main")))
    assert "there is no file json/tool.py" in text


def test_a_missing_module_is_named_with_what_comes_near(tmp_path: Path) -> None:
    entry = "turtle_controller = spiral.turtle_controler:main"
    text = refused(lay(tmp_path, package("spiral", entry)))
    assert "no file spiral/turtle_controler.py. Near: spiral/turtle_controller.py." in text


def test_a_module_that_was_saved_as_text_is_named(tmp_path: Path) -> None:
    files = package("spiral")
    files["spiral/turtle_controller.py.txt"] = files.pop("spiral/turtle_controller.py")
    text = refused(lay(tmp_path, files))
    assert text.endswith(
        "There is spiral/turtle_controller.py.txt: rename it to turtle_controller.py, without .txt."
    )


def test_a_module_of_another_submission_is_out_of_reach(tmp_path: Path) -> None:
    setup = SETUP.format(package="alice", entries="'turtle_controller = bob.node:main'")
    setup = setup.replace("name=", "package_dir={'': '../'}, name=")
    lay(tmp_path, {"alice/setup.py": setup, "bob/node.py": NODE})
    assert "no file bob/node.py" in refused(tmp_path / "alice")


def test_a_source_layout_is_imported_from_its_folder(tmp_path: Path) -> None:
    setup = SETUP.format(package="s", entries="'turtle_controller = s.node:main'")
    setup = setup.replace("exclude=", "where='src', exclude=")
    lay(tmp_path, {"setup.py": setup, "src/s/__init__.py": "", "src/s/node.py": NODE})
    assert found_in(tmp_path).root == tmp_path / "src"


def test_a_module_may_lie_beside_setup_py(tmp_path: Path) -> None:
    setup = "from setuptools import setup\n"
    setup += "setup(py_modules=['n'], entry_points={'console_scripts': ['x = n:main']})\n"
    assert found_in(lay(tmp_path, {"setup.py": setup, "n.py": NODE})).start == EntryPoint(
        "n", "main"
    )


def test_a_missing_init_file_is_added_to_a_copy(tmp_path: Path) -> None:
    files = package("turtlesim_challenge")
    del files["turtlesim_challenge/__init__.py"]
    with open_submission(lay(tmp_path, files)) as submission:
        assert submission.root != tmp_path
        added = submission.root / "turtlesim_challenge"
        assert (added / "__init__.py").read_text() == ""
        assert (added / "turtle_controller.py").read_text() == GUARDED
        assert "with the missing turtlesim_challenge/__init__.py added" in str(submission.found)
    assert not submission.root.exists()
    assert not (tmp_path / "turtlesim_challenge/__init__.py").exists()


@pytest.mark.parametrize("source", ["", "src/"])
def test_a_missing_init_file_takes_nothing_away(tmp_path: Path, source: str) -> None:
    """Neither the package's own files where it has a source folder, nor packages beside it."""
    where = "where='src', exclude=" if source else "exclude="
    setup = SETUP.format(package="s", entries="'turtle_controller = s.node:main'")
    beside = {"my_desc/package.xml": "", "my_desc/urdf/robot.urdf": "<robot/>"}
    own = {
        "setup.py": setup.replace("exclude=", where),
        "package.xml": "",
        "launch/a.launch.py": "",
    }
    files = {f"my_pkg/{name}": text for name, text in own.items()} | beside
    with open_submission(lay(tmp_path, files | {f"my_pkg/{source}s/node.py": NODE})) as submission:
        package = submission.package
        assert package is not None
        assert submission.root == package / source
        assert (submission.root / "s/__init__.py").read_text() == ""
        assert (package / "launch/a.launch.py").exists()
        assert (package.parent / "my_desc/urdf/robot.urdf").exists()
        assert submission.copy is not None
        assert package.is_relative_to(submission.copy.folder)


def test_a_missing_function_is_named_with_those_that_are_there(tmp_path: Path) -> None:
    files = package("s") | {"s/turtle_controller.py": "class Node: ...\ndef Main(): ...\n"}
    text = refused(lay(tmp_path, files))
    assert "s/turtle_controller.py defines no function main (it defines: Main, Node)" in text


def test_a_module_that_does_not_parse_is_left_to_the_interpreter(tmp_path: Path) -> None:
    lay(tmp_path, package("s") | {"s/turtle_controller.py": "def main(:\n"})
    assert found_in(tmp_path).start == EntryPoint("s.turtle_controller", "main")
